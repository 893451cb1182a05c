//! What measurement adds: noise, drift, a spike.

use super::body::Wrench;
use super::plan::{Disturbances, Spike};
use super::truth::AppliedSpike;
use crate::wind_tunnel::{Record, Segment};
use nalgebra::Vector3;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::PI;

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
    pub fn new(plan: &Disturbances, random: &mut ChaCha8Rng) -> Self {
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
    pub fn at(&self, channel: usize, part: f64) -> f64 {
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
        let of_segment = force.and_then(|f| f.get(range.clone())).unwrap_or(&[]);
        of_segment.iter().fold(0.0_f64, |m, x| m.max(x.abs()))
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
