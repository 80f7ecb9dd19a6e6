use super::blocks::load;
use super::numbering::{GlobalConstraint, Part, System};
use super::residual::{Local3, LocalVec, select, write_level};
use super::{Equations, Impulse, Jacobian, Level, Unknowns, VectorsAvq};
use crate::elements::{ElementIn, PointWork, RunScalar, State};
use crate::scalar::{Direction, LANES, Lanes, Rev, Taylor, add_gradients};
use smallvec::SmallVec;
use std::ops::Range;

/// Adjoint variables of one system: one number for each row of F, Y, G, and of the equations inside nodes.
#[derive(Clone, Debug, Default)]
pub struct Adjoints {
    /// Of F.
    pub f: Vec<f64>,
    /// Of Y; empty unless stabilized.
    pub y: Vec<f64>,
    /// Of the scaled G.
    pub g: Vec<f64>,
    /// Of the second set; empty unless stabilized.
    pub g_second: Vec<f64>,
    /// Of the scaled equations inside nodes (both sets one after the other if stabilized).
    pub local: Vec<f64>,
}

impl Adjoints {
    /// Zeros for a system.
    pub fn zeros(system: &System) -> Self {
        let second = |n: usize| vec![0.0; if system.options.stabilized { n } else { 0 }];
        Adjoints {
            f: vec![0.0; system.model.dofs],
            y: second(system.model.dofs),
            g: vec![0.0; system.multipliers()],
            g_second: second(system.multipliers()),
            local: vec![0.0; system.local_equations * if system.options.stabilized { 2 } else { 1 }],
        }
    }
}

/// Where products are taken: point, parameters, time, and which parameters' derivatives are asked for.
#[derive(Clone, Copy)]
pub struct ProductPoint<'p> {
    /// (a, v, q).
    pub at: &'p VectorsAvq<f64>,
    /// Parameters.
    pub p: &'p [f64],
    /// Parameters that depend on a design variable; the others get no derivative.
    pub active: &'p [bool],
    /// Time [s].
    pub t: f64,
}

/// Where products go, for one functional.
pub struct ProductBars<'b> {
    /// Adjoint of (a, v, q).
    pub at: &'b mut VectorsAvq<f64>,
    /// Adjoint of the parameters.
    pub p: &'b mut [f64],
}

/// Which of a joint's adjoints are not all zero.
#[derive(Clone, Copy)]
struct Weighing {
    equations: bool,
    reactions: bool,
}

/// Numbers of one part, reused from part to part.
#[derive(Default)]
struct Work {
    state: Local3<f64>,
    /// One row for each functional.
    weights: Vec<f64>,
    gradients: Vec<f64>,
    results: Vec<Rev>,
    rows: Vec<Taylor<f64>>,
    reaction_rows: Vec<f64>,
    directions: Vec<Direction>,
    curvature: Vec<Direction>,
    multipliers: Vec<f64>,
    /// (a, v, q), parameters, reaction, multipliers.
    lanes: [Vec<Lanes>; 6],
    points: PointWork,
}

/// Copies the numbers of a part's coordinates.
fn pick(part: &Part, values: &[f64], target: &mut Vec<f64>) {
    for segment in &part.segments {
        target.extend_from_slice(&values[segment.clone()]);
    }
}

fn add_to(part: &Part, local: &[f64], values: &mut [f64]) {
    let mut first = 0;
    for segment in &part.segments {
        for (value, l) in values[segment.clone()].iter_mut().zip(&local[first..]) {
            *value += l;
        }
        first += segment.len();
    }
}

/// Arguments of R up to which it is differentiated in lanes instead of recorded.
const FEW: usize = 5 * LANES;

fn add_gradient_rows(part: &Part, gradients: &[f64], variables: usize, bars: &mut [ProductBars]) {
    let n = part.dofs;
    for (bar, gradient) in bars.iter_mut().zip(gradients.chunks_exact(variables)) {
        add_to(part, gradient, &mut bar.at.a);
        add_to(part, &gradient[n..], &mut bar.at.v);
        add_to(part, &gradient[2 * n..], &mut bar.at.q);
        bar.p[part.parameters.clone()].iter_mut().zip(&gradient[3 * n..]).for_each(|(bar, g)| *bar += g);
    }
}

