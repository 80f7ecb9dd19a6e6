//! Matrices of a beam's points, written out because they take most of the time of a scene with beams: a tenth of that of their
//! differentiation, which the contract tests hold against them.

use super::beam::{BeamField, Reference, STRAINS};
use crate::elements::Wide;
use crate::scalar::{
    Dual, Quaternion, RotationRows, SpatialVector, Vector3, g_form, g_rows, rotation_form, rotation_rows, tensor_times,
    tensor_times_rows,
};

type Vector = Vector3<f64>;

/// d(R(e)^T s)/de: the same for the opposite rotation.
#[inline(always)]
fn rotation_back_rows(e: Quaternion<f64>, s: Vector) -> RotationRows {
    let [a, x, y, z] = e.0;
    let mut rows = rotation_rows(Quaternion([a, -x, -y, -z]), s);
    for row in &mut rows {
        for entry in &mut row[1..] {
            *entry = -*entry;
        }
    }
    rows
}

/// x times each column.
#[inline(always)]
fn cross_rows(x: Vector, [first, second, third]: &RotationRows) -> RotationRows {
    let [a, b, c] = x.components();
    let mut rows = [[0.0; 4]; 3];
    for k in 0..4 {
        rows[0][k] = b * third[k] - c * second[k];
        rows[1][k] = c * first[k] - a * third[k];
        rows[2][k] = a * second[k] - b * first[k];
    }
    rows
}

/// Sum of factors times rows, row by row and entry by entry.
#[inline(always)]
fn sum_of_rows<const TERMS: usize>(factors: [f64; TERMS], terms: [&RotationRows; TERMS]) -> RotationRows {
    let mut rows = [[0.0; 4]; 3];
    for l in 0..3 {
        for (factor, term) in factors.iter().zip(terms) {
            for k in 0..4 {
                rows[l][k] += factor * term[l][k];
            }
        }
    }
    rows
}

/// Adds factor x y^T.
#[inline(always)]
fn add_outer(rows: &mut RotationRows, factor: f64, x: Vector, y: &[f64; 4]) {
    for l in 0..3 {
        for k in 0..4 {
            rows[l][k] += factor * x[l] * y[k];
        }
    }
}

/// Numbers of a tying point as they stand in a column: (dr/dxi, de/dxi), which have the weights of slopes, and e with those of values, each at
/// its component of a node.
#[derive(Clone, Copy)]
struct Column {
    slopes: Wide,
    values: Wide,
}
/// Where de/dxi and e begin there.
const TURN: usize = 3;

impl Column {
    const ZERO: Column = Column { slopes: Wide([0.0; 8]), values: Wide([0.0; 8]) };

    #[inline(always)]
    fn add(&mut self, factor: f64, column: &Column) {
        self.slopes.add(factor, &column.slopes);
        self.values.add(factor, &column.values);
    }
}

/// Rows of d(R(e)^T x, 2 G(e) d)/dh times a scale, which changes by `d_scale` with e.
#[inline(always)]
fn gradient_rows(
    scale: f64,
    d_scale: &[f64; 4],
    [back, turned]: [Vector; 2],
    columns: &[Vector; 3],
    [by_e, g_e, g_d]: [&RotationRows; 3],
) -> [Column; STRAINS] {
    let mut rows = [Column::ZERO; STRAINS];
    let twice = 2.0 * scale;
    for l in 0..3 {
        for k in 0..3 {
            // the rows of R^T are the columns of R
            rows[l].slopes.0[k] = scale * columns[l][k];
        }
        for k in 0..4 {
            rows[l].values.0[TURN + k] = scale * by_e[l][k] + d_scale[k] * back[l];
            rows[3 + l].slopes.0[TURN + k] = twice * g_e[l][k];
            rows[3 + l].values.0[TURN + k] = d_scale[k] * turned[l] - twice * g_d[l][k];
        }
    }
    rows
}

/// Adds Lambda^T times rows to those of strains, by a factor.
#[inline(always)]
fn add_components(reference: &Reference<f64>, factor: f64, rows: &[Column; STRAINS], strains: &mut [Column; STRAINS]) {
    for (i, axis) in reference.axes.iter().enumerate() {
        let [a, b, c] = axis.components().map(|axis| factor * axis);
        for first in [0, 3] {
            for (factor, row) in [a, b, c].into_iter().zip(&rows[first..]) {
                strains[first + i].add(factor, row);
            }
        }
    }
}

