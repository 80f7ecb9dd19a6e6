//! Storage of the factors: one array for all small fronts, and own ones for each large front.

use super::matrix_view::MatrixView;
use super::small_front::{LANES, Lines, Shape};
use super::small_substitution::{SmallFactors, transpose_small};
use super::symbolic::Symbolic;

/// What a factorization found in a front.
#[derive(Default)]
pub struct Outcome {
    /// Number of pivots that were found.
    eliminated: usize,
    form: Form,
    /// Those of a front that is large, or was not factored as a small one; kept for the next time.
    large: Option<Box<Large>>,
}

/// How the factors of a front are stored.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub enum Form {
    /// In its own storage.
    #[default]
    Large,
    /// As those of a small front, every row of which has the pivot of its own column.
    Small,
    /// The same, with rows in another order than that of the places.
    SmallExchanged,
}

/// L and U of a front that may have taken up delayed pivots, and the places of its rows and columns.
#[derive(Default)]
struct Large {
    values: Vec<f64>,
    rows: Vec<u32>,
    columns: Vec<u32>,
}

/// Factors of all fronts; none before the first factorization.
#[derive(Default)]
pub struct Factors {
    small: Lines,
    /// Those of small fronts in A^T, where a transposed system was solved.
    transposed: Lines,
    is_transposed: bool,
    /// Places of the rows of small fronts, where these were exchanged.
    rows: Vec<u32>,
    outcomes: Vec<Outcome>,
}

/// The factors of a front: P A Q = [L11; L21] [U11 U1d U12], where d are columns whose pivots are delayed.
#[derive(Clone, Copy)]
pub struct FrontFactors<'f> {
    /// Number of pivots.
    pub eliminated: usize,
    /// Places of the unknowns' rows whose pivots were looked for, those without a pivot at the end.
    pub rows: &'f [u32],
    /// Places of the columns, likewise.
    pub columns: &'f [u32],
    /// L below the diagonal and U on and above it, in all rows of the columns whose pivots were looked for.
    pub lower: MatrixView<'f>,
    /// U of the other columns, in the rows whose pivots were looked for.
    pub upper: MatrixView<'f>,
}

/// The same while it is filled.
pub struct FrontStorage<'f> {
    /// All rows of the columns whose pivots are looked for, column by column.
    pub lower: &'f mut [f64],
    /// The rows whose pivots are looked for, of the other columns.
    pub upper: &'f mut [f64],
    /// Places of these rows.
    pub rows: &'f mut [u32],
    /// Places of these columns.
    pub columns: &'f mut [u32],
}

/// Where the factors of a front, and of all behind it, begin among those of all.
#[derive(Clone, Copy, Default)]
struct Start {
    front: usize,
    place: usize,
    small: usize,
}

/// The factors of fronts that follow each other.
pub struct Part<'f> {
    start: Start,
    small: &'f mut [f64],
    rows: &'f mut [u32],
    outcomes: &'f mut [Outcome],
}

impl Factors {
    /// All fronts, to be factored anew; the first time there is no space yet.
    pub fn part(&mut self, symbolic: &Symbolic) -> Part<'_> {
        self.is_transposed = false;
        if self.outcomes.len() != symbolic.fronts.len() {
            *self = Factors {
                small: Lines::new(symbolic.small_storage() + LANES),
                rows: vec![0; symbolic.size],
                outcomes: symbolic.fronts.iter().map(|_| Outcome::default()).collect(),
                ..Factors::default()
            };
        }
        Part { start: Start::default(), small: &mut self.small, rows: &mut self.rows, outcomes: &mut self.outcomes }
    }

    /// The factors of a front that is not stored as a small one.
    pub fn front(&self, symbolic: &Symbolic, front: usize) -> FrontFactors<'_> {
        let Outcome { eliminated, large, .. } = &self.outcomes[front];
        let Large { values, rows, columns } = large.as_deref().expect("a front that was factored");
        let (others, summed) = (symbolic.fronts[front].others(), rows.len());
        let (lower, upper) = values.split_at((summed + others) * summed);
        FrontFactors {
            eliminated: *eliminated,
            rows,
            columns,
            lower: MatrixView::new(lower, summed + others, summed),
            upper: MatrixView::new(upper, summed, others),
        }
    }

    /// Whether the factors of a front are stored as those of a small one.
    #[inline(always)]
    pub fn is_small(&self, front: usize) -> bool {
        self.outcomes[front].form != Form::Large
    }

    /// The factors of a front that is stored as a small one, in A, or in A^T after [`Factors::transpose`].
    #[inline(always)]
    pub fn small<'f>(&'f self, symbolic: &'f Symbolic, front: usize, is_transposed: bool) -> SmallFactors<'f> {
        let values = if is_transposed { &self.transposed } else { &self.small };
        SmallFactors::new(&symbolic.small_plans[front], values, &symbolic.rows)
    }

    /// The places of the rows of a front that is stored as a small one, where these were exchanged.
    #[inline(always)]
    pub fn exchanged(&self, symbolic: &Symbolic, front: usize) -> Option<&[u32]> {
        (self.outcomes[front].form == Form::SmallExchanged).then(|| {
            let planned = &symbolic.fronts[front];
            &self.rows[planned.first..][..planned.pivots]
        })
    }

    /// Numbers of fronts that are stored as small ones, of those among them whose rows were exchanged, and of small
    /// ones that are not.
    #[cfg(test)]
    pub fn forms(&self, symbolic: &Symbolic) -> [usize; 3] {
        let mut counts = [0; 3];
        for (Outcome { form, .. }, front) in self.outcomes.iter().zip(&symbolic.fronts) {
            let is = [*form != Form::Large, *form == Form::SmallExchanged, front.is_small() && *form == Form::Large];
            counts.iter_mut().zip(is).for_each(|(count, is)| *count += usize::from(is));
        }
        counts
    }

    /// Transposes the factors of small fronts, if that has not been done since they were made.
    pub fn transpose(&mut self, symbolic: &Symbolic) {
        if !self.is_transposed {
            if self.transposed.is_empty() {
                self.transposed = Lines::new(self.small.len());
            }
            let Factors { small, transposed, outcomes, .. } = self;
            for (front, outcome) in symbolic.fronts.iter().zip(outcomes) {
                if outcome.form != Form::Large {
                    let own = front.small..front.small + front.small_storage();
                    transpose_small(Shape::of(front), &small[own.clone()], &mut transposed[own]);
                }
            }
            self.is_transposed = true;
        }
    }

    /// Number of pivots that had to wait for a front above, counted in every front that they left.
    #[cfg(test)]
    pub fn delayed(&mut self, symbolic: &Symbolic) -> usize {
        let part = self.part(symbolic);
        (0..symbolic.fronts.len()).map(|front| part.delayed(front)[0].len()).sum()
    }
}

