//! Energies.

use super::measurand::{GROUP, Measurand};
use super::over::over;
use crate::scenes::file::describing::*;

pub(super) struct Energy;

impl Measurand for Energy {
    const FORM: Form = Form { name: "energy", doc: "energy of all elements [J]", keys: &[] };

    fn add<S: Scalar>(_: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        m.energy_functional(name, over(fields));
        Ok(())
    }
}

pub(super) struct StrainEnergy;

impl Measurand for StrainEnergy {
    const FORM: Form = Form { name: "strain_energy", doc: "energy stored in strains [J]", keys: &[GROUP] };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        m.strain_energy_functional(name, over(fields), &known.group(fields, "of")?);
        Ok(())
    }
}
