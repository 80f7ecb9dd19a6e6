use super::arguments::{ArgumentKind, Arguments};
use super::digest::Digest;
use super::graph::Graph;
use super::listing::Listing;
use super::operation::Node;
use super::recorded::{Recorded, Recording, record};
use super::running::{Making, Program};
use rustc_hash::FxHashMap;
use smallvec::{SmallVec, smallvec};
use std::cell::Cell;
use std::collections::HashMap;
use std::hash::Hash;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, OnceLock, PoisonError, RwLock, Weak};

thread_local! {
    static IS_CAUGHT: Cell<bool> = const { Cell::new(false) };
    static MADE: Cell<usize> = const { Cell::new(0) };
}

/// How many formulas this thread has recorded or derived from others so far, of those that are known by what was recorded none.
pub fn formulas_made() -> usize {
    MADE.get()
}

/// Whether a panic of this thread comes from a formula that is recorded, and becomes an error.
pub fn panic_is_caught() -> bool {
    IS_CAUGHT.get()
}

/// What a program of a formula computes: a name, and the numbers on which its operations depend (sizes, which inputs move, which are asked for).
pub type ProgramKey = (&'static str, Codes);

/// Numbers of a key; lists of usual lengths take no memory of their own.
pub type Codes = SmallVec<[u32; 16]>;

/// A recorded formula with the programs that were made of it: one for all elements of the same type and options, because equal
/// recordings of equal arguments are the same formula.
#[derive(Debug)]
pub struct Formula {
    /// Number of arguments.
    pub inputs: usize,
    /// What they are.
    arguments: Arguments,
    /// Results.
    pub outputs: Vec<Node>,
    /// Stages of the residual of an element with a node map.
    pub stages: Option<Stages<Node>>,
    graph: Mutex<Graph>,
    programs: RwLock<FxHashMap<ProgramKey, Arc<Program>>>,
    values: OnceLock<Arc<Program>>,
    gradients: ProgramCache,
    digest: Digest,
}

/// Numbers between the coordinates of an element and its residual R: y = m(q) of each node by itself, the residual F of these numbers, and
/// R = (dy/dq)^T F.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Stages<N> {
    /// d2y/dt2, dy/dt and y.
    pub numbers: [Vec<N>; 3],
    /// F, conjugate to y.
    pub forces: Vec<N>,
}

impl Stages<Recorded> {
    fn nodes(self, graph: &mut Graph) -> Stages<Node> {
        let mut nodes = |list: Vec<Recorded>| list.into_iter().map(|number| number.node(graph)).collect();
        Stages { numbers: self.numbers.map(&mut nodes), forces: nodes(self.forces) }
    }
}

/// Programs at hand under short codes: looking them up by all that they depend on takes longer than running a small one. Reading writes
/// nothing, so that threads do not wait for each other.
#[derive(Debug, Default)]
pub struct ProgramCache {
    known: [OnceLock<(u32, Arc<Program>)>; USUAL],
    more: OnceLock<Box<ProgramCache>>,
}

/// Usual number of programs of a batch.
const USUAL: usize = 12;

impl ProgramCache {
    /// The program of a code, made when it is first asked for.
    pub fn get(&self, code: u32, make: impl FnOnce() -> Arc<Program>) -> &Arc<Program> {
        self.find(code).unwrap_or_else(|| self.keep(code, make()))
    }

    fn find(&self, code: u32) -> Option<&Arc<Program>> {
        let known = self.known.iter().map_while(OnceLock::get).find(|(own, _)| *own == code);
        known.map(|(_, program)| program).or_else(|| self.more.get()?.find(code))
    }

    /// Keeps a program, unless another thread has made it, too, and been first.
    fn keep(&self, code: u32, program: Arc<Program>) -> &Arc<Program> {
        for place in &self.known {
            let (own, kept) = place.get_or_init(|| (code, Arc::clone(&program)));
            if *own == code {
                return kept;
            }
        }
        self.more.get_or_init(Box::default).keep(code, program)
    }
}

/// Formulas that are kept for models to come, whether one of today uses them or not.
const KEPT: usize = 1000;

/// A formula of the process.
#[derive(Debug)]
struct Listed {
    formula: Weak<Formula>,
    /// It is kept while nobody uses it, but for one with tables, which may be long.
    kept: Option<Arc<Formula>>,
}

