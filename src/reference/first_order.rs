//! The example of section 2.5 of the thesis: a first-order system identified with discrete Laguerre filters.
//!
//! `τ ẏ + y = u` (2.26) with `τ = 0.15 s`, sampled every 5 ms, is trained on sines of six frequencies, asked to predict one
//! that it has not seen, and compared in time and in frequency; then `α` and `L` are varied. The training itself is
//! [`fit_discrete`], the one of bridge decks: a section of one degree of freedom with `B = V = 1` and `ρ = 2`, whose
//! dimensionless motion and force are `u` and `y` themselves.

use crate::aerodynamics::Transfer;
use crate::aerodynamics::laguerre::{alpha_lower_bound, discrete_memory, impulse_response};
use crate::comparison::forces::PerModel;
use crate::error::Result;
use crate::identification::{DiscreteFit, StaticTerm, fit_discrete};
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{Record, RecordHeader, predicted_forces};
use nalgebra::Complex;
use std::f64::consts::TAU;

// the numbers that the thesis prints; it does not print how long each frequency lasts, nor which other `α` its figure shows
/// Time constant `τ`, s.
const TIME_CONSTANT_S: f64 = 0.15;
/// Sampling step, s.
pub(crate) const STEP_S: f64 = 0.005;
/// Frequencies of the training input, in turn, Hz.
const TRAINING_HZ: [f64; 6] = [0.5, 1.0, 1.5, 2.0, 2.5, 3.0];
/// Time at each of them, s; whole periods, so that the input is continuous.
const SECONDS_EACH: f64 = 4.0;
/// Rest before the first, s: longer than any filter of the example remembers.
const REST_S: f64 = 2.0;
/// Frequency of the validation input, Hz.
pub(crate) const VALIDATION_HZ: f64 = 1.3;
/// Number of filters `L`.
pub(crate) const FILTERS: usize = 3;
/// Decay factor.
pub(crate) const ALPHA: f64 = 0.85;
/// Decay factors to be compared (Figure 2.10).
const ALPHAS: [f64; 6] = [0.5, 0.7, 0.8283, 0.85, 0.889, 0.995];
/// Decay factor with which numbers of filters are compared (Figure 2.11).
pub(crate) const ALPHA_OF_ORDERS: f64 = 0.889;
/// Memory on which the upper bound of `α` rests, samples, and the order of the highest filter (2.37).
const MEMORY: (usize, usize) = (176, 3);

/// A transfer function: frequency, Hz, magnitude, and phase, degrees.
type SampledTransfer = PerModel<(f64, f64, f64)>;

/// Everything that Figures 2.6 to 2.11 show.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstOrderResults {
    /// Training input and output, one per step (Figure 2.6).
    pub training: [Vec<f64>; 2],
    /// Validation: input, output of the system, output of the model (Figure 2.7).
    pub validation: [Vec<f64>; 3],
    /// `‖y_model − y‖/‖y‖` of the validation.
    pub validation_error: f64,
    /// Coefficients of the model.
    pub coefficients: Vec<f64>,
    /// The system.
    pub system: SampledTransfer,
    /// The system discretised by Tustin's rule (2.29).
    pub tustin: SampledTransfer,
    /// The model (Figure 2.8).
    pub model: SampledTransfer,
    /// Impulse responses of system and model times the step, one per step (Figure 2.9).
    pub impulse: [Vec<f64>; 2],
    /// Models with other decay factors (Figure 2.10).
    pub by_alpha: Vec<SampledTransfer>,
    /// Models with other numbers of filters (Figure 2.11).
    pub by_order: Vec<SampledTransfer>,
    /// Bounds of `α` by (2.36) and (2.37).
    pub alpha_bounds: (f64, f64),
    /// `|g_3|` at the end of the memory with the `α` of the orders.
    pub last_value: f64,
}

