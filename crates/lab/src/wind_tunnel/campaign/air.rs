//! Density of the air: stated, or by the gas law.

use crate::error::{Error, Result, ensure, positive};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Gas constant of dry air, J/(kg·K).
const DRY_AIR: f64 = 287.058;
/// Gas constant of water vapour, J/(kg·K).
const VAPOUR: f64 = 461.523;
/// 0 °C, K.
const ZERO_CELSIUS: f64 = 273.15;

/// State of the air: either the density, or temperature and pressure.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Air {
    /// Density, kg/m³.
    pub density_kg_m3: Option<f64>,
    /// Temperature, °C.
    pub temperature_c: Option<f64>,
    /// Static pressure, Pa.
    pub pressure_pa: Option<f64>,
    /// Relative humidity, 0 to 1; left out, dry air.
    pub relative_humidity: Option<f64>,
}

impl Air {
    /// What `own` states, and what is common where it states nothing. A density of one's own puts temperature and
    /// pressure that are common out of force, and the other way round.
    pub(crate) fn over(own: Self, common: Self) -> Self {
        let by_gas_law = own.temperature_c.is_some() || own.pressure_pa.is_some();
        let by_density = own.density_kg_m3.is_some();
        let density = common.density_kg_m3.filter(|_| !by_gas_law);
        let temperature = common.temperature_c.filter(|_| !by_density);
        let pressure = common.pressure_pa.filter(|_| !by_density);
        Self {
            density_kg_m3: own.density_kg_m3.or(density),
            temperature_c: own.temperature_c.or(temperature),
            pressure_pa: own.pressure_pa.or(pressure),
            relative_humidity: own.relative_humidity.or(common.relative_humidity),
        }
    }

    /// Whether nothing is stated.
    pub(crate) fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Density `ρ = (p − e)/(R_d T) + e/(R_v T)`, kg/m³, with the vapour pressure `e = φ e_s(T)`, `e_s` after Buck (1996).
    ///
    /// # Errors
    /// [`Error::Input`] below `place` when neither a density nor temperature and pressure are stated, or both, or for
    /// values that air in a laboratory does not have.
    pub(crate) fn density(&self, place: &str) -> Result<f64> {
        let key = |name: &str| format!("{place}.{name}");
        match (self.density_kg_m3, self.temperature_c, self.pressure_pa) {
            (Some(density), None, None) => within(&key("density_kg_m3"), density, 0.1..=10.0),
            (None, Some(temperature), Some(pressure)) => {
                let t = within(&key("temperature_c"), temperature, -60.0..=100.0)?;
                // hPa instead of Pa would pass for a near vacuum
                let p = within(&key("pressure_pa"), pressure, 1e4..=1e6)?;
                let humidity = self.relative_humidity.unwrap_or(0.0);
                let humidity = within(&key("relative_humidity"), humidity, 0.0..=1.0)?;
                let saturated = 611.21 * ((18.678 - t / 234.5) * (t / (257.14 + t))).exp();
                let vapour = humidity * saturated;
                let kelvin = t + ZERO_CELSIUS;
                let dry = (p - vapour) / (DRY_AIR * kelvin);
                positive(place, dry + vapour / (VAPOUR * kelvin))
            }
            stated => {
                let found = match stated {
                    (Some(_), ..) => "both",
                    (None, None, None) => "neither",
                    _ => "one of temperature and pressure only",
                };
                let expected = "either density_kg_m3, or temperature_c and pressure_pa";
                Err(Error::input(place, expected, found))
            }
        }
    }
}

fn within(place: &str, value: f64, range: RangeInclusive<f64>) -> Result<f64> {
    let (least, most) = (range.start(), range.end());
    let expected = format_args!("a number from {least} to {most}");
    ensure(range.contains(&value), place, expected, value).map(|()| value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(temperature_c: f64, pressure_pa: f64, humidity: f64) -> Air {
        Air {
            temperature_c: Some(temperature_c),
            pressure_pa: Some(pressure_pa),
            relative_humidity: Some(humidity),
            ..Air::default()
        }
    }

    #[test]
    fn densities_are_those_of_tables() {
        // ISA sea level: 1.225 kg/m³ at 15 °C and 101 325 Pa, four digits printed
        let isa = state(15.0, 101_325.0, 0.0).density("air").unwrap();
        assert!((isa - 1.225).abs() < 5e-4, "{isa}");
        // CIPM-2007 at 20 °C, 101 325 Pa, 50 %: 1.1992 kg/m³, with carbon dioxide and compressibility that are left out here
        let moist = state(20.0, 101_325.0, 0.5).density("air").unwrap();
        assert!((moist - 1.1992).abs() < 1e-3, "{moist}");
    }

    #[test]
    fn impossible_air_is_refused() {
        let said = |air: Air| air.density("air").unwrap_err().to_string();
        assert_eq!(
            said(Air::default()),
            "air: expected either density_kg_m3, or temperature_c and pressure_pa, found neither"
        );
        assert_eq!(
            said(state(20.0, 1013.25, 0.0)),
            "air.pressure_pa: expected a number from 10000 to 1000000, found 1013.25"
        );
        assert_eq!(
            said(state(20.0, 101_325.0, 45.0)),
            "air.relative_humidity: expected a number from 0 to 1, found 45"
        );
        let mut both = state(20.0, 101_325.0, 0.0);
        both.density_kg_m3 = Some(1.2);
        assert!(said(both).ends_with("found both"));
        // one's own density puts the common temperature out of force
        let own = Air {
            density_kg_m3: Some(1.2),
            ..Air::default()
        };
        let common = state(20.0, 101_325.0, 0.0);
        assert_eq!(Air::over(own, common).density("air").unwrap(), 1.2);
        assert_eq!(Air::over(Air::default(), common), common);
    }
}
