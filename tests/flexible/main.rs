//! Cables, shells and what is measured in them.

mod ancf;
mod free_meshes;
mod functionals;
mod joins;
mod shell_loads;
mod shell_meshes;
mod shells;
mod ties;
