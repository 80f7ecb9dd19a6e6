//! Storage of the factors: one array for all fronts, and own ones for fronts that took up delayed pivots.

use super::matrix_view::MatrixView;
use super::symbolic::{Front, Symbolic};

/// What a factorization found in a front.
#[derive(Default)]
pub struct Outcome {
    /// Number of pivots that were found.
    pub eliminated: usize,
    /// Storage of a front that is larger than planned.
    grown: Option<Box<Grown>>,
}

#[derive(Default)]
struct Grown {
    values: Vec<f64>,
    rows: Vec<u32>,
    columns: Vec<u32>,
}

/// Factors of all fronts.
#[derive(Default)]
pub struct Factors {
    values: Vec<f64>,
    rows: Vec<u32>,
    columns: Vec<u32>,
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

/// The factors of fronts that follow each other.
pub struct Part<'f> {
    first_front: usize,
    first_place: usize,
    first_value: usize,
    values: &'f mut [f64],
    rows: &'f mut [u32],
    columns: &'f mut [u32],
    outcomes: &'f mut [Outcome],
}

impl Factors {
    /// Space for all fronts without delayed pivots.
    pub fn new(symbolic: &Symbolic) -> Self {
        let outcomes = symbolic.fronts.iter().map(|_| Outcome::default()).collect();
        let eliminated = symbolic.fronts.iter().map(|front| front.pivots).sum();
        Factors {
            values: vec![0.0; symbolic.factor_storage()],
            rows: vec![0; eliminated],
            columns: vec![0; eliminated],
            outcomes,
        }
    }

    /// All fronts.
    pub fn part(&mut self) -> Part<'_> {
        Part {
            first_front: 0,
            first_place: 0,
            first_value: 0,
            values: &mut self.values,
            rows: &mut self.rows,
            columns: &mut self.columns,
            outcomes: &mut self.outcomes,
        }
    }

    /// The factors of a front.
    pub fn front(&self, symbolic: &Symbolic, front: usize) -> FrontFactors<'_> {
        let planned = &symbolic.fronts[front];
        let values = &self.values[planned.factors..][..planned.storage()];
        let places = planned.first..planned.first + planned.pivots;
        view(planned, &self.outcomes[front], values, &self.rows[places.clone()], &self.columns[places])
    }

    /// Number of pivots that had to wait for a front above, counted in every front that they left.
    pub fn delayed(&self, symbolic: &Symbolic) -> usize {
        (0..self.outcomes.len()).map(|front| self.front(symbolic, front)).map(|f| f.rows.len() - f.eliminated).sum()
    }

    /// Bytes beyond the planned ones.
    pub fn grown_bytes(&self) -> usize {
        let bytes = |grown: &Grown| size_of_val(&grown.values[..]) + size_of_val(&grown.rows[..]) * 2;
        self.outcomes.iter().filter_map(|outcome| outcome.grown.as_deref()).map(bytes).sum()
    }
}

fn view<'f>(
    planned: &Front,
    outcome: &'f Outcome,
    values: &'f [f64],
    rows: &'f [u32],
    columns: &'f [u32],
) -> FrontFactors<'f> {
    let (values, rows, columns) = match &outcome.grown {
        Some(grown) => (&grown.values[..], &grown.rows[..], &grown.columns[..]),
        None => (values, rows, columns),
    };
    let (others, summed) = (planned.others(), rows.len());
    let (lower, upper) = values.split_at((summed + others) * summed);
    FrontFactors {
        eliminated: outcome.eliminated,
        rows,
        columns,
        lower: MatrixView::new(lower, summed + others, summed),
        upper: MatrixView::new(upper, summed, others),
    }
}

impl<'f> Part<'f> {
    /// The fronts before one of them, and the others.
    pub fn split_at(self, symbolic: &Symbolic, front: usize) -> (Part<'f>, Part<'f>) {
        let (place, value) = symbolic.fronts.get(front).map_or_else(
            || (self.first_place + self.rows.len(), self.first_value + self.values.len()),
            |front| (front.first, front.factors),
        );
        let (values, later_values) = self.values.split_at_mut(value - self.first_value);
        let (rows, later_rows) = self.rows.split_at_mut(place - self.first_place);
        let (columns, later_columns) = self.columns.split_at_mut(place - self.first_place);
        let (outcomes, later_outcomes) = self.outcomes.split_at_mut(front - self.first_front);
        let (first_front, first_place, first_value) = (self.first_front, self.first_place, self.first_value);
        (
            Part { first_front, first_place, first_value, values, rows, columns, outcomes },
            Part {
                first_front: front,
                first_place: place,
                first_value: value,
                values: later_values,
                rows: later_rows,
                columns: later_columns,
                outcomes: later_outcomes,
            },
        )
    }

    /// The same for a shorter time.
    pub fn reborrow(&mut self) -> Part<'_> {
        Part {
            first_front: self.first_front,
            first_place: self.first_place,
            first_value: self.first_value,
            values: self.values,
            rows: self.rows,
            columns: self.columns,
            outcomes: self.outcomes,
        }
    }

    /// The factors of one of the fronts.
    pub fn front(&self, symbolic: &Symbolic, front: usize) -> FrontFactors<'_> {
        let planned = &symbolic.fronts[front];
        let values = &self.values[planned.factors - self.first_value..][..planned.storage()];
        let first = planned.first - self.first_place;
        let places = first..first + planned.pivots;
        let outcome = &self.outcomes[front - self.first_front];
        view(planned, outcome, values, &self.rows[places.clone()], &self.columns[places])
    }

    /// Space for the factors of a front with a number of delayed pivots on top of its own; all values zero, places those of its
    /// own pivots.
    pub fn prepare(&mut self, symbolic: &Symbolic, front: usize, delayed: usize) -> FrontStorage<'_> {
        let planned = &symbolic.fronts[front];
        let outcome = &mut self.outcomes[front - self.first_front];
        let first = planned.first - self.first_place;
        let places = first..first + planned.pivots;
        let (values, rows, columns) = if delayed == 0 {
            outcome.grown = None;
            let values = &mut self.values[planned.factors - self.first_value..][..planned.storage()];
            values.fill(0.0);
            (values, &mut self.rows[places.clone()], &mut self.columns[places])
        } else {
            let grown = outcome.grown.get_or_insert_default();
            let summed = planned.pivots + delayed;
            grown.values.clear();
            grown.values.resize(summed * (summed + 2 * planned.others()), 0.0);
            grown.rows.resize(summed, 0);
            grown.columns.resize(summed, 0);
            (&mut grown.values[..], &mut grown.rows[..], &mut grown.columns[..])
        };
        for list in [&mut *rows, &mut *columns] {
            list.iter_mut().zip(planned.first as u32..).take(planned.pivots).for_each(|(own, place)| *own = place);
        }
        let summed = rows.len();
        let (lower, upper) = values.split_at_mut(summed * (summed + planned.others()));
        FrontStorage { lower, upper, rows, columns }
    }

    /// Notes how many pivots a front has.
    pub fn set_eliminated(&mut self, front: usize, eliminated: usize) {
        self.outcomes[front - self.first_front].eliminated = eliminated;
    }
}
