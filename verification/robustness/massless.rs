//! Mechanisms with bodies without mass, against the same without these bodies, and bodies that nothing determines.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use crate::Lots;
use crate::Report;
use costate::prelude::*;

/// Mechanisms of each family.
const DRAWN: u64 = 40;
/// Difference from the same mechanism without massless bodies, as a share of it, that round-off may make ...
const SAME: f64 = 1e-7;
/// ... and in what half as long steps change in both: stages leave their constraints by the error of the method.
const REFINED: f64 = 4.0;
const METHODS: [&str; 8] = ["esdirk4", "esdirk3", "sdirk4", "midpoint", "bdf1", "bdf2", "generalized-alpha", "variational"];

/// What carries the load.
#[derive(Clone, Copy, PartialEq)]
enum Family {
    /// A hinge whose eyes are massless bodies, welded to the bodies that it joins.
    Eyes,
    /// A massless arm on a driven hinge; the load hangs on it instead of on a heavy one that is driven alike.
    Arm,
    /// A massless rod between two joints, of which one is a cross; without it a distance.
    Rod,
    /// A rod that is free to turn about itself, or two rods on one line.
    Loose,
}

const FAMILIES: [(Family, &str); 4] =
    [(Family::Eyes, "eyes"), (Family::Arm, "driven arms"), (Family::Rod, "rods"), (Family::Loose, "not determined")];

/// A member of a family.
struct Carried {
    family: Family,
    seed: u64,
    /// With the massless bodies, or with what stands for them.
    is_massless: bool,
    /// Number of steps, in those of the family.
    refined: usize,
}

impl Carried {
    fn lots(&self, series: u64) -> Lots {
        Lots::new(self.seed, 20 + series)
    }
}

/// A direction by lot.
fn direction<S: Scalar>(lots: &mut Lots) -> Vector3<S> {
    let own = lots.vector::<S>();
    own * (S::one() / own.length())
}

impl Scene for Carried {
    fn name(&self) -> String {
        format!("carried load {}", self.seed)
    }
    fn variables(&self) -> Vec<DesignVariable> {
        ["length", "mass"].map(|name| DesignVariable::new(name, 1.0, (0.5, 2.0), "-")).to_vec()
    }
    fn settings(&self) -> Settings {
        let mut lots = self.lots(0);
        let (length, steps) = (lots.size(1e-3, 1e3), 10 + lots.below(20));
        // swings of any size in steps alike
        Settings::new(0.01 * f64::sqrt(length) * steps as f64, self.refined * steps).with_method(lots.pick(&METHODS))
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let &[length, mass] = x else { return Err("2 variables".into()) };
        let length = length * self.lots(0).size(1e-3, 1e3);
        let mut lots = self.lots(1);
        let mass = mass * lots.size(1e-3, 1e3);
        let ground = m.ground();
        m.gravity(direction::<S>(&mut lots) * S::from(9.81));
        let (at, axis) = (direction::<S>(&mut lots) * length, direction::<S>(&mut lots));
        let pin = axis.perpendiculars()[0];
        // a rod along a pin of its cross cannot be turned by the other one
        let at = if self.family == Family::Rod { axis.cross(&pin) * length } else { at };
        let load_at = at + direction::<S>(&mut lots) * length;
        let load = m.body("load", load_at, lots.rotation());
        let (moment, zero) = (mass * length * length * 0.2, S::zero());
        m.rigid_body("load", load, mass, Vector3::zeros(), [moment, moment * 1.5, moment * 2.0, zero, zero, zero]);
        let (turned, middle) = ([lots.rotation(), lots.rotation()], at * S::from(0.5));
        let bare = |m: &mut MechanismBuilder<S>, name: &str, place| m.body(name, place, turned[0]);
        match self.family {
            Family::Eyes => {
                let mut nodes = [ground, load];
                if self.is_massless {
                    for (node, name) in nodes.iter_mut().zip(["eye of the ground", "eye of the load"]) {
                        let eye = bare(m, name, at);
                        m.fixed(&format!("weld of the {name}"), [*node, eye], at);
                        *node = eye;
                    }
                }
                m.revolute("hinge", nodes, at, axis);
            }
            Family::Arm => {
                let arm = bare(m, "arm", middle);
                if !self.is_massless {
                    m.rigid_body("arm", arm, mass, Vector3::zeros(), [moment, moment, moment, zero, zero, zero]);
                }
                let duration = S::from(self.settings().end);
                let signal = Signal::of(TimeFunction::SmoothRamp, &[zero, S::from(lots.number(-1.5, 1.5)), zero, duration]);
                m.revolute("main", [ground, arm], Vector3::zeros(), axis);
                m.prescribed_rotation("motor", [ground, arm], axis, signal);
                m.spherical("eye", [arm, load], at);
            }
            Family::Rod => {
                if self.is_massless {
                    let rod = bare(m, "rod", middle);
                    m.universal("cross", [ground, rod], Vector3::zeros(), [axis, pin]);
                    m.spherical("ball", [rod, load], at);
                } else {
                    m.distance("rod", [ground, load], [Vector3::zeros(), at]);
                }
            }
            Family::Loose => {
                let rod = bare(m, "rod", middle);
                if lots.happens(0.5) {
                    m.spherical("first", [ground, rod], Vector3::zeros());
                    m.spherical("second", [rod, load], at);
                } else {
                    let other = bare(m, "other rod", middle);
                    m.revolute("first", [ground, rod], Vector3::zeros(), axis);
                    m.revolute("middle", [rod, other], middle, axis);
                    m.revolute("second", [other, load], at, axis);
                }
            }
        }
        m.position_functional("place", Over::Terminal, load, load_at, direction(&mut lots));
        m.velocity_functional("speed", Over::Integral, load, load_at, direction(&mut lots));
        Ok(())
    }
}

