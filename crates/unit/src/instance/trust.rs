//! What is known of the present moment of a section or a bridge: how far from flutter it is, and whether that can be trusted.

use super::memory::Memory;
use super::unit::Prepared;
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::smallest_damping;
use crate::resources::Resources;
use crate::response::Stepper;
use crate::variables::{Calculated, Role, Safety};

/// Rotation up to which forces are taken as linear: 10 degrees.
pub(super) const LINEAR_ROTATION_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// Relative step of a difference over the wind speed.
const WIND_STEP: f64 = 1e-5;

/// Derivative of the smallest damping ratio with respect to the wind speed, per m/s.
fn damping_slope(section: &CoupledSection, wind: f64) -> Result<f64> {
    let step = WIND_STEP * wind.max(1.0);
    let low = (wind - step).max(0.0);
    let rise = smallest_damping(section, wind + step)? - smallest_damping(section, low)?;
    Ok(rise / (wind + step - low))
}

/// What is known without the motion: numbers of the parameters, and of the present moment.
pub(super) enum Known {
    Calculated(Calculated),
    Status(Safety),
}

impl Known {
    /// `None` for inputs, parameters, states and the motion.
    pub(super) fn of(role: Role) -> Option<Self> {
        match role {
            Role::Calculated(which) => Some(Self::Calculated(which)),
            Role::Status(status) => Some(Self::Status(status)),
            Role::WindSpeed
            | Role::ExternalForce(_)
            | Role::Gust(..)
            | Role::Response(..)
            | Role::Section(_)
            | Role::InitialDisplacement(_)
            | Role::InitialRate(_)
            | Role::OnsetSearchLimit
            | Role::Filter(_)
            | Role::FilterRate(_)
            | Role::Constant
            | Role::Motion(..)
            | Role::Force(..)
            | Role::Strip(..)
            | Role::Prediction
            | Role::MotionDerivatives
            | Role::NodeForce(..)
            | Role::NodeMotion(..)
            | Role::Mode(..)
            | Role::InitialMode(_)
            | Role::ModeParameter(..)
            | Role::TurbulenceFactor => None,
        }
    }
}

/// Whether an unknown follows from the search for the onset; flags, which have no derivative, are none.
pub(super) fn is_of_onset(unknown: &Role) -> bool {
    match Known::of(*unknown) {
        Some(Known::Calculated(_)) => true,
        Some(Known::Status(status)) => match status {
            Safety::FlutterMargin | Safety::FlutterSpeed => true,
            Safety::DampingNow | Safety::WindInTestedRange | Safety::AmplitudeInLinearRange => {
                false
            }
        },
        None => false,
    }
}

/// An unknown that follows from what is calculated or from the smallest damping ratio at a wind speed; `None` for the motion, and
/// for flags, which have no derivative.
pub(super) fn without_motion(
    unknown: Role,
    calculated: impl Fn(Calculated) -> f64,
    wind: f64,
    damping: f64,
) -> Option<f64> {
    match Known::of(unknown)? {
        Known::Calculated(which) => Some(calculated(which)),
        Known::Status(status) => match status {
            Safety::FlutterSpeed => Some(calculated(Calculated::OnsetSpeed)),
            Safety::FlutterMargin => Some(calculated(Calculated::OnsetSpeed) - wind),
            Safety::DampingNow => Some(damping),
            Safety::WindInTestedRange | Safety::AmplitudeInLinearRange => None,
        },
    }
}

/// What has a present moment.
pub(super) trait MonitoredUnit: Prepared {
    /// The motion in its forces; `None` while there is none.
    fn coupled(&self) -> Option<&CoupledSection>;

    /// Smallest damping ratio at a wind speed, m/s; 0 while there is no motion in its forces.
    fn damping_at(&mut self, wind: f64) -> Result<f64>;

    fn wind_speed(&self, memory: &Memory) -> f64;

    /// Flutter speed as it was calculated last, m/s.
    fn onset_speed(&self, memory: &Memory) -> f64;

    /// Greatest rotation, rad.
    fn rotation(&self, memory: &Memory) -> f64;

    fn wind_is_tested(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        notices: &mut Vec<String>,
    ) -> bool;

    /// One of the numbers of the present moment.
    fn present(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        role: Role,
        notices: &mut Vec<String>,
    ) -> f64 {
        let wind = self.wind_speed(memory);
        let flag = |holds: bool| f64::from(u8::from(holds));
        let Role::Status(status) = role else {
            return 0.0;
        };
        match status {
            Safety::FlutterSpeed => {
                self.calculate(resources, memory, notices);
                self.onset_speed(memory)
            }
            Safety::FlutterMargin => {
                self.calculate(resources, memory, notices);
                self.onset_speed(memory) - wind
            }
            Safety::DampingNow => self.damping(wind, notices),
            Safety::WindInTestedRange => flag(self.wind_is_tested(resources, memory, notices)),
            Safety::AmplitudeInLinearRange => {
                flag(self.rotation(memory).abs() <= LINEAR_ROTATION_RAD)
            }
        }
    }

    /// Smallest damping ratio; 0, with the reason, where it is not known.
    fn damping(&mut self, wind: f64, notices: &mut Vec<String>) -> f64 {
        self.damping_at(wind).unwrap_or_else(|why| {
            notices.push(format!("damping_now is not known: {why}"));
            0.0
        })
    }

    /// Derivative of such a number with respect to the wind speed, per m/s.
    fn present_by_wind(&self, memory: &Memory, role: Role) -> Result<f64> {
        match Known::of(role) {
            Some(Known::Status(status)) => match status {
                Safety::FlutterMargin => Ok(-1.0),
                Safety::DampingNow => {
                    let wind = self.wind_speed(memory);
                    self.coupled().map_or(Ok(0.0), |s| damping_slope(s, wind))
                }
                Safety::FlutterSpeed
                | Safety::WindInTestedRange
                | Safety::AmplitudeInLinearRange => Ok(0.0),
            },
            // of the parameters, or of the motion, which is differentiated elsewhere
            Some(Known::Calculated(_)) | None => Ok(0.0),
        }
    }
}

/// Wind speeds (m/s) at which every motion, at its frequency in still air, lies in the tested range; `None` where there
/// are none.
pub(super) fn tested_winds(stepper: &Stepper, resources: &Resources) -> Option<[f64; 2]> {
    let s = stepper.section().structure();
    let (slowest, fastest) = s
        .still_air_rad_s()
        .fold((f64::INFINITY, 0.0_f64), |(a, b), w| (a.min(w), b.max(w)));
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
pub(super) struct TrustWarnings {
    /// Whether the wind was in the tested range after the last step.
    pub wind_was_tested: bool,
    pub wind_left: bool,
    pub rotation_left: bool,
}
