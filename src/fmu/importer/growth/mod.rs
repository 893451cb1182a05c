//! Flutter onset by stepping: a released section in steady wind, its growth rate measured from the outputs alone.
//!
//! Nothing is known of the FMU but its variables, so this is a route to the onset that shares no code with the
//! eigenvalues of the coupled system.

mod estimate;

pub use estimate::{Growth, growth_of_samples};

use super::Fmu;
use super::description::{Kind, Value};
use super::simulation::{Times, start};
use super::slave::{Slave, Status, find};
use crate::error::{Error, Result, positive};
use serde::Serialize;

/// Names of displacement and rate of the motions that a section may have.
const MOTIONS: [(&str, &str, &str); 3] = [
    ("heave", "heave_rate", "initial_heave"),
    ("sway", "sway_rate", "initial_sway"),
    ("rotation", "rotation_rate", "initial_rotation"),
];
/// Release in each of them, m and rad; the section is linear, so that the size does not matter.
const RELEASE: f64 = 0.01;
/// Two estimates from windows of which one lies twice as late must agree within this part of the frequency.
const AGREEMENT: f64 = 1e-6;
/// The first estimate takes this many periods, each further one twice as many as the one before.
const FIRST_PERIODS: f64 = 24.0;
/// Most periods, 24·2⁷.
const MAX_PERIODS: f64 = 3072.0;
/// Most steps of one run.
const MAX_STEPS: usize = 2_000_000;

/// Where to look and how to step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SteppingSearch {
    /// Wind speed at which the section is stable, m/s.
    pub speed_min_m_s: f64,
    /// Highest wind speed, m/s.
    pub speed_max_m_s: f64,
    /// Number of intervals in which the first change of sign is looked for.
    pub intervals: usize,
    /// Communication step, s; several to a period of the fastest mode.
    pub communication_step_s: f64,
    /// Relative width of the bracket at which the search ends.
    pub tolerance: f64,
}

impl SteppingSearch {
    /// Between two wind speeds in ten intervals, to 1e-6.
    pub fn between(speed_min_m_s: f64, speed_max_m_s: f64, communication_step_s: f64) -> Self {
        Self {
            speed_min_m_s,
            speed_max_m_s,
            intervals: 10,
            communication_step_s,
            tolerance: 1e-6,
        }
    }

    fn check(&self) -> Result<()> {
        positive("speed_min_m_s", self.speed_min_m_s)?;
        positive("communication_step_s", self.communication_step_s)?;
        positive("tolerance", self.tolerance)?;
        if self.speed_max_m_s.is_finite() && self.speed_max_m_s > self.speed_min_m_s {
            return Ok(());
        }
        Err(Error::input(
            "speed_max_m_s",
            format!("a finite number above {}", self.speed_min_m_s),
            self.speed_max_m_s.to_string(),
        ))
    }
}

/// Growth at one wind speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GrowthPoint {
    /// Wind speed, m/s.
    pub speed_m_s: f64,
    /// Growth rate of the dominant mode, 1/s; negative when it decays.
    pub growth_rate_per_s: f64,
    /// Its frequency, Hz.
    pub frequency_hz: f64,
}

/// An onset found by stepping.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SteppedOnset {
    /// Wind speed at which the growth rate is zero, m/s.
    pub speed_m_s: f64,
    /// Frequency there, Hz.
    pub frequency_hz: f64,
    /// `|y|/(B|θ|)`, if the FMU has a variable `width`.
    pub mode_ratio: Option<f64>,
    /// Phase of `y` relative to `θ`, degrees in (−180, 180].
    pub phase_deg: f64,
    /// Communication step, s.
    pub communication_step_s: f64,
    /// All speeds that were run, in ascending order.
    pub growth: Vec<GrowthPoint>,
    /// Communication steps done in all.
    pub steps: usize,
}

/// Answer of the search.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SteppedSearch {
    /// The section flutters.
    Onset(Box<SteppedOnset>),
    /// No growth up to this wind speed, m/s.
    StableUpTo(f64),
}

