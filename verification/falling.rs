//! The plate and the tube that fall from a hinge, of any number of elements, over one step of a millisecond.

use costate::scenes::{FileScene, built_in};

/// The plate, of one thickness, of so many elements along and across.
pub fn plate([along, across]: [usize; 2]) -> Result<FileScene, String> {
    let elements = format!("define = {{ along = {along}, across = {across} }}");
    in_one_step("plate-pendulum", &format!("{elements}\nshell.plate.thickness = \"t1\""))
}

/// The tube, of so many elements along and across each wall.
pub fn tube([along, across]: [usize; 2]) -> Result<FileScene, String> {
    let elements = format!("{{ elements = {along}, across = [{across}, {across}] }}");
    in_one_step("box-tube-pendulum", &format!("thin_walls.tube = {elements}"))
}

fn in_one_step(name: &str, changes: &str) -> Result<FileScene, String> {
    built_in::changed(name, &format!("{changes}\nsettings = {{ end = 1e-3, steps = 1 }}"))
}
