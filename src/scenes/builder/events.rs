//! Events, and numbers that they alone change.

use super::MechanismBuilder;
use crate::assembly::{Attached, Closing, ConstraintId, Event, EventArguments, JointFriction, NodeId, Stop, Target};
use crate::elements::joints::{
    Apart, DistanceJoint, JointSurfaces, PointInPlane, SphereFriction, SpheresFriction, Surfaces,
};
use crate::elements::{
    AnyFriction, Constraint, ConstraintPhysics, Element, Friction, NodeKind, Output, Parameter, Slipping, State, Sticking,
    directed_by, going_on, unrelated_numbers,
};
use crate::functionals::{Over, Quantity};
use crate::program::{Digest, Recorded};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::tolerances::CONSISTENT;
use std::sync::Arc;

/// States that do not change by themselves, dz/dt = 0.
#[derive(Hash)]
struct Kept(usize);

impl Element for Kept {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::States(self.0)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, _p: &[S], _t: S, r: &mut [S]) {
        r.iter_mut().zip(s.a).for_each(|(r, &a)| *r += a);
    }
    fn outputs(&self) -> Vec<Output> {
        let names = if self.0 == 1 { &["value"][..] } else { &["count", "time"] };
        names.iter().map(|name| Output::new((*name).to_string(), "")).collect()
    }
    fn write_outputs<S: Scalar>(&self, v: &[S], _q: &[S], _p: &[S], _t: S, outputs: &mut [S]) {
        outputs.copy_from_slice(v);
    }
}

/// What becomes of a number g that reaches zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StopLaw<S> {
    /// It stays at zero or below, or above: behind a hit its rate is -e times what it was before. Without restitution it stays at zero as long as it is
    /// pushed there.
    Stop {
        /// Whether it stays at zero or below.
        is_upper: bool,
        /// e, from 0 to 1.
        restitution: S,
        /// Hits with less than this have no restitution [1/s of g].
        rest_speed: S,
    },
    /// It stays zero for good, or until its multiplier is larger than this.
    Latch {
        /// Size of the multiplier beyond which it opens for good.
        strength: Option<S>,
    },
}

/// A number that only events change.
#[derive(Hash)]
struct KeptValue(&'static str);

impl Quantity for KeptValue {
    fn dofs(&self) -> usize {
        1
    }
    fn unit(&self) -> &'static str {
        self.0
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        s.v[0]
    }
}

/// Time at which an event happened for the k-th time, of how often it has and of that time; not a number before.
#[derive(Hash)]
struct EventTime(usize);

impl Quantity for EventTime {
    fn dofs(&self) -> usize {
        2
    }
    fn unit(&self) -> &'static str {
        "s"
    }
    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], _p: &[S], _t: S) -> S {
        let [count, time] = [s.v[0], s.v[1]];
        count.less(S::from(self.0 as f64 - 0.5)).select(S::from(f64::NAN), time)
    }
}

impl<S: Scalar> MechanismBuilder<S> {
    /// A number z with its value at the start, which only events change: a state with dz/dt = 0.
    pub fn number(&mut self, name: &str, initial: S) -> NodeId {
        self.kept(name, &[initial])
    }

    fn kept(&mut self, name: &str, initial: &[S]) -> NodeId {
        let node = self.states(name, initial);
        self.element(name, &[node], Kept(initial.len()), &[]);
        node
    }

    /// Where `number` passes zero, a formula of the coordinates and rates of nodes, of parameters and of the time: the event, whose direction and what
    /// happens there may be set.
    pub fn event(
        &mut self,
        name: &str,
        nodes: &[NodeId],
        p: &[S],
        number: impl FnOnce(EventArguments) -> Recorded,
    ) -> Option<&mut Event> {
        self.add_event(name, nodes, &[], p, None, number)
    }

    /// The same by a formula that `origin` tells from all others, so that it is recorded once.
    pub(crate) fn add_event(
        &mut self,
        name: &str,
        nodes: &[NodeId],
        joints: &[usize],
        p: &[S],
        origin: Option<Digest>,
        number: impl FnOnce(EventArguments) -> Recorded,
    ) -> Option<&mut Event> {
        if nodes.iter().any(|&node| self.kind_of(name, node).is_none()) {
            return None;
        }
        // its side is that which the numbers tell
        self.numbers.p.extend_from_slice(p);
        self.numbers.p.push(S::zero());
        match self.model.add_event(name, nodes, joints, p.len(), origin, number) {
            Ok(event) => Some(event),
            Err(why) => {
                self.mistakes.push(format!("event \"{name}\": {why}"));
                None
            }
        }
    }

