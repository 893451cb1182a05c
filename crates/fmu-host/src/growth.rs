//! Flutter onset by stepping: a released section in steady wind, its growth rate measured from the outputs alone.
//!
//! Nothing is known of the FMU but its variables, so this is a route to the onset that shares no code with the
//! eigenvalues of the coupled system.

mod estimate;
mod search;

pub use estimate::Growth;
pub(crate) use estimate::growth_of_samples;
pub use search::{GrowthOnset, GrowthPoint, SteppedSearch, SteppingSearch};

use super::Fmu;
use super::description::{Value, VariableType};
use super::simulation::{Times, start};
use super::slave::{Slave, find};
use crate::error::{Error, Result, ensure, positive};
use crate::flutter::StableRange;
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

/// First wind speed at which the released section of the FMU stops decaying.
///
/// The FMU must have the input `wind_speed` and at least one of the pairs of outputs heave, sway, rotation with their
/// rates, and the parameters for their initial values.
///
/// # Errors
/// [`Error::Input`] for a search that makes no sense or an FMU without these variables; [`Error::Numerical`] when no growth
/// rate can be told at the lowest speed, and when the FMU refuses a call.
pub fn onset_by_stepping(fmu: &Fmu, search: &SteppingSearch) -> Result<SteppedSearch> {
    search.check()?;
    let mut run = Run::new(fmu, search.communication_step_s)?;
    let intervals = search.intervals.max(1);
    let mut below = run.growth(search.speed_min_m_s)?;
    let mut above = None;
    while below.1.rate_per_s >= 0.0 && below.0 > DOWNWARDS * search.speed_min_m_s {
        let speed = 0.5 * below.0;
        above = Some(below);
        below = run.growth(speed)?;
    }
    if below.1.rate_per_s >= 0.0 {
        return Ok(SteppedSearch::UnstableAtOrBelow(point(below.0, &below.1)));
    }
    if let Some(above) = above {
        return run.found(below, above, search.tolerance);
    }
    let lowest = below.0;
    let stable = |to_m_s, why: Option<String>| {
        SteppedSearch::StableUpTo(StableRange {
            from_m_s: lowest,
            to_m_s,
            not_judged: Some(why.unwrap_or_else(|| "lower speeds were not stepped".to_owned())),
        })
    };
    for i in 1..=intervals {
        let part = i as f64 / intervals as f64;
        let speed = search.speed_min_m_s + part * (search.speed_max_m_s - search.speed_min_m_s);
        let above = match run.growth(speed) {
            Ok(above) => above,
            Err(Error::Numerical(why)) => {
                return Ok(stable(below.0, Some(format!("beyond: {why}"))));
            }
            Err(other) => return Err(other),
        };
        if above.1.rate_per_s >= 0.0 && above.1.frequency_rad_s > 0.0 {
            return run.found(below, above, search.tolerance);
        }
        if above.1.rate_per_s >= 0.0 {
            let (last, from) = run.divergence(below, above.0);
            let why =
                format!("from {from:.3} m/s on the section diverges, which hides any oscillation");
            return Ok(stable(last.0, Some(why)));
        }
        below = above;
    }
    Ok(stable(search.speed_max_m_s, None))
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
    let (speed, growth) = Run::new(fmu, step)?.growth(speed)?;
    Ok(point(speed, &growth))
}

fn point(speed_m_s: f64, growth: &Growth) -> GrowthPoint {
    GrowthPoint {
        speed_m_s,
        growth_rate_per_s: growth.rate_per_s,
        frequency_hz: growth.frequency_rad_s / TAU,
    }
}

/// One instance, run again and again.
struct Run {
    slave: Slave,
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
        let expected = "the outputs rotation and rotation_rate, or heave and heave_rate";
        ensure(!names.is_empty(), "FMU", expected, "neither").map_err(|e| e.in_file(fmu.path()))?;
        Ok(Self {
            slave: fmu.instantiate("growth")?,
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
        let mut last: Option<Growth> = None;
        let released = TAU / estimate::rough_period(&samples, self.references.len());
        while periods <= MAX_PERIODS {
            let period = estimate::rough_period(&samples, self.references.len());
            let mut wanted = (periods * period / self.step).ceil();
            if wanted >= MAX_STEPS as f64 && last.is_some() {
                // near a divergence the section is nearly at rest, and its period says nothing
                wanted = 2.0 * (samples.len() / self.references.len()) as f64;
            }
            if !(wanted.is_finite() && wanted < MAX_STEPS as f64) {
                break;
            }
            self.extend(&mut samples, wanted as usize)?;
            let moving = estimate::before_rest(&samples, self.references.len(), DIED);
            let now = growth_of_samples(moving, self.references.len(), self.step)?;
            let oscillates = now.frequency_rad_s > 0.0;
            let scale = now.rate_per_s.abs().max(match oscillates {
                true => now.frequency_rad_s,
                false => released,
            });
            let steady = last
                .as_ref()
                .is_some_and(|last| (now.rate_per_s - last.rate_per_s).abs() <= AGREEMENT * scale);
            // no later window holds more of a motion that has died away
            let died = moving.len() < samples.len() && now.rate_per_s < 0.0;
            if steady || died {
                self.points.push(point(speed, &now));
                return Ok((speed, now));
            }
            last = Some(now);
            periods *= 2.0;
        }
        Err(Error::Numerical(format!(
            "growth at {speed:.3} m/s: no steady rate after {:.0} s; last estimate {}",
            samples.len() as f64 / self.references.len() as f64 * self.step,
            last.map_or("none".to_owned(), |g| format!("{:.6} 1/s", g.rate_per_s))
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

    /// The last speed without growth and the first with that of a divergence between two speeds.
    fn divergence(&mut self, mut below: At, mut above_m_s: f64) -> (At, f64) {
        for _ in 0..DIVERGENCE_HALVINGS {
            let middle = 0.5 * (below.0 + above_m_s);
            match self.growth(middle) {
                Ok(at) if at.1.rate_per_s < 0.0 => below = at,
                // nearly at rest on both sides of it, no rate can be told
                _ => above_m_s = middle,
            }
        }
        (below, above_m_s)
    }

    fn found(mut self, below: At, above: At, tolerance: f64) -> Result<SteppedSearch> {
        let (speed, growth) = self.refine(below, above, tolerance)?;
        self.onset(speed, &growth)
            .map(Box::new)
            .map(SteppedSearch::Onset)
    }

    fn onset(mut self, speed: f64, growth: &Growth) -> Result<GrowthOnset> {
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
        self.points
            .sort_by(|a, b| a.speed_m_s.total_cmp(&b.speed_m_s));
        Ok(GrowthOnset {
            speed_m_s: speed,
            frequency_hz: growth.frequency_rad_s / TAU,
            mode_ratio: relative.zip(width).map(|(r, b)| r.norm() / b),
            phase_deg: relative.map_or(0.0, |r| r.arg().to_degrees()),
            communication_step_s: self.step,
            growth: self.points,
            steps: self.steps,
        })
    }
}
