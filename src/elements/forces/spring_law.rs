use crate::elements::entries::{
    ALONG, AT, AXIS, BETWEEN, CHARACTERISTIC, ENDS, Entry, Example, ExampleValue, FROM_TO, Given, INDEX, Key, ON, POINT,
    Range, TWO_BODIES, Type, may,
};
use crate::elements::joints::{angle, components, gap, points, vectors};
use crate::elements::{Characteristic, Element, Frame, NodeKind, NodePair, Output, Parameter};
use crate::scalar::{Scalar, SpatialVector, angle_about};

/// What histories tell of a spring or damper along a line, and of one about an axis.
pub(super) const LENGTH: [(&str, &str); 3] = [("length", "m"), ("rate", "m/s"), ("force", "N")];
pub(super) const ANGLE: [(&str, &str); 3] = [("angle", "rad"), ("rate", "rad/s"), ("moment", "N m")];

/// The number s of which a law is, with its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stretch {
    /// |x_b - x_a| - l0 \[m\]. Parameters: `rest length` l0 \[m\], `point a`, `point b` in the frames of the bodies \[m\].
    Line(NodePair),
    /// Angle of b against a about an axis of a, in (-pi, pi] \[rad\]. Parameters: `axis`, `reference a` in the frame of a, `reference b` in
    /// that of b.
    Angle(NodePair),
    /// n_a . (x_b - x_a) \[m\]. Parameters: `point a`, `point b` in the frames of the bodies \[m\], `axis` n_a in the frame of a.
    Slide(NodePair),
    /// One coordinate of a node, such as a joint angle.
    Coordinate(NodeKind, usize),
}

/// A spring or damper by a law of one's own: F = f(s, ds/dt, t) + dU/ds with an energy U(s), which pulls s back where it is positive.
///
/// Parameters: those of s, of f, of U. Energy is kept where only U is given: what f does is counted as lost or added.
#[derive(Hash)]
pub struct SpringLaw {
    /// What it is of.
    pub of: Stretch,
    /// f [N, N m].
    pub force: Option<Characteristic>,
    /// U \[J\].
    pub energy: Option<Characteristic>,
}

impl Stretch {
    fn parameters(self) -> Vec<Parameter> {
        match self {
            Stretch::Line(_) => [Parameter::new("rest length", "m")].into_iter().chain(points()).collect(),
            Stretch::Angle(_) => angle(),
            Stretch::Slide(_) => points().into_iter().chain(vectors(&["axis"])).collect(),
            Stretch::Coordinate(..) => Vec::new(),
        }
    }

    fn value<S: Scalar>(self, q: &[S], p: &[S]) -> S {
        match self {
            Stretch::Line(ends) => gap(ends, q, &p[1..]).length() - p[0],
            Stretch::Angle(ends) => {
                let [a, b] = Frame::pair(ends, q);
                angle_about(a.direction(p), a.direction(&p[3..]), b.direction(&p[6..]))
            }
            Stretch::Slide(ends) => {
                let mut s = [S::zero()];
                components(&Frame::of(ends[0], q), &p[6..], gap(ends, q, p), &mut s);
                s[0]
            }
            Stretch::Coordinate(_, index) => q[index],
        }
    }
}

impl SpringLaw {
    /// Where the parameters of f and those of U begin.
    fn places(&self) -> [usize; 2] {
        let first = self.of.parameters().len();
        [first, first + self.force.as_ref().map_or(0, |own| own.parameters().len())]
    }

    /// The law of what is given.
    fn given<S: Scalar>(of: Stretch, geometry: Vec<S>, force: &'static str, given: &mut Given<S>) -> (Self, Vec<S>) {
        let [force, energy] = [force, "energy"].map(|key| (key, given.law(key)));
        if force.1.is_none() && energy.1.is_none() {
            let text = format!("\"{}\" needs {} or energy, a law of s", given.owner(), force.0);
            given.wrong(text);
        }
        let [(force, of_force), (energy, of_energy)] =
            [force.1, energy.1].map(|own| own.map_or((None, Vec::new()), |(own, p)| (Some(own), p)));
        (SpringLaw { of, force, energy }, [geometry, of_force, of_energy].concat())
    }
}

impl Element for SpringLaw {
    fn nodes(&self) -> Vec<NodeKind> {
        match self.of {
            Stretch::Line(ends) | Stretch::Angle(ends) | Stretch::Slide(ends) => ends.to_vec(),
            Stretch::Coordinate(of, _) => vec![of],
        }
    }
    fn parameters(&self) -> Vec<Parameter> {
        let unit = match self.of {
            Stretch::Line(_) | Stretch::Slide(_) => "N",
            Stretch::Angle(_) | Stretch::Coordinate(..) => "N m",
        };
        let of = |which: &str, law: &Option<Characteristic>, unit: &'static str| -> Vec<Parameter> {
            let own = law.iter().flat_map(Characteristic::parameters);
            let named = |own: &Parameter| {
                let unit = if own.unit.is_empty() { unit } else { own.unit };
                Parameter { name: format!("{which}, {}", own.name).into(), unit, ..own.clone() }
            };
            own.map(named).collect()
        };
        [self.of.parameters(), of("force", &self.force, unit), of("energy", &self.energy, "J")].concat()
    }
    fn strain_count(&self) -> usize {
        1
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        e[0] = self.of.value(q, p);
    }
    fn outputs(&self) -> Vec<Output> {
        Output::of_strain(match self.of {
            Stretch::Line(_) => [("elongation", "m"), ("rate", "m/s"), ("force", "N")],
            Stretch::Slide(_) => [("displacement", "m"), ("rate", "m/s"), ("force", "N")],
            Stretch::Angle(_) | Stretch::Coordinate(..) => ANGLE,
        })
    }
    fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        let [_, first] = self.places();
        let value = |own: &Characteristic| own.value([e[0], S::zero(), S::zero()], &p[first..]);
        self.energy.as_ref().map_or(S::zero(), value)
    }
    fn damping<S: Scalar>(&self, e: &[S], rate: &[S], p: &[S], t: S, s: &mut [S]) {
        let [first, last] = self.places();
        if let Some(force) = &self.force {
            s[0] = force.value([e[0], rate[0], t], &p[first..last]);
        }
    }
}

