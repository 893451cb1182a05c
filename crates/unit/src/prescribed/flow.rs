//! The air around strips.

/// The air around one strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripFlow {
    /// Width `B`, m.
    pub width_m: f64,
    /// Mean wind speed at the strip over that which [`PrescribedForces::take`](super::PrescribedForces::take) is told.
    pub wind_factor: f64,
}

impl StripFlow {
    /// The air that passes the strip in this mean wind (m/s), of this density (kg/m³).
    pub fn in_air(&self, mean_wind_m_s: f64, density_kg_m3: f64) -> Airflow {
        Airflow {
            wind_m_s: mean_wind_m_s * self.wind_factor,
            width_m: self.width_m,
            density_kg_m3,
        }
    }
}

/// The air that passes a strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Airflow {
    /// Wind speed there, m/s.
    pub wind_m_s: f64,
    /// Width of the deck, m.
    pub width_m: f64,
    /// kg/m³.
    pub density_kg_m3: f64,
}
