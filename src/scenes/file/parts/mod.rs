//! Sections whose entries are made one by one: a file says what a section is, its keys, and what becomes of an entry.

mod beam;
mod body;
mod cable;
mod coordinate;
mod damper;
mod drawing;
mod driver;
mod element;
mod group;
mod hold;
mod joint;
mod joint_angle;
mod laminate;
mod line;
mod loads;
mod material;
mod mesh;
mod mode;
mod point;
mod rigid_interface;
mod section;
mod shell;
mod sphere;
mod spin;
mod spring;
mod state;
mod thin_walls;
mod tie;
mod variable;

use super::fields::Item;
use super::functionals;
use super::known::{Builder, Found, Known, Made};
use super::section::Section;
use crate::elements::entries::joined;
use crate::scalar::Scalar;

/// Lists of sections in the order of the reference page, and what makes an entry of theirs or else a load.
macro_rules! parts {
    ($($(#[$doc:meta])* $list:ident: $($part:ident),*;)*) => {
        $($(#[$doc])* const $list: &[Section] = &[$($part::SECTION),*];)*

        /// Makes what an entry says.
        pub(super) fn build<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
            match item.section {
                $($(section if section == $part::SECTION.name => $part::build(known, item, m),)*)*
                _ => loads::build(known, item, m),
            }
        }
    };
}

parts! {
    /// Sections before those of the loads.
    BEFORE_LOADS:
    variable, material, section, laminate, body, point, beam, cable, shell, mesh, thin_walls, sphere, group, coordinate,
    joint_angle, state, joint, rigid_interface, hold, spin, tie, driver, spring, damper, element;
    /// Sections behind them.
    BEHIND_LOADS: drawing, functionals, mode;
}

/// All of them, with those of the loads.
pub(super) const PARTS: &[Section] =
    &joined::<Section, { BEFORE_LOADS.len() + loads::SECTIONS.len() + BEHIND_LOADS.len() }>(&[
        BEFORE_LOADS,
        &loads::SECTIONS,
        BEHIND_LOADS,
    ]);