impl System<'_> {
    /// Adds `sign` times the gradient of lambda . R(a, v, q, p, t) for every functional: R is recorded once for all of them; that of
    /// linear elements towards (a, v, q) is known from an assembled matrix.
    pub fn add_element_products(
        &self,
        jacobian: &Jacobian,
        adjoints: &[Adjoints],
        sign: f64,
        point: ProductPoint,
        bars: &mut [ProductBars],
    ) {
        let mut work = Work::default();
        let ProductPoint { at, p, active, t } = point;
        for (index, (element, part)) in self.model.elements.iter().zip(&self.element_parts).enumerate() {
            let n = part.dofs;
            work.weights.clear();
            for adjoint in adjoints {
                pick(part, &adjoint.f, &mut work.weights);
            }
            if work.weights.iter().all(|&w| w == 0.0) {
                continue;
            }
            work.weights.iter_mut().for_each(|weight| *weight *= sign);
            let own = part.parameters.clone();
            let with_parameters = active[own.clone()].contains(&true);
            let variables = 3 * n + if with_parameters { own.len() } else { 0 };
            work.gradients.clear();
            work.gradients.resize(variables * adjoints.len(), 0.0);
            let known = jacobian.constants_of(index).filter(|_| element.physics.points().is_none());
            if let Some(matrices) = known {
                let rows = work.weights.chunks_exact(n).zip(work.gradients.chunks_exact_mut(variables));
                for (weights, gradient) in rows {
                    for (matrix, gradient) in matrices.iter().zip(gradient.chunks_exact_mut(n)) {
                        for (row, weight) in matrix.chunks_exact(n).zip(weights) {
                            gradient.iter_mut().zip(row).for_each(|(target, entry)| *target += weight * entry);
                        }
                    }
                }
            }
            if let Some(points) = element.physics.points() {
                let s = work.state.state(part, at);
                points.pull_back(s, &p[own], t, &work.weights, &mut work.points, &mut work.gradients);
                add_gradient_rows(part, &work.gradients, variables, bars);
                continue;
            }
            if variables <= FEW || known.is_some() {
                let first = if known.is_some() { 3 * n } else { 0 };
                self.add_element_lanes(index, part, with_parameters, first..variables, point, &mut work);
                add_gradient_rows(part, &work.gradients, variables, bars);
                continue;
            }
            work.results.clear();
            work.results.resize(n, Rev::default());
            let State { a, v, q } = work.state.state(part, at);
            let numbers = &p[own.clone()];
            let varied = if with_parameters { numbers } else { &[] };
            let physics: &dyn ElementIn<Rev> = &*element.physics;
            let record = |x: &[Rev], r: &mut [Rev]| {
                let (a, rest) = x.split_at(n);
                let (v, rest) = rest.split_at(n);
                let (q, p) = rest.split_at(n);
                let state = State { a, v, q };
                if with_parameters {
                    physics.add_residual(state, p, Rev::from(t), r);
                } else {
                    physics.add_residual(state, &constants(numbers), Rev::from(t), r);
                }
            };
            let rows = work.weights.chunks_exact(n).zip(work.gradients.chunks_exact_mut(variables));
            let values = [a, v, q, varied].into_iter().flatten().copied();
            add_gradients(values, record, &mut work.results, rows);
            add_gradient_rows(part, &work.gradients, variables, bars);
        }
    }

    /// Adds `sign` times the gradient of lambda . (w_P P + w_F F) at (v, q) for every functional.
    pub fn add_impulse_products(
        &self,
        jacobian: &Jacobian,
        adjoints: &[Adjoints],
        (impulse, sign): (Impulse, f64),
        point: ProductPoint,
        bars: &mut [ProductBars],
    ) {
        let ProductPoint { at: VectorsAvq { v, q, .. }, p, active, t } = point;
        for term in impulse.terms() {
            let scaled = |factor: f64| v.iter().map(|v| factor * v).collect();
            let at = VectorsAvq { a: scaled(term.a), v: scaled(term.v), q: q.clone() };
            let mut own = vec![VectorsAvq::zeros(q.len()); bars.len()];
            let targets = own.iter_mut().zip(&mut *bars);
            let mut targets: Vec<ProductBars> = targets.map(|(at, bar)| ProductBars { at, p: &mut *bar.p }).collect();
            let there = ProductPoint { at: &at, p, active, t };
            self.add_element_products(jacobian, adjoints, sign * term.weight, there, &mut targets);
            drop(targets);
            for (bar, own) in bars.iter_mut().zip(&own) {
                let VectorsAvq { v, q, .. } = &mut *bar.at;
                v.iter_mut().zip(own.a.iter().zip(&own.v)).for_each(|(v, (of_a, of_v))| *v += term.a * of_a + term.v * of_v);
                q.iter_mut().zip(&own.q).for_each(|(q, own)| *q += own);
            }
        }
        if impulse.force != 0.0 {
            self.add_momentum_rate_products(adjoints, sign * impulse.force, point, bars);
        }
    }

    /// Adds `factor` times the gradient of lambda . (dP/dq) v, eight arguments at a time.
    fn add_momentum_rate_products(&self, adjoints: &[Adjoints], factor: f64, point: ProductPoint, bars: &mut [ProductBars]) {
        let mut work = Work::default();
        for (element, part) in self.model.elements.iter().zip(&self.element_parts) {
            if element.physics.has_constant_mass() {
                continue;
            }
            let n = part.dofs;
            let Work { state, lanes: [_, v, q, p, r, _], weights, gradients, .. } = &mut work;
            weights.clear();
            adjoints.iter().for_each(|adjoint| pick(part, &adjoint.f, weights));
            let own = state.state(part, point.at);
            load(v, own.v);
            load(q, own.q);
            load(p, &point.p[part.parameters.clone()]);
            let with_parameters = point.active[part.parameters.clone()].contains(&true);
            let variables = 3 * n + if with_parameters { p.len() } else { 0 };
            gradients.clear();
            gradients.resize(variables * adjoints.len(), 0.0);
            // nothing depends on accelerations
            for first in (n..variables).step_by(LANES) {
                let width = LANES.min(variables - first);
                for (argument, lane) in v.iter_mut().chain(&mut *q).chain(&mut *p).skip(first - n).zip(0..width) {
                    argument.eps[lane] = 1.0;
                }
                r.clear();
                r.resize(n, Lanes::default());
                Lanes::element(&*element.physics).add_momentum_rate(v, q, p, r);
                for (weights, gradient) in weights.chunks_exact(n).zip(gradients.chunks_exact_mut(variables)) {
                    for (r, weight) in r.iter().zip(weights) {
                        let targets = gradient[first..first + width].iter_mut();
                        targets.zip(r.eps).for_each(|(target, r)| *target += factor * weight * r);
                    }
                }
                let arguments = v.iter_mut().chain(&mut *q).chain(&mut *p).skip(first - n);
                arguments.take(width).for_each(|argument| argument.eps = [0.0; LANES]);
            }
            add_gradient_rows(part, gradients, variables, bars);
        }
    }

    /// Gradients of weights . R by differentiating R along eight of its arguments at a time: shared by all functionals, and for few
    /// arguments faster than a recording.
    fn add_element_lanes(
        &self,
        index: usize,
        part: &Part,
        with_parameters: bool,
        varied: Range<usize>,
        point: ProductPoint,
        work: &mut Work,
    ) {
        if varied.is_empty() {
            return;
        }
        let (n, variables) = (part.dofs, varied.end);
        let Work { state, lanes: [a, v, q, p, r, _], weights, gradients, .. } = work;
        let own = state.state(part, point.at);
        load(a, own.a);
        load(v, own.v);
        load(q, own.q);
        load(p, &point.p[part.parameters.clone()]);
        let count = if with_parameters { p.len() } else { 0 };
        let physics = Lanes::element(&*self.model.elements[index].physics);
        for first in varied.step_by(LANES) {
            let width = LANES.min(variables - first);
            let arguments = a.iter_mut().chain(&mut *v).chain(&mut *q).chain(p.iter_mut().take(count));
            for (argument, lane) in arguments.skip(first).zip(0..width) {
                argument.eps[lane] = 1.0;
            }
            r.clear();
            r.resize(n, Lanes::default());
            physics.add_residual(State { a, v, q }, p, Lanes::from(point.t), r);
            for (weights, gradient) in weights.chunks_exact(n).zip(gradients.chunks_exact_mut(variables)) {
                for (r, weight) in r.iter().zip(weights) {
                    gradient[first..first + width].iter_mut().zip(r.eps).for_each(|(target, r)| *target += weight * r);
                }
            }
            let arguments = a.iter_mut().chain(&mut *v).chain(&mut *q).chain(p.iter_mut().take(count));
            arguments.skip(first).take(width).for_each(|argument| argument.eps = [0.0; LANES]);
        }
    }

    /// Adds the gradient of lambda_F . A^T mu - lambda_Y . A^T eta + lambda_G . G of all joints, for every functional.
    pub fn add_constraint_products(
        &self,
        equations: &Equations,
        adjoints: &[Adjoints],
        unknowns: &Unknowns<f64>,
        point: ProductPoint,
        bars: &mut [ProductBars],
    ) {
        let mut work = Work::default();
        for (joint, part) in self.global_constraints().zip(&self.constraint_parts) {
            // equations and reactions of a variational step act at different points: at each the adjoints of the others are zero
            let weigh =
                |values: &[f64], places: Range<usize>| values.get(places).unwrap_or_default().iter().any(|&own| own != 0.0);
            let equations_weigh = |own: &Adjoints| [&own.g, &own.g_second].iter().any(|g| weigh(g, joint.equations.clone()));
            let reaction_weighs =
                |own: &Adjoints| part.segments.iter().any(|s| weigh(&own.f, s.clone()) || weigh(&own.y, s.clone()));
            let weighing = Weighing {
                equations: adjoints.iter().any(equations_weigh),
                reactions: adjoints.iter().any(reaction_weighs),
            };
            if weighing.equations {
                self.add_row_products(&joint, part, equations, adjoints, point, bars, &mut work);
            }
            if weighing.reactions {
                let sets = [(&unknowns.mu, false), (&unknowns.eta, true)];
                let stabilized = equations.level == Level::Stabilized;
                for (multipliers, second) in sets.into_iter().take(1 + usize::from(stabilized)) {
                    let multipliers = &multipliers[joint.equations.clone()];
                    self.add_curvature_products(&joint, part, multipliers, second, adjoints, point, bars, &mut work);
                }
            }
            if (weighing.equations || weighing.reactions) && point.active[part.parameters.clone()].contains(&true) {
                self.add_parameter_products(&joint, part, equations, (adjoints, weighing), unknowns, point, bars, &mut work);
            }
        }
    }

    /// The part lambda_G . G towards (a, v, q), from the rows along the motion.
    #[allow(clippy::too_many_arguments)]
    fn add_row_products(
        &self,
        joint: &GlobalConstraint,
        part: &Part,
        equations: &Equations,
        adjoints: &[Adjoints],
        point: ProductPoint,
        bars: &mut [ProductBars],
        work: &mut Work,
    ) {
        let Work { state, rows, reaction_rows, .. } = work;
        let (count, own) = (joint.equations.len(), state.state(part, point.at));
        rows.clear();
        rows.resize(count * part.dofs, Taylor::default());
        let nonholonomic = joint.physics.is_nonholonomic();
        let wanted = if nonholonomic { equations.nonholonomic(false) } else { Some((equations.level, 1.0)) };
        let Some((level, _)) = wanted else { return };
        let p = &point.p[part.parameters.clone()];
        if level == Level::Position && !nonholonomic {
            // nothing moves
            reaction_rows.clear();
            reaction_rows.resize(count * part.dofs, 0.0);
            joint.physics.gradients((own.q, p, point.t), reaction_rows);
            rows.iter_mut().zip(&*reaction_rows).for_each(|(row, &a)| row.value = a);
        } else {
            joint.physics.rows(own, p, point.t, level == Level::Acceleration, rows);
        }
        let scales = match wanted {
            Some((_, scale)) if nonholonomic => [scale, 0.0],
            _ => equations.row_scales(),
        };
        for (adjoint, bar) in adjoints.iter().zip(bars) {
            for (row, equation) in rows.chunks_exact(part.dofs).zip(joint.equations.clone()) {
                let second = adjoint.g_second.get(equation).copied().unwrap_or(0.0);
                add_row(level, row, [adjoint.g[equation] * scales[0], second * scales[1]], &part.segments, bar.at);
            }
        }
    }

    /// The part lambda . A^T mu towards q: the curvature of mu . g along the lambdas of up to eight functionals at once.
    #[allow(clippy::too_many_arguments)]
    fn add_curvature_products(
        &self,
        joint: &GlobalConstraint,
        part: &Part,
        multipliers: &[f64],
        second: bool,
        adjoints: &[Adjoints],
        point: ProductPoint,
        bars: &mut [ProductBars],
        work: &mut Work,
    ) {
        if multipliers.iter().all(|&mu| mu == 0.0) {
            return;
        }
        let Work { state, directions, curvature, weights, multipliers: signed, .. } = work;
        let n = part.dofs;
        let groups = adjoints.len().div_ceil(LANES);
        directions.clear();
        directions.resize(groups * n, [0.0; LANES]);
        curvature.clear();
        curvature.resize(groups * n, [0.0; LANES]);
        for (k, adjoint) in adjoints.iter().enumerate() {
            weights.clear();
            pick(part, if second { &adjoint.y } else { &adjoint.f }, weights);
            for (direction, weight) in directions[k / LANES * n..].iter_mut().zip(&*weights) {
                direction[k % LANES] = *weight;
            }
        }
        signed.clear();
        signed.extend(multipliers.iter().map(|&m| if second { -m } else { m }));
        let q = state.state(part, point.at).q;
        let at = (q, &point.p[part.parameters.clone()], point.t);
        joint.physics.pull_back(at, signed, directions, curvature);
        for (k, bar) in bars.iter_mut().enumerate() {
            weights.clear();
            weights.extend(curvature[k / LANES * n..].iter().take(n).map(|product| product[k % LANES]));
            add_to(part, weights, &mut bar.at.q);
        }
    }

    /// Everything towards the joint's own parameters, eight at a time and for all functionals together.
    #[allow(clippy::too_many_arguments)]
    fn add_parameter_products(
        &self,
        joint: &GlobalConstraint,
        part: &Part,
        equations: &Equations,
        (adjoints, weighing): (&[Adjoints], Weighing),
        unknowns: &Unknowns<f64>,
        point: ProductPoint,
        bars: &mut [ProductBars],
        work: &mut Work,
    ) {
        let Work { state, lanes, .. } = work;
        let own = state.state(part, point.at);
        let [a, v, q, p, r, multipliers] = lanes;
        load(a, own.a);
        load(v, own.v);
        load(q, own.q);
        load(p, &point.p[part.parameters.clone()]);
        let physics = Lanes::constraint(joint.physics);
        let time = Lanes::from(point.t);
        let nonholonomic = joint.physics.is_nonholonomic();
        let (level, scales) = match equations.nonholonomic(false).filter(|_| nonholonomic) {
            Some((level, scale)) => (level, [scale, 0.0]),
            None if nonholonomic => (Level::Position, [0.0; 2]),
            None => (equations.level, equations.row_scales()),
        };
        let mut g: SmallVec<[Taylor<Lanes>; 6]> = SmallVec::from_elem(Taylor::default(), joint.equations.len());
        let stabilized = equations.level == Level::Stabilized;
        let parameters = part.parameters.clone();
        let asked: SmallVec<[usize; 32]> = (0..p.len()).filter(|&index| point.active[parameters.start + index]).collect();
        for asked in asked.chunks(LANES) {
            for (lane, &index) in asked.iter().enumerate() {
                p[index].eps[lane] = 1.0;
            }
            if weighing.equations {
                write_level(physics, level, State { a, v, q }, p, time, &mut g);
            }
            for (adjoint, bar) in adjoints.iter().zip(&mut *bars).filter(|_| weighing.equations) {
                let mut sums = [0.0; LANES];
                for (equation, g) in joint.equations.clone().zip(&g) {
                    let (value, rate) = select(level, *g);
                    let second = adjoint.g_second.get(equation).copied().unwrap_or(0.0);
                    let weights = [adjoint.g[equation] * scales[0], second * scales[1]];
                    for (sum, (value, rate)) in sums.iter_mut().zip(value.eps.iter().zip(rate.eps)) {
                        *sum += weights[0] * value + weights[1] * rate;
                    }
                }
                asked.iter().zip(sums).for_each(|(index, sum)| bar.p[parameters.start + index] += sum);
            }
            let sets = [(&unknowns.mu, false, 1.0), (&unknowns.eta, true, -1.0)];
            let sets = sets.into_iter().take(1 + usize::from(stabilized)).filter(|_| weighing.reactions);
            for (all, second, sign) in sets {
                load(multipliers, &all[joint.equations.clone()]);
                r.clear();
                r.resize(part.dofs, Lanes::default());
                physics.add_reaction(q, multipliers, p, time, r);
                for (adjoint, bar) in adjoints.iter().zip(&mut *bars) {
                    let lambda = if second { &adjoint.y } else { &adjoint.f };
                    let mut sums = [0.0; LANES];
                    for (dof, r) in part.segments.iter().cloned().flatten().zip(&*r) {
                        sums.iter_mut().zip(r.eps).for_each(|(sum, r)| *sum += sign * lambda[dof] * r);
                    }
                    asked.iter().zip(sums).for_each(|(index, sum)| bar.p[parameters.start + index] += sum);
                }
            }
            for (lane, &index) in asked.iter().enumerate() {
                p[index].eps[lane] = 0.0;
            }
        }
    }

    /// The same for constraints inside nodes, in closed form: reactions, or with `with_equations` their equations' adjoints.
    pub fn add_local_products(
        &self,
        with_equations: bool,
        equations: &Equations,
        adjoint: &Adjoints,
        unknowns: &Unknowns<f64>,
        at: &VectorsAvq<f64>,
        bar: &mut VectorsAvq<f64>,
    ) {
        let (scales, mut rows) = (equations.row_scales(), Vec::new());
        for local in self.eliminated() {
            let dofs = self.model.nodes[local.node].dofs.clone();
            let own = local.equations.clone();
            if !with_equations {
                let target = &mut bar.q[dofs.clone()];
                local.form.add_curvature(&unknowns.local_mu[own.clone()], &adjoint.f[dofs.clone()], 1.0, target);
                if let (Some(eta), Some(lambda)) = (unknowns.local_eta.get(own), adjoint.y.get(dofs)) {
                    local.form.add_curvature(eta, lambda, -1.0, target);
                }
                continue;
            }
            rows.clear();
            rows.resize(own.len() * dofs.len(), Taylor::default());
            let state = State { a: &at.a[dofs.clone()], v: &at.v[dofs.clone()], q: &at.q[dofs.clone()] };
            local.form.moving_rows(state, &mut rows);
            for (row, equation) in rows.chunks_exact(dofs.len()).zip(own) {
                let second = adjoint.local.get(equation + self.local_equations).copied().unwrap_or(0.0);
                let weights = [adjoint.local[equation] * scales[0], second * scales[1]];
                add_row(equations.level, row, weights, std::slice::from_ref(&dofs), bar);
            }
        }
    }

    /// Sets the adjoints of the equations inside nodes so that the gradient with respect to each node's unknowns vanishes along
    /// the directions that were eliminated: x_bar + (J^T lambda) + C^T lambda_local = 0, given the left part in (x, y).
    pub fn set_local_adjoints(
        &self,
        equations: &Equations,
        at: &VectorsAvq<f64>,
        unbalanced_x: &[f64],
        unbalanced_y: &[f64],
        adjoints: &mut Adjoints,
    ) {
        for local in self.eliminated() {
            let dofs = self.model.nodes[local.node].dofs.clone();
            let state = State { a: &at.a[dofs.clone()], v: &at.v[dofs.clone()], q: &at.q[dofs.clone()] };
            let rows = super::local::equation_rows(local, equations, state);
            let mut unbalanced: LocalVec<f64> = unbalanced_x[dofs.clone()].into();
            if let Some(y) = unbalanced_y.get(dofs) {
                unbalanced.extend_from_slice(y);
            }
            let count = rows.len() / unbalanced.len();
            let multipliers = super::local::least_squares(&rows, count, &unbalanced);
            let own = local.equations.len();
            adjoints.local[local.equations.clone()].copy_from_slice(&multipliers[..own]);
            if count > own {
                let start = self.local_equations + local.equations.start;
                adjoints.local[start..start + own].copy_from_slice(&multipliers[own..]);
            }
        }
    }
}

/// Adds the scaled weights of the one or two equations of a level times their gradients, given the row A along the motion.
fn add_row(
    level: Level,
    row: &[Taylor<f64>],
    [first, second]: [f64; 2],
    segments: &[Range<usize>],
    bar: &mut VectorsAvq<f64>,
) {
    if [first, second] == [0.0; 2] {
        return;
    }
    for (dof, a) in segments.iter().cloned().flatten().zip(row) {
        match level {
            Level::Position => bar.q[dof] += first * a.value,
            Level::Velocity => {
                bar.v[dof] += first * a.value;
                bar.q[dof] += first * a.first;
            }
            Level::Acceleration => {
                bar.a[dof] += first * a.value;
                bar.v[dof] += 2.0 * first * a.first;
                bar.q[dof] += first * a.second;
            }
            Level::Stabilized => {
                bar.v[dof] += second * a.value;
                bar.q[dof] += first * a.value + second * a.first;
            }
        }
    }
}

fn constants(values: &[f64]) -> LocalVec<Rev> {
    values.iter().map(|&value| Rev::from(value)).collect()
}
