//! Onset and divergence of an exported bridge.

use super::bridge_built::Built;
use crate::aerodynamics::Transfer;
use crate::flutter::{FlutterSearch, OnsetSearch, divergence_speed, find_onset};
use crate::fmu::variables::Calculated;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};

/// Speeds of the search for the onset; more than for a section would take seconds.
const SPEEDS: usize = 60;

/// What a search found.
#[derive(Debug)]
pub(super) struct Found {
    values: [f64; 8],
    /// What a user should know of it.
    pub notices: Vec<String>,
}

impl Found {
    /// Searches up to `limit`, m/s. A search that fails is no reason to end a run.
    pub fn search(built: &Built, tested: Option<ReducedFrequencyRange>, limit: f64) -> Self {
        let mut found = Self {
            values: [0.0; 8],
            notices: Vec::new(),
        };
        found.set(Calculated::OnsetSpeed, limit);
        found.set(Calculated::DivergenceSpeed, limit);
        found.onset(built, tested, limit);
        found.divergence(built, limit);
        found
    }

    /// One of the numbers.
    pub fn value(&self, which: Calculated) -> f64 {
        self.values[which as usize]
    }

    fn set(&mut self, which: Calculated, value: f64) {
        self.values[which as usize] = value;
    }

    fn onset(&mut self, built: &Built, tested: Option<ReducedFrequencyRange>, limit: f64) {
        let search = OnsetSearch {
            speed_max_m_s: limit,
            speeds: SPEEDS,
        };
        match find_onset("bridge", built.stepper.section(), &search, None) {
            Ok(FlutterSearch::Onset(o)) => {
                self.set(Calculated::OnsetSpeed, o.at.speed_m_s);
                self.set(Calculated::OnsetFrequency, o.at.frequency_hz);
                let reduced = o.at.reduced_velocity.v_star();
                self.set(Calculated::OnsetReducedVelocity, reduced);
                self.set(Calculated::OnsetFound, 1.0);
                let inside = tested.is_some_and(|r| r.contains(o.at.reduced_frequency));
                let flag = f64::from(u8::from(inside));
                self.set(Calculated::OnsetInTestedRange, flag);
                self.set(Calculated::StableBelowOnset, 1.0);
                self.notices.extend(o.warnings);
            }
            Ok(FlutterSearch::UnstableAtOrBelow(start)) => {
                self.set(Calculated::OnsetSpeed, start.at.speed_m_s);
                self.set(Calculated::OnsetFrequency, start.at.frequency_hz);
                self.set(Calculated::OnsetFound, 1.0);
                self.notices.push(format!(
                    "the onset lies at {:.3} m/s or lower: {}",
                    start.at.speed_m_s, start.reason
                ));
            }
            Ok(FlutterSearch::StableUpTo(_)) => self.set(Calculated::StableBelowOnset, 1.0),
            Err(why) => self
                .notices
                .push(format!("flutter onset is not known: {why}")),
        }
    }

    fn divergence(&mut self, built: &Built, limit: f64) {
        let still = ReducedFrequency::from_full_width(0.0);
        let structure = built.stepper.section().structure();
        let forces = built.bridge.forces().transfer(still);
        match forces.and_then(|g| divergence_speed(structure, &g)) {
            Ok(Some(speed)) if speed <= limit => {
                self.set(Calculated::DivergenceSpeed, speed);
                self.set(Calculated::DivergenceFound, 1.0);
            }
            Ok(_) => {}
            Err(why) => self.notices.push(format!("divergence is not known: {why}")),
        }
    }
}
