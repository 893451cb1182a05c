//! Response of a bridge in the frequency domain: `S_η = H S_Q Hᴴ` with all modes coupled.

use super::{SpanProblem, unstable};
use crate::aerodynamics::Transfer;
use crate::bridge::{Bridge, ModalForces};
use crate::buffeting::quadrature::integrate;
use crate::buffeting::spectrum::GustComponent;
use crate::buffeting::stability::{Turning, turning};
use crate::error::{Error, Result};
use crate::flutter::{impedance, solve_complex};
use crate::section::Structure;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::{Complex, DMatrix};
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::TAU;

/// Relative error of the variances.
const TOLERANCE: f64 = 1e-5;
/// The integration ends at this many times the highest frequency of the bridge.
const REACH: f64 = 4.0;
/// Frequencies of a spectrum that are spread evenly, and those to each side of a resonance.
const EVEN: usize = 300;
const AROUND: i32 = 12;

/// Response at named nodes to turbulence at one mean wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpanResponse {
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// Places of the nodes in the bridge.
    pub nodes: Vec<usize>,
    /// Root mean square of vertical, lateral displacement (m) and rotation (rad) of each node.
    pub rms: Vec<[f64; 3]>,
    /// Mean frequency of upward crossings of the mean, Hz.
    pub crossing_frequency_hz: Vec<[f64; 3]>,
    /// Part of each variance inside the tested range of `K`, where the forces have one; the rest rests on forces that were
    /// not tested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub part_in_tested_range: Option<Vec<[f64; 3]>>,
}

impl SpanResponse {
    /// Expected greatest departure from the mean in `duration_s`, over the root mean square (Davenport 1964).
    pub(crate) fn peak_factors(&self, duration_s: f64) -> Vec<[f64; 3]> {
        let each = self.crossing_frequency_hz.iter();
        each.map(|f| f.map(|hertz| peak_factor(hertz, duration_s)))
            .collect()
    }
}

/// Expected greatest departure from the mean in `duration_s` of what crosses it upwards `hertz` times a second, over the root mean
/// square (Davenport 1964).
pub(crate) fn peak_factor(hertz: f64, duration_s: f64) -> f64 {
    let root = (2.0 * (hertz * duration_s).max(1.0).ln()).sqrt();
    root + 0.577_215_664_901_532_9 / root
}

/// One-sided spectra of the displacements of named nodes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpanSpectra {
    /// Hz, rising from zero; close together at the resonances.
    pub frequencies_hz: Vec<f64>,
    /// Vertical, lateral (m²/Hz) and rotation (rad²/Hz) of each node at every frequency.
    pub densities: Vec<[Vec<f64>; 3]>,
}

/// A bridge in turbulence at one mean wind speed, at which it is stable. Its self-excited forces are asked for at frequencies
/// alone, so that tables serve as well as models.
pub(crate) struct SpanFrequency<'a> {
    problem: &'a SpanProblem<'a>,
    structure: Structure,
    forces: ModalForces,
    speed_m_s: f64,
    /// Components of the turbulence with the forces of their long gusts, nodes×modes.
    gust_forces: Vec<(GustComponent, DMatrix<f64>)>,
    /// Hz, and half of the half-power width of each.
    resonances_hz: Vec<(f64, f64)>,
    highest_hz: f64,
}

impl<'a> SpanFrequency<'a> {
    /// Looks whether the bridge is stable at this speed, and where it resonates.
    ///
    /// # Errors
    /// [`Error::Input`] for parts that do not fit together and forces that say nothing at a `K`; [`Error::Unstable`] when the
    /// bridge is unstable at this speed; [`Error::Numerical`] at an onset itself.
    pub(crate) fn new(problem: &'a SpanProblem<'a>, speed_m_s: f64) -> Result<Self> {
        problem.validate(speed_m_s)?;
        let (structure, forces) = (problem.bridge.structure(), problem.bridge.forces());
        let turned = turning(&structure, &forces, speed_m_s)?;
        if turned.growing > 0 {
            let at = growth(&turned, &structure, &forces, speed_m_s);
            return Err(unstable(turned.growing, &at, speed_m_s));
        }
        let modes = problem.bridge.modes.iter();
        let highest = modes.map(|m| m.frequency_hz).fold(0.0, f64::max);
        let mut resonances_hz = turned.resonances_hz;
        resonances_hz.retain(|(hertz, _)| *hertz < REACH * highest);
        Ok(Self {
            problem,
            structure,
            forces,
            speed_m_s,
            gust_forces: GustComponent::BOTH
                .map(|c| (c, problem.force_of_long_gusts(c, speed_m_s)))
                .to_vec(),
            resonances_hz,
            highest_hz: highest,
        })
    }

