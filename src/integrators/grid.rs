use super::SideChange;
use crate::assembly::Clock;
use crate::design::shortest;
use crate::elements::RunScalar;
use crate::tolerances::{SAME_DERIVATIVE, SAME_TIME};
use std::collections::{BTreeMap, BTreeSet};

/// How time goes in each stretch between breakpoints, with the index of its first step; empty where these do not move.
pub type Clocks<S> = Vec<(usize, Clock<S>)>;

pub fn clock_at<S: RunScalar>(clocks: &Clocks<S>, step: usize) -> Option<Clock<S>> {
    let place = clocks.partition_point(|(first, _)| *first <= step);
    place.checked_sub(1).map(|place| clocks[place].1)
}

pub fn moved_apart(t: f64) -> String {
    format!(
        "at t = {} s breakpoints of several loads or drivers coincide which the design moves apart: to either side steps are laid in another way, \
         so that there is no derivative; take a design in which they are apart, or make them the same number",
        shortest(t)
    )
}

/// Most steps of a run: their ends are kept.
pub const MOST_STEPS: usize = 10_000_000;

/// The ends of all steps, and which of them are breakpoints of a load or driver.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeGrid {
    /// Start, ends of steps; increasing.
    pub times: Vec<f64>,
    /// Indices into `times` of breakpoints, each with the numbers of all that lie there, in the order in which they were given.
    pub breakpoints: BTreeMap<usize, Vec<usize>>,
    /// Indices into `times` of events within the run, with the sides that change there.
    pub events: BTreeMap<usize, Vec<SideChange>>,
    /// Indices of breakpoints at which a force jumps beyond its limit, and of what happens at once behind an event, with the sides that change there: their
    /// times are those of the breakpoints and events.
    pub jumps: BTreeMap<usize, Vec<SideChange>>,
    /// Steps that events cut to less than a millionth, which Euler's explicit method makes.
    pub(super) shortest: BTreeSet<usize>,
    /// How many equal steps were asked for; 0 where steps were chosen.
    pub(super) asked: usize,
    /// End for which they were, where an event ended the run before it.
    pub(super) laid_end: Option<f64>,
    /// Breakpoints behind that event, up to the first of which steps were laid.
    pub(super) unreached: Vec<(f64, Vec<usize>)>,
    /// Places of steps behind events that are half of what was left to the end of their stretch, once the run has ended.
    halves: Vec<usize>,
    /// Of steps that were chosen, to be made again: sizes of those behind each event in turn, with the shares of its motion that their ends have.
    pub(super) behind_events: Vec<Vec<(f64, f64)>>,
}

/// How an end of a step moves: its shares of the motion of the event before it, and of those of two breakpoints, each with its place among the ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct EndMoves {
    pub by_event: f64,
    pub by_breakpoints: [(usize, f64); 2],
}

impl EndMoves {
    pub fn is_zero(&self) -> bool {
        self.by_event == 0.0 && self.by_breakpoints.iter().all(|(_, share)| *share == 0.0)
    }
}

/// A stretch longer than a whole number of steps by less than this share of one has that number.
const WHOLE: f64 = 1e-6;

impl TimeGrid {
    /// Steps of equal size from 0 to `end`. Each stretch between breakpoints has steps of its own equal size, as many as it takes for none to be
    /// longer than without breakpoints: a breakpoint beside the end of a step makes no step that is much shorter than the others.
    ///
    /// # Errors
    /// An end or step number that is not positive, in words.
    pub fn uniform(end: f64, steps: usize, breakpoints: &[f64]) -> Result<Self, String> {
        if !(end > 0.0 && end.is_finite() && (1..=MOST_STEPS).contains(&steps)) {
            return Err(format!(
                "a simulation needs an end time above 0, at least 1 and at most {MOST_STEPS} steps, not {} s and {steps} steps",
                shortest(end)
            ));
        }
        let h = end / steps as f64;
        let mut grid = Self::begin(0.0, steps);
        for (time, numbers) in grouped(breakpoints, end, SAME_TIME * h) {
            grid.add_stretch(time, h);
            grid.breakpoints.insert(grid.steps(), numbers);
        }
        grid.add_stretch(end, h);
        Ok(grid)
    }

