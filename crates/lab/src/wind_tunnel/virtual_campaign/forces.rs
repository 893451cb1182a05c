//! What the load cells of a virtual campaign are made to say: forces of the rigid model about its centre of rotation, gusts,
//! what measurement adds, and the channels of the cells.

use super::plan::{Disturbances, ModelBody, Spike, StaticWind, Support, TunnelTurbulence};
use super::truth::AppliedSpike;
use crate::signal::largest_magnitude;
use crate::wind_tunnel::{Record, Segment};
use nalgebra::{Rotation3, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::PI;

/// Force and moment about the centre of rotation, global axes: N, N·m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wrench {
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
}

impl Wrench {
    /// From drag, lift (N) and nose-up moment (N·m), which is one about −z.
    pub(crate) fn section(drag: f64, lift: f64, moment: f64) -> Self {
        Self {
            force: Vector3::new(drag, lift, 0.0),
            moment: Vector3::new(0.0, 0.0, -moment),
        }
    }

    pub(crate) fn add(&mut self, other: Self) {
        self.force += other.force;
        self.moment += other.moment;
    }
}

/// Motion of the model at one instant; vertical (m), lateral (m), torsion (rad), and their rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Kinematics {
    pub displacement: [f64; 3],
    pub velocity: [f64; 3],
    pub acceleration: [f64; 3],
}

/// Gravity and inertia of a body of `length_m`.
pub(super) fn gravity_and_inertia(body: &ModelBody, length_m: f64, state: &Kinematics) -> Wrench {
    let mass = body.mass_kg_m * length_m;
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), -state.displacement[2]);
    let arm = turn * Vector3::from(body.centre_of_gravity_m);
    let spin = Vector3::new(0.0, 0.0, -state.velocity[2]);
    let spin_rate = Vector3::new(0.0, 0.0, -state.acceleration[2]);
    let centre = Vector3::new(state.acceleration[1], state.acceleration[0], 0.0);
    let acceleration = centre + spin_rate.cross(&arm) + spin.cross(&spin.cross(&arm));
    let weight = Vector3::new(0.0, -mass * body.gravity_m_s2, 0.0);
    let force = weight - mass * acceleration;
    Wrench {
        force,
        moment: arm.cross(&force) - spin_rate * (body.inertia_kg_m2_m * length_m),
    }
}

/// Steady load and quasi-steady buffeting as (drag, lift, moment) over `½ρV²`, `B`, `B`, `B²` and the length; gusts over
/// the mean speed. Linear in the gusts, as the buffeting forces of section 1.1 of the thesis.
pub(super) fn wind_coefficients(wind: &StaticWind, u: f64, w: f64) -> [f64; 3] {
    [
        wind.drag * (1.0 + 2.0 * u) + (wind.drag_slope - wind.lift) * w,
        wind.lift * (1.0 + 2.0 * u) + (wind.lift_slope + wind.drag) * w,
        wind.moment * (1.0 + 2.0 * u) + wind.moment_slope * w,
    ]
}

/// Downwind and vertical gust over the mean speed, one per sample.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GustSamples {
    pub u: Vec<f64>,
    pub w: Vec<f64>,
}

impl GustSamples {
    /// A first-order process in each direction: variance `I²`, correlation `exp(−V τ/length)`, hence a spectrum that is
    /// flat below `V/(2π length)` Hz and falls as `f⁻²` above. None without turbulence.
    pub(crate) fn new(
        turbulence: Option<&TunnelTurbulence>,
        samples: usize,
        travelled_m_a_sample: f64,
        random: &mut ChaCha8Rng,
    ) -> Self {
        let Some(t) = turbulence else {
            return Self {
                u: vec![0.0; samples],
                w: vec![0.0; samples],
            };
        };
        let kept = (-travelled_m_a_sample / t.length_m).exp();
        let drive = (1.0 - kept * kept).sqrt();
        let mut process = |intensity: f64| {
            let mut value: f64 = StandardNormal.sample(random);
            (0..samples)
                .map(|_| {
                    let now = intensity * value;
                    let new: f64 = StandardNormal.sample(random);
                    value = kept * value + drive * new;
                    now
                })
                .collect()
        };
        Self {
            u: process(t.intensity_u),
            w: process(t.intensity_w),
        }
    }
}

/// White noise of the sum of the cells about the centre of rotation. The components that no record holds (spanwise
/// force, the other two moments) have the noise of the lift and of the moment.
pub(super) fn noise(deviation: [f64; 3], random: &mut ChaCha8Rng) -> Wrench {
    let [drag, lift, moment] = deviation;
    let mut normal = || -> f64 { StandardNormal.sample(random) };
    Wrench {
        force: Vector3::new(drag * normal(), lift * normal(), lift * normal()),
        moment: Vector3::new(moment * normal(), moment * normal(), moment * normal()),
    }
}

