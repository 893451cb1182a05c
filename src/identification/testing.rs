//! Helpers of the tests of this module: the test points of the thesis, and an onset by plain bisection.

use crate::aerodynamics::AerodynamicModel;
use crate::aeroelastic::CoupledSection;
use crate::section::{Dof, SectionModel};
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{Record, RecordHeader, Segment};
use nalgebra::Complex;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Motion frequencies of Table 3.2, Hz.
pub const FREQUENCIES_HZ: [f64; 8] = [0.25, 0.5, 0.8, 1.1, 1.4, 1.7, 2.0, 2.5];

/// Reduced frequencies of the eight motions at one speed, B = 0.5 m.
pub fn eight_k(speed_m_s: f64) -> Vec<ReducedFrequency> {
    FREQUENCIES_HZ
        .iter()
        .map(|&f| ReducedFrequency::from_hertz(f, 0.5, speed_m_s))
        .collect()
}

fn growth(section: &CoupledSection, speed: f64) -> f64 {
    let values = section.at(speed).unwrap().eigenvalues().unwrap();
    // modes only: a filter pole is no flutter
    values
        .iter()
        .filter(|z| z.im > 1.0)
        .map(|z| z.re)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// First wind speed (m/s) above 5 at which a mode of the Table 4.1 section stops being damped.
pub fn onset_m_s(model: &dyn AerodynamicModel) -> f64 {
    let structure = SectionModel::table_4_1().structure().unwrap();
    let section = CoupledSection::new(structure, model.realize().unwrap()).unwrap();
    let mut low = 5.0;
    while growth(&section, low + 0.5) < 0.0 {
        low += 0.5;
        assert!(low < 80.0, "stable up to 80 m/s");
    }
    let mut high = low + 0.5;
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        if growth(&section, middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Forced-vibration records at one speed, one a motion: 8 s of rest, then 27 s at each frequency with ramps of 4 s.
/// The force of a motion `Re a(t) e^{iωt}` is the expansion of `G` about `ω` to second order in the slow `a(t)`.
pub fn records(model: &dyn AerodynamicModel, speed_m_s: f64, noise: f64, seed: u64) -> Vec<Record> {
    let dofs = model.dofs();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    (0..dofs.len())
        .map(|j| {
            let mut record = Record {
                header: header(dofs, j, speed_m_s),
                motion: vec![vec![0.0; SAMPLES]; dofs.len()],
                force: vec![vec![0.0; SAMPLES]; dofs.len()],
            };
            for segment in record.header.segments.clone() {
                add_segment(&mut record, model, j, segment);
            }
            for force in &mut record.force {
                let size = (force.iter().map(|f| f * f).sum::<f64>() / SAMPLES as f64).sqrt();
                for f in force.iter_mut() {
                    // sum of twelve uniform numbers: variance one
                    let gauss: f64 = (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
                    *f += noise * size * gauss;
                }
            }
            record
        })
        .collect()
}

const SAMPLING_HZ: f64 = 200.0;
const REST_S: f64 = 8.0;
const SEGMENT_S: f64 = 27.0;
const RAMP_S: f64 = 4.0;
const SAMPLES: usize = 44_800;

fn header(dofs: &[Dof], moved: usize, speed_m_s: f64) -> RecordHeader {
    RecordHeader {
        name: format!("{} at {speed_m_s} m/s", dofs[moved].name()),
        dofs: dofs.to_vec(),
        width_m: 0.5,
        air_density_kg_m3: 1.19,
        mean_speed_m_s: speed_m_s,
        sampling_hz: SAMPLING_HZ,
        segments: FREQUENCIES_HZ
            .iter()
            .enumerate()
            .map(|(i, &frequency_hz)| Segment {
                frequency_hz,
                start_s: REST_S + SEGMENT_S * i as f64,
                end_s: REST_S + SEGMENT_S * (i + 1) as f64,
            })
            .collect(),
        source: "test".into(),
        licence: "none".into(),
    }
}

/// Envelope with its first two derivatives: quintic ramps at both ends.
fn envelope(t: f64) -> [f64; 3] {
    let ramp = |x: f64| {
        let x = x / RAMP_S;
        if x >= 1.0 {
            [1.0, 0.0, 0.0]
        } else {
            [
                x.powi(3) * (10.0 - 15.0 * x + 6.0 * x * x),
                30.0 * (x * (1.0 - x)).powi(2) / RAMP_S,
                60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (RAMP_S * RAMP_S),
            ]
        }
    };
    let (up, down) = (ramp(t), ramp(SEGMENT_S - t));
    if t < 0.5 * SEGMENT_S {
        up
    } else {
        [down[0], -down[1], down[2]]
    }
}

fn add_segment(record: &mut Record, model: &dyn AerodynamicModel, j: usize, segment: Segment) {
    let h = record.header.clone();
    let n = h.dofs.len();
    let omega = TAU * segment.frequency_hz;
    let g = |w: f64| {
        let k = ReducedFrequency::from_circular(w, h.width_m, h.mean_speed_m_s);
        model.transfer(k).unwrap()
    };
    let d = 1e-4 * omega;
    let (ahead, here, behind) = (g(omega + d), g(omega), g(omega - d));
    let slope = (&ahead - &behind).map(|z| z / (2.0 * d));
    let curvature = (&ahead + &behind - &here - &here).map(|z| z / (d * d));
    let amplitude = if h.dofs[j] == Dof::Torsion {
        1f64.to_radians()
    } else {
        0.01
    };
    let pressure = 0.5 * h.air_density_kg_m3 * h.mean_speed_m_s.powi(2);
    let first = (segment.start_s * SAMPLING_HZ).round() as usize;
    let last = ((segment.end_s * SAMPLING_HZ).round() as usize).min(SAMPLES);
    for k in first..last {
        let t = (k - first) as f64 / SAMPLING_HZ;
        let [a, a1, a2] = envelope(t);
        let turn = Complex::new(0.0, omega * t).exp() * amplitude;
        record.motion[j][k] += (turn * a).re;
        for i in 0..n {
            let scale =
                pressure * h.dofs[i].force_scale(h.width_m) * h.dofs[j].motion_scale(h.width_m);
            // a(t) e^{iωt} is G(ω − i d/dt) a
            let z: Complex<f64> = here[(i, j)] * a
                - Complex::<f64>::i() * slope[(i, j)] * a1
                - curvature[(i, j)] * (0.5 * a2);
            record.force[i][k] += scale * (turn * z).re;
        }
    }
}