    /// Steps to be laid from a time on, for so many equal ones; 0 for steps to be chosen.
    pub(super) fn begin(t: f64, asked: usize) -> Self {
        TimeGrid {
            times: vec![t],
            breakpoints: BTreeMap::new(),
            events: BTreeMap::new(),
            jumps: BTreeMap::new(),
            shortest: BTreeSet::new(),
            asked,
            laid_end: None,
            unreached: Vec::new(),
            halves: Vec::new(),
            behind_events: Vec::new(),
        }
    }

    fn boundaries(&self) -> impl Iterator<Item = usize> {
        [0].into_iter().chain(self.breakpoints.keys().copied()).chain([self.steps()])
    }

    /// The same steps where breakpoints lie at other times: those of each stretch keep their relative places. Where breakpoints come in another
    /// order, or others lie within the run, steps are laid anew.
    pub(crate) fn moved_to(&self, breakpoints: &[f64]) -> Result<Self, String> {
        if self.has_events() {
            return self.without_events().moved_to(breakpoints);
        }
        let end = self.times[self.steps()];
        let groups = grouped(breakpoints, end, SAME_TIME * end / self.asked.max(1) as f64);
        if !groups.iter().map(|(_, numbers)| numbers).eq(self.breakpoints.values()) {
            return match self.asked {
                0 => {
                    Err("breakpoints come in another order, or others lie within the run, than where its steps were chosen"
                        .into())
                }
                asked => Self::uniform(end, asked, breakpoints),
            };
        }
        let ends: Vec<f64> = [self.times[0]].into_iter().chain(groups.iter().map(|(time, _)| *time)).chain([end]).collect();
        let mut moved = self.clone();
        let places: Vec<usize> = self.boundaries().collect();
        for (place, end) in places.windows(2).zip(ends.windows(2)) {
            let (first, last) = (self.times[place[0]], self.times[place[1]]);
            if [first, last] == *end {
                continue;
            }
            for index in place[0] + 1..place[1] {
                moved.times[index] = end[0] + (end[1] - end[0]) * ((self.times[index] - first) / (last - first));
            }
            (moved.times[place[0]], moved.times[place[1]]) = (end[0], end[1]);
        }
        Ok(moved)
    }

    /// Whether sides change in the run.
    pub(crate) fn has_events(&self) -> bool {
        !(self.events.is_empty() && self.jumps.is_empty())
    }

    /// The sides that change at an end of a step.
    pub(crate) fn changes_at(&self, place: usize) -> Option<&Vec<SideChange>> {
        self.events.get(&place).or_else(|| self.jumps.get(&place))
    }

    /// All sides that change, with the ends of steps at which they do, in their order.
    pub(crate) fn changes(&self) -> impl Iterator<Item = (usize, &[SideChange])> {
        (0..=self.steps()).filter_map(|place| Some((place, &self.changes_at(place)?[..])))
    }

    /// The end for which it was laid \[s\].
    pub(crate) fn end(&self) -> f64 {
        self.laid_end.unwrap_or(self.times[self.steps()])
    }