/// Adds beta dr/dv + alpha dr/dq of a tying point, r = J B^T C (strain + eta B v) with B = dstrain/dh, h = (dr/dxi, e, de/dxi).
///
/// With strain = Lambda^T (R^T x, 2 G(e) d) / (J |e|^2) - (1, 0, ..), x = dr/dxi, d = de/dxi:
///
/// J B^T C ((alpha + eta beta) B + alpha eta dB/dt) with dB/dt along v, and alpha times the curvature of w / |e|^2,
/// w = x . R(e) nu + 2 mu . G(e) d for fixed (nu, mu) = Lambda stress.
#[inline(always)]
pub(super) fn add_strain_matrix(
    beam: &BeamField,
    [v, h]: [&[f64]; 2],
    p: &[f64],
    [_, beta, alpha]: [f64; 3],
    matrix: &mut [Wide],
) {
    let reference = Reference::of(p);
    let (stiffness, damping) = beam.stiffness_and_damping(p);
    let split = |h: &[f64]| (Vector3::first_three(h), Quaternion::from_slice(&h[3..]), Quaternion::from_slice(&h[7..]));
    let (x, e, d) = split(h);
    let inverse = 1.0 / e.dot(e);
    let scale = inverse / reference.metric;
    let (back, turned) = (e.rotate_back(x), e.g_times(d) * 2.0);
    let columns = e.columns();
    let (by_e, g_e, g_d) = (rotation_back_rows(e, x), g_rows(e), g_rows(d));
    let shrink = -2.0 * inverse * scale;
    let d_scale = e.0.map(|e| shrink * e);
    let rows = gradient_rows(scale, &d_scale, [back, turned], &columns, [&by_e, &g_e, &g_d]);
    let (mut stretch, mut bend) = (back * scale, turned * scale);

    let mut b = [Column::ZERO; STRAINS];
    add_components(&reference, 1.0, &rows, &mut b);
    // what C is multiplied with from the right
    let mut right = b;
    let together = alpha + damping * beta;
    for row in &mut right {
        *row = Column { slopes: row.slopes.times(together), values: row.values.times(together) };
    }
    if beam.damped {
        let (x_rate, e_rate, d_rate) = split(v);
        let along = e.dot(e_rate);
        let scale_rate = shrink * along;
        let mut d_scale_rate = [0.0; 4];
        for k in 0..4 {
            d_scale_rate[k] = shrink * (e_rate.0[k] - 4.0 * inverse * along * e.0[k]);
        }
        let mut moving = [Dual::<f64, 1>::default(); 4];
        (0..4).for_each(|k| moving[k] = Dual { re: e.0[k], eps: [e_rate.0[k]] });
        let columns_rate = Quaternion(moving).columns().map(|column| column.map(|entry| entry.eps[0]));
        let (g_e_rate, g_d_rate) = (g_rows(e_rate), g_rows(d_rate));
        let by_e_rate = sum_of_rows([1.0, 1.0], [&rotation_back_rows(e, x_rate), &rotation_back_rows(e_rate, x)]);
        let back_rate = e.rotate_back(x_rate) + rows_times(&by_e, e_rate);
        let turned_rate = (e_rate.g_times(d) + e.g_times(d_rate)) * 2.0;
        // rates of a product: of the scale, and of what it multiplies
        let first = gradient_rows(scale_rate, &d_scale_rate, [back, turned], &columns, [&by_e, &g_e, &g_d]);
        let second =
            gradient_rows(scale, &d_scale, [back_rate, turned_rate], &columns_rate, [&by_e_rate, &g_e_rate, &g_d_rate]);
        add_components(&reference, alpha * damping, &first, &mut right);
        add_components(&reference, alpha * damping, &second, &mut right);
        stretch += (back * scale_rate + back_rate * scale) * damping;
        bend += (turned * scale_rate + turned_rate * scale) * damping;
    }
    let right = stiffness_times_rows(beam, reference.metric, stiffness, &right);
    let ([stretch, shear, other], [twist, bend, last]) = (reference.components(stretch), reference.components(bend));
    let [n1, n2, n3, m1, m2, m3] = beam.stiffness_times(stiffness, [stretch - 1.0, shear, other, twist, bend, last]);

    // curvature
    let (nu, mu) = (reference.combine([n1, n2, n3]), reference.combine([m1, m2, m3]));
    let pulled = e.rotate(nu);
    let by_nu = rotation_rows(e, nu);
    let own = alpha * inverse;
    let shrink = 2.0 * own * inverse;
    let (of_e, of_d) = (d.g_transposed_times(mu), e.g_transposed_times(mu));
    let w = pulled.dot(&x) + turned.dot(&mu);
    // dw/dh, and e, as columns
    let (mut gradient, mut unit) = (Column::ZERO, Wide::default());
    gradient.slopes.0[..TURN].copy_from_slice(&pulled.components());
    for k in 0..4 {
        gradient.slopes.0[TURN + k] = 2.0 * of_d[k];
        gradient.values.0[TURN + k] = x[0] * by_nu[0][k] + x[1] * by_nu[1][k] + x[2] * by_nu[2][k] - 2.0 * of_e[k];
        unit.0[TURN + k] = e.0[k];
    }
    let second = rotation_form(nu, x);
    let mixed = g_form(mu);

    // without coupling gamma does not depend on de/dxi, nor kappa on dr/dxi
    let (gammas, kappas) = if beam.coupled { (0..STRAINS, 0..STRAINS) } else { (0..3, 3..STRAINS) };
    let (columns, _) = matrix.as_chunks_mut::<2>();
    for k in 0..3 {
        let mut column = product(gammas.clone(), &b, |i| right[i].slopes.0[k]);
        for i in 0..4 {
            column.values.0[TURN + i] += own * by_nu[k][i];
        }
        column.values.add(-shrink * gradient.slopes.0[k], &unit);
        add_to(&mut columns[k], &column);
    }
    for k in 0..4 {
        let mut column = product(kappas.clone(), &b, |i| right[i].slopes.0[TURN + k]);
        for i in 0..4 {
            column.values.0[TURN + i] += 2.0 * own * mixed[i][k];
        }
        column.values.add(-shrink * gradient.slopes.0[TURN + k], &unit);
        add_to(&mut columns[7 + k], &column);
    }
    for k in 0..4 {
        let mut column = product(0..STRAINS, &b, |i| right[i].values.0[TURN + k]);
        for i in 0..3 {
            column.slopes.0[i] += own * by_nu[i][k];
        }
        for i in 0..4 {
            column.slopes.0[TURN + i] += 2.0 * own * mixed[k][i];
            column.values.0[TURN + i] += 2.0 * own * second[i][k];
        }
        column.add(-shrink * e.0[k], &gradient);
        column.values.add(shrink * (4.0 * inverse * w * e.0[k] - gradient.values.0[TURN + k]), &unit);
        column.values.0[TURN + k] -= shrink * w;
        add_to(&mut columns[3 + k], &column);
    }
}

