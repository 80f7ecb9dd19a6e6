#![doc = include_str!("links.txt")]
#![doc = include_str!("index.md")]
// a page for each file; code here would belong elsewhere

/// Pages of a folder. Their links are defined twice, and the first definition counts: `links.txt` for rustdoc, the end of each file for those
/// who read the file itself.
macro_rules! pages {
    ($folder:literal: $($name:ident)*) => {
        $(
            #[doc = include_str!("links.txt")]
            #[doc = include_str!(concat!($folder, stringify!($name), ".md"))]
            pub mod $name {}
        )*
    };
}

pages!("": getting_started programs python own_parts joints beams cables shells meshes functionals time events contact statics gradients
    optimization fit ranks files commands limits measured glossary changelog);

pub mod theory {
    #![doc = include_str!("links.txt")]
    #![doc = include_str!("theory/index.md")]

    pages!("theory/": descriptor_form coordinates constraint_levels integrators programs discrete_adjoint events beams shells
        aggregates linear_systems);
}

/// The program of the README is run with the examples of this guide.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
