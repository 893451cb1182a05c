//! Carrying out the plan of a virtual campaign.

use super::forces::{
    Drift, GustSamples, Kinematics, Wrench, gravity_and_inertia, noise, place_spike, readings,
    spike_at, wind_coefficients,
};
use super::plan::VirtualCampaignPlan;
use super::truth::{AppliedDisturbances, CampaignTruth, TruthPoint};
use crate::aerodynamics::derivatives::DerivativeTable;
use crate::aerodynamics::{Transfer, TransferMatrix};
use crate::error::Result;
use crate::section::Dof;
use crate::signal::{random_stream, root_mean_square};
use crate::units::ReducedFrequency;
use crate::wind_tunnel::virtual_forces::TransferColumn;
use crate::wind_tunnel::{RawCampaign, RawRecording, RawRun, Record};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// A raw campaign with the truth behind it.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualCampaign {
    /// What the load cells say.
    pub raw: RawCampaign,
    /// What they should have said.
    pub truth: CampaignTruth,
}

impl VirtualCampaignPlan {
    /// A campaign on a deck known by its derivatives, one run per motion among `dofs` and speed group of `table`.
    pub fn from_table(&self, table: &DerivativeTable, dofs: &[Dof]) -> Result<VirtualCampaign> {
        self.validate()?;
        let clean = |delay_s| self.tunnel.clean_from_table(table, dofs, delay_s);
        let records = clean(0.0)?;
        let late = clean(self.disturbances.force_lag_s)?;
        let mut points = Vec::new();
        for (i, record) in records.iter().enumerate() {
            let group = table.at_speed_group(i / dofs.len())?;
            let moving = dofs[i % dofs.len()];
            let at = TransferColumn::new(&group, dofs, moving)?;
            for (p, k) in at.k.iter().enumerate() {
                let column: Vec<_> = at.g.iter().map(|row| row[p]).collect();
                push_points(&mut points, record, moving, p, *k, &column);
            }
        }
        Ok(self.carry_out(&table.name, records, &late, points))
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
        let records = clean(0.0)?;
        let late = clean(self.disturbances.force_lag_s)?;
        let mut points = Vec::new();
        let dofs = model.dofs();
        for (i, record) in records.iter().enumerate() {
            let j = i % dofs.len();
            for (p, segment) in record.header.segments.iter().enumerate() {
                let speed = record.header.mean_speed_m_s;
                let k = ReducedFrequency::from_hertz(segment.frequency_hz, width_m, speed);
                let g: TransferMatrix = model.transfer(k)?;
                let column: Vec<_> = g.column(j).iter().copied().collect();
                push_points(&mut points, record, dofs[j], p, k, &column);
            }
        }
        Ok(self.carry_out(name, records, &late, points))
    }

    /// `late` holds the records as the force channels see them.
    fn carry_out(
        &self,
        section: &str,
        records: Vec<Record>,
        late: &[Record],
        points: Vec<TruthPoint>,
    ) -> VirtualCampaign {
        let header = records.first().map(|r| r.header.clone());
        let (mut runs, mut disturbances) = (Vec::new(), Vec::new());
        for (index, (record, late)) in records.iter().zip(late).enumerate() {
            let run = RunInMaking::new(self, index, record, late);
            runs.push(run.raw());
            disturbances.push(run.applied);
        }
        VirtualCampaign {
            raw: RawCampaign {
                section: section.to_owned(),
                source: header
                    .as_ref()
                    .map_or_else(String::new, |h| format!("virtual campaign; {}", h.source)),
                licence: header
                    .as_ref()
                    .map_or_else(String::new, |h| h.licence.clone()),
                rig: self.rig(header.map_or(0.0, |h| h.width_m)),
                forces: None,
                runs,
            },
            truth: CampaignTruth {
                records,
                points,
                disturbances,
            },
        }
    }
}

