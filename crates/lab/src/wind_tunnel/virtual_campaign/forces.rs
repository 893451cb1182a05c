//! What the load cells of a virtual campaign are made to say: forces of the rigid model about its centre of rotation, gusts,
//! what measurement adds, and the channels of the cells.

use super::plan::{
    AppliedSpike, Disturbances, ModelBody, Spike, StaticWind, Support, TunnelTurbulence,
};
use crate::signal::largest_magnitude;
use crate::wind_tunnel::{Record, Segment};
use nalgebra::{Rotation3, Vector3, Vector6};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::PI;

/// Force and moment about the centre of rotation, global axes: three N, three N·m.
pub(super) type Wrench = Vector6<f64>;

/// From drag, lift (N) and nose-up moment (N·m), which is one about −z.
pub(super) fn section_wrench([drag, lift, moment]: [f64; 3]) -> Wrench {
    Vector6::new(drag, lift, 0.0, 0.0, 0.0, -moment)
}

fn wrench(force: Vector3<f64>, moment: Vector3<f64>) -> Wrench {
    Vector6::new(force.x, force.y, force.z, moment.x, moment.y, moment.z)
}

/// Gravity and inertia of a body of `length_m` with this vertical (m), lateral (m) and torsional (rad) displacement, velocity and
/// acceleration.
pub(super) fn gravity_and_inertia(
    body: &ModelBody,
    length_m: f64,
    [displacement, velocity, acceleration]: &[[f64; 3]; 3],
) -> Wrench {
    let mass = body.mass_kg_m * length_m;
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), -displacement[2]);
    let arm = turn * Vector3::from(body.centre_of_gravity_m);
    let spin = Vector3::new(0.0, 0.0, -velocity[2]);
    let spin_rate = Vector3::new(0.0, 0.0, -acceleration[2]);
    let centre = Vector3::new(acceleration[1], acceleration[0], 0.0);
    let acceleration = centre + spin_rate.cross(&arm) + spin.cross(&spin.cross(&arm));
    let weight = Vector3::new(0.0, -mass * body.gravity_m_s2, 0.0);
    let force = weight - mass * acceleration;
    let moment = arm.cross(&force) - spin_rate * (body.inertia_kg_m2_m * length_m);
    wrench(force, moment)
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

/// Downwind and vertical gust over the mean speed, one per sample: in each direction a first-order process with variance `I²` and
/// correlation `exp(−V τ/length)`, hence a spectrum that is flat below `V/(2π length)` Hz and falls as `f⁻²` above. None without
/// turbulence.
pub(super) fn gusts(
    turbulence: Option<&TunnelTurbulence>,
    samples: usize,
    travelled_m_a_sample: f64,
    random: &mut ChaCha8Rng,
) -> [Vec<f64>; 2] {
    let Some(t) = turbulence else {
        return [vec![0.0; samples], vec![0.0; samples]];
    };
    let kept = (-travelled_m_a_sample / t.length_m).exp();
    let drive = (1.0 - kept * kept).sqrt();
    [t.intensity_u, t.intensity_w].map(|intensity| {
        let mut value: f64 = StandardNormal.sample(random);
        let mut next = |_| {
            let now = intensity * value;
            let new: f64 = StandardNormal.sample(random);
            value = kept * value + drive * new;
            now
        };
        (0..samples).map(&mut next).collect()
    })
}

/// White noise of the sum of the cells about the centre of rotation. The components that no record holds (spanwise
/// force, the other two moments) have the noise of the lift and of the moment.
pub(super) fn noise([drag, lift, moment]: [f64; 3], random: &mut ChaCha8Rng) -> Wrench {
    [drag, lift, lift, moment, moment, moment]
        .map(|deviation| {
            let normal: f64 = StandardNormal.sample(random);
            deviation * normal
        })
        .into()
}

/// Drift of each channel of one cell, drawn once: the size of a rise over the recording and that of half a wave.
pub(super) fn drift(plan: &Disturbances, random: &mut ChaCha8Rng) -> [[f64; 2]; 6] {
    std::array::from_fn(|channel| {
        let size = match channel {
            0..3 => plan.drift_n,
            _ => plan.drift_n_m,
        };
        [
            size * random.random_range(-1.0..1.0),
            0.5 * size * random.random_range(-1.0..1.0),
        ]
    })
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
    let inside = sample.checked_sub(spike.first);
    let inside = inside.filter(|i| *i < spike.samples)?;
    let shape = (PI * (inside as f64 + 0.5) / spike.samples as f64).sin();
    Some(section_wrench(spike.height.map(|height| height * shape)))
}

/// What the two cells say, local axes: six numbers each, N and N·m.
///
/// The forces are shared as the plan says, `f₁ = s F + C`, `f₂ = (1 − s) F − C` with the clamping force `C`; of the
/// moment that these leave, `M − Σ pᵢ × fᵢ`, the cells bear the same shares, with the clamping moment on top.
/// So `Σ fᵢ = F` and `Σ (mᵢ + pᵢ × fᵢ) = M` about the centre of rotation.
pub(super) fn readings(support: &Support, on_model: &Wrench, theta_rad: f64) -> [[f64; 6]; 2] {
    let clamping: [Vector3<f64>; 2] = [support.clamping_n.into(), support.clamping_n_m.into()];
    let shares = [support.share_of_first, 1.0 - support.share_of_first];
    let shared = |what: Vector3<f64>, clamping: Vector3<f64>| {
        [what * shares[0] + clamping, what * shares[1] - clamping]
    };
    let forces = shared(on_model.fixed_rows::<3>(0).into_owned(), clamping[0]);
    let places = support.cells.iter().zip(&forces);
    let by_forces: Vector3<f64> = places
        .map(|(cell, force)| cell.position_at(theta_rad).cross(force))
        .sum();
    let moments = shared(on_model.fixed_rows::<3>(3) - by_forces, clamping[1]);
    std::array::from_fn(|i| {
        let to_local = support.cells[i].axes_at(theta_rad).transpose();
        wrench(to_local * forces[i], to_local * moments[i]).into()
    })
}
