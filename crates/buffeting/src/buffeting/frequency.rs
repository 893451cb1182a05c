//! Spectra of the response, `S_r = H S_Q Hᴴ` with all coordinates coupled, and their integrals.

use super::coherence::coherent_power;
use super::problem::BuffetingProblem;
use super::quadrature::integrate;
use super::response::{BuffetingResponse, SpanResponse, SpectrumCurve, by_node, part};
use super::stability::{FEW, turning};
use crate::aerodynamics::GustComponent;
use crate::error::{Error, Result};
use crate::flutter::{impedance, solve_complex};
use crate::units::{ReducedFrequency, ReducedFrequencyRange, in_equal_ratios};
use aerodeck_core::threads;
use nalgebra::{Complex, DMatrix};
use std::f64::consts::TAU;

/// Relative error of the variances of a bridge, and of those of accelerations, which end at the highest frequency below.
const TOLERANCE: f64 = 1e-5;
/// Of those of a section.
const SECTION_TOLERANCE: f64 = 1e-8;
/// The integration ends at this many times the highest natural frequency of a bridge.
const REACH: f64 = 4.0;
/// Of a section, for which that over the inverse of the frequency begins there.
const SECTION_REACH: f64 = 20.0;
/// Frequencies of a spectrum that are spread evenly, and those to each side of a resonance.
const EVEN: usize = 300;
const AROUND: i32 = 12;

/// A component of the turbulence at one frequency.
pub(super) struct GustAlongSpan {
    pub(super) component: GustComponent,
    /// Square root of the density at each node, with the admittance, times the mean wind.
    pub(super) sizes: Vec<Complex<f64>>,
    /// Coherence of neighbouring nodes.
    pub(super) gaps: Vec<f64>,
}

impl BuffetingProblem<'_> {
    /// One-sided spectra of the rows of `shapes` at a frequency by `u` and by `w` each, which are independent, so that they add up: m²/Hz,
    /// rad²/Hz.
    fn spectra_by_gust(
        &self,
        frequency_hz: f64,
        speed_m_s: f64,
        shapes: &DMatrix<f64>,
    ) -> Result<Vec<[f64; 2]>> {
        // the limit at zero: what is static has no phase
        let frequency = frequency_hz.max(1e-9);
        let sides = shapes.transpose().map(Complex::from);
        let parts = self.parts_of_rows(frequency, speed_m_s, &sides)?;
        let mut spectra = vec![[0.0; 2]; shapes.nrows()];
        for gust in self.gusts_at(frequency, speed_m_s) {
            // motion of each row by a gust of the size of the turbulence at each node
            let motion = &self.gust_forces[gust.component as usize] * &parts;
            for (row, by_gust) in spectra.iter_mut().enumerate() {
                let (re, im) = (motion.column(2 * row), motion.column(2 * row + 1));
                let unit = re.iter().zip(im.iter());
                let each = unit.map(|(re, im)| Complex::new(*re, *im));
                let sized = each.zip(&gust.sizes).map(|(z, size)| z * size);
                by_gust[gust.component as usize] = coherent_power(sized, &gust.gaps);
            }
        }
        Ok(spectra)
    }

    /// The sums of both.
    fn spectra(
        &self,
        frequency_hz: f64,
        speed_m_s: f64,
        shapes: &DMatrix<f64>,
    ) -> Result<Vec<f64>> {
        let by_gust = self.spectra_by_gust(frequency_hz, speed_m_s, shapes)?;
        Ok(by_gust.into_iter().map(|[u, w]| u + w).collect())
    }

    /// Spectra of the displacements of `nodes` over frequencies, Hz.
    pub fn spectra_over(
        &self,
        frequency_hz: Vec<f64>,
        speed_m_s: f64,
        nodes: &[usize],
    ) -> Result<SpectrumCurve> {
        let shapes = self.shapes_at(nodes);
        let rows = threads::each(&frequency_hz, true, |f| {
            self.spectra(*f, speed_m_s, &shapes)
        });
        let rows = rows.into_iter().collect::<Result<Vec<_>>>()?;
        let column = |i: usize| rows.iter().map(|row| row[i]).collect();
        let gust = GustComponent::BOTH.map(|c| {
            let gust = self.turbulence.component(c);
            let density = |f| gust.map_or(0.0, |g| g.spectrum.density(c, f, speed_m_s));
            frequency_hz.iter().map(|f| density(*f)).collect()
        });
        Ok(SpectrumCurve {
            speed_m_s,
            gust,
            motion: (0..shapes.nrows()).map(column).collect(),
            frequency_hz,
        })
    }

    /// Rows of Φ H, (Zᵀ)⁻¹ Φᵀ, at a frequency, real and imaginary parts beside each other, since the forces of long gusts are real.
    pub(super) fn parts_of_rows(
        &self,
        frequency_hz: f64,
        speed_m_s: f64,
        sides: &DMatrix<Complex<f64>>,
    ) -> Result<DMatrix<f64>> {
        let z = impedance(&self.structure, self.model(), speed_m_s, TAU * frequency_hz)?;
        let z = z.transpose();
        // of few coordinates nothing is gained by vectors of the processor
        let rows = match z.nrows() > FEW {
            true => solve_complex(&z, sides),
            false => z.lu().solve(sides),
        };
        let rows = rows.ok_or_else(|| {
            Error::Numerical(format!(
                "buffeting: the impedance is singular at {frequency_hz} Hz and {speed_m_s} m/s"
            ))
        })?;
        let (n, count) = rows.shape();
        Ok(DMatrix::from_fn(n, 2 * count, |m, column| {
            let z = rows[(m, column / 2)];
            if column % 2 == 0 { z.re } else { z.im }
        }))
    }

    /// The components of the turbulence at a frequency.
    pub(super) fn gusts_at(&self, frequency_hz: f64, speed_m_s: f64) -> Vec<GustAlongSpan> {
        let winds = self.winds_m_s(speed_m_s);
        let mut gusts = Vec::with_capacity(2);
        for component in GustComponent::BOTH {
            let Some(gust) = self.turbulence.component(component) else {
                continue;
            };
            let sizes = self.at_nodes(|strips| {
                let local = strips.wind_factor * speed_m_s;
                let density = gust.spectrum.density(component, frequency_hz, local);
                self.admittance(gust, strips, frequency_hz, speed_m_s) * density.sqrt()
            });
            let coherence = &self.coherence;
            gusts.push(GustAlongSpan {
                component,
                sizes,
                gaps: coherence.of_gaps(component, &self.nodes, frequency_hz, &winds),
            });
        }
        gusts
    }
}