fn push_points(
    points: &mut Vec<TruthPoint>,
    record: &Record,
    motion: Dof,
    segment: usize,
    k: ReducedFrequency,
    column: &[nalgebra::Complex<f64>],
) {
    let header = &record.header;
    // broadband motions have no test points
    let Some(frequency_hz) = header.segments.get(segment).map(|s| s.frequency_hz) else {
        return;
    };
    for (force, g) in header.dofs.iter().zip(column) {
        points.push(TruthPoint {
            run: header.name.clone(),
            frequency_hz,
            k: k.full_width(),
            force: *force,
            motion,
            real: g.re,
            imaginary: g.im,
        });
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

/// The two recordings of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RecordingKind {
    Wind,
    Still,
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
                spike: d
                    .spike
                    .as_ref()
                    .and_then(|s| place_spike(s, record, forces, length)),
            },
        };
        run.applied.static_wind = run.wind_load(0.0, 0.0);
        run
    }

    fn raw(&self) -> RawRun {
        let header = &self.record.header;
        RawRun {
            name: header.name.clone(),
            in_wind: self.recording(RecordingKind::Wind),
            still_air: Some(self.recording(RecordingKind::Still)),
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
    fn random(&self, air: RecordingKind, purpose: u64) -> ChaCha8Rng {
        let stream = (2 * self.index as u64 + u64::from(air == RecordingKind::Still)) * 8 + purpose;
        random_stream(self.plan.tunnel.seed, stream)
    }

    /// Displacement and rates of the run `delay_s` late, one per sample.
    fn motion(&self, delay_s: f64) -> Vec<Kinematics> {
        let header = &self.record.header;
        let frequencies: Vec<f64> = header.segments.iter().map(|s| s.frequency_hz).collect();
        let tunnel = &self.plan.tunnel;
        let unit = tunnel.unit_motion(&frequencies, delay_s);
        let moving = header.dofs[self.index % header.dofs.len()];
        let amplitude = tunnel.amplitude(moving);
        let one = |x: &Vec<f64>, i: usize| {
            Dof::THREE.map(|d| if d == moving { amplitude * x[i] } else { 0.0 })
        };
        (0..unit.displacement.len())
            .map(|i| Kinematics {
                displacement: one(&unit.displacement, i),
                velocity: one(&unit.velocity, i),
                acceleration: one(&unit.acceleration, i),
            })
            .collect()
    }

    fn recording(&self, air: RecordingKind) -> RawRecording {
        let (what, offset_s) = match air {
            RecordingKind::Wind => ("in wind", 0.0),
            RecordingKind::Still => ("still air", self.applied.still_air_offset_s),
        };
        let header = &self.record.header;
        let seen = self.motion(offset_s);
        let felt = self.motion(offset_s + self.applied.force_lag_s);
        let travelled = header.mean_speed_m_s / header.sampling_hz;
        let gusts = match air {
            RecordingKind::Wind => self.plan.turbulence.as_ref(),
            RecordingKind::Still => None,
        };
        let gusts = GustSamples::new(gusts, seen.len(), travelled, &mut self.random(air, 0));
        RawRecording {
            source: format!("{}, {what}", header.name),
            sampling_hz: header.sampling_hz,
            motion: std::array::from_fn(|d| seen.iter().map(|k| k.displacement[d]).collect()),
            cells: self.cells(air, &felt, &gusts),
            wind_speed_m_s: self.wind_speed(air, &gusts),
        }
    }

    fn wind_speed(&self, air: RecordingKind, gusts: &GustSamples) -> Vec<f64> {
        let mean = match air {
            RecordingKind::Wind => self.record.header.mean_speed_m_s,
            RecordingKind::Still => 0.0,
        };
        let mut random = self.random(air, 1);
        let deviation = self.plan.disturbances.speed_noise_m_s;
        let mut one = |u: &f64| {
            let normal: f64 = StandardNormal.sample(&mut random);
            mean * (1.0 + u) + deviation * normal
        };
        gusts.u.iter().map(&mut one).collect()
    }

    fn cells(
        &self,
        air: RecordingKind,
        felt: &[Kinematics],
        gusts: &GustSamples,
    ) -> Vec<[Vec<f64>; 6]> {
        let drifts: [Drift; 2] = {
            let mut random = self.random(air, 2);
            std::array::from_fn(|_| Drift::new(&self.plan.disturbances, &mut random))
        };
        let mut random = self.random(air, 3);
        let mut cells = vec![std::array::from_fn(|_| Vec::with_capacity(felt.len())); 2];
        for (sample, state) in felt.iter().enumerate() {
            let mut wrench =
                gravity_and_inertia(&self.plan.model, self.plan.support.model_length_m, state);
            if air == RecordingKind::Wind {
                self.add_wind(&mut wrench, sample, gusts);
            }
            wrench.add(noise(self.applied.noise, &mut random));
            let said = readings(&self.plan.support, &wrench, state.displacement[2]);
            let part = sample as f64 / felt.len() as f64;
            for ((cell, said), drift) in cells.iter_mut().zip(said).zip(&drifts) {
                for (channel, value) in said.into_iter().enumerate() {
                    cell[channel].push(value + drift.at(channel, part));
                }
            }
        }
        cells
    }

    fn add_wind(&self, wrench: &mut Wrench, sample: usize, gusts: &GustSamples) {
        let [drag, lift, moment] = self.wind_load(gusts.u[sample], gusts.w[sample]);
        wrench.add(Wrench::section(drag, lift, moment));
        let length = self.plan.support.model_length_m;
        let excited = |dof| force_of(self.late, dof).map_or(0.0, |f| length * f[sample]);
        wrench.add(Wrench::section(
            excited(Dof::Lateral),
            excited(Dof::Vertical),
            excited(Dof::Torsion),
        ));
        if let Some(knock) = self
            .applied
            .spike
            .as_ref()
            .and_then(|s| spike_at(s, sample))
        {
            wrench.add(knock);
        }
    }
}

/// The self-excited force of a record in one degree of freedom, if it has it.
fn force_of(record: &Record, dof: Dof) -> Option<&[f64]> {
    let row = record.header.dofs.iter().position(|d| *d == dof)?;
    record.force.get(row).map(Vec::as_slice)
}
