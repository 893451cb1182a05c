//! What follows from the parameters of an exported bridge: its coupled modes, and what gusts do to them.

use super::coupled::Built;
use super::damping::PresentDamping;
use crate::bridge::Bridge;
use crate::bridge_gusts::GustRecord;
use crate::error::{Error, Result, ensure};
use crate::flutter::NearbyOnset;
use crate::gust_channels::GustChannels;
use crate::resources::Resources;
use crate::response::{Inputs, SectionState, Stepper};
use crate::units::ReducedFrequency;
use nalgebra::DMatrix;

/// Pieces of a field of turbulence at most in one step.
const MAX_PIECES: f64 = 1e4;
/// Part of a step that is not worth a piece of its own.
const LAST_PIECE: f64 = 1e-9;

/// A bridge with the parameters of its FMU.
#[derive(Debug)]
pub(super) struct TunedBridge {
    pub bridge: Bridge,
    /// Displacements of the mass-normalised modes: vertical, lateral, rotation of each named node.
    pub shapes: DMatrix<f64>,
    /// Strokes of the dampers by unit coordinates.
    pub strokes: DMatrix<f64>,
    gusts: Option<GustChannels>,
    pub turbulence: Option<GustRecord>,
    /// State before the step at hand, and inputs within it.
    before: SectionState,
    now: Inputs,
}

pub(super) type BuiltBridge = Built<TunedBridge>;

impl BuiltBridge {
    /// The bridge of an export with the parameters in `values`.
    pub(super) fn new(resources: &Resources, values: &[f64]) -> Result<Self> {
        let options = resources.bridge.as_ref();
        let options = options.ok_or_else(|| Error::Numerical("bridge: there is none".into()))?;
        let mut bridge = options.bridge()?;
        let mut as_exported = true;
        let all = resources.table.variables().iter().zip(values);
        let tuned = all.filter(|(variable, _)| variable.role.is_tuned());
        for (parameter, (_, value)) in bridge.tunable().zip(tuned) {
            as_exported &= parameter.to_bits() == value.to_bits();
            *parameter = *value;
        }
        let exported = resources.exported.as_ref().filter(|_| as_exported);
        let (stepper, gusts) = match exported {
            Some(exported) => exported.clone(),
            None => options.stepper(&bridge)?,
        };
        let turbulence = match (&resources.turbulence, &options.gusts) {
            (Some(field), Some(gusts)) => Some(field.channels(&bridge, gusts)?),
            _ => None,
        };
        let own = TunedBridge {
            strokes: bridge.strokes(),
            shapes: bridge.shapes_at(&options.named),
            bridge,
            gusts,
            turbulence,
            before: SectionState::default(),
            now: Inputs::steady(0.0, 0),
        };
        Ok(Self {
            stepper,
            damping: PresentDamping::default(),
            own,
        })
    }

    /// Smallest damping ratio of all modes at a wind speed, m/s.
    pub(super) fn damping_at(&mut self, wind: f64) -> Result<f64> {
        self.damping.at(&mut self.stepper, wind)
    }

    /// The mode that has it where it was asked for last; `None` where modes are not followed.
    pub(super) fn least_damped(&self) -> Option<NearbyOnset> {
        self.damping.modes()?.least()
    }

    /// The lowest reduced frequency of all modes at a wind speed, m/s; `None` where modes are not followed.
    pub(super) fn slowest_at(&mut self, wind: f64) -> Option<ReducedFrequency> {
        self.damping_at(wind).ok()?;
        let omega = self.damping.modes()?.slowest_rad_s()?;
        let width = self.own.bridge.width_m();
        Some(ReducedFrequency::from_circular(omega, width, wind))
    }
}

impl TunedBridge {
    /// Loads gusts of the strips and their rates.
    pub(super) fn set_gusts(
        &self,
        inputs: &mut Inputs,
        gusts: impl Iterator<Item = f64>,
        rates: impl Iterator<Item = f64>,
    ) {
        let Some(channels) = &self.gusts else {
            return;
        };
        let count = channels.convection_per_width.len() * self.bridge.coordinates();
        for list in [&mut inputs.gust_m_s, &mut inputs.gust_rate_m_s2] {
            list.clear();
            list.resize(count, 0.0);
        }
        channels.add(gusts, &mut inputs.gust_m_s);
        channels.add(rates, &mut inputs.gust_rate_m_s2);
    }

    /// A step from `time` with the inputs that hold there, turbulence apart, cut where that has its samples. On an error the
    /// state is as it was.
    pub(super) fn advance(
        &mut self,
        stepper: &mut Stepper,
        state: &mut SectionState,
        inputs: &Inputs,
        [time, step, factor]: [f64; 3],
    ) -> Result<()> {
        let Some(record) = &self.turbulence else {
            return stepper.advance(state, inputs, step);
        };
        let pieces = record.pieces(step);
        ensure(
            pieces <= MAX_PIECES,
            "step size",
            format_args!("at most {MAX_PIECES} samples of the turbulence in a step"),
            format_args!("{step} s"),
        )?;
        self.before.set_to(state);
        let mut done = 0.0;
        while done < step {
            let to_next = record.to_next(time + done);
            // a rest that rounding leaves is no piece
            let last = done + to_next >= step * (1.0 - LAST_PIECE);
            let piece = if last { step - done } else { to_next };
            let now = &mut self.now;
            now.set_to(inputs);
            run_on(now, done);
            let (gust, rate) = (&mut now.gust_m_s, &mut now.gust_rate_m_s2);
            record.add(time + done, factor, gust, rate);
            if let Err(why) = stepper.advance(state, now, piece) {
                state.set_to(&self.before);
                return Err(why);
            }
            done = if last { step } else { done + piece };
        }
        Ok(())
    }
}

/// Inputs some time later.
fn run_on(inputs: &mut Inputs, time: f64) {
    inputs.wind_speed_m_s += time * inputs.wind_speed_rate_m_s2;
    let lists = [
        (&mut inputs.force, &inputs.force_rate),
        (&mut inputs.gust_m_s, &inputs.gust_rate_m_s2),
    ];
    for (values, rates) in lists {
        for (value, rate) in values.iter_mut().zip(rates) {
            *value += time * rate;
        }
    }
}
