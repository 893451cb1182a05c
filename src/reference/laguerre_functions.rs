//! Figures 2.1 to 2.5 and 3.10 of the thesis: Laguerre functions over time, and how strongly their filters pass a frequency.

use crate::aerodynamics::laguerre::{FilterBank, discrete_memory, impulse_response};
use crate::error::Result;
use crate::state_space::c2d;
use nalgebra::{Complex, DMatrix};
use serde::Serialize;
use std::f64::consts::PI;

/// Lines with their labels.
pub type Lines = Vec<(String, Vec<(f64, f64)>)>;

/// The curves of each figure; the parameters are those that the thesis prints, or that its figures span.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LaguerreFunctions {
    /// Figure 2.1: `l_n(τ)`, n = 0 to 4, p = 0.2.
    pub by_order: Lines,
    /// Figure 2.2: `l_2(τ)` for several decay rates p.
    pub by_decay_rate: Lines,
    /// Figure 2.3: `g_n[k]`, n = 0 to 4, α = 0.4.
    pub discrete_by_order: Lines,
    /// Figure 2.4: `g_2[k]` for several α.
    pub discrete_by_alpha: Lines,
    /// Figure 2.5: gain `|G_n|` over the frequency, as a part of half the sampling frequency, for several α.
    pub gain: Lines,
    /// Figure 3.10: the filters of the bridge decks, L = 3, α = 0.6.
    pub of_the_decks: Lines,
    /// Memory of these, samples, from which on none exceeds 0.01.
    pub memory: usize,
}

const ALPHAS: [f64; 4] = [0.2, 0.4, 0.6, 0.8];

impl LaguerreFunctions {
    /// All of them.
    ///
    /// # Errors
    /// [`crate::Error::Numerical`] of an exponential, which these parameters do not cause.
    pub fn of_the_thesis() -> Result<Self> {
        let (filters, alpha) = (3, 0.6);
        let discrete = |alpha, orders: &[usize], samples| {
            let g = impulse_response(alpha, 5, samples);
            let line = |n: &usize| g.row(*n).iter().copied().enumerate().collect::<Vec<_>>();
            orders.iter().map(line).collect::<Vec<_>>()
        };
        let numbered = |lines: Vec<Vec<(usize, f64)>>, label: &dyn Fn(usize) -> String| {
            let over = |points: Vec<(usize, f64)>| {
                points.into_iter().map(|(k, y)| (k as f64, y)).collect()
            };
            let lines = lines.into_iter().enumerate();
            lines.map(|(i, points)| (label(i), over(points))).collect()
        };
        let by_alpha = ALPHAS.iter().flat_map(|a| discrete(*a, &[2], 60)).collect();
        Ok(Self {
            by_order: continuous(0.2, 5)?
                .into_iter()
                .enumerate()
                .map(|(n, points)| (format!("n = {n}"), points))
                .collect(),
            by_decay_rate: [0.1, 0.2, 0.4]
                .into_iter()
                .map(|p| Ok((format!("p = {p}"), continuous(p, 3)?.swap_remove(2))))
                .collect::<Result<_>>()?,
            discrete_by_order: numbered(discrete(0.4, &[0, 1, 2, 3, 4], 40), &|n| {
                format!("n = {n}")
            }),
            discrete_by_alpha: numbered(by_alpha, &|i| format!("α = {}", ALPHAS[i])),
            gain: ALPHAS.map(|a| (format!("α = {a}"), gain(a))).into(),
            of_the_decks: numbered(discrete(alpha, &[0, 1, 2], 60), &|n| format!("n = {n}")),
            memory: discrete_memory(alpha, filters),
        })
    }
}

/// `l_0(τ) … ` (2.12), as impulse responses of the filter bank.
fn continuous(decay_rate: f64, count: usize) -> Result<Vec<Vec<(f64, f64)>>> {
    const STEP: f64 = 0.25;
    let (a, mut state) = FilterBank::laguerre(decay_rate, count)?.matrices();
    let b = DMatrix::from_column_slice(count, 1, state.as_slice());
    let phi = c2d(&a, &b, STEP)?.phi;
    let mut lines = vec![Vec::new(); count];
    for k in 0..=240 {
        for (line, value) in lines.iter_mut().zip(state.iter()) {
            line.push((k as f64 * STEP, *value));
        }
        state = &phi * state;
    }
    Ok(lines)
}

/// `√(1−α)/|1 − √α z⁻¹|` (2.18), the same for every order.
fn gain(alpha: f64) -> Vec<(f64, f64)> {
    let at = |part: f64| {
        let delay = Complex::from_polar(1.0, -PI * part);
        (1.0 - alpha).sqrt() / (1.0 - alpha.sqrt() * delay).norm()
    };
    let parts = (0..=200).map(|i| f64::from(i) / 200.0);
    parts.map(|part| (part, at(part))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (2.12) as it is printed for n = 0 and 1, and (2.16): the sum of squares of every function is one.
    #[test]
    fn functions_are_those_of_the_formulas() {
        let all = LaguerreFunctions::of_the_thesis().unwrap();
        let p: f64 = 0.2;
        for (i, (tau, value)) in all.by_order[1].1.iter().enumerate() {
            let decay = (2.0 * p).sqrt() * (-p * tau).exp();
            assert!((all.by_order[0].1[i].1 - decay).abs() < 1e-12);
            assert!(
                (value - (1.0 - 2.0 * p * tau) * decay).abs() < 1e-12,
                "{tau}"
            );
        }
        for (label, points) in all.discrete_by_order.iter().chain(&all.of_the_decks) {
            let sum: f64 = points.iter().map(|(_, g)| g * g).sum();
            assert!((sum - 1.0).abs() < 1e-6, "{label}: {sum}");
        }
        // a sum over all frequencies of the square of the gain is one as well
        for (label, points) in &all.gain {
            let mean = points.iter().skip(1).map(|(_, g)| g * g).sum::<f64>() / 200.0;
            assert!((mean - 1.0).abs() < 0.05, "{label}: {mean}");
        }
        // the thesis reads about 40 samples from its figure
        assert!((20..=45).contains(&all.memory), "{}", all.memory);
    }
}
