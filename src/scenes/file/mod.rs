#![doc = include_str!("../../guide/links.txt")]
#![doc = include_str!("format.md")]
#![doc = include_str!("reference.md")]

mod build_parts;
mod columns;
mod condition;
mod describing;
mod elsewhere;
mod entry_context;
mod extended;
mod fields;
mod fit;
mod formula;
mod formula_names;
mod formula_parts;
mod formula_text;
mod functionals;
mod keys;
mod mesh_groups;
mod mesh_nodes;
mod meshes;
mod mistake;
mod order;
mod own_parts;
mod parts;
mod raw;
mod reader;
mod reference;
mod references;
mod scenarios;
mod scene;
mod schema;
mod section;
mod sections;
mod state_entries;
mod state_laws;
mod stl;
mod tables;
mod values;

#[doc(hidden)]
pub use formula::is_free_name;
pub use own_parts::OwnParts;
pub use reference::reference;
pub use scene::FileScene;
pub use schema::schema;