/// B^T times a column of J C dstrain, over some of the strains.
#[inline(always)]
fn product(strains: std::ops::Range<usize>, b: &[Column; STRAINS], right: impl Fn(usize) -> f64) -> Column {
    let mut sum = Column::ZERO;
    for i in strains {
        sum.add(right(i), &b[i]);
    }
    sum
}

#[inline(always)]
fn add_to(target: &mut [Wide; 2], column: &Column) {
    target[0].add(1.0, &column.slopes);
    target[1].add(1.0, &column.values);
}

/// RotationRows times a quaternion.
#[inline(always)]
fn rows_times(rows: &RotationRows, e: Quaternion<f64>) -> Vector {
    Vector3::from([rows[0], rows[1], rows[2]].map(|row| Quaternion(row).dot(e)))
}

/// J C times rows.
#[inline(always)]
fn stiffness_times_rows(beam: &BeamField, metric: f64, stiffness: &[f64], rows: &[Column; STRAINS]) -> [Column; STRAINS] {
    let mut product = *rows;
    for i in 0..STRAINS {
        let factor = metric * stiffness[i];
        product[i] = Column { slopes: rows[i].slopes.times(factor), values: rows[i].values.times(factor) };
    }
    if beam.coupled {
        let mut entry = STRAINS;
        for i in 0..STRAINS {
            for j in i + 1..STRAINS {
                let factor = metric * stiffness[entry];
                entry += 1;
                product[i].add(factor, &rows[j]);
                product[j].add(factor, &rows[i]);
            }
        }
    }
    product
}

