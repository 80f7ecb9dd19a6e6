//! Products lambda . dr of a beam's points, written out because they would take most of the time of an adjoint sweep with beams; the
//! contract tests hold them against those by differentiation.

use super::beam::{BeamField, GEOMETRY, Reference, STRAINS};
use crate::elements::PointGradient;
use crate::scalar::{Quaternion, SpatialVector, Vector3, rotation_gradient_transposed, tensor_gradient, tensor_times};

#[inline(always)]
fn add(target: &mut [f64], factor: f64, values: &[f64]) {
    target.iter_mut().zip(values).for_each(|(target, value)| *target += factor * value);
}

/// (dr/dxi, e, de/dxi), or a change of them.
#[derive(Clone, Copy)]
struct Place {
    x: Vector3<f64>,
    e: Quaternion<f64>,
    d: Quaternion<f64>,
}

impl Place {
    #[inline(always)]
    fn of(h: &[f64]) -> Self {
        Place { x: Vector3::first_three(h), e: Quaternion::from_slice(&h[3..]), d: Quaternion::from_slice(&h[7..]) }
    }
}

/// Both strains before Lambda^T: `back` = R^T x and `turned` = 2 G(e) d, times `scale` = 1 / (J |e|^2).
struct Strained {
    at: Place,
    /// 1 / |e|^2.
    inverse: f64,
    scale: f64,
    back: Vector3<f64>,
    turned: Vector3<f64>,
}

/// How they change along a direction; the relative change of the scale is `shrink`.
struct Change {
    along: Place,
    shrink: f64,
    scale: f64,
    back: Vector3<f64>,
    turned: Vector3<f64>,
}

/// Adjoints of a place and of what follows from it.
struct Adjoint {
    x: Vector3<f64>,
    e: [f64; 4],
    d: [f64; 4],
    scale: f64,
    /// That of `inverse`, times it, by changes.
    inverse: f64,
    back: Vector3<f64>,
    turned: Vector3<f64>,
}

impl Strained {
    #[inline(always)]
    fn new(at: Place, metric: f64) -> Self {
        let Place { x, e, d } = at;
        let inverse = 1.0 / e.dot(e);
        Strained { at, inverse, scale: inverse / metric, back: e.rotate_back(x), turned: e.g_times(d) * 2.0 }
    }
    #[inline(always)]
    fn change(&self, along: Place) -> Change {
        let Place { x, e, d } = self.at;
        let shrink = -2.0 * self.inverse * e.dot(along.e);
        let opposite = |Quaternion([a, x, y, z]): Quaternion<f64>| Quaternion([a, -x, -y, -z]);
        Change {
            along,
            shrink,
            scale: shrink * self.scale,
            back: e.rotate_back(along.x) + opposite(e).rotate_rate(opposite(along.e), x),
            turned: (along.e.g_times(d) + e.g_times(along.d)) * 2.0,
        }
    }
    /// (Stretch, bend).
    #[inline(always)]
    fn strains(&self) -> [Vector3<f64>; 2] {
        [self.back * self.scale, self.turned * self.scale]
    }
    #[inline(always)]
    fn changes(&self, change: &Change) -> [Vector3<f64>; 2] {
        [self.back * change.scale + change.back * self.scale, self.turned * change.scale + change.turned * self.scale]
    }
    /// Takes adjoints of changes back, and returns the one of `shrink`.
    #[inline(always)]
    fn add_change(&self, change: &Change, [stretch_bar, bend_bar]: [Vector3<f64>; 2], into: &mut Adjoint) -> f64 {
        let Place { x, e, .. } = self.at;
        let along = &change.along;
        let (back_bar, turned_bar) = (stretch_bar * self.scale, bend_bar * self.scale);
        let scale_bar = self.back.dot(&stretch_bar) + self.turned.dot(&bend_bar);
        let shrink_bar = self.scale * scale_bar;
        into.back += stretch_bar * change.scale;
        into.turned += bend_bar * change.scale;
        into.scale += change.back.dot(&stretch_bar) + change.turned.dot(&bend_bar) + change.shrink * scale_bar;
        into.inverse += change.shrink * shrink_bar;
        into.x += e.rotate_rate(along.e, back_bar);
        add(&mut into.e, 1.0, &rotation_gradient_transposed(e, back_bar, along.x));
        add(&mut into.e, 1.0, &rotation_gradient_transposed(along.e, back_bar, x));
        add(&mut into.e, -2.0, &along.d.g_transposed_times(turned_bar));
        add(&mut into.e, -2.0 * self.inverse * shrink_bar, &along.e.0);
        add(&mut into.d, 2.0, &along.e.g_transposed_times(turned_bar));
        shrink_bar
    }
    /// Adds what the adjoints of `back` and `turned` make of those of (x, e, d).
    #[inline(always)]
    fn add_place(&self, back_bar: Vector3<f64>, turned_bar: Vector3<f64>, h_bar: &mut [f64]) {
        let Place { x, e, d } = self.at;
        add(h_bar, 1.0, &e.rotate(back_bar).components());
        add(&mut h_bar[3..7], 1.0, &rotation_gradient_transposed(e, back_bar, x));
        add(&mut h_bar[3..7], -2.0, &d.g_transposed_times(turned_bar));
        add(&mut h_bar[7..], 2.0, &e.g_transposed_times(turned_bar));
    }
}