    /// Root mean squares of the displacements of `nodes` about their mean. `tested` are the reduced frequencies, of the bridge,
    /// in which the forces were tested.
    ///
    /// # Errors
    /// [`Error::Input`] for forces that say nothing at a `K`; [`Error::Numerical`] when the integral does not settle.
    pub(crate) fn response(
        &self,
        nodes: &[usize],
        tested: Option<ReducedFrequencyRange>,
    ) -> Result<SpanResponse> {
        let shapes = self.problem.bridge.shapes_at(nodes);
        let speed_m_s = self.speed_m_s;
        let hertz = |k: ReducedFrequency| k.circular(self.structure.width_m, speed_m_s) / TAU;
        let tested = tested.map(|range| (hertz(range.min), hertz(range.max)));
        let last = REACH * self.highest_hz;
        let mut breaks = vec![0.0, last];
        breaks.extend(self.resonances_hz.iter().map(|(hertz, _)| *hertz));
        breaks.extend(tested.iter().flat_map(|(low, high)| [*low, *high]));
        breaks.retain(|f| *f <= last);
        breaks.sort_by(f64::total_cmp);
        breaks.dedup_by(|a, b| *a <= *b * (1.0 + 1e-6));
        let densities = |f: f64| -> Result<Vec<f64>> {
            let spectra = self.spectra_at(f, &shapes)?;
            let inside = tested.is_some_and(|(low, high)| (low..=high).contains(&f));
            let rates = spectra.iter().map(|s| s * (TAU * f).powi(2));
            let part = spectra.iter().map(|s| if inside { *s } else { 0.0 });
            Ok(spectra.iter().copied().chain(rates).chain(part).collect())
        };
        let at_all = |all: &[f64]| all.par_iter().map(|f| densities(*f)).collect();
        let (variances, _) = integrate(at_all, &breaks, TOLERANCE)?;
        let rows = shapes.nrows();
        let list = |of: &dyn Fn(usize) -> f64| -> Vec<[f64; 3]> {
            let count = 0..nodes.len();
            count
                .map(|n| std::array::from_fn(|i| of(3 * n + i)))
                .collect()
        };
        Ok(SpanResponse {
            speed_m_s,
            nodes: nodes.to_vec(),
            rms: list(&|row| variances[row].sqrt()),
            crossing_frequency_hz: list(&|row| {
                (variances[rows + row] / variances[row]).sqrt() / TAU
            }),
            part_in_tested_range: tested
                .map(|_| list(&|row| variances[2 * rows + row] / variances[row])),
        })
    }

    /// Spectra of the displacements of `nodes`, from zero to four times the fastest resonance.
    ///
    /// # Errors
    /// [`Error::Input`] for forces that say nothing at a `K`.
    pub(crate) fn spectra(&self, nodes: &[usize]) -> Result<SpanSpectra> {
        let frequencies_hz = resolved(&self.resonances_hz);
        let shapes = self.problem.bridge.shapes_at(nodes);
        let mut densities = vec![[const { Vec::new() }; 3]; nodes.len()];
        let each = frequencies_hz.par_iter();
        let each = each.map(|f| self.spectra_at(*f, &shapes));
        for all in each.collect::<Result<Vec<_>>>()? {
            for (row, density) in all.into_iter().enumerate() {
                densities[row / 3][row % 3].push(density);
            }
        }
        Ok(SpanSpectra {
            frequencies_hz,
            densities,
        })
    }

    /// One-sided spectra of the rows of `shapes` at a frequency.
    fn spectra_at(&self, frequency_hz: f64, shapes: &DMatrix<f64>) -> Result<Vec<f64>> {
        // the limit at zero: what is static has no phase
        let frequency = frequency_hz.max(1e-9);
        let sides = shapes.transpose().map(Complex::from);
        let parts = self.parts_of_rows(frequency, &sides)?;
        let mut total = vec![0.0; shapes.nrows()];
        for gust in self.gusts_at(frequency) {
            // motion of each row by a gust of the size of the turbulence at each node
            let motion = gust.forces * &parts;
            for (row, sum) in total.iter_mut().enumerate() {
                let (re, im) = (motion.column(2 * row), motion.column(2 * row + 1));
                let unit = re.iter().zip(im.iter());
                let each = unit.map(|(re, im)| Complex::new(*re, *im));
                let sized = each.zip(&gust.sizes).map(|(z, size)| z * size);
                *sum += coherent_power(sized, &gust.gaps);
            }
        }
        Ok(total)
    }

    /// Rows of Φ H, (Zᵀ)⁻¹ Φᵀ, at a frequency, real and imaginary parts beside each other, since the forces of long gusts are real.
    pub(super) fn parts_of_rows(
        &self,
        frequency: f64,
        sides: &DMatrix<Complex<f64>>,
    ) -> Result<DMatrix<f64>> {
        let speed = self.speed_m_s;
        let z = impedance(&self.structure, &self.forces, speed, TAU * frequency)?;
        let rows = solve_complex(&z.transpose(), sides).ok_or_else(|| {
            Error::Numerical(format!(
                "buffeting: the impedance is singular at {frequency} Hz and {speed} m/s"
            ))
        })?;
        Ok(DMatrix::from_fn(
            rows.nrows(),
            2 * rows.ncols(),
            |m, column| {
                let z = rows[(m, column / 2)];
                if column % 2 == 0 { z.re } else { z.im }
            },
        ))
    }

