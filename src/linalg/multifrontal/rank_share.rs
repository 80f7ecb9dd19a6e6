//! What one rank does of a factorization and of solutions: its stretch of the sequence of fronts.
//!
//! Of a factorization these are subtrees of its own, and fronts above with the contributions of other ranks, in the order of children, of which those
//! that take long are shared.
//! Every number is the sum of the same terms in the same order as in one process, and has the same bits.

use super::factors::{Factors, Part};
use super::front::Contribution;
#[cfg(test)]
use super::pivots::PANEL;
use super::shared_front::{ColumnDistribution, Columns, Inbox, RankGroup, SharedFront};
use super::stretch_solution::{Delayed, StretchSolution, delayed, end_out_of_step};
use super::stretches::Stretches;
use super::substitution::{Side, Substitution};
use super::symbolic::Symbolic;
use super::traversal::Traversal;
use crate::exchange::{Exchange, digest};
use crate::linalg::{OwnUnknowns, Singular};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// The stretch of one rank.
pub struct RankShare {
    mail: Mail,
    /// Subtrees of its own, and then fronts with some of other ranks below them that it factors, or helps to.
    tasks: Vec<Task>,
    shared: SharedFront,
    /// How fronts with some of several ranks below them are dealt, by their numbers.
    distributions: BTreeMap<usize, ColumnDistribution>,
    solution: StretchSolution,
    threads: usize,
}

/// What a rank does, one after the other.
enum Task {
    /// All alone, for children of its own or of others.
    Own(Traversal),
    /// A front with others.
    Shared(usize),
}

/// Messages of other ranks.
struct Mail {
    exchange: &'static dyn Exchange,
    /// Contributions that came before they were needed, and own ones, with their senders.
    early: Vec<(usize, Columns)>,
}

/// First number of its message.
const CONTRIBUTION: f64 = 1.0;
/// In the place of an unknown that has no pivot, where all have one.
const REGULAR: f64 = -1.0;

impl RankShare {
    /// The stretch of this rank, for so many threads.
    pub fn new(symbolic: &Symbolic, stretches: Stretches, threads: usize, exchange: &'static dyn Exchange) -> Self {
        let solution = StretchSolution::new(symbolic, Arc::new(stretches), exchange.rank());
        let stretches = &solution.stretches;
        let parted = (0..symbolic.fronts.len()).filter(|&front| stretches.is_parted(symbolic, front));
        let distributions: BTreeMap<usize, ColumnDistribution> =
            parted.map(|front| (front, ColumnDistribution::new(symbolic, stretches, front))).collect();
        let flops = symbolic.subtree_flops();
        let subtrees = solution.subtrees.iter().filter(|(_, is_parted)| !is_parted);
        let of_subtree = |root: usize| Traversal::of_subtrees(symbolic, &[root], &flops, threads);
        let subtrees = subtrees.map(|(fronts, _)| Task::Own(of_subtree(fronts.end - 1)));
        // what waits for nobody comes first
        let with_others = distributions.values().filter(|distribution| distribution.member(exchange.rank()).is_some());
        let with_others = with_others.map(|distribution| match distribution.is_shared() {
            true => Task::Shared(distribution.front),
            false => Task::Own(Traversal::of_front(symbolic, distribution.front, threads)),
        });
        let tasks = subtrees.chain(with_others).collect();
        let mail = Mail { exchange, early: Vec::new() };
        RankShare { mail, tasks, shared: SharedFront::default(), distributions, solution, threads }
    }

    /// Number of all ranks.
    pub fn ranks(&self) -> usize {
        self.mail.exchange.ranks()
    }

    /// Unknowns whose pivots each rank looks for, but for those that wait for another one.
    pub fn own_unknowns(&self, symbolic: &Symbolic) -> OwnUnknowns {
        let of_rank = |rank| symbolic.order[self.solution.stretches.places(symbolic, rank)].to_vec();
        OwnUnknowns::new(self.mail.exchange, (0..self.ranks()).map(of_rank).collect())
    }

    /// Pivots of the last factorization that wait for a front of another rank.
    #[cfg(test)]
    pub fn delayed_across_ranks(&self) -> usize {
        let owner = |front| self.solution.stretches.owner(front);
        let across = self.solution.delayed.iter().filter(|delayed| owner(delayed.front) != owner(delayed.parent));
        across.map(|delayed| delayed.places[0].len()).sum()
    }