/// Adds gamma dr/da + beta dr/dv + alpha dr/dq of a Gauss point (seven numbers r, e), column after column.
///
/// With omega = 2 G(e) e' / |e|^2, spin = domega/dt, z = spin x s + omega x (omega x s) and
/// M = J spin + omega x J omega + s x R^T a / |e|^2: (m a + R z / |e|^2, 2 G(e)^T M / |e|^2).
#[inline(always)]
pub(super) fn add_inertia_matrix(
    beam: &BeamField,
    [a, v, h]: [&[f64]; 3],
    [gamma, beta, alpha]: [f64; 3],
    p: &[f64],
    matrix: &mut [Wide],
) {
    let (e, rate) = (Quaternion::from_slice(&h[3..]), Quaternion::from_slice(&v[3..]));
    let second = Quaternion::from_slice(&a[3..]);
    let inverse = 1.0 / e.dot(e);
    let twice = 2.0 * inverse;
    let (g, g_rate, g_second) = (g_rows(e), g_rows(rate), g_rows(second));
    let omega = e.g_times(rate) * twice;
    let swing = e.g_times(second) * twice;
    let along = twice * e.dot(rate);
    let spin = swing - omega * along;
    let tensor = &p[4..];
    let momentum = tensor_times(tensor, omega);
    let mut moment = tensor_times(tensor, spin) + omega.cross(&momentum);

    // along e_k: 1 / |e|^2 shrinks by this factor
    let shrink = e.0.map(|e| alpha * twice * e);
    let mut d_omega = sum_of_rows([twice * beta, -twice * alpha], [&g, &g_rate]);
    add_outer(&mut d_omega, -1.0, omega, &shrink);
    let mut d_along = [0.0; 4];
    for k in 0..4 {
        d_along[k] = twice * (alpha * rate.0[k] + beta * e.0[k]) - along * shrink[k];
    }
    let mut d_spin = sum_of_rows([twice * gamma, -twice * alpha, -along], [&g, &g_second, &d_omega]);
    add_outer(&mut d_spin, -1.0, swing, &shrink);
    add_outer(&mut d_spin, -1.0, omega, &d_along);
    let d_momentum = tensor_times_rows(tensor, &d_omega);
    let mut d_moment = sum_of_rows(
        [1.0; 3],
        [&tensor_times_rows(tensor, &d_spin), &cross_rows(-momentum, &d_omega), &cross_rows(omega, &d_momentum)],
    );
    let (of_place, of_turn) = matrix.split_at_mut(3);
    for (k, column) in of_place.iter_mut().enumerate() {
        column.0[k] += gamma * p[0];
    }
    if beam.eccentric {
        let (arm, acceleration) = (Vector3::first_three(&p[1..]), Vector3::first_three(a));
        let columns = e.columns();
        let back = e.rotate_back(acceleration) * inverse;
        moment += arm.cross(&back);
        let mut d_back = rotation_back_rows(e, acceleration);
        d_back.iter_mut().flatten().for_each(|entry| *entry *= alpha * inverse);
        add_outer(&mut d_back, -1.0, back, &shrink);
        d_moment = sum_of_rows([1.0; 2], [&d_moment, &cross_rows(arm, &d_back)]);
        for (k, column) in of_place.iter_mut().enumerate() {
            let row = Vector3::new(columns[0][k], columns[1][k], columns[2][k]);
            let lever = arm.cross(&row) * (gamma * twice * inverse);
            for i in 0..4 {
                column.0[3 + i] += g[0][i] * lever[0] + g[1][i] * lever[1] + g[2][i] * lever[2];
            }
        }
        let turning = omega.cross(&arm);
        let z = spin.cross(&arm) + omega.cross(&turning);
        let d_turning = cross_rows(-arm, &d_omega);
        let d_z = sum_of_rows(
            [1.0; 3],
            [&cross_rows(-arm, &d_spin), &cross_rows(-turning, &d_omega), &cross_rows(omega, &d_turning)],
        );
        let (force, by_z) = (e.rotate(z), rotation_rows(e, z));
        for (k, column) in of_turn.iter_mut().enumerate() {
            for i in 0..3 {
                let turned = columns[0][i] * d_z[0][k] + columns[1][i] * d_z[1][k] + columns[2][i] * d_z[2][k];
                column.0[i] += inverse * (turned + alpha * by_z[i][k] - shrink[k] * force[i]);
            }
        }
    }
    let moment = moment * twice;
    let (force, of_unit) = (e.g_transposed_times(moment), g_form(moment));
    for (k, column) in of_turn.iter_mut().enumerate() {
        let [x, y, z] = [twice * d_moment[0][k], twice * d_moment[1][k], twice * d_moment[2][k]];
        for i in 0..4 {
            column.0[3 + i] += g[0][i] * x + g[1][i] * y + g[2][i] * z + alpha * of_unit[k][i] - shrink[k] * force[i];
        }
    }
}