impl<'f> Part<'f> {
    /// The fronts before one of them, and the others.
    #[inline]
    pub fn split_at(self, symbolic: &Symbolic, front: usize) -> (Part<'f>, Part<'f>) {
        let end = || (self.start.place + self.rows.len(), self.start.small + self.small.len());
        let (place, small) = symbolic.fronts.get(front).map_or_else(end, |planned| (planned.first, planned.small));
        let (smalls, later_smalls) = self.small.split_at_mut(small - self.start.small);
        let (rows, later_rows) = self.rows.split_at_mut(place - self.start.place);
        let (outcomes, later_outcomes) = self.outcomes.split_at_mut(front - self.start.front);
        let start = Start { front, place, small };
        let before = Part { small: smalls, rows, outcomes, ..self };
        (before, Part { start, small: later_smalls, rows: later_rows, outcomes: later_outcomes })
    }

    /// The same for a shorter time.
    #[inline]
    pub fn reborrow(&mut self) -> Part<'_> {
        let Part { start, small, rows, outcomes } = self;
        Part { start: *start, small, rows, outcomes }
    }

    /// Places of the rows and of the columns of a front whose pivots are delayed.
    #[inline]
    pub fn delayed(&self, front: usize) -> [&[u32]; 2] {
        let Outcome { eliminated, form, large } = &self.outcomes[front - self.start.front];
        match large {
            Some(large) if *form == Form::Large => [&large.rows[*eliminated..], &large.columns[*eliminated..]],
            _ => [&[]; 2],
        }
    }

    /// Space for the factors of a small front, and for the places of its rows.
    #[inline]
    pub fn prepare_small(&mut self, symbolic: &Symbolic, front: usize) -> (&mut [f64], &mut [u32]) {
        let planned = &symbolic.fronts[front];
        let first = planned.first - self.start.place;
        let values = &mut self.small[planned.small - self.start.small..][..planned.small_storage()];
        (values, &mut self.rows[first..first + planned.pivots])
    }

    /// Notes how a small front is stored; returns whether it is as one.
    #[inline]
    pub fn set_small(&mut self, symbolic: &Symbolic, front: usize, form: Form) -> bool {
        let outcome = &mut self.outcomes[front - self.start.front];
        (outcome.form, outcome.eliminated) = (form, symbolic.fronts[front].pivots);
        form != Form::Large
    }

    /// Space for the factors of a front with a number of delayed pivots on top of its own; all values zero, places
    /// those of its own pivots.
    pub fn prepare(&mut self, symbolic: &Symbolic, front: usize, delayed: usize) -> FrontStorage<'_> {
        let planned = &symbolic.fronts[front];
        let outcome = &mut self.outcomes[front - self.start.front];
        outcome.form = Form::Large;
        let Large { values, rows, columns } = &mut **outcome.large.get_or_insert_default();
        let summed = planned.pivots + delayed;
        values.clear();
        values.resize(summed * (summed + 2 * planned.others()), 0.0);
        for list in [&mut *rows, &mut *columns] {
            list.clear();
            list.extend(planned.first as u32..(planned.first + planned.pivots) as u32);
            list.resize(summed, 0);
        }
        let (lower, upper) = values.split_at_mut(summed * (summed + planned.others()));
        FrontStorage { lower, upper, rows, columns }
    }

    /// Notes how many pivots a front has.
    pub fn set_eliminated(&mut self, front: usize, eliminated: usize) {
        self.outcomes[front - self.start.front].eliminated = eliminated;
    }
}
