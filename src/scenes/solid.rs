//! Solids of one density: their mass, mass centre and inertia, and what they look like.

use super::facets::Facets;
use super::triangle_surface::TriangleSurface;
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};
use std::f64::consts::PI;
use std::sync::Arc;

/// A solid of one density that is part of a rigid body.
#[derive(Clone, Debug)]
pub struct Solid<S> {
    /// What it is.
    pub shape: SolidShape<S>,
    /// Its density [kg/m3]; without it the solid is drawn only.
    pub density: Option<S>,
}

/// The shape of a [`Solid`], in the world at the start.
#[derive(Clone, Debug)]
pub enum SolidShape<S> {
    /// A bar of rectangular section.
    Box {
        /// Both ends of its middle line \[m\].
        ends: [Vector3<S>; 2],
        /// With the line it spans the plane of the width [-].
        second_axis: Vector3<S>,
        /// Width along the second axis, and height across it \[m\].
        size: [S; 2],
    },
    /// A round bar, or a tube.
    Cylinder {
        /// Both ends of its middle line \[m\].
        ends: [Vector3<S>; 2],
        /// Outer diameter \[m\].
        diameter: S,
        /// Thickness of the wall of a tube \[m\].
        wall: Option<S>,
    },
    /// A ball, solid or hollow.
    Sphere {
        /// Its centre \[m\].
        centre: Vector3<S>,
        /// Outer diameter \[m\].
        diameter: S,
        /// Thickness of the wall of a hollow one \[m\].
        wall: Option<S>,
    },
    /// All that a closed surface holds; without a density it need not be closed.
    Surface {
        /// The surface.
        surface: Arc<TriangleSurface>,
        /// Metres for each of its units.
        scale: S,
        /// Where its origin stands \[m\].
        position: Vector3<S>,
        /// Its axes.
        rotation: Quaternion<S>,
    },
}

/// Volume \[m3\], its centre \[m\], and the integrals of x_k^2 dV \[m5\] along three axes at right angles from there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments<S> {
    pub volume: S,
    pub centre: Vector3<S>,
    pub axes: [Vector3<S>; 3],
    pub second: [S; 3],
}

/// The middle of a line, its length, and axes along and across it.
fn along<S: Scalar>([from, to]: [Vector3<S>; 2], second: Option<Vector3<S>>) -> (Vector3<S>, S, [Vector3<S>; 3]) {
    let (line, middle) = (to - from, (from + to) * S::from(0.5));
    let axis = line.unit();
    let across = second.map_or_else(|| axis.perpendiculars()[0], |second| (second - axis * axis.dot(&second)).unit());
    (middle, line.length(), [axis, across, axis.cross(&across)])
}

/// r^n of the outer radius less that of the inner one.
fn power<S: Scalar>(diameter: S, wall: Option<S>, n: i32) -> S {
    let outer = diameter * 0.5;
    wall.map_or(outer.powi(n), |wall| outer.powi(n) - (outer - wall).powi(n))
}

impl<S: Scalar> SolidShape<S> {
    fn moments(&self) -> Moments<S> {
        match self {
            SolidShape::Box { ends, second_axis, size: [width, height] } => {
                let (centre, length, axes) = along(*ends, Some(*second_axis));
                let volume = length * *width * *height;
                let second = [length, *width, *height].map(|size| volume * size * size * (1.0 / 12.0));
                Moments { volume, centre, axes, second }
            }
            SolidShape::Cylinder { ends, diameter, wall } => {
                let (centre, length, axes) = along(*ends, None);
                let volume = length * power(*diameter, *wall, 2) * PI;
                let across = length * power(*diameter, *wall, 4) * (0.25 * PI);
                Moments { volume, centre, axes, second: [volume * length * length * (1.0 / 12.0), across, across] }
            }
            SolidShape::Sphere { centre, diameter, wall } => {
                let (volume, second) = (power(*diameter, *wall, 3), power(*diameter, *wall, 5));
                Moments {
                    volume: volume * (4.0 / 3.0 * PI),
                    centre: *centre,
                    axes: Quaternion::identity().columns(),
                    second: [second * (4.0 / 15.0 * PI); 3],
                }
            }
            SolidShape::Surface { surface, scale, position, rotation } => {
                // one that holds nothing is a mistake that was told
                let nothing = Vector3::zeros();
                let own = surface.moments().unwrap_or(Moments {
                    volume: 0.0,
                    centre: nothing,
                    axes: [nothing; 3],
                    second: [0.0; 3],
                });
                let axes = own.axes.map(|axis| rotation.rotate(axis.map(S::from)));
                Moments {
                    volume: scale.powi(3) * own.volume,
                    centre: *position + rotation.rotate(own.centre.map(S::from) * *scale),
                    axes,
                    second: own.second.map(|second| scale.powi(5) * second),
                }
            }
        }
    }

