//! Flutter onset by stepping: a released section in steady wind, its growth rate measured from the outputs alone.
//!
//! Nothing is known of the FMU but its variables, so this is a route to the onset that shares no code with the
//! eigenvalues of the coupled system.

mod estimate;

pub use estimate::GrowthPoint;
use estimate::growth_of_samples;

use super::Fmu;
use super::description::{Value, VariableType};
use super::simulation::{Times, start};
use super::slave::{Slave, find};
use crate::error::{Error, Result, ensure, positive};
use crate::flutter::{ModeRatio, StableRange};
use std::f64::consts::TAU;

/// Names of displacement and rate of the motions that a section may have.
const MOTIONS: [(&str, &str, &str); 3] = [
    ("heave", "heave_rate", "initial_heave"),
    ("sway", "sway_rate", "initial_sway"),
    ("rotation", "rotation_rate", "initial_rotation"),
];
/// Release in each of them, m and rad; the section is linear, so that the size does not matter.
const RELEASE: f64 = 0.01;
/// Two estimates from windows of which one lies twice as late must agree within this part of the frequency; of a motion
/// that does not oscillate, of that of the released section.
const AGREEMENT: f64 = 1e-6;
/// The first estimate takes this many periods, each further one twice as many as the one before.
const FIRST_PERIODS: f64 = 24.0;
/// Most periods, 24·2⁷.
const MAX_PERIODS: f64 = 3072.0;
/// Where the section grows at the lowest speed asked for, the search goes down by halves to this part of it.
const DOWNWARDS: f64 = 1.0 / 128.0;
/// Halvings to the speed of a divergence, which only bounds what could be judged.
const DIVERGENCE_HALVINGS: usize = 8;
/// Below this, m and rad, a motion has died away: what is left is soon no number any more.
const DIED: f64 = 1e-250;
/// Most steps of one run.
const MAX_STEPS: usize = 2_000_000;
/// Intervals in which the first change of sign is looked for.
const INTERVALS: usize = 10;
/// Relative width of the bracket at which the search ends.
const TOLERANCE: f64 = 1e-6;

/// An onset found by stepping.
#[derive(Debug, Clone, PartialEq)]
pub struct GrowthOnset {
    /// Wind speed at which the growth rate is zero, m/s.
    pub speed_m_s: f64,
    /// Frequency there, Hz.
    pub frequency_hz: f64,
    /// Heave over rotation, if the FMU has both and a variable `width`.
    pub mode: Option<ModeRatio>,
    /// Communication step, s.
    pub communication_step_s: f64,
    /// The lowest speed that was run, m/s.
    pub lowest_m_s: f64,
    /// Communication steps done in all.
    pub steps: usize,
}

/// Answer of the search.
#[derive(Debug, Clone, PartialEq)]
pub enum SteppedSearch {
    /// The section flutters.
    Onset(Box<GrowthOnset>),
    /// Growth at the lowest speed that was stepped.
    UnstableAtOrBelow(GrowthPoint),
    /// No growth of an oscillation between these speeds.
    StableUpTo(StableRange),
}