impl SteppedSearch {
    /// The onset, if there is one.
    pub fn onset(&self) -> Option<&SteppedOnset> {
        match self {
            Self::Onset(onset) => Some(onset),
            Self::StableUpTo(_) => None,
        }
    }
}

/// First wind speed at which the released section of the FMU stops decaying.
///
/// The FMU must have the input `wind_speed` and at least one of the pairs of outputs heave, sway, rotation with their
/// rates, and the parameters for their initial values.
///
/// # Errors
/// [`Error::Input`] for a search that makes no sense, an FMU without these variables, or a section that grows already at
/// the lowest speed; [`Error::Numerical`] when no growth rate can be told; the errors of [`Slave`].
pub fn onset_by_stepping(fmu: &Fmu, search: &SteppingSearch) -> Result<SteppedSearch> {
    search.check()?;
    let mut run = Run::new(fmu, search.communication_step_s)?;
    let intervals = search.intervals.max(1);
    let mut below = run.growth(search.speed_min_m_s)?;
    if below.1.rate_per_s >= 0.0 {
        return Err(Error::input(
            "speed_min_m_s",
            "a wind speed at which the section is stable",
            format!("{} m/s with growth {} 1/s", below.0, below.1.rate_per_s),
        ));
    }
    for i in 1..=intervals {
        let part = i as f64 / intervals as f64;
        let speed = search.speed_min_m_s + part * (search.speed_max_m_s - search.speed_min_m_s);
        let above = run.growth(speed)?;
        if above.1.rate_per_s >= 0.0 {
            let (speed, growth) = run.refine(below, above, search.tolerance)?;
            return run
                .onset(speed, &growth)
                .map(Box::new)
                .map(SteppedSearch::Onset);
        }
        below = above;
    }
    Ok(SteppedSearch::StableUpTo(search.speed_max_m_s))
}

/// One instance, run again and again.
struct Run {
    slave: Slave,
    fresh: bool,
    step: f64,
    /// References of displacement and rate, for each motion in turn.
    references: Vec<u32>,
    release: Vec<(String, Value)>,
    names: Vec<&'static str>,
    points: Vec<GrowthPoint>,
    steps: usize,
}

type At = (f64, Growth);

impl Run {
    fn new(fmu: &Fmu, step: f64) -> Result<Self> {
        let d = fmu.model_description();
        let (mut references, mut release, mut names) = (Vec::new(), Vec::new(), Vec::new());
        for (displacement, rate, initial) in MOTIONS {
            let (Some(x), Some(v)) = (d.variable(displacement), d.variable(rate)) else {
                continue;
            };
            references.extend([x.value_reference, v.value_reference]);
            names.push(displacement);
            if d.variable(initial).is_some() {
                release.push((initial.to_owned(), Value::Real(RELEASE)));
            }
        }
        find(d, "wind_speed")?;
        if names.is_empty() {
            return Err(Error::input(
                "FMU",
                "the outputs rotation and rotation_rate, or heave and heave_rate",
                "neither",
            )
            .in_file(fmu.path()));
        }
        Ok(Self {
            slave: fmu.instantiate("growth")?,
            fresh: true,
            step,
            references,
            release,
            names,
            points: Vec::new(),
            steps: 0,
        })
    }