    /// The steps as they were laid before a run found events, which each run finds anew; of chosen ones those behind an event as their sizes.
    fn without_events(&self) -> Self {
        let mut grid = Self::begin(self.times[0], self.asked);
        let h = (self.end() - self.times[0]) / self.asked as f64;
        let places: Vec<usize> = self.boundaries().collect();
        for (first, last) in places.iter().copied().zip(places.iter().copied().skip(1)) {
            let end = self.laid_time(last);
            // where an event ended the run steps go on up to the end for which they were laid
            let is_ended = self.laid_end.is_some() && last == self.steps();
            let event = self.events.range(first + 1..last + usize::from(is_ended)).next().map(|(event, _)| *event);
            match event {
                Some(_) if self.asked > 0 => grid.add_stretch(end, h),
                Some(event) => {
                    grid.times.extend_from_slice(&self.times[first + 1..event]);
                    // the step that ends at the event may come to it later
                    let (t, size) = (self.times[event - 1], self.times[event] - self.times[event - 1]);
                    let beyond = t + 2.0 * size;
                    if beyond + size < end {
                        grid.times.push(beyond);
                        grid.add_stretch(end, size);
                    } else {
                        grid.times.push(end);
                    }
                }
                None => grid.times.extend_from_slice(&self.times[first + 1..=last]),
            }
            self.breakpoints.get(&last).map(|numbers| grid.breakpoints.insert(grid.steps(), numbers.clone()));
        }
        // the last stretch went up to the first of these
        let behind = self.unreached.iter().skip(1).map(|own| own.0).chain([self.end()]);
        for ((_, numbers), end) in self.unreached.iter().zip(behind) {
            grid.breakpoints.insert(grid.steps(), numbers.clone());
            let last = grid.times[grid.steps()] - grid.times[grid.steps() - 1];
            grid.add_stretch(end, if self.asked > 0 { h } else { last });
        }
        if self.asked == 0 {
            grid.behind_events = self.events.keys().map(|&event| self.sizes_behind(event)).collect();
        }
        grid
    }

    /// Sizes of the steps behind an event up to the next one or the end of the stretch, with the shares of its motion that their ends have.
    fn sizes_behind(&self, event: usize) -> Vec<(f64, f64)> {
        let is_last = |place: &usize| self.is_fixed(*place) || self.events.contains_key(place);
        let last = (event + 1..=self.steps()).find(is_last).unwrap_or(event);
        let of = |place: usize| {
            // what is found at once may be found later
            let size = match self.shortest.contains(&(place - 1)) && place < self.steps() {
                true => self.sizes_behind(place).first().map_or(self.times[event] - self.times[event - 1], |own| own.0),
                false => self.times[place] - self.times[place - 1],
            };
            // one that an event ends was longer before it was found
            if self.events.contains_key(&place) { (2.0 * size, 1.0) } else { (size, self.share_behind_event(place)) }
        };
        // steps that no event ends and that are so short are made where they are needed
        let is_laid = |place: &usize| !self.shortest.contains(&(place - 1)) || self.events.contains_key(place);
        if self.is_fixed(event) { Vec::new() } else { (event + 1..=last).filter(is_laid).map(of).collect() }
    }

    /// Steps behind an event keep their sizes, so that their ends move with it up to a breakpoint or the end of the run, before which the last step
    /// is as long as what is left, or those before it are halves of that: the share of the event's motion that an end of a step has, if it is no event.
    pub(crate) fn share_behind_event(&self, end: usize) -> f64 {
        if self.is_fixed(end) {
            return 0.0;
        }
        let from = self.stretch_of(end)[0];
        let Some((&event, _)) = self.events.range(from..end).next_back() else { return 0.0 };
        let until = |place: usize| self.halves.partition_point(|half| *half <= place);
        (until(event)..until(end)).fold(1.0, |share, _| 0.5 * share)
    }

    /// Ends a run: finds the halves behind its events.
    pub(super) fn finish(&mut self) {
        let behind = |place: &usize| self.is_behind_event(place - 1) && !self.is_fixed(*place);
        let is_half = |place: &usize| {
            let [_, to] = self.ends_of(self.stretch_of(*place));
            let (own, left) = (self.times[*place] - self.times[place - 1], to - self.times[place - 1]);
            let is_like = |size: f64| (own - size).abs() <= SAME_TIME * own;
            // steps that are all alike up to the end are no halves
            let laid = || match self.asked == 0 && !self.is_interrupted(place - 1) {
                true => self.times[place - 1] - self.times[place - 2],
                false => self.laid_size(*place),
            };
            is_like(0.5 * left) && !is_like(laid())
        };
        self.halves = (1..self.steps()).filter(behind).filter(is_half).collect();
    }

