//! A front that several ranks factor together, each some of its columns.
//!
//! ```text
//! assembly      entries of the matrix come from the master of the front, contributions from those who have their columns
//! pivots        panels of columns in turn: who has one eliminates it, and sends it to all, who subtract it from their later columns
//! other columns each rank solves and reduces its own with all pivots, and keeps what they contribute; U goes to the master
//! ```
//!
//! The master has the factors in the end. Every number is the sum of the same terms in the same order as in one process. A panel with a column
//! that finds no pivot is rare: the master goes on with all columns from there, and sends the others what it found.

use super::entries::EntryBlock;
use super::factors::FrontStorage;
use super::front::{Contribution, Workspace, add, add_rows, reduce_others};
use super::kernels::ColumnThreads;
use super::pivots::{PANEL, PivotBlock};
use super::stretches::Stretches;
use super::symbolic::{Front, Run, Symbolic};
use crate::exchange::Exchange;
use std::ops::Range;

/// Which ranks have which columns of a front that has fronts of several ranks below it.
pub struct ColumnDistribution {
    /// Number of the front.
    pub front: usize,
    /// Ranks, the master first.
    pub ranks: Vec<usize>,
    pivots: usize,
    others: usize,
}

impl ColumnDistribution {
    /// Of a front: among all ranks with fronts below it, where it is worth the messages.
    pub fn new(symbolic: &Symbolic, stretches: &Stretches, front: usize) -> Self {
        let planned = &symbolic.fronts[front];
        let ranks = stretches.ranks_of(symbolic, front);
        ColumnDistribution { front, ranks, pivots: planned.pivots, others: planned.others() }
    }

    /// Whether several ranks factor it.
    pub fn is_shared(&self) -> bool {
        self.ranks.len() > 1
    }

    /// Memory of a rank for the front, at most \[bytes\].
    pub fn bytes(&self) -> usize {
        size_of::<f64>() * (self.pivots + self.others).pow(2)
    }

    /// The place of a rank in the ranks.
    pub fn member(&self, rank: usize) -> Option<usize> {
        self.ranks.iter().position(|&own| own == rank)
    }

    /// Who has a column in which pivots are looked for: panels go round, but for those with pivots that waited, which the master has.
    fn of_pivot(&self, column: usize) -> usize {
        let panel = column / PANEL;
        if (panel + 1) * PANEL > self.pivots { 0 } else { panel % self.ranks.len() }
    }

    /// Which of the other columns a member has.
    fn others(&self, member: usize) -> Range<usize> {
        let first = |member: usize| self.others * member / self.ranks.len();
        first(member)..first(member + 1)
    }

    /// Whether a member has a column, numbered as planned.
    fn has(&self, member: usize, column: usize) -> bool {
        match column.checked_sub(self.pivots) {
            None => self.of_pivot(column) == member,
            Some(other) => self.others(member).contains(&other),
        }
    }

    /// Columns of what the front contributes that a member has, if so many pivots wait; these come first.
    pub fn contributed(&self, member: usize, waiting: usize) -> Range<usize> {
        let own = self.others(member);
        if member == 0 { 0..waiting + own.end } else { waiting + own.start..waiting + own.end }
    }

    /// The columns of a child's contribution that a member needs of some that are there, each with its place in the front as planned, or none where
    /// its pivot waits.
    pub fn wanted(
        &self,
        symbolic: &Symbolic,
        (child, waiting): (usize, usize),
        there: &Range<usize>,
        member: usize,
    ) -> impl Iterator<Item = (usize, Option<usize>)> {
        let late = (0..waiting).filter(move |_| member == 0).map(|column| (column, None));
        let of_run = move |run: &Run| {
            let (from, to) = (waiting + run.from as usize, run.to as usize);
            (0..run.length as usize).map(move |k| (from + k, to + k))
        };
        let runs = &symbolic.extensions[symbolic.fronts[child].extensions.clone()];
        let others = runs.iter().flat_map(of_run).filter(move |own| self.has(member, own.1));
        late.chain(others.map(|(column, place)| (column, Some(place)))).filter(|own| there.contains(&own.0))
    }

