//! Carrying out the plan of a virtual campaign.

use super::forces::{
    drift, gravity_and_inertia, gusts, noise, place_spike, readings, section_wrench, spike_at,
    wind_coefficients,
};
use super::plan::{AppliedDisturbances, TruthPoint, VirtualCampaignPlan};
use crate::aerodynamics::Transfer;
use crate::aerodynamics::derivatives::DerivativeTable;
use crate::error::Result;
use crate::section::Dof;
use crate::signal::{random_stream, root_mean_square};
use crate::units::ReducedFrequency;
use crate::wind_tunnel::virtual_forces::TransferColumn;
use crate::wind_tunnel::{RawCampaign, RawRecording, RawRun, Record, RecordHeader, Segment};
use nalgebra::Complex;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::PI;

/// A raw campaign with the truth behind it: what processing should find, and what it should take away.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualCampaign {
    /// What the load cells say.
    pub raw: RawCampaign,
    /// Motion and self-excited force of each run as in wind, per unit length, without lag, noise or anything else;
    /// in the order of the runs.
    pub records: Vec<Record>,
    /// `G` at every test point.
    pub points: Vec<TruthPoint>,
    /// What was applied to each run, in the order of the runs.
    pub disturbances: Vec<AppliedDisturbances>,
}

impl VirtualCampaignPlan {
    /// A campaign on a deck known by its derivatives, one run per motion among `dofs` and speed group of `table`.
    pub fn from_table(&self, table: &DerivativeTable, dofs: &[Dof]) -> Result<VirtualCampaign> {
        self.validate()?;
        let clean = |delay_s| self.tunnel.clean_from_table(table, dofs, delay_s);
        self.carry_out(&table.name, dofs, clean, |i, _| {
            let group = table.at_speed_group(i / dofs.len())?;
            let at = TransferColumn::new(&group, dofs, dofs[i % dofs.len()])?;
            let column = |p: usize| at.g.iter().map(|row| row[p]).collect();
            let points = at.k.iter().enumerate();
            Ok(points.map(|(p, k)| (*k, column(p))).collect())
        })
    }

    /// A campaign on a deck of `width_m` with the forces of `model`, one run per motion and speed of the plan.
    pub fn from_model(
        &self,
        model: &dyn Transfer,
        name: &str,
        width_m: f64,
    ) -> Result<VirtualCampaign> {
        self.validate()?;
        let clean = |delay_s| self.tunnel.clean_from_model(model, name, width_m, delay_s);
        let dofs = model.dofs();
        self.carry_out(name, dofs, clean, |i, header| {
            let at = |segment: &Segment| {
                let speed = header.mean_speed_m_s;
                let k = ReducedFrequency::from_hertz(segment.frequency_hz, width_m, speed);
                let g = model.transfer(k)?;
                Ok((k, g.column(i % dofs.len()).iter().copied().collect()))
            };
            header.segments.iter().map(at).collect()
        })
    }

    /// Records of motions among `dofs` by `clean`, given by how much the force channels are late; `points` says for each record, by its
    /// number and its header, at which reduced frequencies it was tested and the column of `G` there.
    fn carry_out(
        &self,
        section: &str,
        dofs: &[Dof],
        clean: impl Fn(f64) -> Result<Vec<Record>>,
        points_of: impl Fn(usize, &RecordHeader) -> Result<Vec<(ReducedFrequency, Vec<Complex<f64>>)>>,
    ) -> Result<VirtualCampaign> {
        let records = clean(0.0)?;
        let late = clean(self.disturbances.force_lag_s)?;
        let mut points = Vec::new();
        for (i, record) in records.iter().enumerate() {
            let header = &record.header;
            // broadband motions have no test points
            for ((k, column), segment) in points_of(i, header)?.iter().zip(&header.segments) {
                let point = |(force, g): (&Dof, &Complex<f64>)| TruthPoint {
                    run: header.name.clone(),
                    frequency_hz: segment.frequency_hz,
                    k: k.full_width(),
                    force: *force,
                    motion: dofs[i % dofs.len()],
                    real: g.re,
                    imaginary: g.im,
                };
                points.extend(header.dofs.iter().zip(column).map(point));
            }
        }
        let (mut runs, mut disturbances) = (Vec::new(), Vec::new());
        for (index, (record, late)) in records.iter().zip(&late).enumerate() {
            let run = RunInMaking::new(self, index, record, late);
            runs.push(run.raw());
            disturbances.push(run.applied);
        }
        let header = records.first().map(|r| &r.header);
        let source = |h: &RecordHeader| format!("virtual campaign; {}", h.source);
        Ok(VirtualCampaign {
            raw: RawCampaign {
                section: section.to_owned(),
                source: header.map(source).unwrap_or_default(),
                licence: header.map(|h| h.licence.clone()).unwrap_or_default(),
                rig: self.rig(header.map_or(0.0, |h| h.width_m)),
                forces: None,
                runs,
                findings: Vec::new(),
            },
            records,
            points,
            disturbances,
        })
    }
}

