//! What is run: for how long, in which wind, and how everything else that comes from outside moves.

use crate::error::Result;
use crate::fmu::description::number;
use crate::fmu::vocabulary::Element;
use std::f64::consts::TAU;

/// Parameters of every run.
pub(super) const PARAMETERS: &str = "as_exported.ssv";

/// Runs for one purpose.
pub(super) struct ReferenceSet {
    pub name: &'static str,
    pub role: &'static str,
    pub title: &'static str,
    pub meaning: &'static str,
    pub runs: Vec<PlannedRun>,
}

/// A run that is to be made.
pub(super) struct PlannedRun {
    pub name: String,
    pub meaning: String,
    pub step_s: f64,
    pub steps: usize,
    pub wind_m_s: f64,
    /// Whether everything else that comes from outside moves too.
    pub driven: bool,
}

impl PlannedRun {
    pub(super) fn file(&self, part: &str) -> String {
        format!("{}_{part}.csv", self.name)
    }

    pub(super) fn stop_s(&self) -> f64 {
        self.steps as f64 * self.step_s
    }

    pub(super) fn element(&self) -> Result<Element> {
        let times = Element::new("TransientSimulation")
            .with("startTime", number(0.0)?)
            .with("stopTime", number(self.stop_s())?)
            .with("stepSize", number(self.step_s)?);
        let of = |element: &str, source: &str| Element::new(element).with("source", source);
        Ok(Element::new("Experiment")
            .with("name", &self.name)
            .with("description", &self.meaning)
            .containing([
                times,
                of("Parameters", PARAMETERS),
                of("Stimuli", &self.file("in")),
                of("References", &self.file("out")),
            ]))
    }
}

/// An input that moves: mean + amplitude sin(2πft + phase).
pub(super) struct Stimulus {
    pub place: usize,
    pub mean: f64,
    pub amplitude: f64,
    pub frequency_hz: f64,
    pub phase: f64,
}

impl Stimulus {
    pub(super) fn at(&self, time_s: f64) -> f64 {
        let angle = TAU * self.frequency_hz * time_s + self.phase;
        self.mean + self.amplitude * angle.sin()
    }
}

/// The number with as many digits.
pub(super) fn digits(x: f64, count: usize) -> f64 {
    let text = format!("{x:.*e}", count - 1);
    text.parse().unwrap_or(x)
}