    /// Its surface as flat pieces.
    pub(super) fn facets(&self) -> Facets {
        let place = |point: Vector3<S>| point.components().map(Scalar::value);
        let axes_of = |ends: &[Vector3<S>; 2], second: Option<Vector3<S>>| along(*ends, second).2.map(place);
        match self {
            SolidShape::Box { ends, second_axis, size } => {
                Facets::of_box(ends.map(place), axes_of(ends, Some(*second_axis)), size.map(Scalar::value))
            }
            SolidShape::Cylinder { ends, diameter, wall } => {
                let inner = wall.map(|wall| 0.5 * diameter.value() - wall.value());
                Facets::of_cylinder(ends.map(place), axes_of(ends, None), 0.5 * diameter.value(), inner)
            }
            SolidShape::Sphere { centre, diameter, .. } => Facets::of_sphere(place(*centre), 0.5 * diameter.value()),
            SolidShape::Surface { surface, scale, position, rotation } => {
                let at = |&point: &[f64; 3]| place(*position + rotation.rotate(Vector3::from_f64(point) * *scale));
                Facets::of_triangles(&surface.vertices().iter().map(at).collect::<Vec<_>>(), surface.triangles())
            }
        }
    }
}

impl<S: Scalar> Solid<S> {
    /// What is wrong with its sizes, if anything is.
    pub(super) fn mistake(&self) -> Option<String> {
        let length = |ends: &[Vector3<S>; 2]| (ends[1] - ends[0]).length().value();
        match &self.shape {
            SolidShape::Box { ends, .. } | SolidShape::Cylinder { ends, .. } if length(ends) <= 0.0 => {
                Some("has both of its ends in one place: move them apart".into())
            }
            SolidShape::Box { ends, second_axis, .. }
                if second_axis.cross(&(ends[1] - ends[0])).length().value()
                    <= crate::tolerances::CONSISTENT * second_axis.length().value() * length(ends) =>
            {
                Some("has its second axis along its line: take one across".into())
            }
            SolidShape::Cylinder { diameter, wall: Some(wall), .. }
            | SolidShape::Sphere { diameter, wall: Some(wall), .. }
                if wall.value() * 2.0 > diameter.value() =>
            {
                let (wall, radius) = (wall.value(), 0.5 * diameter.value());
                Some(format!("has a wall of {wall} m, and a radius of {radius} m: a wall is at most as thick as that"))
            }
            SolidShape::Surface { surface, .. } if self.density.is_some() => {
                let why = surface.moments().err()?;
                Some(format!("has a density, but {why}; leave the density out, and it is drawn only"))
            }
            _ => None,
        }
    }
}

/// Mass \[kg\], mass centre \[m\], and the inertia tensor about it (xx, yy, zz, xy, xz, yz) [kg m2], in the axes of the solids.
pub(super) fn mass_properties<S: Scalar>(solids: &[Solid<S>]) -> Option<(S, Vector3<S>, [S; 6])> {
    let heavy: Vec<(S, Moments<S>)> =
        solids.iter().filter_map(|solid| Some((solid.density?, solid.shape.moments()))).collect();
    let mass = heavy.iter().map(|(density, own)| *density * own.volume).reduce(|sum, own| sum + own)?;
    let zero = Vector3::zeros();
    let centre = heavy.iter().fold(zero, |sum, (density, own)| sum + own.centre * (*density * own.volume)) / mass;
    // C = integral of rho x x^T dV from the centre; the inertia is tr(C) I - C
    let mut covariance = [[S::zero(); 3]; 3];
    for (density, own) in &heavy {
        let moved = own.centre - centre;
        let parts = own.axes.into_iter().zip(own.second).chain([(moved, own.volume)]);
        for (axis, weight) in parts {
            for (i, row) in covariance.iter_mut().enumerate() {
                row.iter_mut().enumerate().for_each(|(j, entry)| *entry += *density * weight * axis[i] * axis[j]);
            }
        }
    }
    let [xx, yy, zz] = [0, 1, 2].map(|k| covariance[k][k]);
    let products = [[0, 1], [0, 2], [1, 2]].map(|[i, j]| -covariance[i][j]);
    Some((mass, centre, [yy + zz, xx + zz, xx + yy, products[0], products[1], products[2]]))
}

#[cfg(test)]
mod tests {
    use super::*;

    const DENSITY: f64 = 2700.0;

    fn properties(shape: SolidShape<f64>) -> (f64, Vector3<f64>, [f64; 6]) {
        mass_properties(&[Solid { shape, density: Some(DENSITY) }]).unwrap()
    }

    fn same(own: (f64, Vector3<f64>, [f64; 6]), other: (f64, Vector3<f64>, [f64; 6]), tolerance: f64) {
        let numbers = |(mass, centre, inertia): (f64, Vector3<f64>, [f64; 6])| {
            [&[mass], &centre.components()[..], &inertia[..]].concat()
        };
        for (own, other) in numbers(own).iter().zip(numbers(other)) {
            assert!((own - other).abs() <= tolerance * (1.0 + other.abs()), "{own} {other}");
        }
    }