/// The formulas of the process.
#[derive(Default)]
struct Formulas {
    known: HashMap<Digest, Listed>,
    /// Those that are known by what was recorded, too.
    by_origin: HashMap<Digest, Weak<Formula>>,
    /// Count at which those are forgotten that no model uses.
    full: usize,
}

impl Formulas {
    /// Makes room: a process may build model after model, each with formulas of its own.
    fn forget_unused(&mut self) {
        if self.known.len().max(self.by_origin.len()) >= self.full.max(KEPT) {
            self.known.retain(|_, own| own.formula.strong_count() > usize::from(own.kept.is_some()));
            self.by_origin.retain(|_, own| own.strong_count() > 0);
            self.full = 2 * self.known.len().max(self.by_origin.len());
        }
    }
}

static FORMULAS: LazyLock<Mutex<Formulas>> = LazyLock::new(Mutex::default);

/// Results of a formula, and the stages in which they are made.
type Results = (Vec<Recorded>, Option<Stages<Recorded>>);

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // what a panic left behind is a recording of whole operations all the same
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Formula {
    /// The formula of something that was recorded before, or what `record` makes of it: `origin` tells it from all else of which another formula
    /// would be recorded.
    ///
    /// # Errors
    /// Those of `record`.
    pub fn once(origin: &impl Hash, record: impl FnOnce() -> Result<Arc<Formula>, String>) -> Result<Arc<Formula>, String> {
        let origin = Digest::of(origin);
        if let Some(known) = lock(&FORMULAS).by_origin.get(&origin).and_then(Weak::upgrade) {
            return Ok(known);
        }
        let formula = record()?;
        let mut all = lock(&FORMULAS);
        all.forget_unused();
        all.by_origin.insert(origin, Arc::downgrade(&formula));
        Ok(formula)
    }

    /// Records a formula of some arguments; the same formula of the same kinds of arguments again is the same one.
    ///
    /// # Errors
    /// If it branches on a value: what was recorded would hold for other values only by chance.
    pub fn record(
        arguments: impl Into<Arguments>,
        formula: impl FnOnce(&[Recorded]) -> Vec<Recorded>,
    ) -> Result<Arc<Formula>, String> {
        Self::record_in_stages(arguments, |x| (formula(x), None))
    }

    /// As [`Formula::record`], with the stages in which the results are made.
    ///
    /// # Errors
    /// The same.
    pub fn record_in_stages(
        arguments: impl Into<Arguments>,
        formula: impl FnOnce(&[Recorded]) -> (Vec<Recorded>, Option<Stages<Recorded>>),
    ) -> Result<Arc<Formula>, String> {
        let mut formula = Some(formula);
        Self::recorded(arguments.into(), &mut |x| formula.take().map_or_else(|| (Vec::new(), None), |own| own(x)))
    }

    /// Records what is called once; not generic, as there are hundreds of formulas.
    fn recorded(arguments: Arguments, formula: &mut dyn FnMut(&[Recorded]) -> Results) -> Result<Arc<Formula>, String> {
        let _making = Making::begin();
        // an index out of range in a user's formula: who recorded it knows the name of its part
        let around = IS_CAUGHT.replace(true);
        let recorded = catch_unwind(AssertUnwindSafe(|| record(&vec![f64::NAN; arguments.count()], formula)));
        IS_CAUGHT.set(around);
        let ((results, stages), recording) = recorded.map_err(|panic| {
            let words = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
            format!("its formula panics: {}", words.unwrap_or("without a word"))
        })?;
        let Recording { mut graph, looked, undefined, .. } = recording;
        if looked {
            return Err(
                "its formula looks at the value of a number (Scalar::value, is_constant, is_zero, ==, or its text), and may take another branch \
                 for other values: choose by `select`, `max`, `min` or `abs`"
                    .into(),
            );
        }
        let mut outputs: Vec<Node> = results.into_iter().map(|result| result.node(&mut graph)).collect();
        let mut stages = stages.map(|stages| stages.nodes(&mut graph));
        let forces = stages.as_mut().map_or(&mut [] as &mut [Node], |stages| &mut stages.forces);
        undefined.show(&mut graph, &mut outputs, forces);
        Ok(Self::shared(arguments, outputs, stages, graph))
    }

    fn shared(arguments: Arguments, outputs: Vec<Node>, stages: Option<Stages<Node>>, graph: Graph) -> Arc<Formula> {
        MADE.set(MADE.get() + 1);
        let digest = Digest::of(&(&arguments, &outputs, &stages, &graph));
        let mut all = lock(&FORMULAS);
        if let Some(formula) = all.known.get(&digest).and_then(|own| own.formula.upgrade()) {
            return formula;
        }
        all.forget_unused();
        let has_curves = !graph.curves().is_empty();
        let (graph, programs, values) = (Mutex::new(graph), RwLock::default(), OnceLock::new());
        let (inputs, gradients) = (arguments.count(), ProgramCache::default());
        let formula = Arc::new(Formula { inputs, arguments, outputs, stages, graph, programs, values, gradients, digest });
        let kept = (!has_curves).then(|| Arc::clone(&formula));
        all.known.insert(digest, Listed { formula: Arc::downgrade(&formula), kept });
        formula
    }

    /// A program that computes `results` from the formula's arguments and `extra` more; made when it is first asked for.
    ///
    /// `results` gets the arguments, those that are added, and the formula's results; what is zero everywhere is left out of its own, the
    /// others keep their numbers as [labels](Program::labels).
    pub fn sparse_program(
        &self,
        key: ProgramKey,
        extra: usize,
        results: impl FnOnce(&mut Graph, &[Node], &[Node]) -> Vec<Node>,
    ) -> Arc<Program> {
        self.program(key, extra, true, results)
    }

    /// As [`Formula::sparse_program`] with all results.
    pub fn dense_program(
        &self,
        key: ProgramKey,
        extra: usize,
        results: impl FnOnce(&mut Graph, &[Node], &[Node]) -> Vec<Node>,
    ) -> Arc<Program> {
        self.program(key, extra, false, results)
    }

    fn program(
        &self,
        key: ProgramKey,
        extra: usize,
        sparse: bool,
        results: impl FnOnce(&mut Graph, &[Node], &[Node]) -> Vec<Node>,
    ) -> Arc<Program> {
        if let Some(program) = self.programs.read().unwrap_or_else(PoisonError::into_inner).get(&key) {
            return Arc::clone(program);
        }
        let _making = Making::begin();
        let mut graph = lock(&self.graph);
        let count = self.inputs + extra;
        let inputs: Vec<Node> = (0..count).map(|index| graph.input(index)).collect();
        let results = results(&mut graph, &inputs, &self.outputs);
        let kept = results.iter().enumerate().filter(|(_, node)| !(sparse && graph.is_zero(**node)));
        let (labels, kept): (Vec<u32>, Vec<Node>) = kept.map(|(label, &node)| (label as u32, node)).unzip();
        let program = Arc::new(Program::new(Listing::of(&graph, &kept, count), labels));
        drop(graph);
        let mut programs = self.programs.write().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(programs.entry(key).or_insert(program))
    }

    /// The results themselves.
    pub fn values(&self) -> &Arc<Program> {
        self.values.get_or_init(|| self.dense_program(("values", smallvec![]), 0, |_, _, outputs| outputs.to_vec()))
    }

    /// Gradient of the sum of some results, at most 32, towards all arguments; zeros are left out, labels are numbers of arguments.
    pub fn gradient(&self, results: &[usize]) -> &Arc<Program> {
        let code = results.iter().fold(0, |code, &result| code | 1 << result);
        self.gradients.get(code, || {
            self.sparse_program(("gradient", smallvec![code]), 0, |graph, inputs, outputs| {
                let chosen: Vec<Node> = results.iter().map(|&result| outputs[result]).collect();
                let weights = vec![graph.constant(1.0); chosen.len()];
                graph.reverse(&chosen, &weights, inputs)
            })
        })
    }

    /// A formula of the same arguments whose results are made of this one's.
    pub fn derived(&self, results: impl FnOnce(&mut Graph, &[Node], &[Node]) -> Vec<Node>) -> Arc<Formula> {
        let _making = Making::begin();
        let mut graph = lock(&self.graph).clone();
        let inputs: Vec<Node> = (0..self.inputs).map(|index| graph.input(index)).collect();
        let outputs = results(&mut graph, &inputs, &self.outputs);
        Self::shared(self.arguments.clone(), outputs, None, graph)
    }

    /// The formula of a part with `count` more parameters behind its own: `arguments` makes its arguments of those of the new one, without and with
    /// these.
    ///
    /// # Errors
    /// A formula without parameters of a part.
    pub fn with_parameters(
        &self,
        count: usize,
        arguments: impl FnOnce(&[Recorded], &[Recorded]) -> Vec<Recorded>,
    ) -> Result<Arc<Formula>, String> {
        self.widened((ArgumentKind::Parameter, count), arguments)
    }

    /// The same with more arguments of any kind behind parameters and sides.
    pub(super) fn widened(
        &self,
        added: (ArgumentKind, usize),
        arguments: impl FnOnce(&[Recorded], &[Recorded]) -> Vec<Recorded>,
    ) -> Result<Arc<Formula>, String> {
        let mut kinds = self.arguments.kinds().to_vec();
        let is_own = |(kind, _): &(ArgumentKind, usize)| matches!(kind, ArgumentKind::Parameter | ArgumentKind::Side);
        let is_measured = |(kind, _): &(ArgumentKind, usize)| *kind == ArgumentKind::MeasureParameter;
        let last = kinds.iter().rposition(is_own).or_else(|| kinds.iter().rposition(is_measured));
        let last = last.ok_or("it has no parameters of its own")?;
        let end: usize = kinds[..=last].iter().map(|(_, own)| own).sum();
        match added {
            (kind, count) if kind == kinds[last].0 => kinds[last].1 += count,
            (_, 0) => {}
            _ => kinds.insert(last + 1, added),
        }
        Self::record_in_stages(kinds, |x| {
            let (before, rest) = x.split_at(end);
            let (added, behind) = rest.split_at(added.1);
            self.again(&arguments(&[before, behind].concat(), added))
        })
    }

    /// The formula with others in place of its arguments, which `arguments` makes of these.
    ///
    /// # Errors
    /// None that it did not have itself.
    pub fn with_arguments(&self, arguments: impl FnOnce(&[Recorded]) -> Vec<Recorded>) -> Result<Arc<Formula>, String> {
        Self::record_in_stages(self.arguments.kinds().to_vec(), |x| self.again(&arguments(x)))
    }

    /// Its results for arguments of another recording.
    fn again(&self, arguments: &[Recorded]) -> Results {
        let of_stages = |stages: &Stages<Node>| [stages.numbers.concat(), stages.forces.clone()].concat();
        let nodes = [self.outputs.clone(), self.stages.as_ref().map_or_else(Vec::new, of_stages)].concat();
        let mut values = lock(&self.graph).values_of(&nodes, arguments).into_iter();
        let mut next = |count: usize| values.by_ref().take(count).collect::<Vec<_>>();
        let results = next(self.outputs.len());
        let stages = self.stages.as_ref().map(|own| {
            let numbers = own.numbers.each_ref().map(|list| next(list.len()));
            Stages { numbers, forces: next(own.forces.len()) }
        });
        (results, stages)
    }

    /// What it computes of which arguments: the same for equal recordings in every process.
    pub fn digest(&self) -> Digest {
        self.digest
    }

    /// What its arguments are.
    pub fn arguments(&self) -> &Arguments {
        &self.arguments
    }

    /// Looks at the recording.
    pub fn inspect<T>(&self, look: impl FnOnce(&mut Graph, &[Node]) -> T) -> T {
        look(&mut lock(&self.graph), &self.outputs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_that_no_model_uses_are_forgotten() {
        let record = |k: usize| Formula::record(1, |x| vec![x[0] * (k as f64 + 0.5)]).expect("does not branch");
        let used = record(0);
        (1..5 * KEPT).for_each(|k| drop(record(k)));
        let count = lock(&FORMULAS).known.len();
        assert!(count < 3 * KEPT, "{count} formulas are kept");
        assert!(Arc::ptr_eq(&used, &record(0)), "one that is used was forgotten");
    }

    #[test]
    fn programs_are_made_once_and_found_again() {
        let cache = ProgramCache::default();
        let record = |k: u32| Formula::record(1, |x| vec![x[0] * (f64::from(k) + 0.25)]).expect("does not branch");
        let codes = 0..30;
        let all: Vec<_> = codes.clone().map(|code| record(code).values().clone()).collect();
        for (code, program) in codes.clone().zip(&all) {
            assert!(Arc::ptr_eq(cache.get(code, || program.clone()), program));
        }
        for (code, program) in codes.zip(&all) {
            assert!(Arc::ptr_eq(cache.get(code, || panic!("program {code} was forgotten")), program));
            // what another thread made meanwhile stays
            assert!(Arc::ptr_eq(cache.keep(code, all[0].clone()), program));
        }
    }
}