/// A structure in turbulence at one mean wind speed. Its self-excited forces are asked for at frequencies alone, so that tables serve as
/// well as models.
pub struct FrequencyDomain<'a> {
    pub(super) problem: &'a BuffetingProblem<'a>,
    pub(super) speed_m_s: f64,
    /// Motions that grow.
    pub growing: usize,
    /// Frequencies of resonance, Hz, and half of the half-power width of each, negative where the motion grows.
    resonances_hz: Vec<(f64, f64)>,
}

impl<'a> FrequencyDomain<'a> {
    /// At a speed at which the structure is stable.
    ///
    /// # Errors
    /// Those of [`Self::turned`]; [`Error::Unstable`] when the structure is unstable at this speed.
    pub fn new(problem: &'a BuffetingProblem<'a>, speed_m_s: f64) -> Result<Self> {
        let domain = Self::turned(problem, speed_m_s)?;
        match domain.growing {
            0 => Ok(domain),
            growing => Err(problem.unstable(growing, &domain.growth(), speed_m_s)),
        }
    }

    /// Looks where the structure resonates, and how many of its motions grow.
    ///
    /// # Errors
    /// [`Error::Input`] for forces that say nothing at a `K`; [`Error::Numerical`] at an onset itself.
    pub fn turned(problem: &'a BuffetingProblem<'a>, speed_m_s: f64) -> Result<Self> {
        let (growing, resonances_hz) = turning(&problem.structure, problem.model(), speed_m_s)?;
        Ok(Self {
            problem,
            speed_m_s,
            growing,
            resonances_hz,
        })
    }