    fn surface_of(facets: &Facets) -> SolidShape<f64> {
        let surface = TriangleSurface::new(facets.vertices.clone(), facets.triangles.clone()).unwrap();
        let (position, rotation) = (Vector3::zeros(), Quaternion::identity());
        SolidShape::Surface { surface: Arc::new(surface), scale: 1.0, position, rotation }
    }

    const ENDS: [[f64; 3]; 2] = [[0.3, -0.2, 0.5], [1.1, 0.4, 0.1]];

    #[test]
    fn a_slanted_box_is_what_its_surface_holds() {
        let second_axis = Vector3::new(0.1, 0.2, 1.0);
        let shape = SolidShape::Box { ends: ENDS.map(Vector3::from_f64), second_axis, size: [0.2, 0.07] };
        same(properties(shape.clone()), properties(surface_of(&shape.facets().welded())), 1e-13);
    }

    /// m = rho pi (R^2 - r^2) L, I along the line m (R^2 + r^2) / 2, across m (3 (R^2 + r^2) + L^2) / 12.
    #[test]
    fn a_tube_has_the_inertia_of_textbooks() {
        let ends = [Vector3::zeros(), Vector3::new(0.0, 0.0, 1.2)];
        let (mass, centre, inertia) = properties(SolidShape::Cylinder { ends, diameter: 0.2, wall: Some(0.03) });
        let (square, sum) = (0.01 - 0.0049, 0.01 + 0.0049);
        let m = DENSITY * PI * square * 1.2;
        let across = m * (3.0 * sum + 1.44) / 12.0;
        let expected = (m, Vector3::new(0.0, 0.0, 0.6), [across, across, 0.5 * m * sum, 0.0, 0.0, 0.0]);
        same((mass, centre, inertia), expected, 1e-14);
    }

    /// I = 2/5 m (R^5 - r^5) / (R^3 - r^3).
    #[test]
    fn a_hollow_sphere_has_the_inertia_of_textbooks() {
        let centre = Vector3::new(1.0, 2.0, 3.0);
        let (mass, _, inertia) = properties(SolidShape::Sphere { centre, diameter: 0.4, wall: Some(0.05) });
        let cube = 0.2_f64.powi(3) - 0.15_f64.powi(3);
        assert!((mass - DENSITY * 4.0 / 3.0 * PI * cube).abs() < 1e-12 * mass);
        let moment = 0.4 * mass * (0.2_f64.powi(5) - 0.15_f64.powi(5)) / cube;
        assert!(inertia[..3].iter().all(|own| (own - moment).abs() < 1e-13), "{inertia:?} {moment}");
        assert!(inertia[3..].iter().all(|own| own.abs() < 1e-15));
    }

    /// I = sum of m (|x|^2 1 - x x^T) + 2/5 m r^2 1: balls at (1, 2, 0) and opposite have the product -2 m 1 2 in it.
    #[test]
    fn products_of_inertia_have_the_sign_of_the_tensor() {
        let ball = |sign: f64| {
            let centre = Vector3::new(sign, 2.0 * sign, 0.0);
            Solid { shape: SolidShape::Sphere { centre, diameter: 0.2, wall: None }, density: Some(DENSITY) }
        };
        let (mass, centre, inertia) = mass_properties(&[ball(1.0), ball(-1.0)]).unwrap();
        let own = 0.4 * mass * 0.01;
        let expected = [4.0 * mass + own, mass + own, 5.0 * mass + own, -2.0 * mass, 0.0, 0.0];
        same((mass, centre, inertia), (mass, Vector3::zeros(), expected), 1e-14);
    }

    /// A regular prism of n sides has sin(2 pi / n) n / (2 pi) of the area of the circle around it.
    #[test]
    fn facets_of_round_solids_are_closed_and_hold_what_prisms_hold() {
        let ends = ENDS.map(Vector3::from_f64);
        let length = (ends[1] - ends[0]).length();
        for (wall, area) in [(None, 0.01), (Some(0.03), 0.01 - 0.0049)] {
            let shape = SolidShape::Cylinder { ends, diameter: 0.2, wall };
            let facets = shape.facets().welded();
            let (mass, ..) = properties(surface_of(&facets));
            let n = super::super::facets::SIDES as f64;
            let share = (2.0 * PI / n).sin() * n / (2.0 * PI);
            let expected = DENSITY * PI * area * length * share;
            assert!((mass / expected - 1.0).abs() < 1e-12, "{mass} {expected}");
        }
        let ball = SolidShape::Sphere { centre: ends[0], diameter: 0.2, wall: None };
        let (mass, centre, _) = properties(surface_of(&ball.facets().welded()));
        let (whole, ..) = properties(ball);
        assert!(mass < whole && mass > 0.95 * whole && (centre - ends[0]).length() < 1e-14, "{mass} {whole}");
    }
}
