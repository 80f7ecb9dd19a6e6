//! Energies.

use super::measurand::{GROUP, Measurand};
use super::over::over;
use crate::scenes::file::describing::*;

pub(super) const ENERGY: Measurand = Measurand {
    form: Form { name: "energy", doc: "energy of all elements [J]", keys: &[] },
    add: |e, m| {
        m.energy_functional(e.name(), over(&e));
        Ok(())
    },
};

pub(super) const STRAIN_ENERGY: Measurand = Measurand {
    form: Form { name: "strain_energy", doc: "energy stored in strains [J]", keys: &[GROUP] },
    add: |e, m| {
        m.strain_energy_functional(e.name(), over(&e), &e.group("of")?);
        Ok(())
    },
};
