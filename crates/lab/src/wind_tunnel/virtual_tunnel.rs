//! A virtual wind tunnel: forced-vibration records as in Table 3.2 of the thesis.
//!
//! A run is one motion (heave, sway or rotation) at one speed: rest, then every frequency in turn with smooth
//! ramps from and to rest. The forces come either
//!
//! - from a table of derivatives exactly at its test points: in each segment equation (1.14) with the numbers of
//!   that point, `q = Re(G) r + Im(G) r'/K`, with the actual ramped motion and its analytic rate; or
//! - from any transfer matrix `G(K)`: the exact linear response to the whole ramped motion, by Fourier transform
//!   of the motion padded with zeros.
//!
//! Broadband motions ([`TrainingMotion`]) need `G` at every frequency: a table then has to be interpolated, which the plan
//! must ask for.
//!
//! A table has a slightly different mean speed at each point, a record has one: that of the speed group. The
//! frequency of the segment is therefore `f = K V/(2πB)` with the point's own `K` and the record's `V`, within a
//! per cent of the frequency that was driven, and the dimensionless force is exactly `G` at the point's own `K`.

use super::records::{Record, RecordHeader};
use super::tunnel_plan::{TrainingMotion, TunnelPlan, UnitMotion};
use super::virtual_forces::{TransferColumn, unit_response};
use crate::aerodynamics::Transfer;
use crate::aerodynamics::derivatives::DerivativeTable;
use crate::error::{Result, positive};
use crate::section::Dof;
use crate::signal::{random_stream, root_mean_square};
use crate::units::ReducedFrequency;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

impl TunnelPlan {
    /// One record per motion and speed group of `table`, forces from its derivatives at its own test points.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for an impossible plan, or a table that lacks a derivative of `dofs`. Where derivatives of one motion
    /// were tested at different points, those of the first are taken and the others interpolated; the record says so.
    pub fn records_from_table(&self, table: &DerivativeTable, dofs: &[Dof]) -> Result<Vec<Record>> {
        let records = self.clean_from_table(table, dofs, 0.0)?;
        Ok(self.with_noise(records))
    }

    /// The same without noise, motion and forces `delay_s` late.
    pub(super) fn clean_from_table(
        &self,
        table: &DerivativeTable,
        dofs: &[Dof],
        delay_s: f64,
    ) -> Result<Vec<Record>> {
        self.validate()?;
        table.require(dofs)?;
        let speeds = self.speeds_of(table);
        let mut records = Vec::new();
        for (i, speed) in speeds.iter().enumerate() {
            let group = table.at_speed_group(i)?;
            if self.motion != TrainingMotion::default() {
                records.extend(self.interpolated_records(&group, dofs, *speed, delay_s)?);
                continue;
            }
            for motion in dofs {
                records.push(self.record_at_points(&group, dofs, *motion, *speed, delay_s)?);
            }
        }
        Ok(records)
    }

    /// One record per motion and speed of the plan, forces from the transfer matrix of `model` for a deck of `width_m`.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for an impossible plan or width, and a model that says nothing at a `K` from zero to
    /// that of half the sampling frequency.
    pub fn records_from_model(
        &self,
        model: &dyn Transfer,
        name: &str,
        width_m: f64,
    ) -> Result<Vec<Record>> {
        let records = self.clean_from_model(model, name, width_m, 0.0)?;
        Ok(self.with_noise(records))
    }

    /// The same without noise, motion and forces `delay_s` late.
    pub(super) fn clean_from_model(
        &self,
        model: &dyn Transfer,
        name: &str,
        width_m: f64,
        delay_s: f64,
    ) -> Result<Vec<Record>> {
        self.validate()?;
        positive("width_m", width_m)?;
        let mut records = Vec::new();
        for speed in &self.speeds_m_s {
            records.extend(self.records_at_speed(model, name, width_m, *speed, delay_s)?);
        }
        Ok(records)
    }

    /// One record per motion at one speed, without noise.
    pub(super) fn records_at_speed(
        &self,
        model: &dyn Transfer,
        name: &str,
        width_m: f64,
        speed_m_s: f64,
        delay_s: f64,
    ) -> Result<Vec<Record>> {
        let unit = self.unit_motion(&self.frequencies_hz, delay_s);
        let response = unit_response(model, &unit, self.sampling_hz, width_m / speed_m_s)?;
        let dofs = model.dofs();
        let record = |(j, motion): (usize, &Dof)| {
            let header = RecordHeader {
                source: format!("virtual tunnel: linear response of {name}"),
                licence: String::new(),
                ..self.header(name, dofs, *motion, width_m, speed_m_s, &unit)
            };
            self.record(header, *motion, &unit, |i, k| response[i][j][k])
        };
        Ok(dofs.iter().enumerate().map(record).collect())
    }

    /// Mean speeds of the records of a table, m/s. For a table without speeds the first of the plan is taken: its
    /// dimensionless forces are the same at every speed.
    fn speeds_of(&self, table: &DerivativeTable) -> Vec<f64> {
        match table.speed_groups() {
            none if none.is_empty() => self.speeds_m_s.iter().copied().take(1).collect(),
            speeds => speeds,
        }
    }