    /// What the event made last sets, all of it from the values before: formulas of the coordinates and rates of nodes, of parameters and of the time.
    pub fn event_sets(
        &mut self,
        nodes: &[NodeId],
        p: &[S],
        targets: Vec<Target>,
        values: impl FnOnce(EventArguments) -> Vec<Recorded>,
    ) {
        self.add_event_sets(nodes, p, targets, None, values);
    }

    /// The same by formulas that `origin` tells from all others.
    pub(crate) fn add_event_sets(
        &mut self,
        nodes: &[NodeId],
        p: &[S],
        targets: Vec<Target>,
        origin: Option<Digest>,
        values: impl FnOnce(EventArguments) -> Vec<Recorded>,
    ) {
        let Some(last) = self.model.events.len().checked_sub(1) else { return };
        self.add_reset(last, nodes, p, targets, origin, values);
    }

    /// A stop or latch of what a constraint with one equation would hold at zero, g(q, p, t): the constraint is there while it pushes, or is latched.
    /// Returns it with the number of the event that hits it.
    pub fn stop(
        &mut self,
        name: &str,
        nodes: &[NodeId],
        constraint: impl Constraint + Clone,
        p: &[S],
        law: StopLaw<S>,
    ) -> Option<(ConstraintId, usize)> {
        let (value, count) = (constraint.clone(), p.len());
        let origin = ("stop", Digest::of_typed(&value), count);
        let joint = self.constraint(name, nodes, constraint, p);
        self.model.find_constraint(joint)?;
        self.model.set_presence(joint.0, false);
        let hit = self.model.events.len();
        let [of_hit, of_release] = match law {
            StopLaw::Stop { restitution, rest_speed, .. } => [vec![restitution, rest_speed], Vec::new()],
            StopLaw::Latch { strength } => [Vec::new(), strength.into_iter().collect()],
        };
        let event = self.add_event(
            name,
            nodes,
            &[],
            &[p, &of_hit].concat(),
            Some(Digest::of(&origin)),
            |EventArguments { q, p, t, .. }| {
                let mut g = [Recorded::default()];
                value.g(q, &p[..count], t, &mut g);
                g[0]
            },
        )?;
        let places = event.condition.parameters.start + count;
        event.while_joint = Some((joint.0, false));
        let stop = match law {
            StopLaw::Stop { is_upper, .. } => {
                event.directions = [is_upper, !is_upper];
                Some(Stop { parameters: [places, places + 1], is_upper })
            }
            StopLaw::Latch { .. } => {
                event.once = true;
                None
            }
        };
        event.closes = vec![Closing { joint: joint.0, stop, impulse: None }];
        let directions = match law {
            StopLaw::Stop { is_upper, .. } => [!is_upper, is_upper],
            StopLaw::Latch { strength: Some(_) } => [true, false],
            StopLaw::Latch { strength: None } => return Some((joint, hit)),
        };
        let release = self.add_event(
            &format!("release of {name}"),
            &[],
            &[joint.0],
            &of_release,
            Some(Digest::of(&"release")),
            |own| own.p.first().map_or(own.mu[0], |&strength| own.mu[0].abs() - strength),
        )?;
        (release.directions, release.opens) = (directions, vec![joint.0]);
        release.while_joint = Some((joint.0, true));
        Some((joint, hit))
    }

    /// A joint that opens for good where the size of its force is more than a strength \[N\]: the length of those of its multipliers that are forces; of a
    /// joint that has none, of its moments [N m].
    pub fn joint_strength(&mut self, joint: ConstraintId, strength: S) {
        let Some(name) = self.model.find_constraint(joint).map(|own| format!("release of {}", own.name)) else { return };
        if self.model.presence.iter().all(|own| own.0 != joint.0) {
            self.comes_and_goes(joint, true);
        }
        let (equations, _) = self.forces_of(joint);
        let origin = ("strength", &equations);
        let release = self.add_event(
            &name,
            &[],
            &[joint.0],
            &[strength],
            Some(Digest::of(&origin)),
            |EventArguments { mu, p, .. }| equations.iter().map(|&own| mu[own] * mu[own]).sum::<Recorded>() - p[0] * p[0],
        );
        let release = release.is_some().then(|| self.model.events.len() - 1);
        let opens = self.with_companions(&[joint]).into_iter().map(|own| own.0).collect();
        let Some(event) = release else { return };
        let release = &mut self.model.events[event];
        (release.directions, release.opens, release.while_joint) = ([true, false], opens, Some((joint.0, true)));
    }