/// One run and what it needs.
struct RunInMaking<'a> {
    plan: &'a VirtualCampaignPlan,
    index: usize,
    record: &'a Record,
    late: &'a Record,
    applied: AppliedDisturbances,
}

impl<'a> RunInMaking<'a> {
    fn new(
        plan: &'a VirtualCampaignPlan,
        index: usize,
        record: &'a Record,
        late: &'a Record,
    ) -> Self {
        let d = &plan.disturbances;
        let forces = [Dof::Lateral, Dof::Vertical, Dof::Torsion].map(|d| force_of(record, d));
        let length = plan.support.model_length_m;
        let rms = |force: Option<&[f64]>| root_mean_square(force.unwrap_or(&[]));
        let spike = d.spike.as_ref();
        let mut run = Self {
            plan,
            index,
            record,
            late,
            applied: AppliedDisturbances {
                run: record.header.name.clone(),
                static_wind: [0.0; 3],
                noise: forces.map(|f| plan.tunnel.noise_fraction * length * rms(f)),
                force_lag_s: d.force_lag_s,
                still_air_offset_s: d.still_air_offset_s,
                spike: spike.and_then(|s| place_spike(s, record, forces, length)),
            },
        };
        run.applied.static_wind = run.wind_load(0.0, 0.0);
        run
    }

    fn raw(&self) -> RawRun {
        let header = &self.record.header;
        RawRun {
            name: header.name.clone(),
            motion: self.record.moving().collect(),
            in_wind: self.recording(true),
            still_air: Some(self.recording(false)),
            mean_speed_m_s: header.mean_speed_m_s,
            air_density_kg_m3: header.air_density_kg_m3,
        }
    }

    /// Drag, lift (N) and moment (N·m) of the wind on the whole model that rests; gusts over the mean speed.
    fn wind_load(&self, u: f64, w: f64) -> [f64; 3] {
        let h = &self.record.header;
        let pressure = 0.5 * h.air_density_kg_m3 * h.mean_speed_m_s.powi(2);
        let area = pressure * h.width_m * self.plan.support.model_length_m;
        let [drag, lift, moment] = wind_coefficients(&self.plan.static_wind, u, w);
        [area * drag, area * lift, area * h.width_m * moment]
    }

    /// Each purpose in each recording of each run draws from a stream of its own.
    fn random(&self, in_wind: bool, purpose: u64) -> ChaCha8Rng {
        let stream = (2 * self.index as u64 + u64::from(!in_wind)) * 8 + purpose;
        random_stream(self.plan.tunnel.seed, stream)
    }

    /// Displacement, velocity and acceleration of the three motions of the run `delay_s` late, one per sample.
    fn motion(&self, delay_s: f64) -> Vec<[[f64; 3]; 3]> {
        let header = &self.record.header;
        let frequencies: Vec<f64> = header.segments.iter().map(|s| s.frequency_hz).collect();
        let tunnel = &self.plan.tunnel;
        let unit = tunnel.unit_motion(&frequencies, delay_s);
        let moving = header.dofs[self.index % header.dofs.len()];
        let amplitude = tunnel.amplitude(moving);
        let at = |i: usize| {
            let rates = [&unit.displacement, &unit.velocity, &unit.acceleration];
            rates.map(|x| Dof::THREE.map(|d| if d == moving { amplitude * x[i] } else { 0.0 }))
        };
        (0..unit.displacement.len()).map(at).collect()
    }

