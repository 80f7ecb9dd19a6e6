use crate::scalar::Scalar;

/// The outline of a section of a beam or cable, as it is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline {
    /// Outer sizes along axes 2 and 3 \[m\].
    pub sizes: [f64; 2],
    /// Its middle along axes 2 and 3 \[m\].
    pub middle: [f64; 2],
    /// A circle instead of a rectangle.
    pub round: bool,
    /// Young's modulus of its material [N/m2], where it has one.
    pub young: Option<f64>,
}

/// Points of a circle.
const AROUND: usize = 12;

impl Outline {
    /// A rectangle of the same stiffness against stretch and bending as a section of which nothing else is known: sizes sqrt(12 EI / EA) for
    /// EI about axes 2 and 3.
    pub fn of_stiffness<S: Scalar>(axial: S, [about_2, about_3]: [S; 2]) -> Self {
        let size = |bending: S| (bending.value() * 12.0 / axial.value()).sqrt();
        Outline { sizes: [size(about_3), size(about_2)], middle: [0.0; 2], round: false, young: None }
    }

    /// Points of the outline along axes 2 and 3 \[m\], counterclockwise seen against axis 1: corners, or points on a circle.
    pub fn points(&self) -> Vec<[f64; 2]> {
        let at = |[x, y]: [f64; 2]| [self.middle[0] + self.sizes[0] * 0.5 * x, self.middle[1] + self.sizes[1] * 0.5 * y];
        if self.round {
            let angle = |k: usize| std::f64::consts::TAU * k as f64 / AROUND as f64;
            (0..AROUND).map(|k| at([angle(k).cos(), angle(k).sin()])).collect()
        } else {
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(at).to_vec()
        }
    }
}
