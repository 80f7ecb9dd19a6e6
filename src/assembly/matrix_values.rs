//! Values of a matrix, to which one thread or several add the entries of parts.

use std::marker::PhantomData;
use std::ops::Range;

/// Where entries of a matrix are added to.
pub(super) trait MatrixValues {
    /// Adds a number at a place, if that is in the matrix.
    fn add(&mut self, place: u32, entry: f64);
    /// The numbers at some places.
    fn run(&mut self, places: Range<usize>) -> &mut [f64];
}

impl MatrixValues for &mut [f64] {
    #[inline(always)]
    fn add(&mut self, place: u32, entry: f64) {
        if let Some(value) = self.get_mut(place as usize) {
            *value += entry;
        }
    }
    #[inline(always)]
    fn run(&mut self, places: Range<usize>) -> &mut [f64] {
        &mut self[places]
    }
}

/// Values of a matrix to which threads add at once, each to places of its own.
#[derive(Clone, Copy)]
pub(super) struct SharedValues<'v> {
    first: *mut f64,
    count: usize,
    values: PhantomData<&'v mut [f64]>,
}

// SAFETY: a list of numbers, of which each thread reads and writes others, as who makes it promises.
unsafe impl Send for SharedValues<'_> {}
// SAFETY: likewise.
unsafe impl Sync for SharedValues<'_> {}

impl<'v> SharedValues<'v> {
    /// Of a list.
    ///
    /// # Safety
    /// No place is added to, or asked for, by more than one thread until all of them have ended.
    pub unsafe fn new(values: &'v mut [f64]) -> Self {
        SharedValues { first: values.as_mut_ptr(), count: values.len(), values: PhantomData }
    }
}

impl MatrixValues for SharedValues<'_> {
    #[inline(always)]
    fn add(&mut self, place: u32, entry: f64) {
        if (place as usize) < self.count {
            // SAFETY: it is in the list, and no other thread's.
            unsafe { *self.first.add(place as usize) += entry };
        }
    }
    #[inline(always)]
    fn run(&mut self, places: Range<usize>) -> &mut [f64] {
        assert!(places.start <= places.end && places.end <= self.count, "places of the list");
        // SAFETY: they are in the list, and no other thread's.
        unsafe { std::slice::from_raw_parts_mut(self.first.add(places.start), places.len()) }
    }
}
