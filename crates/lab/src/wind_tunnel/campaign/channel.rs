//! One channel of the files: its name, its unit and its sign; and units, what each quantity may be stated in and the factor to SI.

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

/// Kinds of channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Quantity {
    /// Displacement, m.
    Length,
    /// Rotation, rad.
    Angle,
    /// Force, N.
    Force,
    /// Moment, N·m.
    Moment,
    /// Wind speed, m/s.
    Speed,
    /// Time, s.
    Time,
    /// Density, kg/m³.
    Density,
    /// Temperature, °C.
    Temperature,
    /// Pressure, Pa.
    Pressure,
}

/// Unit, quantity, factor to the unit used here.
const UNITS: &[(&str, Quantity, f64)] = &[
    ("m", Quantity::Length, 1.0),
    ("cm", Quantity::Length, 1e-2),
    ("mm", Quantity::Length, 1e-3),
    ("um", Quantity::Length, 1e-6),
    ("rad", Quantity::Angle, 1.0),
    ("mrad", Quantity::Angle, 1e-3),
    ("deg", Quantity::Angle, std::f64::consts::PI / 180.0),
    ("°", Quantity::Angle, std::f64::consts::PI / 180.0),
    ("N", Quantity::Force, 1.0),
    ("mN", Quantity::Force, 1e-3),
    ("kN", Quantity::Force, 1e3),
    ("Nm", Quantity::Moment, 1.0),
    ("Nmm", Quantity::Moment, 1e-3),
    ("mNm", Quantity::Moment, 1e-3),
    ("Ncm", Quantity::Moment, 1e-2),
    ("kNm", Quantity::Moment, 1e3),
    ("m/s", Quantity::Speed, 1.0),
    ("km/h", Quantity::Speed, 1.0 / 3.6),
    ("s", Quantity::Time, 1.0),
    ("ms", Quantity::Time, 1e-3),
    ("kg/m3", Quantity::Density, 1.0),
    ("C", Quantity::Temperature, 1.0),
    ("°C", Quantity::Temperature, 1.0),
    ("Pa", Quantity::Pressure, 1.0),
    ("hPa", Quantity::Pressure, 1e2),
    ("mbar", Quantity::Pressure, 1e2),
    ("kPa", Quantity::Pressure, 1e3),
];

impl Quantity {
    /// Factor from `unit` to SI (°C for temperatures).
    pub(crate) fn factor(self, place: &str, unit: &str) -> Result<f64> {
        self.factor_of(unit).ok_or_else(|| {
            let own = UNITS.iter().filter(|(_, quantity, _)| *quantity == self);
            let own: Vec<&str> = own.map(|(name, ..)| *name).collect();
            let article = if self == Self::Angle { "an" } else { "a" };
            let name = format!("{self:?}").to_lowercase();
            let expected = format!("a unit of {article} {name}: {}", own.join(", "));
            Error::input(place, expected, format!("`{unit}`"))
        })
    }

    /// The same; `None` for a unit that does not fit.
    pub(crate) fn factor_of(self, unit: &str) -> Option<f64> {
        let plain = normalised(unit);
        let mut units = UNITS.iter();
        let unit = units.find(|(name, quantity, _)| *quantity == self && *name == plain);
        unit.map(|(.., factor)| *factor)
    }
}

/// Whether `unit` is one of any quantity.
pub(super) fn is_known(unit: &str) -> bool {
    let plain = normalised(unit);
    UNITS.iter().any(|(name, ..)| *name == plain)
}

/// The unit that the name of a channel ends with, if it does: `y_mm`, `lift, kN`. Of the units of one letter only N is one beyond doubt.
pub(super) fn unit_in_name(name: &str) -> Option<&str> {
    let (_, ending) = name.rsplit_once(['_', ' ', ',', '/', '-'])?;
    let is_certain = ending == "N" || ending.chars().nth(1).is_some();
    let is_unit = UNITS.iter().any(|(name, ..)| *name == ending);
    (is_certain && is_unit).then_some(ending)
}

/// Spellings of one unit as one: `N·m`, `N m`, `N*m`, `kg/m^3`, `kg/m³`, `degC`.
fn normalised(unit: &str) -> String {
    let letter = |c: char| match c {
        ' ' | '·' | '*' | '.' | '^' => None,
        '³' => Some('3'),
        'µ' | 'μ' => Some('u'),
        c => Some(c),
    };
    let plain: String = unit.trim().chars().filter_map(letter).collect();
    // words for symbols, in any case and number
    let word = plain.to_lowercase();
    let symbol = match word.trim_end_matches('s') {
        "degc" | "celsiu" => "C",
        "degree" | "deg" => "deg",
        "radian" | "rad" => "rad",
        "metre" | "meter" => "m",
        "millimetre" | "millimeter" => "mm",
        "newton" => "N",
        "second" | "sec" => "s",
        _ => return plain,
    };
    symbol.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_those_of_their_quantity() {
        let factor = |q: Quantity, unit: &str| q.factor_of(unit);
        assert_eq!(factor(Quantity::Length, "mm"), Some(1e-3));
        assert_eq!(factor(Quantity::Moment, "N·m"), Some(1.0));
        assert_eq!(factor(Quantity::Moment, "kN m"), Some(1e3));
        assert_eq!(factor(Quantity::Density, "kg/m³"), Some(1.0));
        assert_eq!(factor(Quantity::Temperature, "degC"), Some(1.0));
        let degree = factor(Quantity::Angle, "deg").unwrap();
        assert!((degree * 180.0 / std::f64::consts::PI - 1.0).abs() < 1e-15);
        // mN is a force and never milli of a moment; N is no moment
        assert_eq!(factor(Quantity::Moment, "N"), None);
        assert_eq!(
            Quantity::Force
                .factor("channels.x", "mm")
                .unwrap_err()
                .to_string(),
            "channels.x: expected a unit of a force: N, mN, kN, found `mm`"
        );
    }
}