    /// Blocks of the matrix in the columns of a member: which, and which of their columns, numbered as planned.
    fn entries(&self, symbolic: &Symbolic, member: usize) -> impl Iterator<Item = (EntryBlock, usize)> {
        let pivots = self.pivots;
        let blocks = symbolic.entries[symbolic.fronts[self.front].entries.clone()].iter();
        let blocks = blocks.filter(move |block| (block.row as usize) < pivots || (block.column as usize) < pivots);
        let columns = blocks.flat_map(|block| (0..block.width as usize).map(move |column| (*block, column)));
        columns.filter(move |(block, column)| self.has(member, block.column as usize + column))
    }
}

/// Some columns of what a front below contributes.
pub struct Columns {
    pub child: usize,
    /// Places of rows and of columns whose pivots wait.
    pub waiting: [Vec<u32>; 2],
    /// Which columns the sender has; those that are wanted of them follow each other in the message.
    pub there: Range<usize>,
    pub message: Vec<f64>,
    /// Where they begin there.
    pub first: usize,
}

impl Columns {
    /// The numbers.
    pub fn values(&self) -> &[f64] {
        &self.message[self.first..]
    }
}

/// First numbers of messages: what they are.
const ENTRIES: f64 = 4.0;
const PANEL_DONE: f64 = 5.0;
const REMAINING: f64 = 6.0;
const ELIMINATED: f64 = 7.0;
const UPPER: f64 = 8.0;

/// Ranks that work on a front.
#[derive(Clone, Copy)]
pub struct RankGroup<'t> {
    pub exchange: &'static dyn Exchange,
    pub distribution: &'t ColumnDistribution,
    /// The place of this one.
    pub member: usize,
    pub threads: usize,
}

impl RankGroup<'_> {
    /// All others, one of them first.
    fn others_from(&self, first: usize) -> impl Iterator<Item = usize> + use<'_> {
        let (count, own) = (self.distribution.ranks.len(), self.member);
        (0..count).map(move |k| (first + k) % count).filter(move |&member| member != own)
    }

    fn send(&self, member: usize, message: Vec<f64>) {
        self.exchange.send(self.distribution.ranks[member], message);
    }

    fn head(&self, what: f64) -> Vec<f64> {
        vec![what, self.distribution.front as f64]
    }
}

/// Takes the next message of a rank that is no contribution.
pub trait Inbox {
    /// Behind its head, which has to be this one.
    fn expect(&mut self, from: usize, head: [f64; 2]) -> Vec<f64>;
}

/// Room of a rank for the fronts that it shares.
#[derive(Default)]
pub struct SharedFront {
    room: Room,
    exchanges: Vec<(u32, u32)>,
    workspace: Workspace,
    /// What its columns contribute.
    pub contribution: Vec<f64>,
    /// Places of rows and columns whose pivots wait.
    pub waiting: [Vec<u32>; 2],
}

/// Columns of a front that another rank is the master of.
#[derive(Default)]
struct Room {
    lower: Vec<f64>,
    upper: Vec<f64>,
    rows: Vec<u32>,
    columns: Vec<u32>,
}

