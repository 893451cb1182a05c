//! Jobs of any size, for curves of cost over size.

use super::bridge::{beam, problem};
use super::fits;
use super::models::{POLE, sources};
use super::samples;
use crate::bridges::coupled;
use crate::entry::{Job, finding};
use aerodeck::Result;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::buffeting::{span_record, turbulence_field};
use aerodeck::flutter::{OnsetSearch, find_onset, trace_modes};
use aerodeck::identification::{Constraints, Form, PoleSearch, TimeFit, TimeWeights, fit_records};
use aerodeck::response::{Inputs, Stepper};
use aerodeck::section::Dof;
use aerodeck::wind_tunnel::{RecordHeader, RecordSource, Segment};
use std::f64::consts::TAU;
use std::hint::black_box;

const STEP_S: f64 = 0.05;
const NODES: usize = 63;
/// Of the flat plate: displacement, rate and two lags.
const STATES_PER_MODE: usize = 4;
const SPEED_M_S: f64 = 30.0;

/// Nodes of a bridge of so many modes: from Langenuen as its modes are stored to the largest that is foreseen.
pub(crate) fn nodes(modes: u64) -> f64 {
    (63.0 * (modes as f64 / 39.0).powf(2.115)).round()
}

fn by_states(states: u64) -> CoupledSection {
    let section = coupled(&beam(NODES, states as usize / STATES_PER_MODE));
    assert_eq!(section.states() as u64, states, "states of the beam");
    section
}

fn stepped(section: CoupledSection, wind: fn(f64) -> f64) -> Job {
    let modes = section.structure().dofs.len();
    let mut stepper = Stepper::new(section);
    let release = stepper.released(&vec![1.0; modes], &vec![0.0; modes]);
    let (mut state, mut n) = (release.expect("a release"), 0.0);
    Job::new(move || {
        let inputs = Inputs::steady(wind(n), modes);
        let step = stepper.advance(&mut state, &inputs, STEP_S);
        step.expect("a step");
        n += 1.0;
    })
}

pub(crate) fn step(states: u64) -> Job {
    stepped(by_states(states), |_| SPEED_M_S)
}

/// Another wind before each step.
pub(crate) fn change_of_wind(states: u64) -> Job {
    stepped(by_states(states), |n| SPEED_M_S + (0.05 * n).sin())
}

pub(crate) fn onset(states: u64) -> Job {
    let (section, search) = (by_states(states), OnsetSearch::default());
    Job::new(move || {
        black_box(find_onset("beam", &section, &search, None).expect("an answer"));
    })
}

fn by_modes(modes: u64) -> aerodeck::bridge::Bridge {
    beam(nodes(modes) as usize, modes as usize)
}

pub(crate) fn assembly(modes: u64) -> Job {
    let bridge = by_modes(modes);
    Job::new(move || {
        black_box(coupled(&bridge));
    })
}

pub(crate) fn bridge_step(modes: u64) -> Job {
    stepped(coupled(&by_modes(modes)), |_| SPEED_M_S)
}

pub(crate) fn sweep(modes: u64) -> Job {
    finding(coupled(&by_modes(modes)), |section| {
        let speeds: Vec<f64> = (1..=10).map(|i| 3.0 * f64::from(i)).collect();
        trace_modes("beam", section, &speeds)
    })
}

/// Turbulence of three minutes and the response to it.
pub(crate) fn buffeting(modes: u64) -> Job {
    finding(by_modes(modes), |bridge| {
        let problem = problem(bridge);
        let field = turbulence_field(&problem, SPEED_M_S, STEP_S, 4096, 1)?;
        let nodes = [bridge.nodes.len() / 2];
        span_record(&problem, &nodes, SPEED_M_S, STEP_S, &field)
    })
}

/// Six filters and least squares over two records.
pub(crate) fn training(samples: u64) -> Job {
    let records = [0, 1].map(|moving| LongRecord::new(moving, samples as usize));
    let fit = TimeFit {
        form: Form::laguerre(6),
        poles: PoleSearch::fixed(&[POLE]),
        constraints: Constraints::None,
        weights: TimeWeights::None,
        ..TimeFit::default()
    };
    finding(records, move |records| {
        let records = records.each_ref().map(|r| r as &dyn RecordSource);
        fit_records(&records, &fit, &|_, _| ())
    })
}

pub(crate) fn monte_carlo(samples: u64) -> Job {
    samples::analysis(samples as usize)
}

// The same work for every number of threads, and what it finds.

pub(crate) fn training_by_threads(_: u64) -> Job {
    let records = super::models::full_set();
    finding(records, |records| {
        fit_records(&sources(records), &TimeFit::default(), &|_, _| ())
    })
}

pub(crate) fn grid_by_threads(_: u64) -> Job {
    fits::grid_continuous()
}

pub(crate) fn monte_carlo_by_threads(_: u64) -> Job {
    samples::analysis(100_000)
}

pub(crate) fn sweep_by_threads(_: u64) -> Job {
    sweep(60)
}

pub(crate) fn buffeting_by_threads(_: u64) -> Job {
    buffeting(60)
}

/// A record of any length that is made while it is read: one motion at eight frequencies, one after the other.
struct LongRecord {
    header: RecordHeader,
    moving: usize,
    samples: usize,
}

const SAMPLING_HZ: f64 = 200.0;
const FREQUENCIES_HZ: [f64; 8] = [0.5, 0.8, 1.1, 1.4, 1.7, 2.0, 2.3, 2.6];

impl LongRecord {
    fn new(moving: usize, samples: usize) -> Self {
        let length_s = samples as f64 / SAMPLING_HZ / FREQUENCIES_HZ.len() as f64;
        let segment = |(i, frequency_hz): (usize, &f64)| Segment {
            frequency_hz: *frequency_hz,
            start_s: i as f64 * length_s,
            end_s: (i + 1) as f64 * length_s,
        };
        let segments = FREQUENCIES_HZ.iter().enumerate().map(segment).collect();
        let header = RecordHeader {
            name: Dof::TWO[moving].name().to_owned(),
            dofs: Dof::TWO.to_vec(),
            width_m: 0.5,
            air_density_kg_m3: 1.2,
            mean_speed_m_s: 8.0,
            sampling_hz: SAMPLING_HZ,
            segments,
            source: String::new(),
            licence: String::new(),
        };
        Self {
            header,
            moving,
            samples,
        }
    }
}

impl RecordSource for LongRecord {
    fn header(&self) -> &RecordHeader {
        &self.header
    }

    fn for_each_block(&self, f: &mut dyn FnMut(&[&[f64]]) -> Result<()>) -> Result<()> {
        const BLOCK: usize = 4096;
        let part = self.samples.div_ceil(FREQUENCIES_HZ.len());
        for first in (0..self.samples).step_by(BLOCK) {
            let samples = first..self.samples.min(first + BLOCK);
            let angle = |k: usize| TAU * FREQUENCIES_HZ[k / part] * k as f64 / SAMPLING_HZ;
            let still = vec![0.0; samples.len()];
            let (mut motion, mut force) = (vec![still.clone(), still.clone()], vec![still; 2]);
            for (at, k) in samples.enumerate() {
                let (sine, cosine) = angle(k).sin_cos();
                motion[self.moving][at] = 0.01 * sine;
                force[0][at] = 3.0 * sine + 0.7 * cosine;
                force[1][at] = 0.4 * sine - 0.2 * cosine;
            }
            let channels = motion.iter().chain(&force);
            f(&channels.map(Vec::as_slice).collect::<Vec<_>>())?;
        }
        Ok(())
    }
}
