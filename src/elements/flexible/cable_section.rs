use super::Outline;
use super::cable::{green_strain, square_of_curvature};
use super::section::{ImpossibleSize, Material, OfShape, Shape};
use crate::elements::entries::Given;
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// Which strains a cable's energy is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CableStrain {
    /// Green's axial strain and the exact curvature.
    #[default]
    Exact,
    /// Strain of the chord and second derivative.
    Small,
}

impl CableStrain {
    /// Axial strain [-] and curvature [1/m] from r_x, r_xx, the vector between the nodes, and the length of the element.
    pub fn of<S: Scalar>(self, first: Vector3<S>, second: Vector3<S>, chord: Vector3<S>, length: S) -> [S; 2] {
        match self {
            CableStrain::Exact => [green_strain(first), square_of_curvature(first, second).sqrt()],
            CableStrain::Small => [chord.length() / length - 1.0, second.length()],
        }
    }
}

/// Stiffness and inertia of a cable for each length; bending is the same about every axis at right angles to it.
#[derive(Clone, Copy, Debug)]
pub struct CableSection<S> {
    /// EA \[N\].
    pub axial: S,
    /// EI [N m2].
    pub bending: S,
    /// Mass for each length [kg/m].
    pub mass: S,
    /// Damping proportional to stiffness \[s\].
    pub damping: S,
    /// Whether damping is asked for: topology, so that a design variable that is zero now can still be differentiated.
    pub damped: bool,
    /// Strains of the energy.
    pub strain: CableStrain,
    /// What it looks like, where it is made of a shape.
    pub(crate) shown: Option<Outline>,
    /// Young's modulus [N/m2] and the distance of the outer fibres from the axis \[m\], where it is made of a shape.
    pub(crate) outer_fibres: Option<[S; 2]>,
    /// A size that its shape cannot have.
    pub(crate) impossible: Option<ImpossibleSize>,
}

impl<S: Scalar> CableSection<S> {
    /// What the keys of [`SECTION`](super::SECTION) say.
    pub(crate) fn given(given: &mut Given<S>, of: OfShape<S>) -> Self {
        let section = match of {
            Some((material, shape)) => CableSection::of(material, shape),
            None => CableSection::new(given.number("axial"), given.number("bending"), given.number("mass")),
        };
        if given.has("damping") { section.damped(given.number("damping")) } else { section }
    }

    /// A section by its stiffnesses EA \[N\] and EI [N m2] and its mass for each length [kg/m].
    pub fn new(axial: S, bending: S, mass: S) -> Self {
        let (damping, strain) = (S::zero(), CableStrain::Exact);
        let damped = false;
        CableSection { axial, bending, mass, damping, damped, strain, shown: None, outer_fibres: None, impossible: None }
    }

    /// A section of a material and a shape, which bends about axis 2 of the shape or is as stiff about every axis.
    pub fn of(material: Material<S>, shape: Shape<S>) -> Self {
        let Material { young, density, .. } = material;
        let section = CableSection::new(young * shape.area, young * shape.second_moments[0], density * shape.area);
        let ([_, height], _) = shape.outer;
        let outer_fibres = Some([young, height * 0.5]);
        CableSection { shown: Some(shape.outline(young)), outer_fibres, impossible: shape.impossible, ..section }
    }

    /// With damping proportional to stiffness, eta \[s\].
    #[must_use]
    pub fn damped(mut self, damping: S) -> Self {
        self.damping = damping;
        self.damped = true;
        self
    }

    /// What it looks like: the shape it is made of, or a rectangle as stiff.
    pub(crate) fn outline(&self) -> Outline {
        self.shown.unwrap_or_else(|| Outline::of_stiffness(self.axial, [self.bending; 2]))
    }

    /// With the simplified formulas for small strains.
    #[must_use]
    pub fn small_strains(mut self) -> Self {
        self.strain = CableStrain::Small;
        self
    }
}