/// Trains all models and samples what the figures show.
///
/// # Errors
/// Those of the fits.
pub fn first_order_example() -> Result<FirstOrderResults> {
    let input = training_input();
    let training = record(&input);
    let model = train(&training, FILTERS, ALPHA)?;
    let frequencies_hz: Vec<f64> = (1..=120).map(|i| 0.05 * f64::from(i)).collect();
    let system = exact(&frequencies_hz);
    let sample = |label: String, model: &Model| {
        let g = frequencies_hz.iter();
        let g = g.map(|f| Ok(model.transfer(ReducedFrequency::from_full_width(TAU * f))?[(0, 0)]));
        let g = g.collect::<Result<Vec<_>>>();
        g.map(|g| sampled(label, &frequencies_hz, &g))
    };
    let trial = |label: String, filters, alpha| sample(label, &train(&training, filters, alpha)?);
    let shown = sine(VALIDATION_HZ, 5.0 / VALIDATION_HZ);
    let validation = record(&shown);
    let predicted = predicted_forces(&model, &validation)?.swap_remove(0);
    let (samples, order) = MEMORY;
    let coefficients = match &model {
        Model::DiscreteLaguerre(m) => m.terms[0].coefficients.as_slice().to_vec(),
        _ => Vec::new(),
    };
    let last = impulse_response(ALPHA_OF_ORDERS, order + 1, samples + 1);
    let tustin = tustin(&frequencies_hz);
    Ok(FirstOrderResults {
        validation_error: relative_error(&predicted, &validation.force[0]),
        validation: [shown, validation.force[0].clone(), predicted],
        model: sample(format!("L = {FILTERS}, α = {ALPHA}"), &model)?,
        by_alpha: (ALPHAS.iter())
            .map(|a| trial(format!("α = {a}"), FILTERS, *a))
            .collect::<Result<_>>()?,
        by_order: (1..=4)
            .map(|l| trial(format!("L = {l}"), l, ALPHA_OF_ORDERS))
            .collect::<Result<_>>()?,
        impulse: impulses(&coefficients),
        alpha_bounds: (
            alpha_lower_bound(highest_hz(), 1.0 / STEP_S),
            alpha_upper_bound(order + 1, samples),
        ),
        last_value: last[(order, samples)].abs(),
        tustin: sampled("Tustin".into(), &frequencies_hz, &tustin),
        system: sampled("system".into(), &frequencies_hz, &system),
        training: [input, training.force[0].clone()],
        coefficients,
    })
}

fn highest_hz() -> f64 {
    TRAINING_HZ.into_iter().fold(0.0, f64::max)
}

fn sine(frequency_hz: f64, seconds: f64) -> Vec<f64> {
    let count = (seconds / STEP_S).round() as usize;
    (0..count)
        .map(|k| (TAU * frequency_hz * k as f64 * STEP_S).sin())
        .collect()
}

fn training_input() -> Vec<f64> {
    let mut input = vec![0.0; (REST_S / STEP_S).round() as usize];
    for f in TRAINING_HZ {
        input.extend(sine(f, SECONDS_EACH));
    }
    input
}

/// Input and output of the system as motion and force; the output is exact for an input that runs straight from sample
/// to sample, as MATLAB's `lsim` takes a smooth one.
fn record(input: &[f64]) -> Record {
    let ratio = STEP_S / TIME_CONSTANT_S;
    let decay = (-ratio).exp();
    // ∫ e^{−(h−t)/τ}/τ of a ramp over the step
    let late = 1.0 - (1.0 - decay) / ratio;
    let early = 1.0 - decay - late;
    let (mut y, mut before) = (0.0, 0.0);
    let output = input.iter().map(|u| {
        y = decay * y + early * before + late * u;
        before = *u;
        y
    });
    Record {
        force: vec![output.collect()],
        motion: vec![input.to_vec()],
        header: RecordHeader {
            name: "first-order system".into(),
            dofs: vec![Dof::Vertical],
            width_m: 1.0,
            air_density_kg_m3: 2.0,
            mean_speed_m_s: 1.0,
            sampling_hz: 1.0 / STEP_S,
            segments: Vec::new(),
            source: "(2.26)".into(),
            licence: String::new(),
        },
    }
}