impl Room {
    /// Own columns all zero, places those of the front's own pivots.
    fn prepare(&mut self, front: &Front, group: RankGroup<'_>, summed: usize) -> FrontStorage<'_> {
        let Room { lower, upper, rows, columns } = self;
        let size = summed + front.others();
        lower.resize(size * summed, 0.0);
        let own = (0..summed).filter(|&column| group.distribution.of_pivot(column) == group.member);
        own.for_each(|column| lower[column * size..][..size].fill(0.0));
        upper.clear();
        upper.resize(summed * group.distribution.others(group.member).len(), 0.0);
        for list in [&mut *rows, &mut *columns] {
            list.resize(summed, 0);
            list.iter_mut().zip(front.first as u32..).take(front.pivots).for_each(|(own, place)| *own = place);
        }
        FrontStorage { lower, upper, rows, columns }
    }
}

impl SharedFront {
    /// Factors own columns of a front, all of whose children's columns are there; the master has room for the factors, and the matrix.
    /// Returns the number of pivots.
    pub fn factor(
        &mut self,
        symbolic: &Symbolic,
        group: RankGroup<'_>,
        inbox: &mut impl Inbox,
        children: &[Vec<Columns>],
        of_master: Option<(FrontStorage<'_>, &[f64])>,
    ) -> usize {
        let SharedFront { room, exchanges, workspace, contribution, waiting } = self;
        let front = &symbolic.fronts[group.distribution.front];
        let late: Vec<usize> = children.iter().map(|pieces| pieces[0].waiting[0].len()).collect();
        let summed = front.pivots + late.iter().sum::<usize>();
        let entries = exchange_entries(symbolic, group, inbox, of_master.as_ref().map(|of_master| of_master.1));
        let storage = of_master.map_or_else(|| room.prepare(front, group, summed), |of_master| of_master.0);
        let FrontStorage { lower, upper, rows, columns } = storage;

        let bare: Vec<Contribution<'_>> = children.iter().map(|pieces| bare(&pieces[0])).collect();
        workspace.place(symbolic, front, &bare, rows, columns);
        let mut own = Own { symbolic, front, group, lower, upper, summed, others: group.distribution.others(group.member) };
        own.add_entries(&entries);
        own.add_children(children, &late, workspace);

        exchanges.clear();
        let mut block = PivotBlock {
            values: own.lower,
            size: summed + front.others(),
            rows: &mut *rows,
            columns: &mut *columns,
            exchanges,
            is_last: front.is_last(),
            threads: group.threads,
        };
        let found = eliminate(&mut block, group, inbox);
        *waiting = [&*rows, &*columns].map(|list| list[found..].to_vec());
        let (size, count) = (own.size(), own.others.len());
        let width = group.distribution.contributed(group.member, summed - found).len();
        contribution.resize((size - found) * width, 0.0);
        let workers = ColumnThreads { threads: group.threads, elsewhere: front.others() - count };
        reduce_others(own.lower, &mut own.upper[..summed * count], [size, summed, found], exchanges, contribution, workers);
        own.add_others(children, workspace, found, contribution);
        own.gather_upper(inbox);
        found
    }
}

/// Entries of the matrix in own columns, which the master has and sends.
fn exchange_entries(symbolic: &Symbolic, group: RankGroup<'_>, inbox: &mut impl Inbox, values: Option<&[f64]>) -> Vec<f64> {
    let Some(values) = values else {
        return inbox.expect(group.distribution.ranks[0], [ENTRIES, group.distribution.front as f64]);
    };
    group.others_from(1).for_each(|member| group.send(member, entries_for(symbolic, group, member, values)));
    entries_for(symbolic, group, 0, values)
}

/// A contribution without its numbers.
fn bare(columns: &Columns) -> Contribution<'_> {
    let [delayed_rows, delayed_columns] = &columns.waiting;
    Contribution { front: columns.child, delayed_rows, delayed_columns, values: &[] }
}

/// The entries of the matrix in the columns of a member; a message for another one.
fn entries_for(symbolic: &Symbolic, group: RankGroup<'_>, member: usize, values: &[f64]) -> Vec<f64> {
    let mut message = if member == group.member { Vec::new() } else { group.head(ENTRIES) };
    for (block, column) in group.distribution.entries(symbolic, member) {
        let first = block.source as usize + column * block.stride as usize;
        message.extend_from_slice(&values[first..][..block.height as usize]);
    }
    message
}

/// Calls a function for each column of children that is there: the child's number, the place in the front, and the column.
fn for_each_column(
    symbolic: &Symbolic,
    group: RankGroup<'_>,
    children: &[Vec<Columns>],
    mut call: impl FnMut(usize, Option<usize>, &[f64]),
) {
    for (number, pieces) in children.iter().enumerate() {
        for piece in pieces {
            let waiting = piece.waiting[0].len();
            let order = waiting + symbolic.fronts[piece.child].others();
            let wanted = group.distribution.wanted(symbolic, (piece.child, waiting), &piece.there, group.member);
            wanted.zip(piece.values().chunks_exact(order)).for_each(|((_, place), column)| call(number, place, column));
        }
    }
}

/// Own columns of a front.
struct Own<'o> {
    symbolic: &'o Symbolic,
    front: &'o Front,
    group: RankGroup<'o>,
    /// All columns in which pivots are looked for, of which others fill their own.
    lower: &'o mut [f64],
    /// Rows in which they are, of the other columns: first the own ones, and of the master those of all.
    upper: &'o mut [f64],
    /// Columns in which pivots are looked for.
    summed: usize,
    /// The own ones of the other columns.
    others: Range<usize>,
}

