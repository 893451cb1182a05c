//! One channel of the files: its name, its unit and its sign.

use super::quantity::{Quantity, is_known, unit_in_name};
use crate::error::{Error, Result, ensure, finite};
use crate::files::lab::ChannelSet;
use crate::signal::mean;
use serde::{Deserialize, Serialize};

/// One channel of the files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelRef {
    /// Name in the file.
    pub name: String,
    /// Unit; may be left out where the file states it.
    pub unit: Option<String>,
    /// Factor on the samples before they are taken in `unit`; negative to turn the sign, 1 when left out.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub scale: f64,
}

/// A channel of a cell, or the statement that there is none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum CellChannel {
    /// Not measured: `"none"`. Taken as zero.
    #[serde(rename = "none")]
    NotMeasured,
    /// Measured.
    #[serde(untagged)]
    Measured(ChannelRef),
}

fn one() -> f64 {
    1.0
}

#[allow(clippy::trivially_copy_pass_by_ref)] // the signature that serde wants
fn is_one(scale: &f64) -> bool {
    *scale == 1.0
}

impl ChannelRef {
    /// A channel in a unit as it is.
    pub(crate) fn new(name: impl Into<String>, unit: &str) -> Self {
        Self {
            name: name.into(),
            unit: Some(unit.to_owned()),
            scale: 1.0,
        }
    }

    pub(super) fn validate(&self, place: &str, quantity: Quantity) -> Result<()> {
        if let Some(unit) = &self.unit {
            quantity.factor(&format!("{place}.unit"), unit)?;
        }
        let is_one = self.scale.is_finite() && self.scale != 0.0;
        let place = format_args!("{place}.scale");
        ensure(is_one, place, "a number other than zero", self.scale)
    }

    /// The samples in SI units.
    ///
    /// # Errors
    /// [`Error::Input`] at `place` listing what the file holds when there is no such channel, and for units that are
    /// missing, do not fit, or differ from those that the file states.
    pub(crate) fn samples(
        &self,
        place: &str,
        quantity: Quantity,
        set: &ChannelSet,
    ) -> Result<Vec<f64>> {
        let channel = set.only_channel(place, &self.name)?;
        let factor = self.factor(place, quantity, channel.unit.as_deref())?;
        Ok(channel.samples.iter().map(|x| factor * x).collect())
    }

    /// A single number in SI units, or the mean of a channel.
    pub(crate) fn number(&self, place: &str, quantity: Quantity, set: &ChannelSet) -> Result<f64> {
        let value = match set.number(&self.name) {
            Some(number) => number * self.factor(place, quantity, None)?,
            None => mean(&self.samples(place, quantity, set)?),
        };
        finite(format_args!("{place}, `{}`", self.name), value)
    }

    /// Factor from the samples to SI units.
    fn factor(&self, place: &str, quantity: Quantity, stated: Option<&str>) -> Result<f64> {
        let place = format!("{place}, `{}`", self.name);
        let unit =
            self.unit.as_deref().or(stated).ok_or_else(|| {
                Error::input(&place, "its unit, in the map or in the file", "none")
            })?;
        let factor = quantity.factor(&place, unit)?;
        // a unit of the file that is not known here (volts, counts) cannot be compared
        let differs = |by_file: &&str| {
            let factor_of_file = quantity.factor_of(by_file);
            factor_of_file.map_or(is_known(by_file), |f| (f / factor - 1.0).abs() > 1e-12)
        };
        // an ending of the name that is a unit of another quantity may be a word: `cell_N`
        let in_name = unit_in_name(&self.name).filter(|u| quantity.factor_of(u).is_some());
        match stated.or(in_name).filter(differs) {
            None => Ok(self.scale * factor),
            Some(by_file) => {
                let expected = format!("the unit `{by_file}` that the file states");
                let found = format!("`{unit}` in the map");
                Err(Error::input(place, expected, found))
            }
        }
    }
}