    /// The recording in wind, or the one of the same motion in still air.
    fn recording(&self, in_wind: bool) -> RawRecording {
        let (what, offset_s, turbulence) = match in_wind {
            true => ("in wind", 0.0, self.plan.turbulence.as_ref()),
            false => ("still air", self.applied.still_air_offset_s, None),
        };
        let header = &self.record.header;
        let seen = self.motion(offset_s);
        let felt = self.motion(offset_s + self.applied.force_lag_s);
        let travelled = header.mean_speed_m_s / header.sampling_hz;
        let mut random = self.random(in_wind, 0);
        let gusts = gusts(turbulence, seen.len(), travelled, &mut random);
        RawRecording {
            source: format!("{}, {what}", header.name),
            sampling_hz: header.sampling_hz,
            motion: std::array::from_fn(|d| seen.iter().map(|[x, ..]| x[d]).collect()),
            cells: self.cells(in_wind, &felt, &gusts),
            wind_speed_m_s: self.wind_speed(in_wind, &gusts[0]),
            channels: Vec::new(),
        }
    }

    /// The channel of the wind speed with the gusts `u`.
    fn wind_speed(&self, in_wind: bool, u: &[f64]) -> Vec<f64> {
        let mean = match in_wind {
            true => self.record.header.mean_speed_m_s,
            false => 0.0,
        };
        let mut random = self.random(in_wind, 1);
        let deviation = self.plan.disturbances.speed_noise_m_s;
        let mut one = |u: &f64| {
            let normal: f64 = StandardNormal.sample(&mut random);
            mean * (1.0 + u) + deviation * normal
        };
        u.iter().map(&mut one).collect()
    }

    fn cells(
        &self,
        in_wind: bool,
        felt: &[[[f64; 3]; 3]],
        gusts: &[Vec<f64>; 2],
    ) -> Vec<[Vec<f64>; 6]> {
        let plan = self.plan;
        let mut random = self.random(in_wind, 2);
        let drifts: [_; 2] = std::array::from_fn(|_| drift(&plan.disturbances, &mut random));
        let mut random = self.random(in_wind, 3);
        let mut cells = vec![std::array::from_fn(|_| Vec::with_capacity(felt.len())); 2];
        for (sample, state) in felt.iter().enumerate() {
            let mut wrench = gravity_and_inertia(&plan.model, plan.support.model_length_m, state);
            if in_wind {
                let [u, w] = gusts.each_ref().map(|g| g[sample]);
                wrench += section_wrench(self.wind_load(u, w));
                wrench += section_wrench(self.excited(sample));
                let spike = self.applied.spike.as_ref();
                if let Some(knock) = spike.and_then(|s| spike_at(s, sample)) {
                    wrench += knock;
                }
            }
            wrench += noise(self.applied.noise, &mut random);
            let said = readings(&plan.support, &wrench, state[0][2]);
            let part = sample as f64 / felt.len() as f64;
            for ((cell, said), drift) in cells.iter_mut().zip(said).zip(&drifts) {
                for ((channel, value), [rise, wave]) in cell.iter_mut().zip(said).zip(drift) {
                    channel.push(value + (rise * part + wave * (PI * part).sin()));
                }
            }
        }
        cells
    }

    /// Drag, lift (N) and moment (N·m) that the motion excites on the whole model, as the force channels see them.
    fn excited(&self, sample: usize) -> [f64; 3] {
        let length = self.plan.support.model_length_m;
        let excited = |dof| force_of(self.late, dof).map_or(0.0, |f| length * f[sample]);
        [Dof::Lateral, Dof::Vertical, Dof::Torsion].map(excited)
    }
}

/// The self-excited force of a record in one degree of freedom, if it has it.
fn force_of(record: &Record, dof: Dof) -> Option<&[f64]> {
    let row = record.header.dofs.iter().position(|d| *d == dof)?;
    record.force.get(row).map(Vec::as_slice)
}