impl Own<'_> {
    fn size(&self) -> usize {
        self.summed + self.front.others()
    }

    /// Adds entries of the matrix, in their order.
    fn add_entries(&mut self, mut values: &[f64]) {
        let (pivots, summed, size) = (self.front.pivots, self.summed, self.size());
        for (block, column) in self.group.distribution.entries(self.symbolic, self.group.member) {
            let (own, rest) = values.split_at(block.height as usize);
            values = rest;
            let (row, column) = (block.row as usize, block.column as usize + column);
            let target = match column.checked_sub(pivots) {
                None => &mut self.lower[column * size + if row < pivots { row } else { row + summed - pivots }..],
                Some(other) => &mut self.upper[(other - self.others.start) * summed + row..],
            };
            add(&mut target[..own.len()], own);
        }
    }

    /// Adds what children contribute to own columns, but to rows and columns of which both have no pivot here.
    fn add_children(&mut self, children: &[Vec<Columns>], late: &[usize], Workspace { runs, bounds, .. }: &Workspace) {
        let (pivots, summed, size) = (self.front.pivots, self.summed, self.size());
        // those of pivots that wait stand behind the front's own, child by child
        let mut next: Vec<usize> = late.iter().scan(pivots, |end, late| Some(std::mem::replace(end, *end + late))).collect();
        for_each_column(self.symbolic, self.group, children, |number, place, source| {
            let [start, middle, end] = bounds[number];
            let other = place.and_then(|place| place.checked_sub(pivots));
            let (target, end) = match other {
                Some(other) => (&mut self.upper[(other - self.others.start) * summed..][..summed], middle),
                None => {
                    let column = place.unwrap_or(next[number]);
                    next[number] += usize::from(place.is_none());
                    (&mut self.lower[column * size..][..size], end)
                }
            };
            add_rows(&runs[start..end], source, target, 0);
        });
    }

    /// Adds what children contribute to rows and columns without a pivot here.
    fn add_others(&self, children: &[Vec<Columns>], workspace: &Workspace, found: usize, contribution: &mut [f64]) {
        let left = self.summed - found;
        let (order, first) =
            (left + self.front.others(), self.group.distribution.contributed(self.group.member, left).start);
        for_each_column(self.symbolic, self.group, children, |number, place, source| {
            let Some(other) = place.and_then(|place| place.checked_sub(self.front.pivots)) else { return };
            let target = &mut contribution[(left + other - first) * order..][..order];
            let [_, middle, end] = workspace.bounds[number];
            add_rows(&workspace.runs[middle..end], source, target, found);
        });
    }

    /// The master gets U of all.
    fn gather_upper(&mut self, inbox: &mut impl Inbox) {
        let (group, summed) = (self.group, self.summed);
        if self.front.others() == 0 {
            return;
        }
        if group.member > 0 {
            let own = &self.upper[..summed * self.others.len()];
            return group.send(0, [&group.head(UPPER)[..], own].concat());
        }
        for member in group.others_from(1) {
            let of_member = inbox.expect(group.distribution.ranks[member], [UPPER, group.distribution.front as f64]);
            let places = group.distribution.others(member);
            self.upper[places.start * summed..places.end * summed].copy_from_slice(&of_member);
        }
    }
}

/// Eliminates the pivots of a front, panels in turn; returns their number.
fn eliminate(block: &mut PivotBlock<'_>, group: RankGroup<'_>, inbox: &mut impl Inbox) -> usize {
    let (count, distribution) = (block.columns.len(), group.distribution);
    let panel_at = |first: usize| first..(first + PANEL).min(count);
    let (mut done, mut ahead) = (0, None);
    while done < count {
        let (panel, next) = (panel_at(done), panel_at((done + PANEL).min(count)));
        let owner = distribution.of_pivot(done);
        let found = if owner == group.member {
            ahead.take().unwrap_or_else(|| eliminate_and_send(block, group, panel.clone()))
        } else {
            let message = inbox.expect(distribution.ranks[owner], [PANEL_DONE, distribution.front as f64]);
            take_panel(block, panel.clone(), &message)
        };
        let mut rest = panel.end;
        if found == panel.end && !next.is_empty() && distribution.of_pivot(next.start) == group.member {
            // others wait for it
            block.subtract(panel.clone(), next.clone(), count - next.end);
            ahead = Some(eliminate_and_send(block, group, next.clone()));
            rest = next.end;
        }
        for first in (rest..count).step_by(PANEL).filter(|&first| distribution.of_pivot(first) == group.member) {
            let own = panel_at(first);
            block.subtract(done..found, own.clone(), count - panel.end - own.len());
        }
        if found < panel.end {
            return eliminate_rest(block, group, inbox, panel, found);
        }
        done = found;
    }
    done
}

