//! The onset of a bridge whose frequencies, damping and derivatives scatter (Monte Carlo).

use super::{BridgeStudy, coupled};
use crate::aerodynamics::{
    ContinuousRealization, Realizable, Realization, Transfer, TransferMatrix,
};
use crate::bridge::Bridge;
use crate::error::{Error, Result, non_negative};
use crate::flutter::{NearbyOnset, Onset, OnsetSearch, find_onset};
use crate::section::Dof;
use crate::signal::random_stream;
use crate::units::ReducedFrequency;
use nalgebra::DMatrix;
use rand::Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;

/// Samples at most.
const MOST_SAMPLES: usize = 1_000_000;

/// Standard deviations over the mean; every mode and every entry of the force matrices scatters by itself.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Scatter {
    /// Of the frequencies, normal.
    pub frequency: f64,
    /// Of the damping ratios, log-normal.
    pub damping: f64,
    /// Of each entry of the matrix of self-excited forces, normal: the derivatives of one force by one motion together.
    pub derivatives: f64,
    /// Number of samples.
    pub samples: usize,
    /// Seed.
    pub seed: u64,
}

/// Distribution of the onset.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ScatteredOnset {
    /// What scattered.
    pub scatter: Scatter,
    /// Mean, m/s.
    pub mean_m_s: f64,
    /// Standard deviation, m/s.
    pub standard_deviation_m_s: f64,
    /// 95 % of the samples lie between these, m/s.
    pub interval_m_s: [f64; 2],
    /// Samples without an onset up to the highest wind speed; they are not in the numbers above.
    pub without_onset: usize,
}

impl BridgeStudy {
    /// The onset when frequencies, damping and forces scatter: that of the mode which flutters in the mean, followed in every
    /// sample from the onset of the mean; where it cannot be followed the onset is searched.
    ///
    /// # Errors
    /// [`Error::Input`] for scatter that cannot be; those of the forces; [`Error::Numerical`] when fewer than two samples have an
    /// onset.
    pub fn scattered_onset(&self, onset: &Onset, scatter: &Scatter) -> Result<ScatteredOnset> {
        non_negative("scatter of the frequencies", scatter.frequency)?;
        non_negative("scatter of the damping", scatter.damping)?;
        non_negative("scatter of the derivatives", scatter.derivatives)?;
        if !(2..=MOST_SAMPLES).contains(&scatter.samples) {
            return Err(Error::input(
                "samples",
                format!("2 to {MOST_SAMPLES}"),
                scatter.samples.to_string(),
            ));
        }
        let nearby = NearbyOnset::of(&self.by_model, &onset.at)?;
        let found = (0..scatter.samples)
            .into_par_iter()
            .map(|i| self.onset_of_sample(&nearby, scatter, i as u64))
            .collect::<Result<Vec<_>>>()?;
        let mut speeds: Vec<f64> = found.iter().copied().flatten().collect();
        if speeds.len() < 2 {
            return Err(Error::Numerical(
                "scatter: fewer than two samples have an onset".into(),
            ));
        }
        speeds.sort_by(f64::total_cmp);
        let count = speeds.len() as f64;
        let mean = speeds.iter().sum::<f64>() / count;
        let square = speeds.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let quantile = |p: f64| speeds[((count - 1.0) * p).round() as usize];
        Ok(ScatteredOnset {
            scatter: *scatter,
            mean_m_s: mean,
            standard_deviation_m_s: square.sqrt(),
            interval_m_s: [quantile(0.025), quantile(0.975)],
            without_onset: found.len() - speeds.len(),
        })
    }

    /// The onset of one sample, m/s: from nearby, else by a search.
    fn onset_of_sample(
        &self,
        nearby: &NearbyOnset,
        scatter: &Scatter,
        index: u64,
    ) -> Result<Option<f64>> {
        let other = coupled(&self.sample(scatter, index)?)?;
        if let Some((speed, _)) = nearby.find(&other) {
            return Ok(Some(speed));
        }
        let search = OnsetSearch {
            speed_max_m_s: self.file.flutter.speed_max_m_s,
            speeds: self.file.flutter.speeds,
        };
        let found = find_onset("sample", &other, &search, self.tested_range())?;
        Ok(found.critical_speed_m_s())
    }

    fn sample(&self, scatter: &Scatter, index: u64) -> Result<Bridge> {
        let mut random = random_stream(scatter.seed, index);
        let mut normal = || -> f64 { random.sample(StandardNormal) };
        let mut bridge = self.by_model.clone();
        // a log-normal factor of mean one
        let spread = (1.0 + scatter.damping * scatter.damping).ln();
        for mode in &mut bridge.modes {
            mode.frequency_hz *= 1.0 + scatter.frequency * normal();
            mode.damping_ratio *= (spread.sqrt() * normal() - 0.5 * spread).exp();
            crate::error::positive("scattered frequency", mode.frequency_hz)?;
        }
        if scatter.derivatives > 0.0 {
            for group in &mut bridge.groups {
                let n = group.forces.dofs().len();
                let factors = DMatrix::from_fn(n, n, |_, _| 1.0 + scatter.derivatives * normal());
                group.forces = Arc::new(Scaled::of(group.forces.as_ref(), &factors)?);
            }
        }
        Ok(bridge)
    }
}

/// Forces whose entries are multiplied by a factor each.
struct Scaled {
    dofs: Vec<Dof>,
    realization: Realization,
}

impl Scaled {
    fn of(forces: &dyn Transfer, factors: &DMatrix<f64>) -> Result<Self> {
        let unfit = || {
            Error::input(
                "scatter of the derivatives",
                "forces with filters of single motions",
                "others",
            )
        };
        let Some(Realization::Continuous(r)) = forces.realizable().map(Realizable::realize) else {
            return Err(unfit());
        };
        let mut c = r.c.clone();
        for (l, mut column) in c.column_iter_mut().enumerate() {
            let motion = driver(&r, l).ok_or_else(unfit)?;
            column.component_mul_assign(&factors.column(motion));
        }
        Ok(Self {
            dofs: forces.dofs().to_vec(),
            realization: Realization::Continuous(ContinuousRealization {
                c,
                e0: r.e0.component_mul(factors),
                e1: r.e1.component_mul(factors),
                e2: r.e2.component_mul(factors),
                ..r
            }),
        })
    }
}

/// The one motion that drives a filter.
fn driver(r: &ContinuousRealization, filter: usize) -> Option<usize> {
    let mut motions = (0..r.b.ncols()).filter(|j| r.b[(filter, *j)] != 0.0);
    motions.next().filter(|_| motions.next().is_none())
}

impl Transfer for Scaled {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        self.realization.transfer(k)
    }

    fn realizable(&self) -> Option<&dyn Realizable> {
        Some(self)
    }
}

impl Realizable for Scaled {
    fn realize(&self) -> Realization {
        self.realization.clone()
    }
}