    /// Coulomb friction of a revolute, prismatic or point-on-line joint, by the size of its force: sliding and static coefficient [-], preload \[N\],
    /// and of a revolute joint the radius of its bearing \[m\].
    pub fn joint_friction(
        &mut self,
        joint: ConstraintId,
        [sliding, sticking, preload]: [S; 3],
        radius: Option<S>,
    ) -> Option<[usize; 2]> {
        let own = self.model.find_constraint(joint).cloned()?;
        let nodes = self.kinds_of(&own.nodes);
        let (Some(surfaces), &[a, b]) = (own.physics.part().surfaces(), &nodes[..]) else {
            let name = &own.name;
            self.mistakes.push(format!(
                "\"{name}\" has no friction: only revolute, prismatic and point_on_line joints, contacts and clutches do"
            ));
            return None;
        };
        if radius.is_some() != (surfaces == Surfaces::Bearing) {
            let name = &own.name;
            self.mistakes.push(format!(
                "friction of \"{name}\": a revolute joint needs the radius of its bearing, and others have none"
            ));
            return None;
        }
        let (forces, _) = self.forces_of(joint);
        let geometry = self.numbers.p[own.parameters][..JointSurfaces::GEOMETRY].to_vec();
        let p = [geometry, vec![sliding, sticking, preload, radius.unwrap_or_else(S::one)]].concat();
        self.friction(joint, JointSurfaces { nodes: [a, b], surfaces, forces }, &p)
    }

    /// Friction that has a capacity of its own, between nodes that nothing holds together: returns the numbers of the events at which they stick and slip.
    pub fn clutch(&mut self, name: &str, nodes: &[NodeId], friction: impl Friction, p: &[S]) -> Option<[usize; 2]> {
        let joint = self.constraint(name, nodes, Apart(friction.nodes()), &[]);
        self.friction(joint, friction, p)
    }

    /// A sphere that may touch a plane of another body: nodes (plane, sphere), world centre \[m\], a point of the plane and its normal towards the sphere,
    /// radius \[m\], 0 of a point. It hits with a restitution, below the rest speed [m/s] without, and has sliding and static friction where these are
    /// given. Returns the contact, the event that hits it, and those at which it sticks and slips.
    pub fn sphere_on_plane(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        (centre, radius): (Vector3<S>, S),
        (point, normal): (Vector3<S>, Vector3<S>),
        law: [S; 2],
        friction: Option<[S; 2]>,
    ) -> Option<(ConstraintId, usize, Option<[usize; 2]>)> {
        let mut given = self.given(name, &nodes, vec![("normal", normal.into())]);
        let (kinds, normal) = (given.body_and_guided(), given.unit("normal"));
        let touching = point + normal * radius;
        let geometry = [given.local_points([0, 1], [touching, centre]), given.local_directions(0, [normal])].concat();
        let [u, w] = normal.perpendiculars();
        let (of_centre, axes) =
            (given.node(1).local_point(centre).components().to_vec(), given.local_directions(0, [u, w, normal]));
        let wrong = given.mistakes();
        if !wrong.is_empty() {
            self.keep_mistakes(name, wrong);
            return None;
        }
        let own = friction.map(|own| (SphereFriction(kinds), [of_centre, axes, vec![radius], own.to_vec()].concat()));
        self.contact(name, &nodes, (PointInPlane(kinds), &geometry), law, own)
    }