    /// The components of the turbulence at a frequency.
    pub(super) fn gusts_at(&self, frequency: f64) -> Vec<GustAlongSpan<'_>> {
        let (problem, speed) = (self.problem, self.speed_m_s);
        let mut gusts = Vec::with_capacity(self.gust_forces.len());
        for (component, forces) in &self.gust_forces {
            let Some(gust) = problem.turbulence.component(*component) else {
                continue;
            };
            let coherence = &problem.coherence;
            let gaps = coherence.of_gaps(*component, problem.bridge, frequency, speed);
            let mut sizes = vec![Complex::default(); forces.nrows()];
            for group in problem.blown() {
                let local = group.wind_factor * speed;
                let density = gust.spectrum.density(*component, frequency, local);
                let size = problem.admittance(gust, group, frequency, speed) * density.sqrt();
                group.nodes.iter().for_each(|n| sizes[*n] = size);
            }
            gusts.push(GustAlongSpan {
                forces,
                sizes,
                gaps,
            });
        }
        gusts
    }

    /// Frequencies between which everything is smooth, Hz.
    pub(super) fn resolved_hz(&self) -> Vec<f64> {
        resolved(&self.resonances_hz)
    }

    /// The bridge.
    pub(crate) fn bridge(&self) -> &Bridge {
        self.problem.bridge
    }
}

/// A component of the turbulence at one frequency.
pub(super) struct GustAlongSpan<'a> {
    /// Forces of long gusts, nodes×modes.
    pub(super) forces: &'a DMatrix<f64>,
    /// Square root of the density at each node, with the admittance.
    pub(super) sizes: Vec<Complex<f64>>,
    /// Coherence of neighbouring nodes.
    pub(super) gaps: Vec<f64>,
}

/// Where motions grow, in words, and whether tables know of it.
fn growth(turned: &Turning, structure: &Structure, forces: &ModalForces, speed: f64) -> String {
    let growing = turned.resonances_hz.iter().filter(|r| r.1 < 0.0);
    let one = |(hertz, _): &(f64, f64)| {
        let k = ReducedFrequency::from_hertz(*hertz, structure.width_m, speed);
        let tested = match forces.known_range().map(|range| range.contains(k)) {
            Some(true) => ", inside the tested range",
            Some(false) => ", where nothing was tested",
            None => "",
        };
        format!(" near {hertz:.4} Hz (K {:.3}{tested})", k.full_width())
    };
    growing.map(one).collect::<Vec<_>>().join(",")
}

/// Frequencies, Hz, that show every resonance: zero, from a hundredth of the slowest on evenly spread on a logarithmic scale,
/// and within ten half-power widths of each. Zero, since a motion whose resonance is a fast one follows slow gusts: below the
/// hundredth lies a twenty-fifth of the variance of a rotation.
fn resolved(resonances_hz: &[(f64, f64)]) -> Vec<f64> {
    let hertz = resonances_hz.iter().map(|r| r.0);
    let lowest = hertz.clone().fold(f64::INFINITY, f64::min) / 100.0;
    let highest = hertz.fold(0.0, f64::max) * REACH;
    let even = (0..=EVEN).map(|i| lowest * (highest / lowest).powf(i as f64 / EVEN as f64));
    let near = resonances_hz.iter().flat_map(|(f, half)| {
        (-AROUND..=AROUND)
            .map(move |i| f + half.abs() * 10.0 * (f64::from(i) / f64::from(AROUND)).powi(3))
    });
    let above = even.chain(near.filter(|f| *f > 0.0));
    let mut all: Vec<f64> = std::iter::once(0.0).chain(above).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| *a <= *b * (1.0 + 1e-9));
    all
}

/// `vᴴ C v` with the exponential coherence of a line, in one pass: `C = T + Tᴴ − I` with a recursion for `T`.
fn coherent_power(v: impl Iterator<Item = Complex<f64>>, gaps: &[f64]) -> f64 {
    let mut sum = 0.0;
    let mut before = Complex::default();
    for (n, z) in v.enumerate() {
        if n > 0 {
            before *= gaps[n - 1];
        }
        sum += z.norm_sqr() + 2.0 * (z.conj() * before).re;
        before += z;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_pass_is_the_double_sum() {
        let along = [0.0, 3.0, 4.5, 10.0, 11.0f64];
        let v: Vec<Complex<f64>> = (0..5)
            .map(|i| Complex::new((f64::from(i) * 1.3).sin(), 0.2 * f64::from(i)))
            .collect();
        let gaps: Vec<f64> = along
            .windows(2)
            .map(|x| (-0.3 * (x[1] - x[0])).exp())
            .collect();
        let mut expected = Complex::<f64>::default();
        for (a, x) in v.iter().zip(along) {
            for (b, y) in v.iter().zip(along) {
                let coherence: f64 = (-0.3 * f64::abs(x - y)).exp();
                expected += a.conj() * b * coherence;
            }
        }
        assert!((coherent_power(v.iter().copied(), &gaps) - expected.re).abs() < 1e-13);
    }
}