/// First wind speed at which the released section of the FMU stops decaying, searched for between two wind speeds, m/s, with a
/// communication step of several to a period of the fastest mode. Where the section grows at the lower one already, the search goes down.
///
/// The FMU must have the input `wind_speed` and at least one of the pairs of outputs heave, sway, rotation with their
/// rates, and the parameters for their initial values.
///
/// # Errors
/// [`Error::Input`] for a search that makes no sense or an FMU without these variables; [`Error::Numerical`] when no growth
/// rate can be told at the lowest speed, and when the FMU refuses a call.
pub fn onset_by_stepping(
    fmu: &Fmu,
    speed_min_m_s: f64,
    speed_max_m_s: f64,
    communication_step_s: f64,
) -> Result<SteppedSearch> {
    let min = positive("speed_min_m_s", speed_min_m_s)?;
    let step = positive("communication_step_s", communication_step_s)?;
    let is_above = speed_max_m_s.is_finite() && speed_max_m_s > min;
    let expected = format_args!("a finite number above {min}");
    ensure(is_above, "speed_max_m_s", expected, speed_max_m_s)?;
    let mut run = Run::new(fmu, step)?;
    let mut below = run.growth(min)?;
    let mut above = None;
    while below.growth_rate_per_s >= 0.0 && below.speed_m_s > DOWNWARDS * min {
        let speed = 0.5 * below.speed_m_s;
        above = Some(below);
        below = run.growth(speed)?;
    }
    if below.growth_rate_per_s >= 0.0 {
        return Ok(SteppedSearch::UnstableAtOrBelow(below));
    }
    if let Some(above) = above {
        return run.found(below, above);
    }
    let lowest = below.speed_m_s;
    let stable = |to_m_s, why: String| {
        Ok(SteppedSearch::StableUpTo(StableRange {
            from_m_s: lowest,
            to_m_s,
            not_judged: Some(why),
        }))
    };
    for i in 1..=INTERVALS {
        let part = i as f64 / INTERVALS as f64;
        let above = match run.growth(min + part * (speed_max_m_s - min)) {
            Ok(above) => above,
            Err(Error::Numerical(why)) => {
                return stable(below.speed_m_s, format!("beyond: {why}"));
            }
            Err(other) => return Err(other),
        };
        if above.growth_rate_per_s >= 0.0 && above.frequency_rad_s > 0.0 {
            return run.found(below, above);
        }
        if above.growth_rate_per_s >= 0.0 {
            let (to, from) = run.divergence(below.speed_m_s, above.speed_m_s);
            let why =
                format!("from {from:.3} m/s on the section diverges, which hides any oscillation");
            return stable(to, why);
        }
        below = above;
    }
    stable(speed_max_m_s, "lower speeds were not stepped".to_owned())
}

/// Growth of the released section of the FMU at one wind speed (m/s).
///
/// # Errors
/// [`Error::Input`] for a search that makes no sense or an FMU without these variables; [`Error::Numerical`] when the FMU
/// refuses a call.
pub fn growth_by_stepping(
    fmu: &Fmu,
    speed_m_s: f64,
    communication_step_s: f64,
) -> Result<GrowthPoint> {
    let speed = positive("wind speed", speed_m_s)?;
    let step = positive("communication_step_s", communication_step_s)?;
    Run::new(fmu, step)?.growth(speed)
}