    /// Two spheres that may touch, by their world centres and radii \[m\], of which one may be 0: the same as [`MechanismBuilder::sphere_on_plane`].
    pub fn sphere_on_sphere(
        &mut self,
        name: &str,
        nodes: [NodeId; 2],
        spheres: [(Vector3<S>, S); 2],
        law: [S; 2],
        friction: Option<[S; 2]>,
    ) -> Option<(ConstraintId, usize, Option<[usize; 2]>)> {
        let [(centre_a, radius_a), (centre_b, radius_b)] = spheres;
        let mut given = self.given(name, &nodes, vec![("line between the centres", (centre_b - centre_a).into())]);
        let (kinds, normal) = (given.body_and_guided(), given.unit("line between the centres"));
        let centres = given.local_points([0, 1], [centre_a, centre_b]);
        let wrong = given.mistakes();
        if !wrong.is_empty() {
            self.keep_mistakes(name, wrong);
            return None;
        }
        let [u, w] = normal.perpendiculars();
        let axes = [u, w, normal].map(|own| own.components().to_vec()).concat();
        let geometry = [&centres[..], &[radius_a + radius_b]].concat();
        let own = friction.map(|own| (SpheresFriction(kinds), [&centres[..], &axes, &[radius_a, radius_b], &own].concat()));
        self.contact(name, &nodes, (DistanceJoint(kinds), &geometry), law, own)
    }

    /// A gap that is never below zero, with the friction of what is together there.
    fn contact(
        &mut self,
        name: &str,
        nodes: &[NodeId],
        (gap, p): (impl Constraint + Clone, &[S]),
        [restitution, rest_speed]: [S; 2],
        friction: Option<(impl Friction, Vec<S>)>,
    ) -> Option<(ConstraintId, usize, Option<[usize; 2]>)> {
        let (joint, hit) = self.stop(name, nodes, gap, p, StopLaw::Stop { is_upper: false, restitution, rest_speed })?;
        let of_friction = friction.and_then(|(own, p)| self.friction(joint, own, &p));
        Some((joint, hit, of_friction))
    }

    /// Friction of a joint or stop: its surfaces stick, or slip with a force. Returns the numbers of the events at which they stick and slip.
    pub fn friction(&mut self, joint: ConstraintId, friction: impl Friction, p: &[S]) -> Option<[usize; 2]> {
        let own = self.model.find_constraint(joint).cloned()?;
        let (name, nodes) = (&own.name, &own.nodes);
        let wrong = self.promises_of(&friction, &own, p);
        let friction: Arc<dyn AnyFriction> = Arc::new(friction);
        let directions = friction.direction_count();
        let is_sound = self.check_parameters(name, friction.parameter_list().len(), p.len())
            & self.check_nodes(name, nodes, &friction.node_kinds());
        if !(1..=2).contains(&directions) {
            self.mistakes.push(format!("friction of \"{name}\" has {directions} velocities of slip: one or two are known"));
            return None;
        }
        if !is_sound {
            return None;
        }
        if let Some(wrong) = wrong {
            self.mistakes.push(format!("friction of \"{name}\": {wrong}"));
            return None;
        }
        let (still, told) = (vec![S::zero(); directions], vec![S::zero(); directed_by(directions)]);
        let slipping = Slipping { joint: own.physics.part(), friction: Arc::clone(&friction) };
        let known = self.numbers.p[own.parameters.clone()].to_vec();
        self.numbers.p.extend([&known, p, &[S::one()], &told].into_iter().flatten());
        self.model.replace_constraint(joint, Arc::new(slipping));
        let axis = if directions == 2 { vec![S::one(), S::zero()] } else { Vec::new() };
        let sticks = [p, &still, &axis].concat();
        let stick =
            self.add_constraint(&format!("sticking of {name}"), nodes, Box::new(Sticking(Arc::clone(&friction))), &sticks);
        self.model.find_constraint(stick)?;
        self.model.set_presence(stick.0, false);
        let count = p.len();
        let law = Arc::clone(&friction);
        let one = Recorded::from(1.0);
        let origin = (friction.origin(), count, own.equations.len());
        let limits = self.model.add_limits(stick.0, Some(Digest::of(&origin)), |EventArguments { v, q, p, t, .. }| {
            law.limits_of_load(one, [v, q, &p[..count]], t).to_vec()
        });
        if let Err(why) = limits {
            self.mistakes.push(format!("friction \"{name}\": {why}"));
            return None;
        }
        let (first, count) = (self.model.events.len(), p.len());
        let law = Arc::clone(&friction);
        let event = self.add_event(
            &format!("stick of {name}"),
            nodes,
            &[],
            &[p, &told].concat(),
            Some(Digest::of(&("stick", &origin))),
            |EventArguments { v, q, p, t, .. }| {
                let (p, d) = p.split_at(count);
                going_on(&law.slip_of([v, q, p], t), d)
            },
        );
        let event = event?;
        let of_event = event.condition.parameters.start + count;
        (event.directions, event.while_joint) = ([false, true], Some((stick.0, false)));
        event.closes = vec![Closing { joint: stick.0, stop: None, impulse: None }];
        let (of_slip, equations) = ([p, &[S::one()]].concat(), own.equations.len());
        let event = self.add_event(
            &format!("slip of {name}"),
            nodes,
            &[joint.0, stick.0],
            &of_slip,
            Some(Digest::of(&("slip", &origin))),
            |EventArguments { v, q, mu, p, t }| {
                let (mu, pull) = mu.split_at(equations);
                let [_, limit] = friction.limits_of([v, q, mu, &p[..count]], t, p[count]);
                match pull {
                    [pull] => pull.abs() - limit,
                    _ => pull.iter().map(|&pull| pull * pull).sum::<Recorded>() - limit * limit,
                }
            },
        );
        let event = event?;
        let flag = event.condition.parameters.start + count;
        (event.directions, event.while_joint, event.opens) = ([true, false], Some((stick.0, true)), vec![stick.0]);
        let [slips, sticks] = [joint, stick].map(|own| self.model.constraints[own.0].parameters.end);
        self.model.frictions.push(JointFriction {
            joints: [joint.0, stick.0],
            events: [first, first + 1],
            direction: [slips - told.len()..slips, of_event..of_event + told.len()],
            kept: sticks - axis.len() - directions..sticks - axis.len(),
            axis: sticks - axis.len()..sticks,
            forces: [slips - told.len() - 1, flag],
        });
        Some([first, first + 1])
    }