    /// Root mean squares of a section, the variances integrated over all frequencies to 1e-8. `tested` is the range of reduced frequencies
    /// in which the model was tested.
    ///
    /// # Errors
    /// Those of [`Self::response`].
    pub fn section_response(
        &self,
        tested: Option<ReducedFrequencyRange>,
    ) -> Result<BuffetingResponse> {
        let last = SECTION_REACH * self.problem.highest_hz;
        let peaks: Vec<f64> = self.resonances_below(last).map(|r| r.0).collect();
        let breaks = [&[0.0], &peaks[..], &[last]].concat();
        let (problem, speed) = (self.problem, self.speed_m_s);
        let all = |f: f64| problem.spectra(f, speed, &problem.shapes);
        // by u, by w, of the rate, one motion after the other
        let densities = |f: f64| -> Result<Vec<f64>> {
            let square = (TAU * f).powi(2);
            let each = problem.spectra_by_gust(f, speed, &problem.shapes)?;
            let each = each.into_iter();
            Ok(each.flat_map(|[u, w]| [u, w, square * (u + w)]).collect())
        };
        let inner = self.integral(densities, &breaks, SECTION_TOLERANCE)?;
        let beyond = |t: f64| -> Result<Vec<f64>> {
            let values = densities(1.0 / t)?.into_iter();
            Ok(values.map(|v| v / (t * t)).collect())
        };
        // a millionth of the whole at most, so a coarser tolerance does
        let tail = self.integral(beyond, &[0.0, 1.0 / last], 1e-4)?;
        let sums: Vec<f64> = inner.iter().zip(tail).map(|(a, b)| a + b).collect();
        let motions = || sums.chunks_exact(3);
        let rms: Vec<f64> = motions().map(|m| (m[0] + m[1]).sqrt()).collect();
        let rate_rms: Vec<f64> = motions().map(|m| m[2].sqrt()).collect();
        // by themselves, so that those of the displacements do not hang on them
        let accelerations = |f: f64| -> Result<Vec<f64>> {
            let fourth = (TAU * f).powi(4);
            Ok(all(f)?.iter().map(|s| fourth * s).collect())
        };
        let accelerations = self.integral(accelerations, &breaks, TOLERANCE)?;
        let tested = tested.map(|range| -> Result<Vec<f64>> {
            let (low, high) = self.hertz(range);
            let within = peaks.iter().copied().filter(|f| (low..high).contains(f));
            let breaks: Vec<f64> = [low].into_iter().chain(within).chain([high]).collect();
            let inside = self.integral(all, &breaks, 1e-6)?;
            let parts = inside.iter().zip(&rms);
            Ok(parts.map(|(v, r)| part(*v, r * r, 1.0)).collect())
        });
        let both = rate_rms.iter().zip(&rms);
        let crossing = both.map(|(rate, rms)| part(*rate, *rms, 0.0) / TAU);
        Ok(BuffetingResponse {
            speed_m_s: self.speed_m_s,
            acceleration_rms: accelerations.iter().map(|v| v.sqrt()).collect(),
            rms_by_gust: [0, 1].map(|c| motions().map(|m| m[c].sqrt()).collect()),
            crossing_frequency_hz: crossing.collect(),
            part_in_tested_range: tested.transpose()?,
            rms,
            rate_rms,
        })
    }

    /// Root mean squares of the displacements of `nodes` about their mean. `tested` are the reduced frequencies, of the bridge,
    /// in which the forces were tested.
    ///
    /// # Errors
    /// [`Error::Input`] for forces that say nothing at a `K`; [`Error::Numerical`] when the integral does not settle.
    pub fn response(
        &self,
        nodes: &[usize],
        tested: Option<ReducedFrequencyRange>,
    ) -> Result<SpanResponse> {
        let shapes = self.problem.shapes_at(nodes);
        let tested = tested.map(|range| self.hertz(range));
        let last = REACH * self.problem.highest_hz;
        let mut breaks = vec![0.0, last];
        breaks.extend(self.resonances_below(last).map(|(hertz, _)| hertz));
        breaks.extend(tested.iter().flat_map(|(low, high)| [*low, *high]));
        breaks.retain(|f| *f <= last);
        breaks.sort_by(f64::total_cmp);
        breaks.dedup_by(|a, b| *a <= *b * (1.0 + 1e-6));
        let densities = |f: f64| -> Result<Vec<f64>> {
            let spectra = self.problem.spectra(f, self.speed_m_s, &shapes)?;
            let inside = tested.is_some_and(|(low, high)| (low..=high).contains(&f));
            let rates = spectra.iter().map(|s| s * (TAU * f).powi(2));
            let part = spectra.iter().map(|s| if inside { *s } else { 0.0 });
            Ok(spectra.iter().copied().chain(rates).chain(part).collect())
        };
        let variances = self.integral(densities, &breaks, TOLERANCE)?;
        let (rows, count) = (shapes.nrows(), nodes.len());
        let inside = |row| part(variances[2 * rows + row], variances[row], 1.0);
        Ok(SpanResponse {
            speed_m_s: self.speed_m_s,
            nodes: nodes.to_vec(),
            rms: by_node(count, |row| variances[row].sqrt()),
            crossing_frequency_hz: by_node(count, |row| {
                part(variances[rows + row], variances[row], 0.0).sqrt() / TAU
            }),
            part_in_tested_range: tested.map(|_| by_node(count, inside)),
        })
    }