    /// Fronts of several panels that ranks share, and pivots of the last factorization that wait for a front above one that is shared.
    #[cfg(test)]
    pub fn shared_fronts(&self, symbolic: &Symbolic) -> [usize; 2] {
        let is_shared = |front: &usize| self.distributions.get(front).is_some_and(ColumnDistribution::is_shared);
        let has_panels = |front: &usize| is_shared(front) && symbolic.fronts[*front].pivots > 3 * PANEL;
        let waiting = self.solution.delayed.iter().filter(|delayed| is_shared(&delayed.front));
        let waiting = waiting.map(|delayed| delayed.places[0].len()).sum();
        [(0..symbolic.fronts.len()).filter(has_panels).count(), waiting]
    }

    /// Bytes of waiting contributions at their peak.
    pub fn bytes(&self) -> usize {
        let of_task = |task: &Task| match task {
            Task::Own(piece) => piece.bytes(),
            Task::Shared(front) => self.distributions[front].bytes(),
        };
        // those of shared fronts have one room
        let (alone, shared): (Vec<&Task>, Vec<&Task>) = self.tasks.iter().partition(|task| matches!(task, Task::Own(_)));
        alone.into_iter().map(of_task).sum::<usize>() + shared.into_iter().map(of_task).max().unwrap_or(0)
    }

    /// Factors values given in the order of the pattern.
    ///
    /// Only a last front finds that there is no pivot: all others leave it to the one above. So whoever waits for a contribution gets it, and
    /// every last front is looked at, of which the first in the order of elimination tells, as in one process.
    ///
    /// # Errors
    /// [`Singular`] with the column that has no pivot, on all ranks.
    pub fn factor(&mut self, symbolic: &Symbolic, values: &[f64], factors: &mut Factors) -> Result<(), Singular> {
        let RankShare { mail, tasks, shared, distributions, solution, threads } = self;
        let own = solution.stretches.fronts(mail.exchange.rank());
        let (_, rest) = factors.part(symbolic).split_at(symbolic, own.start);
        let (mut part, _) = rest.split_at(symbolic, own.end);
        let mut failure: Option<(usize, Singular)> = None;
        for task in tasks {
            let number = match task {
                Task::Own(piece) => piece.root(),
                Task::Shared(number) => *number,
            };
            let children = match distributions.contains_key(&number) {
                true => mail.take_children(symbolic, distributions, &solution.stretches, number),
                false => Vec::new(),
            };
            let handing = Handing { symbolic, distributions, mail };
            let result = match task {
                Task::Own(piece) => handing.factor_own(piece, values, &mut part, children),
                Task::Shared(_) => handing.factor_shared(shared, (number, *threads), values, &mut part, &children),
            };
            if let Err(singular) = result {
                failure = failure.filter(|&(earlier, _)| earlier < number).or(Some((number, singular)));
            }
            mail.exchange.hurry();
        }
        let delayed = if failure.is_some() { Vec::new() } else { delayed(symbolic, &part, &solution.pieces) };
        self.agree(symbolic, failure.map(|(_, singular)| singular), delayed)
    }

    /// All ranks know of the first failure, and of pivots that were delayed.
    fn agree(&mut self, symbolic: &Symbolic, failure: Option<Singular>, delayed: Vec<Delayed>) -> Result<(), Singular> {
        let failed = failure.map_or(REGULAR, |singular| singular.unknown as f64);
        let mut own = vec![failed];
        for Delayed { front, places: [rows, columns], .. } in delayed {
            own.extend([front as f64, rows.len() as f64]);
            own.extend(rows.iter().chain(&columns).map(|&place| f64::from(place)));
        }
        let all = self.mail.exchange.gather_lists(&own);
        // stretches follow each other as the fronts do
        if let Some(failed) = all.iter().find(|other| other[0] != REGULAR) {
            return Err(Singular { unknown: failed[0] as usize });
        }
        self.solution.delayed.clear();
        for mut rest in all.iter().map(|other| &other[1..]) {
            while let [front, count, after @ ..] = rest {
                let (places, after) = after.split_at(2 * *count as usize);
                let (rows, columns) = places.split_at(*count as usize);
                let places = [rows, columns].map(|list| list.iter().map(|&place| place as u32).collect());
                let (front, parent) = (*front as usize, symbolic.fronts[*front as usize].parent);
                let parent = parent.expect("what is delayed has a front above");
                self.solution.delayed.push(Delayed { front, parent, places });
                rest = after;
            }
        }
        Ok(())
    }