    /// How an end of a step moves: in a stretch between breakpoints with both of its ends; behind an event with that, by the sizes of the steps that
    /// were laid in the stretch, and before its end with that.
    pub(crate) fn moves_of(&self, place: usize) -> EndMoves {
        if self.breakpoints.contains_key(&place) {
            return EndMoves { by_event: 0.0, by_breakpoints: [(place, 1.0), (0, 0.0)] };
        }
        let [first, last] = self.stretch_of(place);
        let [from, to] = self.ends_of([first, last]);
        let Some(event) = self.events.range(..=place).next_back().map(|(event, _)| *event).filter(|event| *event > first)
        else {
            let share = (self.times[place] - from) / (to - from);
            return EndMoves { by_event: 0.0, by_breakpoints: [(first, 1.0 - share), (last, share)] };
        };
        let by_event = if event == place { 1.0 } else { self.share_behind_event(place) };
        // of steps that were laid, whose number stays
        let until = if by_event < 1.0 { place - 1 } else { place };
        let laid = match self.asked {
            0 => 0.0,
            _ => by_event * (self.times[until] - self.times[event]) / (to - from),
        };
        EndMoves { by_event, by_breakpoints: [(first, -laid), (last, 1.0 - by_event + laid)] }
    }

    /// Size of the equal steps that were laid in the stretch of an end of a step; not a number where they were chosen.
    fn laid_size(&self, place: usize) -> f64 {
        let ([from, to], all) = (self.ends_of(self.stretch_of(place)), self.end() - self.times[0]);
        if self.asked == 0 { f64::NAN } else { (to - from) / count_of(to - from, all / self.asked as f64) }
    }

    /// Places of the breakpoints, or start and end of the run, between which an end of a step lies; the second may be that itself.
    fn stretch_of(&self, place: usize) -> [usize; 2] {
        let first = self.breakpoints.range(..place).next_back().map_or(0, |(place, _)| *place);
        let last = self.breakpoints.range(place..).next().map_or(self.steps(), |(place, _)| *place);
        [first, last]
    }

    /// The times between which the steps of a stretch are laid.
    fn ends_of(&self, stretch: [usize; 2]) -> [f64; 2] {
        stretch.map(|place| self.laid_time(place))
    }

    /// The time of an end of a stretch as it was laid \[s\]: that of the last one may be behind an event that ended the run.
    pub(super) fn laid_time(&self, place: usize) -> f64 {
        match place == self.steps() {
            true => self.unreached.first().map_or(self.end(), |own| own.0),
            false => self.times[place],
        }
    }

    /// The ends of stretches that are breakpoints, that up to which the last steps were laid among them, with the numbers of these.
    pub(crate) fn moving_ends(&self) -> impl Iterator<Item = (usize, &[usize])> {
        let last = self.unreached.first().map(|own| (self.steps(), &own.1[..]));
        self.breakpoints.iter().map(|(&place, numbers)| (place, &numbers[..])).chain(last)
    }

    /// Whether an end of a step is that of a stretch between breakpoints.
    pub(super) fn is_fixed(&self, place: usize) -> bool {
        place >= self.steps() || self.breakpoints.contains_key(&place)
    }

    /// Whether an event lies before a step, and no breakpoint between them.
    pub(crate) fn is_behind_event(&self, step: usize) -> bool {
        let last = |place: Option<&usize>| place.map_or(0, |place| place + 1);
        let event = last(self.events.range(..=step).next_back().map(|(place, _)| place));
        event > last(self.breakpoints.range(..=step).next_back().map(|(place, _)| place))
    }

    /// Whether a step that starts at an end of a step does not go on from those before.
    pub(super) fn is_interrupted(&self, place: usize) -> bool {
        self.breakpoints.contains_key(&place) || self.changes_at(place).is_some()
    }

    /// Whether another grid was laid for the same run.
    pub(crate) fn is_of_same_run(&self, other: &TimeGrid) -> bool {
        (self.asked, self.end()) == (other.asked, other.end())
    }