/// Values and derivatives along one direction.
fn figures(scene: &Carried) -> Result<Vec<f64>, String> {
    let settings = scene.settings();
    let mut method = Prepared::method_of(&settings).map_err(|why| why.to_string())?;
    if method.table.variational.is_none() {
        method.level = scene.lots(2).pick(&ConstraintLevel::ALL);
    }
    let prepared = Prepared::with(scene, &[1.0, 1.0], method, settings).map_err(|why| why.to_string())?;
    let analysis = prepared.analysis();
    let forward = analysis.forward(&prepared.x).map_err(|why| why.to_string())?;
    let gradient = analysis.adjoint(&prepared.x, &forward).map_err(|why| why.to_string())?;
    Ok(forward.values.iter().copied().chain(gradient.rows.iter().map(|row| row[0] + 0.3 * row[1])).collect())
}

/// Whether a mechanism is the same with massless bodies and without, as far as its steps tell.
fn are_same([own, other, refined, other_refined]: &[Vec<f64>; 4], length: f64) -> Result<(), String> {
    for (i, (own, other)) in own.iter().zip(other).enumerate() {
        let by_steps = (own - refined[i]).abs() + (other - other_refined[i]).abs();
        // written so that a NaN is wrong
        if !((own - other).abs() <= SAME * length.max(other.abs()) + REFINED * by_steps) {
            return Err(format!("figure {i}: {own:e} beside {other:e}; with half the steps {:e}", refined[i]));
        }
    }
    Ok(())
}

/// Counts how each family ends.
pub fn count(report: &mut Report) {
    for (family, name) in FAMILIES {
        let [mut right, mut errors, mut wrong] = [0.0; 3];
        for seed in 1..=DRAWN {
            let of = |is_massless, refined| figures(&Carried { family, seed, is_massless, refined });
            let length = Lots::new(seed, 20).size(1e-3, 1e3);
            let all = || Ok([of(true, 1)?, of(false, 1)?, of(true, 2)?, of(false, 2)?]);
            let (outcome, why): (_, Option<String>) = match family {
                Family::Loose => match of(true, 1) {
                    Err(why) if why.contains("start (t = 0 s)") && why.contains("rod\"") => (&mut right, None),
                    Err(why) => (&mut errors, Some(why)),
                    Ok(_) => (&mut wrong, Some("simulated".into())),
                },
                _ => match all().map(|all| are_same(&all, length)) {
                    Err(why) => (&mut errors, Some(why)),
                    Ok(Err(why)) => (&mut wrong, Some(why)),
                    Ok(Ok(())) => (&mut right, None),
                },
            };
            *outcome += 1.0;
            why.into_iter().for_each(|why| report.note(format!("{name} {seed}: {why}")));
        }
        report.compare(format!("massless/{name}/right, share"), right / DRAWN as f64, 1.0, 0.05);
        report.inform(format!("massless/{name}/errors"), errors);
        report.at_most(format!("massless/{name}/wrong"), wrong, 0.0);
    }
}