    /// Replaces a block of right-hand sides, column by column, by solutions.
    pub fn solve(
        &mut self,
        symbolic: &Symbolic,
        factors: &Factors,
        substitution: &mut Substitution,
        side: Side,
        rhs: &mut [f64],
    ) {
        self.solution.forward(self.mail.exchange, (symbolic, factors), substitution, side, rhs);
        self.solution.backward(self.mail.exchange, (symbolic, factors), substitution, side);
        self.gather(symbolic, substitution, rhs);
        substitution.store(symbolic, rhs, 0..symbolic.size);
    }

    /// Brings the unknowns of all ranks together, and compares what they were asked for.
    fn gather(&self, symbolic: &Symbolic, substitution: &mut Substitution, rhs: &[f64]) {
        let ranks = self.mail.exchange.ranks();
        let places = |rank: usize| self.solution.stretches.places(symbolic, rank);
        let columns = rhs.len() / symbolic.size;
        let mut own = vec![digest(rhs)];
        for solution in substitution.solutions(symbolic) {
            own.extend_from_slice(&solution[places(self.mail.exchange.rank())]);
        }
        let counts: Vec<usize> = (0..ranks).map(|rank| 1 + columns * places(rank).len()).collect();
        let all = self.mail.exchange.gather(&own, &counts);
        let mut rest = &all[..];
        for (rank, count) in counts.into_iter().enumerate() {
            let (others, after) = rest.split_at(count);
            rest = after;
            if others[0] != all[0] {
                self.mail.exchange.end(&format!("rank {rank} has other numbers than rank 0: are all processors the same?"));
            }
            let lists = others[1..].chunks_exact(places(rank).len().max(1));
            for (solution, list) in substitution.solutions(symbolic).zip(lists) {
                solution[places(rank)].copy_from_slice(list);
            }
        }
    }
}

/// Fronts whose contributions go to those above.
struct Handing<'h> {
    symbolic: &'h Symbolic,
    distributions: &'h BTreeMap<usize, ColumnDistribution>,
    mail: &'h mut Mail,
}

impl Handing<'_> {
    /// Factors a subtree, or a front alone with the contributions of its children, and hands on what it contributes.
    fn factor_own(
        self,
        piece: &mut Traversal,
        values: &[f64],
        part: &mut Part<'_>,
        mut children: Vec<Vec<Columns>>,
    ) -> Result<(), Singular> {
        let Handing { symbolic, distributions, mail } = self;
        let root = piece.root();
        let (_, mut fronts) = part.reborrow().split_at(symbolic, piece.fronts().start);
        if distributions.contains_key(&root) {
            children.iter_mut().for_each(join);
            let children: Vec<_> = children.iter().map(|child| child[0].whole()).collect();
            piece.factor_front(symbolic, values, &mut fronts, &children)?;
        } else {
            piece.factor(symbolic, values, fronts)?;
        }
        let contribution = piece.contribution(symbolic, part);
        let there = 0..contribution.delayed_rows.len() + symbolic.fronts[root].others();
        mail.hand_on(symbolic, distributions, contribution, there);
        Ok(())
    }

    /// Factors a front with others, and hands on what own columns of it contribute.
    fn factor_shared(
        self,
        shared: &mut SharedFront,
        (number, threads): (usize, usize),
        values: &[f64],
        part: &mut Part<'_>,
        children: &[Vec<Columns>],
    ) -> Result<(), Singular> {
        let Handing { symbolic, distributions, mail } = self;
        let (exchange, distribution) = (mail.exchange, &distributions[&number]);
        let member = distribution.member(exchange.rank()).expect("a task of the group");
        let group = RankGroup { exchange, distribution, member, threads };
        if member == 0 {
            let delayed = children.iter().map(|pieces| pieces[0].waiting[0].len()).sum();
            let storage = part.prepare(symbolic, number, delayed);
            let found = shared.factor(symbolic, group, mail, children, Some((storage, values)));
            part.set_eliminated(number, found);
        } else {
            shared.factor(symbolic, group, mail, children, None);
        }
        let [delayed_rows, delayed_columns] = &shared.waiting;
        if let (0, true, Some(&place)) = (member, symbolic.fronts[number].is_last(), delayed_columns.first()) {
            return Err(Singular { unknown: symbolic.order[place as usize] as usize });
        }
        let contribution = Contribution { front: number, delayed_rows, delayed_columns, values: &shared.contribution };
        mail.hand_on(symbolic, distributions, contribution, distribution.contributed(member, delayed_rows.len()));
        Ok(())
    }
}

