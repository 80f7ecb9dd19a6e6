//! Where the numbers of the parts of a batch stand in the lists of a model.

use super::numbering::DofMap;
use smallvec::SmallVec;
use std::ops::Range;

/// Most parts that are evaluated side by side.
pub(super) const MOST_LANES: usize = 8;

/// Where the numbers of each part of a batch begin in a list, and how many they are.
#[derive(Debug, Default)]
pub(crate) struct Starts {
    /// Behind the last part some more that are like it, so that each group has one for each lane.
    places: Vec<u32>,
    /// How many numbers a part has.
    pub length: usize,
}

impl Starts {
    /// Of parts with as many numbers each.
    pub fn of_parts(numbers: impl Iterator<Item = Range<usize>>) -> Self {
        let mut starts = Starts::default();
        for own in numbers {
            assert!(starts.places.is_empty() || starts.length == own.len(), "parts of one kind with unlike numbers");
            starts.length = own.len();
            starts.places.push(own.start as u32);
        }
        starts.filled_up()
    }

    /// Those of some parts.
    pub fn of_chosen(&self, chosen: &[usize]) -> Self {
        let places = chosen.iter().map(|&part| self.places[part]).collect();
        Starts { places, length: self.length }.filled_up()
    }

    fn filled_up(mut self) -> Self {
        let last = self.places.last().copied().unwrap_or(0);
        self.places.resize(self.places.len() + MOST_LANES, last);
        self
    }

    /// The numbers of a part.
    #[inline(always)]
    pub fn of(&self, part: usize) -> Range<usize> {
        let start = self.places[part] as usize;
        start..start + self.length
    }

    /// Where the numbers begin, from a part on: at least one for each lane.
    #[inline(always)]
    pub fn places_from(&self, part: usize) -> &[u32] {
        &self.places[part..]
    }
}

/// Where coordinates, parameters and multipliers of parts stand.
#[derive(Debug, Default)]
pub(super) struct GatherMap {
    /// The coordinates of each node.
    pub nodes: SmallVec<[Starts; 3]>,
    /// Parameters.
    pub parameters: Starts,
    /// Multipliers; none of elements.
    pub multipliers: Starts,
}

impl GatherMap {
    /// Of parts of one kind, each with the numbers of its multipliers.
    pub fn of<'p>(parts: impl Iterator<Item = (&'p DofMap, Range<usize>)> + Clone) -> Self {
        let nodes = parts.clone().next().map_or(0, |(part, _)| part.segments.len());
        let of_node = |node: usize| Starts::of_parts(parts.clone().map(|(part, _)| part.segments[node].clone()));
        GatherMap {
            nodes: (0..nodes).map(of_node).collect(),
            parameters: Starts::of_parts(parts.clone().map(|(part, _)| part.parameters.clone())),
            multipliers: Starts::of_parts(parts.map(|(_, multipliers)| multipliers)),
        }
    }

    /// Those of some parts.
    pub fn of_chosen(&self, chosen: &[usize]) -> Self {
        GatherMap {
            nodes: self.nodes.iter().map(|starts| starts.of_chosen(chosen)).collect(),
            parameters: self.parameters.of_chosen(chosen),
            multipliers: self.multipliers.of_chosen(chosen),
        }
    }
}
