//! Products lambda . dr of a beam's points, written out because they would take most of the time of an adjoint sweep with beams; the
//! contract tests hold them against those by differentiation.

use super::beam::{BeamField, GEOMETRY, Reference, STRAINS};
use crate::elements::PointGradient;
use crate::scalar::{Quaternion, Vec3, rotation_gradient_transposed, tensor_times};

fn add(target: &mut [f64], factor: f64, values: &[f64]) {
    target.iter_mut().zip(values).for_each(|(target, value)| *target += factor * value);
}

/// Adds the gradient of a six-number tensor's x . J y.
fn add_tensor(target: &mut [f64], x: Vec3<f64>, y: Vec3<f64>) {
    let ([a, b, c], [d, e, f]) = (x.0, y.0);
    add(target, 1.0, &[a * d, b * e, c * f, a * e + b * d, a * f + c * d, b * f + c * e]);
}

/// Adds the gradient of phi = lambda . dV/dh of a tying point without damping, V = J/2 strain . C strain: with the change dstrain of the strains along
/// lambda, phi = J dstrain . C strain.
///
/// Both strains are Lambda^T of (R^T x, 2 G(e) d) s - (1, 0, ..) with s = 1 / (J |e|^2); numbers along lambda begin with `d_`.
#[inline(always)]
pub(super) fn add_strain_products(beam: &BeamField, h: &[f64], p: &[f64], lambda: &[f64], into: &mut PointGradient) {
    let reference = Reference::of(p);
    let (metric, stiffness) = (reference.metric, &p[GEOMETRY..]);
    let split = |h: &[f64]| (Vec3::from_slice(h), Quaternion::from_slice(&h[3..]), Quaternion::from_slice(&h[7..]));
    let ((x, e, d), (d_x, d_e, d_d)) = (split(h), split(lambda));
    let inverse = 1.0 / e.norm_squared();
    let scale = inverse / metric;
    let shrink = -2.0 * inverse * e.dot(d_e);
    let d_scale = shrink * scale;
    let (back, turned) = (e.rotate_back(x), e.g_times(d) * 2.0);
    let d_back = e.rotate_back(d_x) + e.conjugate().rotate_rate(d_e.conjugate(), x);
    let d_turned = (d_e.g_times(d) + e.g_times(d_d)) * 2.0;
    let (stretch, bend) = (back * scale, turned * scale);
    let (d_stretch, d_bend) = (back * d_scale + d_back * scale, turned * d_scale + d_turned * scale);
    let both = |stretch: Vec3<f64>, bend: Vec3<f64>| -> [f64; STRAINS] {
        let ([a, b, c], [d, e, f]) = (reference.components(stretch), reference.components(bend));
        [a, b, c, d, e, f]
    };
    let (mut strain, d_strain) = (both(stretch, bend), both(d_stretch, d_bend));
    strain[0] -= 1.0;

    // back: adjoints of the strains and of their changes
    let strain_bar = beam.stiffness_times(stiffness, d_strain).map(|stress| metric * stress);
    let stress = beam.stiffness_times(stiffness, strain);
    let d_strain_bar = stress.map(|stress| metric * stress);
    let of =
        |bar: &[f64; STRAINS]| (reference.combine([bar[0], bar[1], bar[2]]), reference.combine([bar[3], bar[4], bar[5]]));
    let ((stretch_bar, bend_bar), (d_stretch_bar, d_bend_bar)) = (of(&strain_bar), of(&d_strain_bar));
    let back_bar = stretch_bar * scale + d_stretch_bar * d_scale;
    let turned_bar = bend_bar * scale + d_bend_bar * d_scale;
    let (d_back_bar, d_turned_bar) = (d_stretch_bar * scale, d_bend_bar * scale);
    let d_scale_bar = back.dot(d_stretch_bar) + turned.dot(d_bend_bar);
    let scale_bar = back.dot(stretch_bar)
        + d_back.dot(d_stretch_bar)
        + turned.dot(bend_bar)
        + d_turned.dot(d_bend_bar)
        + shrink * d_scale_bar;
    let shrink_bar = scale * d_scale_bar;
    let inverse_bar = (shrink * shrink_bar + scale * scale_bar) / inverse;

    let x_bar = e.rotate(back_bar) + e.rotate_rate(d_e, d_back_bar);
    let [_, _, h_bar] = &mut into.state;
    add(h_bar, 1.0, &x_bar.0);
    let e_bar = &mut h_bar[3..7];
    add(e_bar, 1.0, &rotation_gradient_transposed(e, back_bar, x));
    add(e_bar, 1.0, &rotation_gradient_transposed(e, d_back_bar, d_x));
    add(e_bar, 1.0, &rotation_gradient_transposed(d_e, d_back_bar, x));
    add(e_bar, -2.0, &d.g_transposed_times(turned_bar));
    add(e_bar, -2.0, &d_d.g_transposed_times(d_turned_bar));
    add(e_bar, -2.0 * inverse * shrink_bar, &d_e.0);
    add(e_bar, -2.0 * inverse * inverse * inverse_bar, &e.0);
    let d_bar = &mut h_bar[7..];
    add(d_bar, 2.0, &e.g_transposed_times(turned_bar));
    add(d_bar, 2.0, &d_e.g_transposed_times(d_turned_bar));

    if into.p.is_empty() {
        return;
    }
    let energy = d_strain.iter().zip(&stress).map(|(d_strain, stress)| d_strain * stress).sum::<f64>();
    into.p[0] += energy - scale_bar * scale / metric;
    let mut axes_bar = [Vec3::zero(); 3];
    for (i, axis) in axes_bar.iter_mut().enumerate() {
        *axis =
            stretch * strain_bar[i] + d_stretch * d_strain_bar[i] + bend * strain_bar[3 + i] + d_bend * d_strain_bar[3 + i];
    }
    let [tangent, second, _] = reference.axes;
    add(&mut into.p[1..4], 1.0, &(axes_bar[0] + second.cross(axes_bar[2])).0);
    add(&mut into.p[4..7], 1.0, &(axes_bar[1] + axes_bar[2].cross(tangent)).0);
    let stiffness_bar = &mut into.p[GEOMETRY..];
    for i in 0..STRAINS {
        stiffness_bar[i] += metric * d_strain[i] * strain[i];
    }
    if beam.coupled {
        let pairs = (0..STRAINS).flat_map(|i| (i + 1..STRAINS).map(move |j| (i, j)));
        for ((i, j), bar) in pairs.zip(&mut stiffness_bar[STRAINS..]) {
            *bar += metric * (d_strain[i] * strain[j] + d_strain[j] * strain[i]);
        }
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
    let (acceleration, shift) = (Vec3::from_slice(a), Vec3::from_slice(lambda));
    let inverse = 1.0 / e.norm_squared();
    let twice = 2.0 * inverse;
    let [omega, swing, delta] = [rate, second, turn].map(|z| e.g_times(z) * twice);
    let along = twice * e.dot(rate);
    let alpha = swing - omega * along;
    let tensor = &p[4..];
    let momentum = tensor_times(tensor, omega);
    let cross = delta.cross(omega);

    let mut delta_bar = tensor_times(tensor, alpha) + omega.cross(momentum);
    let mut alpha_bar = tensor_times(tensor, delta);
    let mut omega_bar = momentum.cross(delta) + tensor_times(tensor, cross);
    let mut acceleration_bar = shift * p[0];
    let mut e_bar = [0.0; 4];
    // 1 / |e|^2 times its adjoint
    let mut inverse_part = 0.0;
    let mut arm_bar = Vec3::zero();
    if beam.eccentric {
        let arm = Vec3::from_slice(&p[1..]);
        let (shift_back, back) = (e.rotate_back(shift) * inverse, e.rotate_back(acceleration) * inverse);
        let crossed = shift_back.cross(omega);
        alpha_bar += arm.cross(shift_back);
        omega_bar += omega.cross(arm).cross(shift_back) + arm.cross(crossed);
        delta_bar += arm.cross(back);
        arm_bar = shift_back.cross(alpha) + crossed.cross(omega) + back.cross(delta);
        let shift_back_bar = alpha.cross(arm) + omega.cross(omega.cross(arm));
        let back_bar = delta.cross(arm);
        add(&mut e_bar, inverse, &rotation_gradient_transposed(e, shift_back_bar, shift));
        add(&mut e_bar, inverse, &rotation_gradient_transposed(e, back_bar, acceleration));
        inverse_part += shift_back.dot(shift_back_bar) + back.dot(back_bar);
        acceleration_bar += e.rotate(back_bar) * inverse;
    }
    omega_bar = omega_bar - alpha_bar * along;
    let along_bar = -omega.dot(alpha_bar);

    let [a_bar, v_bar, h_bar] = &mut into.state;
    add(a_bar, 1.0, &acceleration_bar.0);
    add(&mut a_bar[3..], twice, &e.g_transposed_times(alpha_bar));
    add(&mut v_bar[3..], twice, &e.g_transposed_times(omega_bar));
    add(&mut v_bar[3..], twice * along_bar, &e.0);
    add(&mut e_bar, twice * along_bar, &rate.0);
    inverse_part += along * along_bar;
    for (z, y, bar) in [(rate, omega, omega_bar), (second, swing, alpha_bar), (turn, delta, delta_bar)] {
        add(&mut e_bar, -twice, &z.g_transposed_times(bar));
        inverse_part += y.dot(bar);
    }
    add(&mut e_bar, -twice * inverse_part, &e.0);
    add(&mut h_bar[3..], 1.0, &e_bar);

    if into.p.is_empty() {
        return;
    }
    into.p[0] += shift.dot(acceleration);
    add(&mut into.p[1..4], 1.0, &arm_bar.0);
    add_tensor(&mut into.p[4..], delta, alpha);
    add_tensor(&mut into.p[4..], cross, omega);
}
