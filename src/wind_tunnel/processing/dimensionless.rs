//! Dimensionless records, resampled to one step and stacked.
//!
//! `s = Vt/B` (3.2), `q = F/(½ρV²B)`, `M/(½ρV²B²)` per unit length ((3.3) and (3.4) with the ½ of (1.17)), `r = (y/B, x/B, θ)`. The
//! step `Δs = VΔt/B` differs from speed to speed; a discrete model needs one. Records of a shorter step are filtered (zero phase,
//! four fifths of the new Nyquist frequency) and read off at the longest one by six-point interpolation.

use crate::error::{Error, Result, positive};
use crate::section::Dof;
use crate::signal::{ButterworthLowPass, value_at};
use crate::wind_tunnel::Record;
use serde::{Deserialize, Serialize};

/// Order of the filter before resampling.
const ORDER: usize = 6;
/// Its cut-off over the new sampling frequency.
const CUTOFF: f64 = 0.4;

/// A record, or several end to end, without dimensions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DimensionlessRecord {
    /// Degrees of freedom, in the order of the channels.
    pub dofs: Vec<Dof>,
    /// `Δs = VΔt/B`.
    pub delta_s: f64,
    /// `r`, one vector a degree of freedom.
    pub motion: Vec<Vec<f64>>,
    /// `q`, one vector a degree of freedom.
    pub force: Vec<Vec<f64>>,
    /// First sample of each record that was stacked.
    pub starts: Vec<usize>,
}

/// A record in dimensionless form, at its own step.
///
/// # Errors
/// [`Error::Input`] for a header with numbers that are not positive.
pub fn dimensionless(record: &Record) -> Result<DimensionlessRecord> {
    let h = &record.header;
    let place = |key: &str| format!("record {}: {key}", h.name);
    let width = positive(&place("width_m"), h.width_m)?;
    let speed = positive(&place("mean_speed_m_s"), h.mean_speed_m_s)?;
    let density = positive(&place("air_density_kg_m3"), h.air_density_kg_m3)?;
    let sampling = positive(&place("sampling_hz"), h.sampling_hz)?;
    let pressure = 0.5 * density * speed * speed;
    let scaled = |channels: &[Vec<f64>], factor: &dyn Fn(Dof) -> f64| {
        let one = |(d, x): (&Dof, &Vec<f64>)| x.iter().map(|v| v * factor(*d)).collect();
        h.dofs.iter().zip(channels).map(one).collect()
    };
    Ok(DimensionlessRecord {
        dofs: h.dofs.clone(),
        delta_s: speed / (width * sampling),
        motion: scaled(&record.motion, &|d| d.motion_scale(width)),
        force: scaled(&record.force, &|d| 1.0 / (pressure * d.force_scale(width))),
        starts: vec![0],
    })
}

impl DimensionlessRecord {
    /// The same record at a longer step; at its own step it is returned as it is.
    ///
    /// # Errors
    /// [`Error::Input`] for a step shorter than its own.
    pub fn resampled(&self, delta_s: f64) -> Result<Self> {
        let ratio = delta_s / self.delta_s;
        // a step equal but for rounding is the same step
        if (ratio - 1.0).abs() < 1e-9 {
            return Ok(self.clone());
        }
        if !(ratio.is_finite() && ratio > 1.0) {
            let expected = format!("at least the record's own, {}", self.delta_s);
            return Err(Error::input("delta_s", expected, delta_s.to_string()));
        }
        let filter = ButterworthLowPass::new(ORDER, CUTOFF / ratio, 1.0)?;
        let one = |x: &Vec<f64>| -> Result<Vec<f64>> {
            let smooth = filter.zero_phase(x)?;
            let count = ((x.len() as f64 - 1.0) / ratio) as usize + 1;
            Ok((0..count)
                .map(|m| value_at(&smooth, m as f64 * ratio))
                .collect())
        };
        let all = |channels: &[Vec<f64>]| channels.iter().map(one).collect::<Result<Vec<_>>>();
        Ok(Self {
            dofs: self.dofs.clone(),
            delta_s,
            motion: all(&self.motion)?,
            force: all(&self.force)?,
            starts: self
                .starts
                .iter()
                .map(|s| (*s as f64 / ratio).ceil() as usize)
                .collect(),
        })
    }
}

/// All records in one, at the longest of their steps.
///
/// # Errors
/// [`Error::Input`] for no records, or records of different degrees of freedom.
pub fn stack(records: &[Record]) -> Result<DimensionlessRecord> {
    let all = records
        .iter()
        .map(dimensionless)
        .collect::<Result<Vec<_>>>()?;
    let longest = all.iter().map(|r| r.delta_s).fold(0.0, f64::max);
    let mut parts = all.iter();
    let Some(first) = parts.next() else {
        return Err(Error::input("records", "at least one", "none"));
    };
    let mut stacked = first.resampled(longest)?;
    for (record, part) in records[1..].iter().zip(parts) {
        if part.dofs != stacked.dofs {
            return Err(Error::input(
                format!("record {}: dofs", record.header.name),
                format!("{:?}, as in the first record", stacked.dofs),
                format!("{:?}", part.dofs),
            ));
        }
        let part = part.resampled(longest)?;
        stacked
            .starts
            .push(stacked.motion.first().map_or(0, Vec::len));
        for (to, from) in stacked.motion.iter_mut().zip(part.motion) {
            to.extend(from);
        }
        for (to, from) in stacked.force.iter_mut().zip(part.force) {
            to.extend(from);
        }
    }
    Ok(stacked)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::FlatPlate;
    use crate::wind_tunnel::TunnelPlan;

    #[test]
    fn stacked_records_have_one_step_and_the_same_harmonics() {
        let plan = TunnelPlan {
            speeds_m_s: vec![8.0, 4.0],
            frequencies_hz: vec![2.0],
            ..TunnelPlan::default()
        };
        let records = plan
            .records_from_model(&FlatPlate::default(), "plate", 0.5)
            .unwrap();
        let stacked = stack(&records).unwrap();
        assert_eq!(stacked.delta_s, 8.0 / 0.5 / 200.0);
        assert_eq!(stacked.starts.len(), 4);
        // record 2 is heave at 4 m/s, read off every second sample
        let own = dimensionless(&records[2]).unwrap();
        let from = stacked.starts[2];
        for m in 500..3000 {
            let (a, b) = (stacked.force[0][from + m], own.force[0][2 * m]);
            // the filter passes 2 Hz to 1e-13, but not the corners of a ramp, whose third derivative jumps
            assert!((a - b).abs() < 2e-8, "{m}: {a} {b}");
        }
        assert!(own.resampled(0.5 * own.delta_s).is_err());
        assert!(stack(&[]).is_err());
    }
}