/// Adds the gradient of phi = lambda . r of a tying point, r = J B^T C (strain + eta B v): with the changes dstrain of the strains along lambda and
/// the rates of the strains along v, phi = J dstrain . C (strain + eta rate).
///
/// Both strains are Lambda^T of (R^T x, 2 G(e) d) s - (1, 0, ..) with s = 1 / (J |e|^2); numbers along lambda begin with `d_`.
#[inline(always)]
pub(super) fn add_strain_products(
    beam: &BeamField,
    [v, h]: [&[f64]; 2],
    p: &[f64],
    lambda: &[f64],
    into: &mut PointGradient,
) {
    let reference = Reference::of(p);
    let metric = reference.metric;
    let (stiffness, damping) = beam.stiffness_and_damping(p);
    let at = Strained::new(Place::of(h), metric);
    let (change, motion) = (at.change(Place::of(lambda)), if beam.damped { Some(at.change(Place::of(v))) } else { None });
    let components = |[stretch, bend]: [Vector3<f64>; 2]| -> [f64; STRAINS] {
        let ([a, b, c], [d, e, f]) = (reference.components(stretch), reference.components(bend));
        [a, b, c, d, e, f]
    };
    let (strains, changes) = (at.strains(), at.changes(&change));
    // strain + eta rate
    let mut together = strains;
    let rates = motion.as_ref().map(|motion| at.changes(motion));
    if let Some(rates) = rates {
        (0..2).for_each(|kind| together[kind] += rates[kind] * damping);
    }
    let (mut strain, d_strain) = (components(together), components(changes));
    strain[0] -= 1.0;

    // back: adjoints of the strains, of their rates by damping, and of their changes
    let mut strain_bar = beam.stiffness_times(stiffness, d_strain);
    let stress = beam.stiffness_times(stiffness, strain);
    let mut d_strain_bar = stress;
    for i in 0..STRAINS {
        strain_bar[i] *= metric;
        d_strain_bar[i] *= metric;
    }
    let of =
        |bar: &[f64; STRAINS]| [reference.combine([bar[0], bar[1], bar[2]]), reference.combine([bar[3], bar[4], bar[5]])];
    let [stretch_bar, bend_bar] = of(&strain_bar);
    let mut adjoint = Adjoint {
        x: Vector3::zeros(),
        e: [0.0; 4],
        d: [0.0; 4],
        scale: at.back.dot(&stretch_bar) + at.turned.dot(&bend_bar),
        inverse: 0.0,
        back: stretch_bar * at.scale,
        turned: bend_bar * at.scale,
    };
    at.add_change(&change, of(&d_strain_bar), &mut adjoint);
    let [_, v_bar, h_bar] = &mut into.state;
    if let Some(motion) = &motion {
        let bars = [stretch_bar * damping, bend_bar * damping];
        let shrink_bar = at.add_change(motion, bars, &mut adjoint);
        at.add_place(bars[0] * at.scale, bars[1] * at.scale, v_bar);
        add(&mut v_bar[3..7], -2.0 * at.inverse * shrink_bar, &at.at.e.0);
    }
    at.add_place(adjoint.back, adjoint.turned, h_bar);
    add(h_bar, 1.0, &adjoint.x.components());
    add(&mut h_bar[3..7], 1.0, &adjoint.e);
    add(&mut h_bar[3..7], -2.0 * at.inverse * (adjoint.inverse + at.scale * adjoint.scale), &at.at.e.0);
    add(&mut h_bar[7..], 1.0, &adjoint.d);

    if into.p.is_empty() {
        return;
    }
    let mut energy = 0.0;
    for i in 0..STRAINS {
        energy += d_strain[i] * stress[i];
    }
    into.p[0] += energy - adjoint.scale * at.scale / metric;
    let mut axes_bar = [Vector3::zeros(); 3];
    for (i, axis) in axes_bar.iter_mut().enumerate() {
        for kind in 0..2 {
            *axis += together[kind] * strain_bar[3 * kind + i] + changes[kind] * d_strain_bar[3 * kind + i];
        }
    }
    let [tangent, second, _] = reference.axes;
    add(&mut into.p[1..4], 1.0, &(axes_bar[0] + second.cross(&axes_bar[2])).components());
    add(&mut into.p[4..7], 1.0, &(axes_bar[1] + axes_bar[2].cross(&tangent)).components());
    let stiffness_bar = &mut into.p[GEOMETRY..];
    for i in 0..STRAINS {
        stiffness_bar[i] += metric * d_strain[i] * strain[i];
    }
    if beam.coupled {
        let mut entry = STRAINS;
        for i in 0..STRAINS {
            for j in i + 1..STRAINS {
                stiffness_bar[entry] += metric * (d_strain[i] * strain[j] + d_strain[j] * strain[i]);
                entry += 1;
            }
        }
    }
    if let Some([stretch_rate, bend_rate]) = rates {
        stiffness_bar[stiffness.len()] += stretch_bar.dot(&stretch_rate) + bend_bar.dot(&bend_rate);
    }
}

