#![doc = include_str!("index.md")]
// a page for each file; code here would belong elsewhere

pub mod getting_started {
    #![doc = include_str!("getting_started.md")]
}

pub mod programs {
    #![doc = include_str!("programs.md")]
}

pub mod own_parts {
    #![doc = include_str!("own_parts.md")]
}

pub mod joints {
    #![doc = include_str!("joints.md")]
}

pub mod beams {
    #![doc = include_str!("beams.md")]
}

pub mod cables {
    #![doc = include_str!("cables.md")]
}

pub mod shells {
    #![doc = include_str!("shells.md")]
}

pub mod meshes {
    #![doc = include_str!("meshes.md")]
}

pub mod functionals {
    #![doc = include_str!("functionals.md")]
}

pub mod time {
    #![doc = include_str!("time.md")]
}

pub mod statics {
    #![doc = include_str!("statics.md")]
}

pub mod gradients {
    #![doc = include_str!("gradients.md")]
}

pub mod optimization {
    #![doc = include_str!("optimization.md")]
}

pub mod files {
    #![doc = include_str!("files.md")]
}

pub mod commands {
    #![doc = include_str!("commands.md")]
}

pub mod theory {
    #![doc = include_str!("theory/index.md")]

    pub mod descriptor_form {
        #![doc = include_str!("theory/descriptor_form.md")]
    }

    pub mod coordinates {
        #![doc = include_str!("theory/coordinates.md")]
    }

    pub mod constraint_levels {
        #![doc = include_str!("theory/constraint_levels.md")]
    }

    pub mod integrators {
        #![doc = include_str!("theory/integrators.md")]
    }

    pub mod programs {
        #![doc = include_str!("theory/programs.md")]
    }

    pub mod discrete_adjoint {
        #![doc = include_str!("theory/discrete_adjoint.md")]
    }

    pub mod beams {
        #![doc = include_str!("theory/beams.md")]
    }

    pub mod shells {
        #![doc = include_str!("theory/shells.md")]
    }

    pub mod aggregates {
        #![doc = include_str!("theory/aggregates.md")]
    }

    pub mod linear_systems {
        #![doc = include_str!("theory/linear_systems.md")]
    }
}

pub mod limits {
    #![doc = include_str!("limits.md")]
}

pub mod measured {
    #![doc = include_str!("measured.md")]
}

pub mod glossary {
    #![doc = include_str!("glossary.md")]
}

pub mod changelog {
    #![doc = include_str!("changelog.md")]
}

/// The program of the README is run with the examples of this guide.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