/// One instance, run again and again.
struct Run {
    slave: Slave,
    step: f64,
    /// References of displacement and rate, for each motion in turn.
    references: Vec<u32>,
    release: Vec<(String, Value)>,
    names: Vec<&'static str>,
    lowest_m_s: f64,
    steps: usize,
}

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
        let expected = "the outputs rotation and rotation_rate, or heave and heave_rate";
        ensure(!names.is_empty(), "FMU", expected, "neither").map_err(|e| e.in_file(fmu.path()))?;
        Ok(Self {
            slave: fmu.instantiate("growth")?,
            step,
            references,
            release,
            names,
            lowest_m_s: f64::INFINITY,
            steps: 0,
        })
    }

    /// Growth at one wind speed, from windows that lie later and later until two agree.
    fn growth(&mut self, speed: f64) -> Result<GrowthPoint> {
        if self.steps > 0 {
            self.slave.reset()?;
        }
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
        let mut last: Option<GrowthPoint> = None;
        let width = self.references.len();
        let released = TAU / estimate::rough_period(&samples, width);
        while periods <= MAX_PERIODS {
            let period = estimate::rough_period(&samples, width);
            let mut wanted = (periods * period / self.step).ceil();
            if wanted >= MAX_STEPS as f64 && last.is_some() {
                // near a divergence the section is nearly at rest, and its period says nothing
                wanted = 2.0 * (samples.len() / width) as f64;
            }
            if !(wanted.is_finite() && wanted < MAX_STEPS as f64) {
                break;
            }
            self.extend(&mut samples, wanted as usize)?;
            let moving = estimate::before_rest(&samples, width, DIED);
            let mut now = growth_of_samples(moving, width, self.step)?;
            let oscillates = now.frequency_rad_s > 0.0;
            let scale = now.growth_rate_per_s.abs().max(match oscillates {
                true => now.frequency_rad_s,
                false => released,
            });
            let steady = last.as_ref().is_some_and(|last| {
                (now.growth_rate_per_s - last.growth_rate_per_s).abs() <= AGREEMENT * scale
            });
            // no later window holds more of a motion that has died away
            let died = moving.len() < samples.len() && now.growth_rate_per_s < 0.0;
            if steady || died {
                now.speed_m_s = speed;
                self.lowest_m_s = self.lowest_m_s.min(speed);
                return Ok(now);
            }
            last = Some(now);
            periods *= 2.0;
        }
        let seconds = samples.len() as f64 / width as f64 * self.step;
        let last = last.map(|g| format!("{:.6} 1/s", g.growth_rate_per_s));
        let last = last.unwrap_or("none".to_owned());
        Err(Error::Numerical(format!(
            "growth at {speed:.3} m/s: no steady rate after {seconds:.0} s; last estimate {last}"
        )))
    }

    /// Steps on until there are `count` samples; the first is that at the start.
    fn extend(&mut self, samples: &mut Vec<f64>, count: usize) -> Result<()> {
        let width = self.references.len();
        let mut row = vec![0.0; width];
        for point in samples.len() / width..count {
            if point > 0 {
                let time = (point - 1) as f64 * self.step;
                self.slave.whole_step(time, self.step)?;
                self.steps += 1;
            }
            self.slave.read_real(&self.references, &mut row)?;
            samples.extend_from_slice(&row);
        }
        Ok(())
    }

    /// Zero of the growth rate in a bracket: regula falsi with the Illinois weight, which never loses the bracket.
    fn refine(&mut self, mut low: GrowthPoint, mut high: GrowthPoint) -> Result<GrowthPoint> {
        let (mut f_low, mut f_high) = (low.growth_rate_per_s, high.growth_rate_per_s);
        let mut side = 0;
        for _ in 0..60 {
            if high.speed_m_s - low.speed_m_s <= TOLERANCE * high.speed_m_s || f_high == 0.0 {
                break;
            }
            let guess = (low.speed_m_s * f_high - high.speed_m_s * f_low) / (f_high - f_low);
            // a hair inside, so that the last bracket is narrow on both sides
            let margin = 0.2 * TOLERANCE * high.speed_m_s;
            let speed = guess.clamp(low.speed_m_s + margin, high.speed_m_s - margin);
            let now = self.growth(speed)?;
            let (end, f_end, f_other, its_side) = match now.growth_rate_per_s < 0.0 {
                true => (&mut low, &mut f_low, &mut f_high, -1),
                false => (&mut high, &mut f_high, &mut f_low, 1),
            };
            *f_end = now.growth_rate_per_s;
            *end = now;
            if side == its_side {
                *f_other *= 0.5;
            }
            side = its_side;
        }
        let low_is_nearer = low.growth_rate_per_s.abs() < high.growth_rate_per_s.abs();
        Ok(if low_is_nearer { low } else { high })
    }

    /// The last speed without growth and the first with that of a divergence between two speeds, m/s.
    fn divergence(&mut self, mut below: f64, mut above: f64) -> (f64, f64) {
        for _ in 0..DIVERGENCE_HALVINGS {
            let middle = 0.5 * (below + above);
            match self.growth(middle) {
                Ok(at) if at.growth_rate_per_s < 0.0 => below = middle,
                // nearly at rest on both sides of it, no rate can be told
                _ => above = middle,
            }
        }
        (below, above)
    }

    fn found(mut self, below: GrowthPoint, above: GrowthPoint) -> Result<SteppedSearch> {
        let growth = self.refine(below, above)?;
        let place = |name: &str| self.names.iter().position(|n| *n == name);
        let relative = match (place("heave"), place("rotation")) {
            (Some(y), Some(theta)) => Some(growth.shape[y] / growth.shape[theta]),
            _ => None,
        };
        let width = match self.slave.model_description().variable("width") {
            Some(v) if v.kind == VariableType::Real => {
                Some(self.slave.get_real(&[v.value_reference])?[0])
            }
            _ => None,
        };
        self.slave.terminate()?;
        Ok(SteppedSearch::Onset(Box::new(GrowthOnset {
            speed_m_s: growth.speed_m_s,
            frequency_hz: growth.frequency_hz(),
            mode: relative.zip(width).map(|(ratio, width)| ModeRatio {
                mode_ratio: ratio.norm() / width,
                phase_deg: ratio.arg().to_degrees(),
            }),
            communication_step_s: self.step,
            lowest_m_s: self.lowest_m_s,
            steps: self.steps,
        })))
    }
}