    /// What a friction of one's own has to be for impacts and does not keep, by its numbers at the start: a load of the first degree in the multipliers,
    /// and limits linear in the load.
    fn promises_of(&self, friction: &impl Friction, joint: &Attached<ConstraintPhysics>, p: &[S]) -> Option<&'static str> {
        let real = |numbers: &[S]| numbers.iter().map(|own| own.value()).collect::<Vec<f64>>();
        let of_nodes = |numbers: &[S]| {
            let dofs = joint.nodes.iter().flat_map(|node| self.model.nodes[node.0].dofs.clone());
            dofs.map(|dof| numbers[dof].value()).collect::<Vec<f64>>()
        };
        let (p, v, q) = (real(p), of_nodes(&self.numbers.v), of_nodes(&self.numbers.q));
        if p.len() != friction.parameters().len() || friction.nodes() != self.kinds_of(&joint.nodes) {
            return None;
        }
        let mu: Vec<f64> = unrelated_numbers().take(joint.equations.len()).collect();
        let twice: Vec<f64> = mu.iter().map(|mu| 2.0 * mu).collect();
        let [one, two] = [mu, twice].map(|mu: Vec<f64>| -> f64 { friction.load(&mu, &q, &p, 0.0) });
        if (two - 2.0 * one).abs() > CONSISTENT * two.abs() {
            return Some(
                "its load is not of the first degree in the multipliers: twice of these are to press twice as much",
            );
        }
        let limits = [0.0, 1.0, 2.0].map(|load: f64| friction.limits(load, State { a: &[], v: &v, q: &q }, &p, 0.0));
        let is_bent = |k: usize| {
            let [none, one, two] = limits.map(|own: [f64; 2]| own[k]);
            (two - 2.0 * one + none).abs() > CONSISTENT * (two.abs() + none.abs())
        };
        (is_bent(0) || is_bent(1)).then_some("its limits are not linear in the load")
    }

    fn kinds_of(&self, nodes: &[NodeId]) -> Vec<NodeKind> {
        nodes.iter().map(|&node| self.model.node(node).kind).collect()
    }

    /// A joint that is not there at the start, or that events remove.
    #[doc(hidden)]
    pub fn comes_and_goes(&mut self, joint: ConstraintId, is_there: bool) {
        if self.has_joint("an event", joint) {
            self.with_companions(&[joint]).into_iter().for_each(|own| self.model.set_presence(own.0, is_there));
        }
    }

    /// Joints, each behind what comes and goes with it.
    fn with_companions(&self, joints: &[ConstraintId]) -> Vec<ConstraintId> {
        joints.iter().flat_map(|joint| self.companions.get(joint).copied().into_iter().chain([*joint])).collect()
    }

    /// Joints that the event made last removes, and that it adds with an impact; of what rolls with the contact. Stops and contacts are there no more, or
    /// can be hit again.
    pub fn event_changes(&mut self, removed: &[ConstraintId], added: &[ConstraintId]) {
        let [removed, added] = [removed, added].map(|joints| self.with_companions(joints));
        for &joint in removed.iter().chain(&added) {
            if self.model.presence.iter().all(|own| own.0 != joint.0) {
                self.comes_and_goes(joint, true);
            }
        }
        let Some(event) = self.model.events.last_mut() else { return };
        event.opens.extend(removed.iter().map(|joint| joint.0));
        event.closes.extend(added.iter().map(|joint| Closing { joint: joint.0, stop: None, impulse: None }));
    }

    /// What locks a joint needs one that is not there: says which are there all the time.
    pub(super) fn check_locks(&mut self) {
        let events = &self.model.events;
        let is_removed = |joint: usize| events.iter().any(|own| own.opens.contains(&joint));
        let locks = events.iter().flat_map(|own| own.closes.iter().map(move |closing| (own, closing.joint)));
        let idle = locks.filter(|(_, joint)| self.model.is_there_at_start(*joint) && !is_removed(*joint));
        let words = idle.map(|(event, joint)| {
            let (event, joint) = (&event.condition.name, &self.model.constraints[joint].name);
            format!("event \"{event}\" locks \"{joint}\", which is there from the start: give it present = false, or let an event remove it before")
        });
        let words: Vec<String> = words.collect();
        self.mistakes.extend(words);
    }

    fn add_reset(
        &mut self,
        event: usize,
        nodes: &[NodeId],
        p: &[S],
        targets: Vec<Target>,
        origin: Option<Digest>,
        values: impl FnOnce(EventArguments) -> Vec<Recorded>,
    ) {
        self.numbers.p.extend_from_slice(p);
        if let Err(why) = self.model.add_reset(event, nodes, p.len(), targets, origin, values) {
            let name = &self.model.events[event].condition.name;
            self.mistakes.push(format!("event \"{name}\": {why}"));
        }
    }

    /// The time \[s\] at which an event happens for the `number`-th time, counted from 1.
    pub fn event_time_functional(&mut self, name: &str, event: usize, number: usize) {
        let node = self.kept(&format!("time of {name}"), &[S::zero(); 2]);
        let first = self.model.nodes[node.0].dofs.start;
        let targets = vec![Target::Rate(first), Target::Rate(first + 1)];
        self.add_reset(
            event,
            &[node],
            &[],
            targets,
            Some(Digest::of(&("time of an event", number))),
            |EventArguments { v, t, .. }| {
                let count = v[0] + Recorded::from(1.0);
                let is_it = (count - Recorded::from(number as f64)).abs().less(Recorded::from(0.5));
                vec![count, is_it.select(t, v[1])]
            },
        );
        self.functional(name, Over::Terminal, (&[node], &[]), EventTime(number), &[]);
    }

    /// The sum of the sizes of all impulses with which stops or latches are hit, by the events that hit them: of forces \[N s\], of an angle [N m s].
    pub fn impulse_functional(&mut self, name: &str, hits: &[usize]) {
        let known = hits.first().and_then(|&hit| self.model.events[hit].closes.first()?.impulse);
        let node = match known.and_then(|dof| self.model.nodes.iter().position(|node| node.dofs.start == dof)) {
            Some(place) => self.model.node_id(place),
            None => self.kept(&format!("impulse of {name}"), &[S::zero()]),
        };
        let dof = self.model.nodes[node.0].dofs.start;
        for &hit in hits {
            self.model.events[hit].closes.iter_mut().for_each(|own| own.impulse = Some(dof));
        }
        self.functional(name, Over::Terminal, (&[node], &[]), KeptValue("N s"), &[]);
    }
}