const FORCE: Key = may(
    "force",
    Type::Law("N", &CHARACTERISTIC),
    "force that pulls s back: a formula of s, its rate v and the time t, or a table of s",
);
const MOMENT: Key = may(
    "moment",
    Type::Law("N m", &CHARACTERISTIC),
    "moment that turns s back: a formula of s, its rate v and the time t, or a table of s",
);
const ENERGY: Key = may(
    "energy",
    Type::Energy("J", &CHARACTERISTIC),
    "energy U that is stored: a formula of s, or a table; its slope acts like force",
);
const LAW: (&str, ExampleValue) = ("force", ExampleValue::Table(&[-2.0, -0.5, 0.3, 2.0], &[-9.0, -1.0, 0.4, 12.0]));
const TURNING: (&str, ExampleValue) = ("moment", LAW.1);
const STORED: (&str, ExampleValue) = ("energy", ExampleValue::Table(&[-3.0, -0.4, 0.6, 3.0], &[4.0, 0.2, 0.3, 7.0]));

/// A `SpringLaw` along a line.
pub struct LineLaw;
/// A `SpringLaw` about an axis.
pub struct TorsionLaw;
/// A `SpringLaw` along an axis.
pub struct SlideLaw;
/// A `SpringLaw` of a joint angle.
pub struct AngleLaw;

impl Entry for LineLaw {
    type Law = SpringLaw;
    const NAME: &'static str = "line_law";
    const DOC: &'static str = "between two points, by a law of one's own; s is how much longer the line is than at rest";
    const KEYS: &'static [Key] = &[
        BETWEEN,
        ENDS,
        may("rest_length", Type::Number("m", Range::AtLeastZero), "length at which s is 0; that at the start"),
        FORCE,
        ENERGY,
    ];
    const EXAMPLE: Example = (TWO_BODIES, &[FROM_TO, LAW, STORED]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (SpringLaw, Vec<S>) {
        let (kinds, ends) = ([given.in_space(0), given.in_space(1)], given.points("points"));
        let rest = given.number_or("rest_length", (ends[1] - ends[0]).length());
        let geometry = [&[rest], &given.local_points([0, 1], ends)[..]].concat();
        SpringLaw::given(Stretch::Line(kinds), geometry, "force", given)
    }
}

impl Entry for TorsionLaw {
    type Law = SpringLaw;
    const NAME: &'static str = "torsion_law";
    const DOC: &'static str = "about an axis, by a law of one's own; s is the angle, zero as they stand, within half a turn";
    const KEYS: &'static [Key] = &[BETWEEN, AXIS, MOMENT, ENERGY];
    const EXAMPLE: Example = (TWO_BODIES, &[ALONG, TURNING, STORED]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (SpringLaw, Vec<S>) {
        let (kinds, axis) = (given.bodies(), given.unit("axis"));
        let geometry = given.angle_frame(axis);
        SpringLaw::given(Stretch::Angle(kinds), geometry, "moment", given)
    }
}

impl Entry for SlideLaw {
    type Law = SpringLaw;
    const NAME: &'static str = "slide_law";
    const DOC: &'static str = "along an axis of a, by a law of one's own; s is the displacement of b from the origin";
    const KEYS: &'static [Key] =
        &[BETWEEN, may("origin", Type::Vector("m"), "where s is 0; the place of a"), POINT, AXIS, FORCE, ENERGY];
    const EXAMPLE: Example = (TWO_BODIES, &[("origin", ExampleValue::Point([0.1, 0.2, -0.3])), AT, ALONG, LAW, STORED]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (SpringLaw, Vec<S>) {
        let (kinds, places) = (given.body_and_guided(), [given.point("origin", 0), given.point("point", 1)]);
        let axis = given.unit("axis");
        let geometry = [given.local_points([0, 1], places), given.local_directions(0, [axis])].concat();
        SpringLaw::given(Stretch::Slide(kinds), geometry, "force", given)
    }
}

impl Entry for AngleLaw {
    type Law = SpringLaw;
    const NAME: &'static str = "angle_law";
    const DOC: &'static str = "on a joint angle over any number of turns, by a law of one's own; s is the angle";
    const KEYS: &'static [Key] = &[ON, INDEX, MOMENT, ENERGY];
    const EXAMPLE: Example = (&[NodeKind::Coordinates(1)], &[TURNING, STORED]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (SpringLaw, Vec<S>) {
        let (of, index) = given.coordinate();
        SpringLaw::given(Stretch::Coordinate(of, index), Vec::new(), "moment", given)
    }
}
