//! Sections whose entries are made one by one: a file says what a section is, its keys, and what becomes of an entry.

mod beam;
mod body;
mod cable;
mod contact;
mod coordinate;
mod drawing;
mod element;
mod event;
mod friction;
mod group;
mod hold;
mod joint;
mod joint_angle;
mod laminate;
mod line;
mod material;
mod measurement;
mod mesh;
mod mode;
mod point;
mod rigid_interface;
mod section;
mod shell;
mod sphere;
mod spin;
mod springs;
mod state;
mod stop;
mod thin_walls;
mod tie;
mod variable;

pub(super) use contact::Shape;

use super::functionals;
use super::section::Section;
use crate::elements::entries::joined;

/// Sections before those of the loads, in the order of the reference page.
const BEFORE_LOADS: &[Section] = &[
    variable::SECTION,
    material::SECTION,
    section::SECTION,
    laminate::SECTION,
    body::SECTION,
    point::SECTION,
    beam::SECTION,
    cable::SECTION,
    shell::SECTION,
    mesh::SECTION,
    thin_walls::SECTION,
    sphere::SECTION,
    group::SECTION,
    coordinate::SECTION,
    joint_angle::SECTION,
    state::SECTION,
    event::NUMBER,
    joint::JOINT,
    rigid_interface::SECTION,
    hold::SECTION,
    spin::SECTION,
    tie::SECTION,
    joint::DRIVER,
    springs::SPRING,
    springs::DAMPER,
    element::SECTION,
    stop::STOP,
    friction::FRICTION,
    friction::CLUTCH,
    contact::SHAPE,
    contact::CONTACT,
    stop::LATCH,
    event::EVENT,
];
/// Sections behind them.
const BEHIND_LOADS: &[Section] = &[drawing::SECTION, functionals::SECTION, mode::SECTION, measurement::SECTION];

/// All of them, with those of the loads.
pub(super) const PARTS: &[Section] = &joined::<
    Section,
    { BEFORE_LOADS.len() + springs::LOAD_SECTIONS.len() + BEHIND_LOADS.len() },
>(&[BEFORE_LOADS, &springs::LOAD_SECTIONS, BEHIND_LOADS]);
