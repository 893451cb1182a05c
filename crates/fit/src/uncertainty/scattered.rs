//! A virtual campaign whose truth differs between mean speeds and between runs.

use crate::aerodynamics::{Transfer, TransferMatrix};
use crate::error::Result;
use crate::section::Dof;
use crate::signal::random_stream;
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{Record, TunnelPlan};
use nalgebra::Complex;
use rand_distr::{Distribution, StandardNormal};

/// Stream of the truth's random numbers; the records' noise has the streams from zero.
const STREAM: u64 = 1 << 40;

/// Records without noise, and the same with every force turned by a right angle: together they make records of
/// transfer functions of other size and phase.
pub(super) struct ScatteredTunnel {
    /// Records of the truth itself.
    pub(super) straight: Vec<Record>,
    turned: Vec<Record>,
    /// Standard deviation of every transfer function between speeds, relative, in size and in phase.
    speeds: f64,
    /// The same of all forces of a run together.
    runs: f64,
}

/// `i G(K)`.
struct QuarterTurned<'a>(&'a dyn Transfer);

impl Transfer for QuarterTurned<'_> {
    fn dofs(&self) -> &[Dof] {
        self.0.dofs()
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        Ok(self.0.transfer(k)? * Complex::i())
    }
}

impl ScatteredTunnel {
    /// For a plan without noise.
    pub(crate) fn new(
        quiet: &TunnelPlan,
        model: &dyn Transfer,
        width_m: f64,
        speeds: f64,
        runs: f64,
    ) -> Result<Self> {
        let straight = quiet.records_from_model(model, "truth", width_m)?;
        let turned = if speeds > 0.0 || runs > 0.0 {
            quiet.records_from_model(&QuarterTurned(model), "truth", width_m)?
        } else {
            Vec::new()
        };
        Ok(Self {
            straight,
            turned,
            speeds,
            runs,
        })
    }

    /// Records of one campaign.
    pub(crate) fn draw(&self, seed: u64) -> Vec<Record> {
        let mut records = self.straight.clone();
        let mut random = random_stream(seed, STREAM);
        let mut factor = |deviation: f64| {
            let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
            Complex::new(deviation * normal(), deviation * normal())
        };
        for (record, turned) in records.iter_mut().zip(&self.turned) {
            let run = factor(self.runs);
            for (force, turned) in record.force.iter_mut().zip(&turned.force) {
                // one motion per record: each force of a record is a transfer function of its own at that speed
                let change = factor(self.speeds) + run;
                for (f, t) in force.iter_mut().zip(turned) {
                    *f += change.re * *f + change.im * t;
                }
            }
        }
        records
    }
}