/// Adds the gradient of phi = lambda . r of a Gauss point: with y(z) = 2 G(e) z / |e|^2 and omega = y(e'), delta = y(lambda_e),
///
/// phi = lambda_x . (m a + R (z) / |e|^2) + delta . (J alpha + omega x J omega + s x R^T a / |e|^2),
///
/// alpha = y(e'') - omega 2 e . e' / |e|^2, z = alpha x s + omega x (omega x s).
#[inline(always)]
pub(super) fn add_inertia_products(
    beam: &BeamField,
    [a, v, h]: [&[f64]; 3],
    p: &[f64],
    lambda: &[f64],
    into: &mut PointGradient,
) {
    let quaternion = |h: &[f64]| Quaternion::from_slice(&h[3..]);
    let (e, rate, second, turn) = (quaternion(h), quaternion(v), quaternion(a), quaternion(lambda));
    let (acceleration, shift) = (Vector3::first_three(a), Vector3::first_three(lambda));
    let inverse = 1.0 / e.norm_squared();
    let twice = 2.0 * inverse;
    let [omega, swing, delta] = [rate, second, turn].map(|z| e.g_times(z) * twice);
    let along = twice * e.dot(rate);
    let alpha = swing - omega * along;
    let tensor = &p[4..];
    let momentum = tensor_times(tensor, omega);
    let cross = delta.cross(&omega);

    let mut delta_bar = tensor_times(tensor, alpha) + omega.cross(&momentum);
    let mut alpha_bar = tensor_times(tensor, delta);
    let mut omega_bar = momentum.cross(&delta) + tensor_times(tensor, cross);
    let mut acceleration_bar = shift * p[0];
    let mut e_bar = [0.0; 4];
    // 1 / |e|^2 times its adjoint
    let mut inverse_part = 0.0;
    let mut arm_bar = Vector3::zeros();
    if beam.eccentric {
        let arm = Vector3::first_three(&p[1..]);
        let (shift_back, back) = (e.rotate_back(shift) * inverse, e.rotate_back(acceleration) * inverse);
        let crossed = shift_back.cross(&omega);
        alpha_bar += arm.cross(&shift_back);
        omega_bar += omega.cross(&arm).cross(&shift_back) + arm.cross(&crossed);
        delta_bar += arm.cross(&back);
        arm_bar = shift_back.cross(&alpha) + crossed.cross(&omega) + back.cross(&delta);
        let shift_back_bar = alpha.cross(&arm) + omega.cross(&omega.cross(&arm));
        let back_bar = delta.cross(&arm);
        add(&mut e_bar, inverse, &rotation_gradient_transposed(e, shift_back_bar, shift));
        add(&mut e_bar, inverse, &rotation_gradient_transposed(e, back_bar, acceleration));
        inverse_part += shift_back.dot(&shift_back_bar) + back.dot(&back_bar);
        acceleration_bar += e.rotate(back_bar) * inverse;
    }
    omega_bar = omega_bar - alpha_bar * along;
    let along_bar = -omega.dot(&alpha_bar);

    let [a_bar, v_bar, h_bar] = &mut into.state;
    add(a_bar, 1.0, &acceleration_bar.components());
    add(&mut a_bar[3..], twice, &e.g_transposed_times(alpha_bar));
    add(&mut v_bar[3..], twice, &e.g_transposed_times(omega_bar));
    add(&mut v_bar[3..], twice * along_bar, &e.0);
    add(&mut e_bar, twice * along_bar, &rate.0);
    inverse_part += along * along_bar;
    for (z, y, bar) in [(rate, omega, omega_bar), (second, swing, alpha_bar), (turn, delta, delta_bar)] {
        add(&mut e_bar, -twice, &z.g_transposed_times(bar));
        inverse_part += y.dot(&bar);
    }
    add(&mut e_bar, -twice * inverse_part, &e.0);
    add(&mut h_bar[3..], 1.0, &e_bar);

    if into.p.is_empty() {
        return;
    }
    into.p[0] += shift.dot(&acceleration);
    add(&mut into.p[1..4], 1.0, &arm_bar.components());
    add(&mut into.p[4..], 1.0, &tensor_gradient(delta, alpha));
    add(&mut into.p[4..], 1.0, &tensor_gradient(cross, omega));
}
