//! What is known of the present moment of a section: how far from flutter it is, and whether that can be trusted.

use super::saving::Memory;
use super::section_unit::SectionUnit;
use super::unit::Unit;
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::fmu::resources::Resources;
use crate::fmu::variables::{Role, Status};
use crate::response::Stepper;

/// Rotation up to which forces are taken as linear: 10 degrees.
pub(super) const LINEAR_ROTATION_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// Relative step of a difference over the wind speed.
const WIND_STEP: f64 = 1e-5;

/// Smallest damping ratio of the modes at a wind speed; one where nothing oscillates.
pub(super) fn smallest_damping(section: &CoupledSection, wind: f64) -> Result<f64> {
    let modes = section.at(wind)?.eigenvalues()?;
    let oscillating = modes.iter().filter(|z| z.im > 0.0);
    let least = oscillating.map(|z| -z.re / z.norm()).reduce(f64::min);
    Ok(least.unwrap_or(1.0))
}

/// Wind speeds (m/s) at which every motion, at its frequency in still air, lies in the tested range; `None` where there
/// are none.
pub(super) fn tested_winds(stepper: &Stepper, resources: &Resources) -> Option<[f64; 2]> {
    let s = stepper.section().structure();
    let omega = (0..s.dofs.len()).map(|i| (s.stiffness[(i, i)] / s.mass[(i, i)]).sqrt());
    let (slowest, fastest) = omega.fold((f64::INFINITY, 0.0_f64), |(a, b), w| (a.min(w), b.max(w)));
    let range = resources.model.tested_range;
    let low = fastest * s.width_m / range.max.full_width();
    let high = slowest * s.width_m / range.min.full_width();
    (low <= high).then_some([low, high])
}

/// What is said of a rotation (rad) beyond it.
pub(super) fn beyond_linear(rotation: f64) -> String {
    let degrees = rotation.to_degrees();
    format!("the rotation, {degrees:.1} degrees, is beyond linear theory (about 10 degrees)")
}

/// What has been said since the initialisation: a gust may cross a limit at every step.
#[derive(Debug, Default)]
pub(super) struct Told {
    /// Whether the wind was in the tested range after the last step.
    wind_was_tested: bool,
    wind_left: bool,
    rotation_left: bool,
}

impl SectionUnit {
    /// One of the numbers of the present moment.
    pub(super) fn present(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        role: Role,
        notices: &mut Vec<String>,
    ) -> f64 {
        let wind = memory.values[self.places.wind_speed];
        let flag = |holds: bool| f64::from(u8::from(holds));
        match role {
            Role::Status(Status::FlutterSpeed) => {
                self.calculate(resources, memory, notices);
                memory.values[self.places.onset_speed]
            }
            Role::Status(Status::FlutterMargin) => {
                self.calculate(resources, memory, notices);
                memory.values[self.places.onset_speed] - wind
            }
            Role::Status(Status::DampingNow) => match self.damping(wind) {
                Ok(ratio) => ratio,
                Err(why) => {
                    notices.push(format!("damping_now is not known: {why}"));
                    0.0
                }
            },
            Role::Status(Status::WindInTestedRange) => {
                let range = self.tested_winds;
                flag(range.is_some_and(|[low, high]| (low..=high).contains(&wind)))
            }
            Role::Status(Status::AmplitudeInLinearRange) => {
                flag(self.rotation(memory).abs() <= LINEAR_ROTATION_RAD)
            }
            _ => 0.0,
        }
    }

    fn damping(&self, wind: f64) -> Result<f64> {
        match &self.stepper {
            Some(stepper) => smallest_damping(stepper.section(), wind),
            None => Ok(0.0),
        }
    }

    /// Derivative of such a number with respect to the wind speed, per m/s.
    pub(super) fn present_by_wind(&self, memory: &Memory, role: Role) -> Result<f64> {
        let wind = memory.values[self.places.wind_speed];
        Ok(match role {
            Role::Status(Status::FlutterMargin) => -1.0,
            Role::Status(Status::DampingNow) => {
                let step = WIND_STEP * wind.max(1.0);
                let low = (wind - step).max(0.0);
                (self.damping(wind + step)? - self.damping(low)?) / (wind + step - low)
            }
            _ => 0.0,
        })
    }

    fn rotation(&self, memory: &Memory) -> f64 {
        memory.system.values[self.places.force.len() - 1]
    }

    /// Whether there may be something to say; part of every step.
    #[inline]
    pub(super) fn trust_changes(&self, memory: &Memory) -> bool {
        let wind = memory.values[self.places.wind_speed];
        let tested = self.tested_winds;
        let inside = tested.is_some_and(|[low, high]| (low..=high).contains(&wind));
        inside != self.told.wind_was_tested || self.rotation_news(memory)
    }

    /// Whether the rotation is beyond linear theory for the first time.
    #[inline]
    pub(super) fn rotation_news(&self, memory: &Memory) -> bool {
        self.rotation(memory).abs() > LINEAR_ROTATION_RAD && !self.told.rotation_left
    }

    /// Says when the wind leaves the tested range, and when the rotation leaves linear theory; each once.
    #[cold]
    pub(super) fn watch_trust(&mut self, memory: &Memory, notices: &mut Vec<String>) {
        let wind = memory.values[self.places.wind_speed];
        let tested = self.tested_winds;
        let inside = tested.is_some_and(|[low, high]| (low..=high).contains(&wind));
        let leaves = self.told.wind_was_tested && !inside && !self.told.wind_left;
        if let Some([low, high]) = tested.filter(|_| leaves) {
            self.told.wind_left = true;
            notices.push(format!(
                "wind_speed = {wind} m/s leaves the speeds at which this section was tested, {low:.3} to {high:.3} m/s \
                 at its frequencies in still air: the forces are extrapolated"
            ));
        }
        self.told.wind_was_tested = inside;
        let rotation = self.rotation(memory);
        if rotation.abs() > LINEAR_ROTATION_RAD && !self.told.rotation_left {
            self.told.rotation_left = true;
            notices.push(beyond_linear(rotation));
        }
    }
}