    /// Growth at one wind speed, from windows that lie later and later until two agree.
    fn growth(&mut self, speed: f64) -> Result<At> {
        if !self.fresh {
            self.slave.reset()?;
        }
        self.fresh = false;
        let mut values = self.release.clone();
        values.push(("wind_speed".to_owned(), Value::Real(speed)));
        let endless = Times {
            start: 0.0,
            stop: f64::MAX,
            step: self.step,
        };
        start(&mut self.slave, &endless, &values)?;
        let mut samples = Vec::new();
        self.extend(&mut samples, 64)?;
        let mut periods = FIRST_PERIODS;
        let mut last: Option<Growth> = None;
        while periods <= MAX_PERIODS {
            let period = estimate::rough_period(&samples, self.references.len());
            let wanted = (periods * period / self.step).ceil();
            if !(wanted.is_finite() && wanted < MAX_STEPS as f64) {
                break;
            }
            self.extend(&mut samples, wanted as usize)?;
            let now = growth_of_samples(&samples, self.references.len(), self.step)?;
            let scale = now.frequency_rad_s.max(now.rate_per_s.abs());
            if let Some(last) = &last
                && (now.rate_per_s - last.rate_per_s).abs() <= AGREEMENT * scale
            {
                self.points.push(GrowthPoint {
                    speed_m_s: speed,
                    growth_rate_per_s: now.rate_per_s,
                    frequency_hz: now.frequency_rad_s / std::f64::consts::TAU,
                });
                return Ok((speed, now));
            }
            last = Some(now);
            periods *= 2.0;
        }
        Err(Error::Numerical(format!(
            "growth at {speed} m/s: no steady rate after {:.0} s; last estimate {:?} 1/s",
            samples.len() as f64 / self.references.len() as f64 * self.step,
            last.map(|g| g.rate_per_s)
        )))
    }

    /// Steps on until there are `count` samples; the first is that at the start.
    fn extend(&mut self, samples: &mut Vec<f64>, count: usize) -> Result<()> {
        let width = self.references.len();
        let mut row = vec![0.0; width];
        for point in samples.len() / width..count {
            if point > 0 {
                let time = (point - 1) as f64 * self.step;
                let status = self.slave.do_step(time, self.step)?;
                if status == Status::Discard {
                    return Err(Error::Numerical(format!(
                        "fmi2DoStep discarded the step from {time} s over {} s",
                        self.step
                    )));
                }
                self.steps += 1;
            }
            self.slave.read_real(&self.references, &mut row)?;
            samples.extend_from_slice(&row);
        }
        Ok(())
    }

    /// Zero of the growth rate in a bracket: regula falsi with the Illinois weight, which never loses the bracket.
    fn refine(&mut self, below: At, above: At, tolerance: f64) -> Result<At> {
        let (mut low, mut high) = (below, above);
        let (mut f_low, mut f_high) = (low.1.rate_per_s, high.1.rate_per_s);
        let mut side = 0;
        for _ in 0..60 {
            if high.0 - low.0 <= tolerance * high.0 || f_high == 0.0 {
                break;
            }
            let guess = (low.0 * f_high - high.0 * f_low) / (f_high - f_low);
            // a hair inside, so that the last bracket is narrow on both sides
            let margin = 0.2 * tolerance * high.0;
            let speed = guess.clamp(low.0 + margin, high.0 - margin);
            let now = self.growth(speed)?;
            if now.1.rate_per_s < 0.0 {
                f_low = now.1.rate_per_s;
                low = now;
                if side == -1 {
                    f_high *= 0.5;
                }
                side = -1;
            } else {
                f_high = now.1.rate_per_s;
                high = now;
                if side == 1 {
                    f_low *= 0.5;
                }
                side = 1;
            }
        }
        Ok(if low.1.rate_per_s.abs() < high.1.rate_per_s.abs() {
            low
        } else {
            high
        })
    }

    fn onset(mut self, speed: f64, growth: &Growth) -> Result<SteppedOnset> {
        let place = |name: &str| self.names.iter().position(|n| *n == name);
        let relative = match (place("heave"), place("rotation")) {
            (Some(y), Some(theta)) => Some(growth.shape[y] / growth.shape[theta]),
            _ => None,
        };
        let width = match self.slave.model_description().variable("width") {
            Some(v) if v.kind == Kind::Real => Some(self.slave.get_real(&[v.value_reference])?[0]),
            _ => None,
        };
        self.slave.terminate()?;
        self.points
            .sort_by(|a, b| a.speed_m_s.total_cmp(&b.speed_m_s));
        Ok(SteppedOnset {
            speed_m_s: speed,
            frequency_hz: growth.frequency_rad_s / std::f64::consts::TAU,
            mode_ratio: relative.zip(width).map(|(r, b)| r.norm() / b),
            phase_deg: relative.map_or(0.0, |r| r.arg().to_degrees()),
            communication_step_s: self.step,
            growth: self.points,
            steps: self.steps,
        })
    }
}
