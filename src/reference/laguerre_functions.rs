//! Figures 2.1 to 2.5 and 3.10 of the thesis: Laguerre functions over time, and how strongly their filters pass a frequency.

use crate::aerodynamics::laguerre::{FilterBank, impulse_response};
use crate::error::Result;
use crate::state_space::c2d;
use nalgebra::{Complex, DMatrix};
use std::f64::consts::PI;

/// Lines with their labels.
pub type Lines = Vec<(String, Vec<(f64, f64)>)>;

const ALPHAS: [f64; 4] = [0.2, 0.4, 0.6, 0.8];
const DECAY_RATES: [f64; 3] = [0.1, 0.2, 0.4];

/// Decay factor and number of the filters of the bridge decks, in Figure 3.10.
pub const OF_THE_DECKS: (f64, usize) = (0.6, 3);

/// The curves of each figure; the parameters are those that the thesis prints, or that its figures span. `l_n(τ)`, n = 0 to 4, p = 0.2
/// (2.1); `l_2(τ)` for several decay rates p (2.2); `g_n[k]`, n = 0 to 4, α = 0.4 (2.3); `g_2[k]` for several α (2.4); gain `|G_n|` over the
/// frequency, as a part of half the sampling frequency, for several α (2.5); the filters of the bridge decks (3.10).
///
/// # Errors
/// [`crate::Error::Numerical`] of an exponential, which these parameters do not cause.
pub fn laguerre_functions() -> Result<[Lines; 6]> {
    let discrete = |alpha, orders: std::ops::Range<usize>, samples| {
        let g = impulse_response(alpha, 5, samples);
        let numbered = |n| {
            let (row, point) = (g.row(n), |(k, y): (usize, &f64)| (k as f64, *y));
            row.iter().enumerate().map(point).collect()
        };
        orders.map(numbered).collect::<Vec<_>>()
    };
    let by_order = |lines| labelled(lines, &|n| format!("n = {n}"));
    let by_alpha = |lines| labelled(lines, &|i| format!("α = {}", ALPHAS[i]));
    let second = DECAY_RATES.map(|p| Ok(continuous(p, 3)?.swap_remove(2)));
    let second = second.into_iter().collect::<Result<Vec<_>>>()?;
    let of_alphas = ALPHAS.iter().flat_map(|a| discrete(*a, 2..3, 60));
    Ok([
        by_order(continuous(0.2, 5)?),
        labelled(second, &|i| format!("p = {}", DECAY_RATES[i])),
        by_order(discrete(0.4, 0..5, 40)),
        by_alpha(of_alphas.collect()),
        by_alpha(ALPHAS.map(gain).into()),
        by_order(discrete(OF_THE_DECKS.0, 0..3, 60)),
    ])
}

fn labelled(lines: Vec<Vec<(f64, f64)>>, label: &dyn Fn(usize) -> String) -> Lines {
    let lines = lines.into_iter().enumerate();
    lines.map(|(i, points)| (label(i), points)).collect()
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
    use super::{OF_THE_DECKS, laguerre_functions};
    use crate::aerodynamics::laguerre::discrete_memory;

    /// (2.12) as it is printed for n = 0 and 1, and (2.16): the sum of squares of every function is one.
    #[test]
    fn functions_are_those_of_the_formulas() {
        let [by_order, _, discrete, _, gain, of_the_decks] = laguerre_functions().unwrap();
        let p: f64 = 0.2;
        for (i, (tau, value)) in by_order[1].1.iter().enumerate() {
            let decay = (2.0 * p).sqrt() * (-p * tau).exp();
            assert!((by_order[0].1[i].1 - decay).abs() < 1e-12);
            assert!(
                (value - (1.0 - 2.0 * p * tau) * decay).abs() < 1e-12,
                "{tau}"
            );
        }
        for (label, points) in discrete.iter().chain(&of_the_decks) {
            let sum: f64 = points.iter().map(|(_, g)| g * g).sum();
            assert!((sum - 1.0).abs() < 1e-6, "{label}: {sum}");
        }
        // a sum over all frequencies of the square of the gain is one as well
        for (label, points) in &gain {
            let mean = points.iter().skip(1).map(|(_, g)| g * g).sum::<f64>() / 200.0;
            assert!((mean - 1.0).abs() < 0.05, "{label}: {mean}");
        }
        // the thesis reads about 40 samples from its figure
        let memory = discrete_memory(OF_THE_DECKS.0, OF_THE_DECKS.1);
        assert!((20..=45).contains(&memory), "{memory}");
    }
}