/// Eliminates a panel and sends it to all; returns the end of the pivots.
fn eliminate_and_send(block: &mut PivotBlock<'_>, group: RankGroup<'_>, panel: Range<usize>) -> usize {
    let before = block.exchanges.len();
    let found = block.eliminate_panel(panel.clone());
    let exchanges = &block.exchanges[before..];
    let mut message = group.head(PANEL_DONE);
    message.extend([found as f64, exchanges.len() as f64]);
    message.extend(exchanges.iter().flat_map(|&(a, b)| [f64::from(a), f64::from(b)]));
    message.extend(block.columns[panel.clone()].iter().map(|&place| f64::from(place)));
    message.extend_from_slice(&block.values[panel.start * block.size..panel.end * block.size]);
    // who eliminates the next one is first
    group.others_from(group.member + 1).for_each(|member| group.send(member, message.clone()));
    found
}

/// Takes over what another rank made of a panel.
fn take_panel(block: &mut PivotBlock<'_>, panel: Range<usize>, message: &[f64]) -> usize {
    let ([found, exchanges], rest) = message.split_first_chunk().expect("a panel");
    let (exchanges, rest) = rest.split_at(2 * *exchanges as usize);
    let (columns, values) = rest.split_at(panel.len());
    for exchange in exchanges.chunks_exact(2) {
        block.exchange_rows(exchange[0] as usize, exchange[1] as usize);
    }
    block.columns[panel.clone()].iter_mut().zip(columns).for_each(|(own, &place)| *own = place as u32);
    block.values[panel.start * block.size..panel.end * block.size].copy_from_slice(values);
    *found as usize
}

/// The master goes on behind a panel with columns that found no pivot; all have the same in the end.
fn eliminate_rest(
    block: &mut PivotBlock<'_>,
    group: RankGroup<'_>,
    inbox: &mut impl Inbox,
    panel: Range<usize>,
    found: usize,
) -> usize {
    let (distribution, size, count) = (group.distribution, block.size, block.columns.len());
    let behind = |member: usize| (panel.end..count).filter(move |&column| distribution.of_pivot(column) == member);
    let number = distribution.front as f64;
    if group.member > 0 {
        let mut message = group.head(REMAINING);
        behind(group.member).for_each(|column| message.extend_from_slice(&block.values[column * size..][..size]));
        group.send(0, message);
        let all = inbox.expect(distribution.ranks[0], [ELIMINATED, number]);
        let ([found, exchanges], rest) = all.split_first_chunk().expect("what was eliminated");
        let (exchanges, rest) = rest.split_at(2 * *exchanges as usize);
        let (places, values) = rest.split_at(2 * count);
        block.exchanges.clear();
        block.exchanges.extend(exchanges.chunks_exact(2).map(|pair| (pair[0] as u32, pair[1] as u32)));
        let (rows, columns) = places.split_at(count);
        block.rows.iter_mut().zip(rows).for_each(|(own, &place)| *own = place as u32);
        block.columns.iter_mut().zip(columns).for_each(|(own, &place)| *own = place as u32);
        block.values.copy_from_slice(values);
        return *found as usize;
    }
    for member in group.others_from(1) {
        let message = inbox.expect(distribution.ranks[member], [REMAINING, number]);
        for (column, values) in behind(member).zip(message.chunks_exact(size)) {
            block.values[column * size..][..size].copy_from_slice(values);
        }
    }
    let found = block.eliminate_behind_first_failure(panel, found);
    let mut message = group.head(ELIMINATED);
    message.extend([found as f64, block.exchanges.len() as f64]);
    message.extend(block.exchanges.iter().flat_map(|&(a, b)| [f64::from(a), f64::from(b)]));
    message.extend(block.rows.iter().chain(&*block.columns).map(|&place| f64::from(place)));
    message.extend_from_slice(block.values);
    group.others_from(1).for_each(|member| group.send(member, message.clone()));
    found
}
