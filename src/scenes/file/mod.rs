#![doc = include_str!("format.md")]
#![doc = include_str!("reference.md")]

mod build;
mod expression;
mod keys;
mod known;
mod mistake;
mod raw;
mod reader;
mod reference;
mod scene;
mod schema;
mod sections;
mod unknown;

pub use reference::reference;
pub use scene::FileScene;
pub use schema::schema;
pub use unknown::unknown;