/// Drift of each channel of one cell: a rise over the recording and half a wave, drawn once.
pub(super) struct Drift([[f64; 2]; 6]);

impl Drift {
    pub(crate) fn new(plan: &Disturbances, random: &mut ChaCha8Rng) -> Self {
        let mut draw = |channel: usize| {
            let size = if channel < 3 {
                plan.drift_n
            } else {
                plan.drift_n_m
            };
            [
                size * random.random_range(-1.0..1.0),
                0.5 * size * random.random_range(-1.0..1.0),
            ]
        };
        Self(std::array::from_fn(&mut draw))
    }

    /// Drift of a channel after a `part` of the recording, 0 to 1.
    pub(crate) fn at(&self, channel: usize, part: f64) -> f64 {
        let [rise, wave] = self.0[channel];
        rise * part + wave * (PI * part).sin()
    }
}

/// Where and how high the spike stands: in the middle of the segment of `record` nearest to its frequency, as a
/// multiple of the largest force there, on the whole model. `forces` are drag, lift, moment a unit length.
pub(super) fn place_spike(
    spike: &Spike,
    record: &Record,
    forces: [Option<&[f64]>; 3],
    length_m: f64,
) -> Option<AppliedSpike> {
    let off = |s: &Segment| (s.frequency_hz / spike.frequency_hz).ln().abs();
    let segments = &record.header.segments;
    let segment = segments.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
    let rate = record.header.sampling_hz;
    let middle = 0.5 * (segment.start_s + segment.end_s);
    let first = ((middle - 0.5 * spike.duration_s) * rate).ceil().max(0.0) as usize;
    let last = ((middle + 0.5 * spike.duration_s) * rate).floor() as usize;
    let range = (segment.start_s * rate) as usize..(segment.end_s * rate) as usize;
    let largest = |force: Option<&[f64]>| {
        largest_magnitude(force.and_then(|f| f.get(range.clone())).unwrap_or(&[]))
    };
    Some(AppliedSpike {
        first,
        samples: (last + 1).saturating_sub(first).max(1),
        height: forces.map(|f| spike.height * largest(f) * length_m),
    })
}

/// The force of a spike at a sample.
pub(super) fn spike_at(spike: &AppliedSpike, sample: usize) -> Option<Wrench> {
    let inside = sample
        .checked_sub(spike.first)
        .filter(|i| *i < spike.samples)?;
    let shape = (PI * (inside as f64 + 0.5) / spike.samples as f64).sin();
    let [drag, lift, moment] = spike.height;
    Some(Wrench::section(drag * shape, lift * shape, moment * shape))
}

/// What the two cells say, local axes: six numbers each, N and N·m.
///
/// The forces are shared as the plan says, `f₁ = s F + C`, `f₂ = (1 − s) F − C` with the clamping force `C`; of the
/// moment that these leave, `M − Σ pᵢ × fᵢ`, the cells bear the same shares, with the clamping moment on top.
/// So `Σ fᵢ = F` and `Σ (mᵢ + pᵢ × fᵢ) = M` about the centre of rotation.
pub(super) fn readings(support: &Support, wrench: &Wrench, theta_rad: f64) -> [[f64; 6]; 2] {
    let clamping = Wrench {
        force: support.clamping_n.into(),
        moment: support.clamping_n_m.into(),
    };
    let shares = [support.share_of_first, 1.0 - support.share_of_first];
    let signs = [1.0, -1.0];
    let force = |i: usize| wrench.force * shares[i] + clamping.force * signs[i];
    let arms: Vec<Vector3<f64>> = support
        .cells
        .iter()
        .map(|cell| cell.position_at(theta_rad))
        .collect();
    let by_forces: Vector3<f64> = arms
        .iter()
        .enumerate()
        .map(|(i, p)| p.cross(&force(i)))
        .sum();
    let mut cells = [[0.0; 6]; 2];
    for (i, (cell, reading)) in support.cells.iter().zip(&mut cells).enumerate() {
        let to_local = cell.axes_at(theta_rad).transpose();
        let moment = (wrench.moment - by_forces) * shares[i] + clamping.moment * signs[i];
        let (force, moment) = (to_local * force(i), to_local * moment);
        reading[..3].copy_from_slice(force.as_slice());
        reading[3..].copy_from_slice(moment.as_slice());
    }
    cells
}