fn train(training: &Record, filters: usize, alpha: f64) -> Result<Model> {
    let fit = DiscreteFit {
        filters,
        alpha,
        // "neglected because the training signal is with null mean value"
        static_term: StaticTerm::None,
        ..DiscreteFit::default()
    };
    Ok(fit_discrete(&[training], &fit, &|_, _| ())?.model)
}

/// (2.27) at `s = iω`.
fn exact(frequencies_hz: &[f64]) -> Vec<Complex<f64>> {
    let at = |f: &f64| Complex::new(1.0, TAU * f * TIME_CONSTANT_S).inv();
    frequencies_hz.iter().map(at).collect()
}

/// (2.29) at `z = e^{iωΔt}`.
fn tustin(frequencies_hz: &[f64]) -> Vec<Complex<f64>> {
    let (h, tau) = (STEP_S, TIME_CONSTANT_S);
    let at = |f: &f64| {
        let z = Complex::new(0.0, TAU * f * h).exp();
        (z + 1.0) * h / (z * (h + 2.0 * tau) + (h - 2.0 * tau))
    };
    frequencies_hz.iter().map(at).collect()
}

fn sampled(model: String, frequencies_hz: &[f64], g: &[Complex<f64>]) -> SampledTransfer {
    let values = frequencies_hz.iter().zip(g);
    let points = values.map(|(f, z)| (*f, z.norm(), z.arg().to_degrees()));
    let points = points.collect();
    PerModel { model, points }
}

impl FirstOrderResults {
    /// Largest error of a transfer function relative to the system between the lowest and highest training frequency.
    pub fn worst_in_band(&self, of: &SampledTransfer) -> f64 {
        let lowest = TRAINING_HZ.into_iter().fold(f64::INFINITY, f64::min);
        let band = lowest * (1.0 - 1e-9)..=highest_hz() * (1.0 + 1e-9);
        let value = |p: &(f64, f64, f64)| Complex::from_polar(p.1, p.2.to_radians());
        let all = of.points.iter().zip(&self.system.points);
        let inside = all.filter(|(p, _)| band.contains(&p.0));
        let errors = inside.map(|(g, h)| (value(g) - value(h)).norm() / h.1);
        errors.fold(0.0, f64::max)
    }
}

/// `h(t) Δt = Δt/τ e^{−t/τ}` and (2.34).
fn impulses(coefficients: &[f64]) -> [Vec<f64>; 2] {
    let count = (6.0 * TIME_CONSTANT_S / STEP_S).round() as usize;
    let ratio = STEP_S / TIME_CONSTANT_S;
    let g = impulse_response(ALPHA, coefficients.len(), count);
    let columns = g.column_iter();
    let model = columns.map(|g| g.iter().zip(coefficients).map(|(g, c)| g * c).sum());
    [
        (0..count)
            .map(|k| ratio * (-ratio * k as f64).exp())
            .collect(),
        model.collect(),
    ]
}

fn relative_error(found: &[f64], exact: &[f64]) -> f64 {
    let difference: f64 = found.iter().zip(exact).map(|(a, b)| (a - b).powi(2)).sum();
    let size: f64 = exact.iter().map(|x| x * x).sum();
    (difference / size).sqrt()
}