    /// What records of `table` take for granted; `None` when it says all that they need.
    pub fn assumption(&self, table: &DerivativeTable) -> Option<String> {
        table.speed_groups().is_empty().then(|| {
            let speed = self.speeds_m_s.first().copied().unwrap_or(f64::NAN);
            format!(
                "the table states no mean wind speeds: records of the virtual tunnel take {speed} m/s \
                 (tunnel.speeds_m_s) and the width {} m",
                table.width_m
            )
        })
    }

    /// Amplitude of a motion: m, rad.
    pub(super) fn amplitude(&self, motion: Dof) -> f64 {
        match motion {
            Dof::Vertical => self.vertical_amplitude_m,
            Dof::Lateral => self.lateral_amplitude_m,
            Dof::Torsion => self.torsion_amplitude_deg.to_radians(),
        }
    }

    fn header(
        &self,
        name: &str,
        dofs: &[Dof],
        motion: Dof,
        width_m: f64,
        speed_m_s: f64,
        unit: &UnitMotion,
    ) -> RecordHeader {
        RecordHeader {
            name: format!("{name}-{}-{speed_m_s:.2}", motion.name()),
            dofs: dofs.to_vec(),
            width_m,
            air_density_kg_m3: self.air_density_kg_m3,
            mean_speed_m_s: speed_m_s,
            sampling_hz: self.sampling_hz,
            segments: unit.segments.clone(),
            ..RecordHeader::default()
        }
    }

    /// The record of one motion, given the dimensionless force `unit_force(row, sample)` due to a dimensionless
    /// motion that is `unit`.
    fn record(
        &self,
        header: RecordHeader,
        motion: Dof,
        unit: &UnitMotion,
        unit_force: impl Fn(usize, usize) -> f64,
    ) -> Record {
        let amplitude = self.amplitude(motion);
        let samples = unit.displacement.len();
        let channel = |d: &Dof| match *d == motion {
            true => unit.displacement.iter().map(|x| amplitude * x).collect(),
            false => vec![0.0; samples],
        };
        let pressure = 0.5 * header.air_density_kg_m3 * header.mean_speed_m_s.powi(2);
        let dimensionless = amplitude * motion.motion_scale(header.width_m);
        let force = |(i, d): (usize, &Dof)| {
            let factor = pressure * d.force_scale(header.width_m) * dimensionless;
            (0..samples).map(|k| factor * unit_force(i, k)).collect()
        };
        Record {
            motion: header.dofs.iter().map(channel).collect(),
            force: header.dofs.iter().enumerate().map(force).collect(),
            header,
        }
    }

    fn record_at_points(
        &self,
        group: &DerivativeTable,
        dofs: &[Dof],
        motion: Dof,
        speed_m_s: f64,
        delay_s: f64,
    ) -> Result<Record> {
        let points = TransferColumn::new(group, dofs, motion)?;
        let frequency = |k: &ReducedFrequency| k.circular(group.width_m, speed_m_s) / TAU;
        let frequencies: Vec<f64> = points.k.iter().map(frequency).collect();
        self.check_sampling(&frequencies)?;
        let unit = self.unit_motion(&frequencies, delay_s);
        let at = match points.interpolated {
            true => "the test points of the first, the others interpolated",
            false => "their test points",
        };
        let assumption = self.assumption(group).map(|a| format!("; {a}"));
        let header = RecordHeader {
            source: format!(
                "virtual tunnel: derivatives of {} at {at} ({}){}",
                group.name,
                group.header.source,
                assumption.unwrap_or_default()
            ),
            licence: group.header.licence.clone(),
            ..self.header(&group.name, dofs, motion, group.width_m, speed_m_s, &unit)
        };
        let force = |row: usize, sample: usize| {
            unit.segment_of[sample].map_or(0.0, |segment| {
                let g = points.g[row][segment];
                let in_quadrature = unit.velocity[sample] / (TAU * frequencies[segment]);
                g.re * unit.displacement[sample] + g.im * in_quadrature
            })
        };
        Ok(self.record(header, motion, &unit, force))
    }

    /// White noise on every record.
    fn with_noise(&self, mut records: Vec<Record>) -> Vec<Record> {
        for (index, record) in records.iter_mut().enumerate() {
            self.add_noise(record, index);
        }
        records
    }

    /// Noise on every force of record number `index`; each record draws from a stream of its own.
    pub fn add_noise(&self, record: &mut Record, index: usize) {
        if self.noise_fraction == 0.0 {
            return;
        }
        let mut random = random_stream(self.seed, index as u64);
        // e[k] = a e[k−1] + √(1 − a²) n[k], the samples of noise with an exponential correlation
        let memory = match self.noise_correlation_s > 0.0 {
            true => (-1.0 / (self.sampling_hz * self.noise_correlation_s)).exp(),
            false => 0.0,
        };
        let fresh = (1.0 - memory * memory).sqrt();
        for force in &mut record.force {
            let deviation = self.noise_fraction * root_mean_square(force);
            let mut noise: f64 = StandardNormal.sample(&mut random);
            for (k, f) in force.iter_mut().enumerate() {
                if k > 0 {
                    let normal: f64 = StandardNormal.sample(&mut random);
                    noise = memory * noise + fresh * normal;
                }
                *f += deviation * noise;
            }
        }
    }
}

#[cfg(test)]
mod tests;
