//! Numbers of the present moment of a section or bridge.

use super::coupled::{Built, Coupled, CoupledKind};
use super::damping::told_from;
use super::memory::{Memory, Now};
use super::trust::shown;
use super::unit::Prepared;
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::smallest_damping;
use crate::resources::Resources;
use crate::response::Outputs;
use crate::section::Dof;
use crate::variables::{ComputedNumber, Known, Present, Response, Role};
use std::cmp::Ordering;

/// Relative step of a difference over the wind speed.
const WIND_STEP: f64 = 1e-5;

/// Derivative of the smallest damping ratio with respect to the wind speed, per m/s; `None` where that is not known.
fn damping_slope(section: &CoupledSection, wind: f64) -> Option<f64> {
    let (step, lowest) = (WIND_STEP * wind.max(1.0), told_from(section));
    let low = (wind - step).max(lowest);
    let damping = |at: f64| smallest_damping(section, at).ok();
    let rise = || Some(damping(wind + step)? - damping(low)?);
    (wind >= lowest)
        .then(rise)?
        .map(|rise| rise / (wind + step - low))
}

impl<S: CoupledKind> Coupled<S> {
    /// Whether the wind is below, in or above the tested range; `None` where that is not known.
    #[inline]
    pub(super) fn beside_tests(&self, wind: f64) -> Option<Ordering> {
        S::tested_winds(self).map(|[low, high]| match wind {
            _ if wind < low => Ordering::Less,
            _ if wind > high => Ordering::Greater,
            _ => Ordering::Equal,
        })
    }

    /// Says, once, when the wind leaves the tested range, or comes to be above it; below it every ramp begins.
    #[cold]
    pub(super) fn watch_wind(&mut self, wind: f64, notices: &mut Vec<String>) {
        let now = self.beside_tests(wind);
        let outside = match now {
            Some(Ordering::Less) => self.wind_was == Some(Ordering::Equal),
            Some(Ordering::Greater) => true,
            Some(Ordering::Equal) | None => false,
        };
        if let Some([low, high]) = S::tested_winds(self).filter(|_| outside && !self.wind_left) {
            self.wind_left = true;
            let wind = shown(wind);
            notices.push(format!(
                "wind_speed = {wind} m/s is outside the speeds at which {}, {low:.3} to {high:.3} m/s: the forces are \
                 extrapolated",
                S::TESTED_AT
            ));
        }
        self.wind_was = now;
    }

    /// What a number reads of the present.
    pub(super) fn read(&mut self, now: &mut Now, number: &ComputedNumber) -> Present {
        let wind = now.memory.values[self.indices.wind_speed];
        let mut present = Present {
            wind_m_s: wind.into(),
            ..Present::default()
        };
        for known in number.reads {
            match known {
                Known::Onset => {
                    self.calculate(now);
                    present.onset = self.calculated.onset();
                }
                Known::Wind | Known::Length => {}
                Known::Damping => {
                    let Built {
                        stepper, damping, ..
                    } = &mut self.built;
                    match damping.at(stepper, wind) {
                        Ok(ratio) => present.damping_ratio = ratio.into(),
                        // zero
                        Err(why) => now.notices.push(format!("damping_now is not known: {why}")),
                    }
                }
                Known::TestedWind => {
                    present.wind_is_tested = S::wind_is_tested(self, now);
                }
                Known::Rotation => present.rotation_rad = S::rotation(self, &now.memory).into(),
                Known::Motion(response, dof) => match self.outputs(&mut now.memory) {
                    Ok(()) => {
                        let value =
                            S::motion(self, &now.memory.system, &self.outputs, *response, *dof);
                        *present.motion_mut(*response, *dof) = value.into();
                    }
                    Err(why) => now
                        .notices
                        .push(format!("{} is not known: {why}", number.name)),
                },
            }
        }
        present
    }

    /// Derivative of such a number, as the wind and the outputs of the coordinates change with what is asked for; without outputs that is
    /// the upper end of the search for the onset.
    pub(super) fn slope(
        &mut self,
        now: &mut Now,
        number: &ComputedNumber,
        by_wind: f64,
        by_outputs: Option<&Outputs>,
    ) -> Result<f64> {
        if number.is_flag() {
            return Ok(0.0);
        }
        let mut present = self.read(now, number);
        present.wind_m_s.slope = by_wind;
        let slope = |response, dof| {
            let found = |outputs| S::motion(self, &now.memory.system, outputs, response, dof);
            by_outputs.map_or(0.0, found)
        };
        for known in number.reads {
            match known {
                Known::Rotation => {
                    present.rotation_rad.slope = slope(Response::Displacement, Dof::Torsion);
                }
                Known::Motion(response, dof) => {
                    present.motion_mut(*response, *dof).slope = slope(*response, *dof);
                }
                _ => {}
            }
        }
        if by_outputs.is_none() {
            present.onset.follow_limit();
        }
        if by_wind != 0.0 && number.reads(Known::Damping) {
            let wind = now.memory.values[self.indices.wind_speed];
            let slope = damping_slope(self.section(), wind);
            present.damping_ratio.slope = by_wind * slope.unwrap_or(0.0);
        }
        Ok(number.evaluate(&present).slope)
    }

    /// The unknowns of what is released with the values in `memory`, with the parameters that it has been made with.
    pub(super) fn unknowns(
        &mut self,
        resources: &Resources,
        memory: &Memory,
        unknowns: &[Role],
    ) -> Result<Vec<f64>> {
        S::load_inputs(self, memory);
        let state = self.release(&memory.values)?;
        let instant = self.instant(&state)?;
        let wind = memory.values[self.indices.wind_speed];
        let mut present = Present {
            wind_m_s: wind.into(),
            ..Present::default()
        };
        for response in Response::ALL {
            for dof in Dof::THREE {
                let value = S::motion(self, &state, &instant.outputs, response, dof);
                *present.motion_mut(response, dof) = value.into();
            }
        }
        present.rotation_rad = present.motion(Response::Displacement, Dof::Torsion);
        let read = |known: Known| {
            unknowns
                .iter()
                .any(|u| matches!(u, Role::Computed(n) if !n.is_flag() && n.reads(known)))
        };
        if read(Known::Onset) {
            present.onset = S::searched(self, resources, memory).numbers;
        }
        if read(Known::Damping) {
            let told = wind >= told_from(self.section());
            let damping = smallest_damping(self.section(), wind).ok();
            present.damping_ratio = damping.filter(|_| told).unwrap_or(0.0).into();
        }
        let value = |unknown: &Role| match unknown {
            // flags have no derivative
            Role::Computed(number) if number.is_flag() => 0.0,
            Role::Computed(number) => number.evaluate(&present).value,
            other => self.pick(&instant, *other),
        };
        Ok(unknowns.iter().map(value).collect())
    }
}
