//! Communication steps.

use super::Instance;
use super::trust::shown;
use crate::lifecycle::State;
use crate::refusal::{CallResult, Refusal};
use crate::response::wind_at_rest;

/// How far an importer's clock may be from ours, relative to the time: a few roundings. Nothing adds up, as each point that it
/// gives becomes ours.
const CLOCK_TOLERANCE: f64 = 4.0 * f64::EPSILON;
/// The same relative to the step, for times near zero.
const CLOCK_TOLERANCE_OF_STEP: f64 = 1e-6;
/// Part of the step that its point may be off at most, however little the time resolves: a step is not taken twice.
const SAME_POINT: f64 = 0.5;

impl Instance {
    /// One communication step of `step` seconds from the point of time `point`.
    ///
    /// # Errors
    /// An error for a step that is not positive, a point that is not ours, or an end behind the stop time; a discard,
    /// with everything as it was, when the step cannot be computed.
    #[inline]
    pub fn do_step(&mut self, point: f64, step: f64) -> CallResult<()> {
        // most steps need no more, nor a closer look at a step that is positive and finite
        let stop = self.now.memory.experiment.and_then(|(_, stop)| stop);
        if (point - self.now.memory.time).abs() <= CLOCK_TOLERANCE_OF_STEP * step
            && stop.is_none_or(|stop| point + step <= stop)
            && let Some(news) = self.unit.repeat(&mut self.now.memory, step)
        {
            self.outputs_current = false;
            self.now.memory.time = point + step;
            if news {
                self.unit.watch(&mut self.now);
            }
            return Ok(());
        }
        self.do_step_anew(point, step)
    }

    #[inline(never)]
    fn do_step_anew(&mut self, point: f64, step: f64) -> CallResult<()> {
        let time = self.now.memory.time;
        if !(step.is_finite() && step > 0.0) {
            return Err(no_step(step));
        }
        let resolved = CLOCK_TOLERANCE * time.abs().max(point.abs());
        let tolerance = (resolved + CLOCK_TOLERANCE_OF_STEP * step).min(SAME_POINT * step);
        let drift = (point - time).abs();
        if drift.is_nan() || drift > tolerance {
            return Err(elsewhere(point, time));
        }
        let end = point + step;
        if let Some((start, Some(stop))) = self.now.memory.experiment {
            // what rounding takes from this step, it takes from each of a sum of such steps
            let summed = (point - start) / step * (end - point - step).abs();
            if end > stop + tolerance + summed {
                return Err(too_late(end, stop));
            }
        }
        let now = &mut self.now;
        let prepared = self.unit.prepared(&now.resources, &mut now.memory);
        let advanced = prepared
            .map_err(Refusal::from)
            .and_then(|unit| unit.advance(&mut now.memory, step));
        self.outputs_current = advanced.map_err(|refusal| {
            now.memory.state = State::StepFailed;
            Refusal::discard(refusal.message)
        })?;
        // after the step: one that is refused is refused at once
        self.unit.watch(now);
        if now.memory.input_rates.iter().any(|rate| *rate != 0.0) {
            self.run_inputs_on(step);
        }
        self.now.memory.time = end;
        Ok(())
    }

    fn run_inputs_on(&mut self, step: f64) {
        let values = &mut self.now.memory.values;
        let inputs = self.unit.inputs();
        let before = values[inputs[0]];
        for (index, rate) in inputs.iter().zip(&self.now.memory.input_rates) {
            if *rate != 0.0 {
                values[*index] += rate * step;
            }
        }
        values[inputs[0]] = wind_at_rest(values[inputs[0]], before);
    }
}

#[cold]
fn no_step(step: f64) -> Refusal {
    Refusal::error(format!(
        "communication step: expected a positive number, found {}",
        shown(step)
    ))
}

#[cold]
fn elsewhere(point: f64, time: f64) -> Refusal {
    Refusal::error(format!(
        "communication point: expected {} s, where the last step ended, found {}",
        shown(time),
        shown(point)
    ))
}

#[cold]
fn too_late(end: f64, stop: f64) -> Refusal {
    Refusal::error(format!(
        "communication step: expected an end not after the stop time {} s, found {}",
        shown(stop),
        shown(end)
    ))
}