/// The columns of a child's contribution that several ranks have, in one list.
fn join(pieces: &mut Vec<Columns>) {
    let mut others = pieces.split_off(1);
    let first = &mut pieces[0];
    for other in &mut others {
        first.message.extend_from_slice(other.values());
        first.there.end = other.there.end;
    }
}

impl Columns {
    /// What a message says; nothing if it is no contribution.
    fn of(message: Vec<f64>) -> Option<Self> {
        let &[CONTRIBUTION, child, start, end, waiting, ..] = &message[..] else { return None };
        let count = waiting as usize;
        let waiting = [0, 1].map(|list| message[5 + list * count..][..count].iter().map(|&place| place as u32).collect());
        Some(Columns { child: child as usize, waiting, there: start as usize..end as usize, message, first: 5 + 2 * count })
    }

    /// The whole contribution, where all columns are there.
    fn whole(&self) -> Contribution<'_> {
        let [delayed_rows, delayed_columns] = &self.waiting;
        Contribution { front: self.child, delayed_rows, delayed_columns, values: self.values() }
    }
}

impl Mail {
    /// Contributions of all children to a front, whenever they come, each in the order of those who have its columns.
    fn take_children(
        &mut self,
        symbolic: &Symbolic,
        distributions: &BTreeMap<usize, ColumnDistribution>,
        stretches: &Stretches,
        parent: usize,
    ) -> Vec<Vec<Columns>> {
        let children = &symbolic.children[symbolic.fronts[parent].children.clone()];
        let of_child = |&child: &u32| {
            let (child, alone) = (child as usize, [stretches.owner(child as usize)]);
            let senders = distributions.get(&child).map_or(&alone[..], |distribution| &distribution.ranks);
            senders.iter().map(|&sender| self.take(sender, child)).collect()
        };
        children.iter().map(of_child).collect()
    }

    /// Columns of a front's contribution that a rank has.
    fn take(&mut self, sender: usize, child: usize) -> Columns {
        loop {
            if let Some(place) = self.early.iter().position(|(from, early)| (*from, early.child) == (sender, child)) {
                return self.early.swap_remove(place).1;
            }
            match Columns::of(self.exchange.receive(sender)) {
                Some(columns) => self.early.push((sender, columns)),
                None => end_out_of_step(self.exchange, sender),
            }
        }
    }

    /// Sends each rank that works on the front above the columns that it has there, of those that are there.
    fn hand_on(
        &mut self,
        symbolic: &Symbolic,
        distributions: &BTreeMap<usize, ColumnDistribution>,
        contribution: Contribution<'_>,
        there: Range<usize>,
    ) {
        let Contribution { front, delayed_rows, delayed_columns, values } = contribution;
        let Some(distribution) = symbolic.fronts[front].parent.and_then(|parent| distributions.get(&parent)) else { return };
        let waiting = delayed_rows.len();
        let order = waiting + symbolic.fronts[front].others();
        for (member, &rank) in distribution.ranks.iter().enumerate() {
            let mut message = vec![CONTRIBUTION, front as f64, there.start as f64, there.end as f64, waiting as f64];
            message.extend([delayed_rows, delayed_columns].into_iter().flatten().map(|&place| f64::from(place)));
            if distribution.is_shared() {
                for (column, _) in distribution.wanted(symbolic, (front, waiting), &there, member) {
                    message.extend_from_slice(&values[(column - there.start) * order..][..order]);
                }
            } else {
                message.extend_from_slice(values);
            }
            match rank == self.exchange.rank() {
                true => self.early.extend(Columns::of(message).map(|columns| (rank, columns))),
                false => self.exchange.send(rank, message),
            }
        }
    }
}

impl Inbox for Mail {
    fn expect(&mut self, from: usize, head: [f64; 2]) -> Vec<f64> {
        loop {
            let mut message = self.exchange.receive(from);
            if message.starts_with(&head) {
                message.drain(..head.len());
                return message;
            }
            match Columns::of(message) {
                Some(columns) => self.early.push((from, columns)),
                None => end_out_of_step(self.exchange, from),
            }
        }
    }
}