/// Upper bound of `α`: the largest for which the responses of `count` filters have died out after `memory` samples
/// (2.37 with `|g_l[k]| ≤ 0.01` for all `k ≥ M`, since the filters oscillate).
///
/// 0 when even the fastest filters remember more than that.
pub(super) fn alpha_upper_bound(count: usize, memory: usize) -> f64 {
    let (mut low, mut high) = (0.0, 1.0 - 1e-6);
    // the memory is counted in whole samples: beyond this the bound does not move
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        if discrete_memory(middle, count) <= memory {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::laguerre::discrete_memory;

    /// "L = 3, α = 0.85" and what the thesis says of its figures: α bounds 0.8283 and 0.889, |g_3| = 0.0096 at the end of
    /// the memory, a better fit towards the upper bound, "really precisely approximated already with four filters".
    #[test]
    fn figures_of_section_2_5() {
        let results = first_order_example().unwrap();
        let (lower, upper) = results.alpha_bounds;
        assert!((lower - 0.8283).abs() < 5e-5, "{lower}");
        assert!((upper - 0.889).abs() < 1e-3, "{upper}");
        assert!((results.last_value - 0.0096).abs() < 5e-5);
        let memory = discrete_memory(ALPHA, FILTERS);
        assert!(memory as f64 * STEP_S < REST_S);
        let error = |label: &str| {
            let mut trials = results.by_alpha.iter().chain(&results.by_order);
            results.worst_in_band(trials.find(|t| t.model == label).unwrap())
        };
        // "quite well reconstructed … some differences on the peaks"
        assert!(
            (0.02..0.1).contains(&results.validation_error),
            "{}",
            results.validation_error
        );
        assert!((results.worst_in_band(&results.model) - error("α = 0.85")).abs() < 1e-12);
        // below the lower bound the approximation is bad, within the bounds it improves towards the upper one
        for (worse, better) in [
            ("α = 0.5", "α = 0.7"),
            ("α = 0.7", "α = 0.8283"),
            ("α = 0.8283", "α = 0.85"),
            ("α = 0.85", "α = 0.889"),
            ("L = 1", "L = 2"),
            ("L = 2", "L = 3"),
            ("L = 3", "L = 4"),
        ] {
            assert!(error(worse) > error(better), "{worse} {better}");
        }
        assert!(error("α = 0.5") > 0.3 && error("α = 0.889") < 0.05 && error("L = 4") < 0.01);
        // far above the upper bound the filters are too slow for the system
        assert!(error("α = 0.995") > 2.0 * error("α = 0.889"));
    }

    /// Ordinary least squares on (2.32) written out as matrices, with every sample in the memory.
    #[test]
    fn coefficients_are_those_of_the_matrix_form() {
        let results = first_order_example().unwrap();
        let [u, y] = &results.training;
        let g = impulse_response(ALPHA, FILTERS, u.len());
        let x = nalgebra::DMatrix::from_fn(u.len(), FILTERS, |k, l| {
            (0..=k).map(|m| g[(l, m)] * u[k - m]).sum()
        });
        let c = x
            .svd(true, true)
            .solve(&nalgebra::DVector::from_column_slice(y), 0.0)
            .unwrap();
        for (found, expected) in results.coefficients.iter().zip(c.iter()) {
            assert!((found - expected).abs() < 1e-10, "{found} {expected}");
        }
    }

    /// The held output against the closed form of the response to a sine from rest.
    #[test]
    fn the_training_output_is_that_of_the_system() {
        let input = sine(1.3, 3.0);
        let y = &record(&input).force[0];
        let (omega, tau) = (TAU * 1.3, TIME_CONSTANT_S);
        let h = Complex::new(1.0, omega * tau).inv();
        for (k, y) in y.iter().enumerate() {
            let t = k as f64 * STEP_S;
            let steady = (h * Complex::new(0.0, omega * t).exp()).im;
            let exact = steady - h.im * (-t / tau).exp();
            // straight lines between samples: (ωΔt)²/12
            assert!((y - exact).abs() < 2e-4, "{k}: {y} {exact}");
        }
    }

    /// As [`discrete_memory`] counts.
    #[test]
    fn the_largest_decay_factor_is_forgotten_in_time() {
        let upper = alpha_upper_bound(4, 176);
        assert!((upper - 0.889).abs() < 1e-3, "{upper}");
        assert_eq!(discrete_memory(upper, 4), 176);
        assert_eq!(alpha_upper_bound(3, 0), 0.0);
    }
}