    pub(crate) fn halved(&self) -> Self {
        if self.has_events() {
            return self.without_events().halved();
        }
        let mut times = vec![self.times[0]];
        times.extend(self.times.windows(2).flat_map(|ends| [0.5 * (ends[0] + ends[1]), ends[1]]));
        let breakpoints = self.breakpoints.iter().map(|(index, numbers)| (2 * index, numbers.clone())).collect();
        TimeGrid { times, breakpoints, asked: 2 * self.asked, ..Self::begin(0.0, 0) }
    }

    /// How time goes in each stretch, with the index of its first step, where breakpoints have these derivative parts; nothing where none has any.
    pub(crate) fn clocks<S: RunScalar>(&self, parts: &[S]) -> Result<Clocks<S>, String> {
        let size = |part: &S| (0..S::PARTS).fold(0.0, |size: f64, i| size.max(part.part(i).abs()));
        let mut moves = vec![S::zero()];
        for (index, numbers) in self.moving_ends() {
            let own = parts[numbers[0]];
            let differs = |part: S| size(&(part - own)) > SAME_DERIVATIVE * size(&own).max(size(&part));
            if numbers.iter().any(|&number| differs(parts[number])) {
                return Err(moved_apart(self.laid_time(index)));
            }
            moves.push(own);
        }
        moves.resize(self.boundaries().count(), S::zero());
        if moves.iter().all(|own| size(own) == 0.0) {
            return Ok(Vec::new());
        }
        let places: Vec<usize> = self.boundaries().collect();
        let stretches = places.windows(2).zip(moves.windows(2));
        let clock = |(places, moves): (&[usize], &[S])| {
            (places[0], Clock::new(self.ends_of([places[0], places[1]]), [moves[0], moves[1]]))
        };
        Ok(stretches.map(clock).collect())
    }

    /// Adds steps of equal size, none longer than `h`, up to a time.
    fn add_stretch(&mut self, end: f64, h: f64) {
        let start = self.times[self.steps()];
        let length = end - start;
        let count = count_of(length, h);
        self.times.extend((1..count as usize).map(|i| start + i as f64 * (length / count)));
        self.times.push(end);
    }

    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.times.len() - 1
    }

    /// "step 412 (t = 1.03 s)" for the step of index 411.
    pub fn place(&self, index: usize) -> String {
        let t = self.times.get(index).copied().unwrap_or(f64::NAN);
        format!("step {} (t = {} s)", index + 1, shortest(t))
    }

    /// Start and end of step `index` as elements see them: before a breakpoint the end is a number below it.
    pub fn span(&self, index: usize) -> (f64, f64) {
        let end = self.times[index + 1];
        (self.times[index], if self.breakpoints.contains_key(&(index + 1)) { beside(end, -1.0) } else { end })
    }
}

/// A time by which a formula takes the piece before a breakpoint, or behind it for a side of 1, though it rounds what it makes of it.
pub(super) fn beside(t: f64, side: f64) -> f64 {
    t + side * ROUNDINGS * (t.next_up() - t)
}

/// Roundings of a time.
const ROUNDINGS: f64 = 4.0;

/// How many equal steps of at most `h` a length takes.
fn count_of(length: f64, h: f64) -> f64 {
    (length / h - WHOLE).ceil().max(1.0)
}

/// Breakpoints within a run, in the order of their times, each with the numbers of those that are not farther apart than `near`.
fn grouped(breakpoints: &[f64], end: f64, near: f64) -> Vec<(f64, Vec<usize>)> {
    let mut within: Vec<usize> = (0..breakpoints.len()).collect();
    within.retain(|&number| breakpoints[number] > near && breakpoints[number] < end - near);
    within.sort_by(|&a, &b| breakpoints[a].total_cmp(&breakpoints[b]));
    let mut groups: Vec<(f64, Vec<usize>)> = Vec::new();
    for number in within {
        let time = breakpoints[number];
        match groups.last_mut() {
            Some((first, numbers)) if time - *first <= near => {
                numbers.push(number);
                numbers.sort_unstable();
            }
            _ => groups.push((time, vec![number])),
        }
    }
    groups
}