    /// `∫ densities df` over the polygon of `breaks`, side by side where there are many coordinates.
    fn integral(
        &self,
        densities: impl Fn(f64) -> Result<Vec<f64>> + Sync,
        breaks: &[f64],
        tolerance: f64,
    ) -> Result<Vec<f64>> {
        let many = self.problem.structure.dofs.len() > FEW;
        let at_all = |all: &[f64]| {
            let values = threads::each(all, many, |f| densities(*f));
            values.into_iter().collect()
        };
        integrate(at_all, breaks, tolerance).map(|(value, _)| value)
    }

    /// Spectra of the displacements of `nodes`, from zero to four times the fastest resonance.
    ///
    /// # Errors
    /// [`Error::Input`] for forces that say nothing at a `K`.
    pub fn spectra(&self, nodes: &[usize]) -> Result<SpectrumCurve> {
        let frequencies = self.resolved_hz();
        self.problem
            .spectra_over(frequencies, self.speed_m_s, nodes)
    }

    /// Frequencies, Hz, that show every resonance: zero, from a hundredth of the slowest on evenly spread on a logarithmic scale,
    /// and within ten half-power widths of each. Zero, since a motion whose resonance is a fast one follows slow gusts: below the
    /// hundredth lies a twenty-fifth of the variance of a rotation.
    pub(super) fn resolved_hz(&self) -> Vec<f64> {
        let resonances = || self.resonances_below(REACH * self.problem.highest_hz);
        let hertz = || resonances().map(|r| r.0);
        let lowest = hertz().fold(f64::INFINITY, f64::min) / 100.0;
        let highest = hertz().fold(0.0, f64::max) * REACH;
        let even = in_equal_ratios(lowest, highest, EVEN + 1);
        let near = resonances().flat_map(|(f, half)| {
            let part = |i: i32| (f64::from(i) / f64::from(AROUND)).powi(3);
            (-AROUND..=AROUND).map(move |i| f + half.abs() * 10.0 * part(i))
        });
        let above = even.chain(near.filter(|f| *f > 0.0));
        let mut all: Vec<f64> = std::iter::once(0.0).chain(above).collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| *a <= *b * (1.0 + 1e-9));
        all
    }

    /// Resonances, Hz, and half of the half-power width of each.
    fn resonances_below(&self, last_hz: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let all = self.resonances_hz.iter().copied();
        all.filter(move |(hertz, _)| *hertz < last_hz)
    }

    /// Ends of a range of reduced frequencies, Hz.
    fn hertz(&self, range: ReducedFrequencyRange) -> (f64, f64) {
        let width_m = self.problem.structure.width_m;
        let hertz = |k: ReducedFrequency| k.circular(width_m, self.speed_m_s) / TAU;
        (hertz(range.min), hertz(range.max))
    }

    /// Where motions grow, in words, and whether tables know of it.
    fn growth(&self) -> String {
        let growing = self.resonances_hz.iter().filter(|r| r.1 < 0.0);
        let known = self.problem.model().known_range();
        let one = |(hertz, _): &(f64, f64)| {
            let width_m = self.problem.structure.width_m;
            let k = ReducedFrequency::from_hertz(*hertz, width_m, self.speed_m_s);
            let tested = match known.map(|range| range.contains(k)) {
                Some(true) => ", inside the tested range",
                Some(false) => ", where nothing was tested",
                None => "",
            };
            format!(" near {hertz:.4} Hz (K {:.3}{tested})", k.full_width())
        };
        growing.map(one).collect::<Vec<_>>().join(",")
    }
}

#[cfg(test)]
mod tests;
