//! Steps by the Taylor series of the motion: no matrix exponential where the wind changes, and no allocation.
//!
//! The wind runs on a straight line over a step, so that the equation of motion has coefficients of second degree in
//! time, and the series `y(t + sτ) = Σ yₖ sᵏ` follows term by term (`V` the wind at the start, `v = V̇τ`, forces
//! `w₀ + w₁s + w₂s²`):
//!
//! ```text
//! q̇ₖ₊₁ = τ/(k+1) (A₀[q̇, q]ₖ + V dₖ + v dₖ₋₁ + V² fₖ + 2Vv fₖ₋₁ + v² fₖ₋₂ + M⁻¹wₖ)      d = A₁ q̇, f = A₂ [q, x]
//! qₖ₊₁ = τ/(k+1) q̇ₖ,    xₖ₊₁ = τ/(k+1) (V gₖ + v gₖ₋₁)                                  g = G [q, x]
//! ```
//!
//! It converges for every step; parts of bounded norm keep its terms from cancelling. It ends when what is left out is
//! below rounding, so that nothing is lost against the exponential: the wind's change costs no accuracy. Gusts add their lags
//! to the system and their force to `w`.

mod matrices;

use super::gusts::{Gusts, SeriesPart};
use super::lanes::{FourLanes, OnLanes, on_lanes};
use super::linked::Linked;
use super::packed::{Packed, largest_of};
use super::values::Inputs;
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use matrices::matrices;
use nalgebra::DMatrix;

/// Norm of one part: its terms grow to some `e²` times the motion at most, which costs two or three bits.
const NORM_OF_PART: f64 = 3.0;
/// What the series may leave out, relative to its largest term.
const LEFT_OUT: f64 = f64::EPSILON / 8.0;
/// Terms of a part at most: 3⁶⁰/60! = 5e-54.
const MAX_TERMS: usize = 60;

/// Wind and external forces over a step, polynomials of the time since its start.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drive<'a> {
    /// Gusts, and how fast the wind changes.
    pub inputs: &'a Inputs,
    /// Time of the start after that of `inputs`, s.
    pub after: f64,
    /// Wind speed then, m/s.
    pub wind: f64,
    /// Forces and their coefficients of first and second degree, per unit length; an empty list is zero.
    pub force: [&'a [f64]; 3],
}

/// A section ready for series. Motion is scaled by powers of two to numbers of one size, exactly: displacements by their
/// motion scale, rates by a frequency as well.
#[derive(Debug, Clone)]
pub(super) struct PowerSeries {
    pub dofs: usize,
    /// Factor from a displacement to its scaled value.
    scale: Vec<f64>,
    /// Unit of the rates, rad/s.
    rate: f64,
    /// `[A₀; A₁]` on `[q̇, q]`.
    structure: Packed,
    /// `[A₂; G]` on `[q, x]`.
    aerodynamic: Linked,
    /// `M⁻¹`, scaled.
    force: Packed,
    /// Largest row sums of the scaled system, by the power of the wind speed that they go with.
    norm_of_structure: f64,
    norm_of_damping: f64,
    norm_of_pressure: f64,
    norm_of_filters: f64,
    fastest_lag: f64,
    /// Those of the section.
    pub gusts: Option<Gusts>,
    work: Work,
}

/// Memory of a step.
#[derive(Debug, Clone)]
struct Work {
    /// `[q̇, q, x]`, scaled.
    sum: Vec<f64>,
    term: Vec<f64>,
    /// `[A₀[q̇, q]; d]` of this term and the one before.
    structure: [Vec<f64>; 2],
    /// `[f; g]` of this term and the two before.
    aerodynamic: [Vec<f64>; 3],
    /// Gusts behind the lags of their admittance.
    gusts: Vec<f64>,
    /// External forces of one power of time.
    force: Vec<f64>,
    /// Accelerations by them, by the power of time.
    push: [Vec<f64>; 3],
    /// Accelerations by the gusts, of the order at hand.
    by_gusts: Vec<f64>,
    /// Those by nothing.
    none: Vec<f64>,
}

impl PowerSeries {
    /// The section; of a sampled model the structure alone. Gusts act where their forces are known.
    pub(super) fn new(section: &CoupledSection, gusts: Option<Gusts>) -> Self {
        let s = section.structure();
        let n = s.dofs.len();
        let scale = s.dofs.iter();
        let scale: Vec<f64> = scale
            .map(|d| power_of_two(d.motion_scale(s.width_m)))
            .collect();
        let stiffest = (section.inverse_mass() * &s.stiffness).diagonal().amax();
        let rate = power_of_two(if stiffest > 0.0 { stiffest.sqrt() } else { 1.0 });
        let (structure, aerodynamic) = matrices(section, &scale, rate);
        let filters = aerodynamic.nrows() - n;
        let force = DMatrix::from_fn(n, n, |i, j| {
            section.inverse_mass()[(i, j)] * scale[i] / rate
        });
        Self {
            dofs: n,
            scale,
            rate,
            structure: Packed::new(&structure),
            aerodynamic: Linked::new(&aerodynamic, n),
            force: Packed::new(&force),
            norm_of_structure: row_sum(&structure, 0..n),
            norm_of_damping: row_sum(&structure, n..2 * n),
            norm_of_pressure: row_sum(&aerodynamic, 0..n),
            norm_of_filters: row_sum(&aerodynamic, n..n + filters),
            fastest_lag: gusts.as_ref().map_or(0.0, Gusts::fastest),
            gusts,
            work: Work {
                sum: vec![0.0; 2 * n + filters],
                term: vec![0.0; 2 * n + filters],
                structure: [vec![0.0; 2 * n], vec![0.0; 2 * n]],
                aerodynamic: std::array::from_fn(|_| vec![0.0; n + filters]),
                gusts: Vec::new(),
                force: vec![0.0; n],
                push: std::array::from_fn(|_| vec![0.0; n]),
                by_gusts: vec![0.0; n],
                none: vec![0.0; n],
            },
        }
    }

    /// Norm of a step in winds up to `wind`.
    pub(super) fn norm(&self, wind: f64, step: f64) -> f64 {
        let by_wind = self.norm_of_damping + wind * self.norm_of_pressure;
        let motion = self.norm_of_structure + wind * by_wind;
        step * self.rate.max(motion).max(wind * self.norm_of_filters)
    }

    /// Parts into which a step is cut in winds up to `wind`, with or without gusts; not a number where the norm is none.
    pub(super) fn parts(&self, wind: f64, step: f64, gusts: bool) -> f64 {
        let lags = match gusts {
            true => step * wind * self.fastest_lag,
            false => 0.0,
        };
        let parts = self.norm(wind, step).max(lags) / NORM_OF_PART;
        if parts > 1.0 { parts.ceil() } else { 1.0 }
    }

    /// Advances what moves by a step of so many parts: `[q, q̇, x]` (of a sampled model `[q, q̇]`), and gusts on their way through
    /// the admittance, none where none act.
    ///
    /// # Errors
    /// A result that is not finite; everything is as it was.
    pub(super) fn advance(
        &mut self,
        values: &mut [f64],
        gusts: Option<&mut [f64]>,
        drive: &Drive<'_>,
        step: f64,
        parts: f64,
    ) -> Result<()> {
        let (n, rate) = (self.dofs, self.rate);
        for i in 0..n {
            self.work.sum[i] = values[n + i] * (self.scale[i] / rate);
            self.work.sum[n + i] = values[i] * self.scale[i];
        }
        self.work.sum[2 * n..].copy_from_slice(&values[2 * n..]);
        let lagging = gusts.as_deref().unwrap_or_default();
        self.work.gusts.clear();
        self.work.gusts.extend_from_slice(lagging);
        let gusts_act = gusts.is_some();
        let tau = step / parts;
        for i in 0..parts as usize {
            on_lanes(PartOfStep {
                series: self,
                drive,
                start: i as f64 * tau,
                tau,
                gusts_act,
            });
        }
        let sum = &self.work.sum;
        if !sum.iter().chain(&self.work.gusts).all(|x| x.is_finite()) {
            return Err(overgrown());
        }
        if let Some(gusts) = gusts {
            gusts.copy_from_slice(&self.work.gusts);
        }
        for i in 0..n {
            values[n + i] = sum[i] * (rate / self.scale[i]);
            values[i] = sum[n + i] / self.scale[i];
        }
        values[2 * n..].copy_from_slice(&sum[2 * n..]);
        Ok(())
    }

    /// Scaled accelerations by the external forces from `start` on, for a time in units of `tau`.
    #[inline(always)]
    fn accelerations<S: FourLanes>(&mut self, simd: S, drive: &Drive<'_>, start: f64, tau: f64) {
        let work = &mut self.work;
        for (power, push) in work.push.iter_mut().enumerate() {
            for (j, force) in work.force.iter_mut().enumerate() {
                let [w0, w1, w2] = drive.force.map(|w| w.get(j).copied().unwrap_or(0.0));
                *force = match power {
                    0 => w0 + start * (w1 + start * w2),
                    1 => tau * (w1 + 2.0 * start * w2),
                    _ => tau * tau * w2,
                };
            }
            self.force.set(simd, &work.force, push, |x| x);
        }
    }
}

/// A part of a step by so many terms of its series, compiled for each set of vectors a processor may have: a closure would not always be.
struct PartOfStep<'a, 'b> {
    series: &'a mut PowerSeries,
    drive: &'a Drive<'b>,
    /// Time since the start of the step, s.
    start: f64,
    /// How long it is, s.
    tau: f64,
    gusts_act: bool,
}

impl OnLanes for PartOfStep<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<S: FourLanes>(self, simd: S) {
        let (series, drive, start, tau) = (self.series, self.drive, self.start, self.tau);
        let wind_rate = drive.inputs.wind_speed_rate_m_s2;
        // rounding must not turn a wind that comes to rest into a negative one
        let wind = (drive.wind + wind_rate * start).max(0.0);
        let change = wind_rate * tau;
        let part = SeriesPart {
            start: drive.after + start,
            tau,
            wind,
            change,
        };
        series.accelerations(simd, drive, start, tau);
        let norm = series.norm(wind + change.abs(), tau);
        let (n, work) = (series.dofs, &mut series.work);
        let mut gusts = series.gusts.as_mut().filter(|_| self.gusts_act);
        match &mut gusts {
            Some(gusts) => gusts.begin(&work.gusts),
            None => work.by_gusts.fill(0.0),
        }
        // the sum so far is the first term, with none before it
        work.term.copy_from_slice(&work.sum);
        work.structure[0].fill(0.0);
        work.aerodynamic[..2].iter_mut().for_each(|g| g.fill(0.0));
        let mut largest = largest_of(&work.term);
        let [mut s, mut s_before] = work.structure.each_mut().map(Vec::as_mut_slice);
        let [mut g, mut g_before, mut g_first] = work.aerodynamic.each_mut().map(Vec::as_mut_slice);
        let mut last = [0.0; 3];
        for k in 0..MAX_TERMS {
            if change != 0.0 {
                (s, s_before) = (s_before, s);
                (g, g_before, g_first) = (g_first, g, g_before);
            }
            series.structure.set(simd, &work.term[..2 * n], s, |x| x);
            series.aerodynamic.set(simd, &work.term[n..], g);
            let mut pushed = 0.0;
            if let Some(gusts) = &mut gusts {
                let force = gusts.next(k, part, drive.inputs, &mut work.gusts);
                series.force.set(simd, force, &mut work.by_gusts, |x| x);
                pushed = tau * largest_of(&work.by_gusts);
            }
            let push = [work.push.get(k).unwrap_or(&work.none), &work.by_gusts].map(Vec::as_slice);
            let (structure, aerodynamic) = ([&*s, s_before], [&*g, g_before, g_first]);
            let scale = [series.rate, tau / (k + 1) as f64];
            next_term(&mut work.term, push, structure, aerodynamic, part, scale);
            for (sum, term) in work.sum.iter_mut().zip(&work.term) {
                *sum += term;
            }
            let size = f64::max(largest_of(&work.term), pushed);
            largest = if size > largest { size } else { largest };
            last = [size, last[0], last[1]];
            // each term to come is below norm/(k+2) times the largest of those it is made from
            let made_from = last.into_iter().fold(size, f64::max);
            let rest = norm * if change == 0.0 { size } else { made_from };
            let blown = gusts.as_ref().is_none_or(|g| g.converged(LEFT_OUT));
            let converged = blown && rest <= LEFT_OUT * (k + 2) as f64 * largest;
            if k >= 2 && (converged || rest.is_nan()) {
                break;
            }
        }
    }
}

/// Replaces a term by the next one. What that is made from, of this term and those before: accelerations by external forces and by
/// gusts, `[A₀[q̇, q]; d]`, `[f; g]`; last the unit of the rates and `τ/(k + 1)`.
#[inline(always)]
fn next_term(
    term: &mut [f64],
    [push, by_gusts]: [&[f64]; 2],
    structure: [&[f64]; 2],
    aerodynamic: [&[f64]; 3],
    part: SeriesPart,
    [rate, factor]: [f64; 2],
) {
    let SeriesPart { wind, change, .. } = part;
    let n = push.len();
    let [(s, d), (_, d_before)] = structure.map(|s| s.split_at(n));
    let [(f, g), (f_before, g_before), (f_first, _)] = aerodynamic.map(|g| g.split_at(n));
    let (velocity, behind) = term.split_at_mut(n);
    let (displacement, filters) = behind.split_at_mut(n);
    for i in 0..n {
        let mut sum = s[i] + (push[i] + by_gusts[i]) + wind * (d[i] + wind * f[i]);
        if change != 0.0 {
            sum += change * (d_before[i] + 2.0 * wind * f_before[i] + change * f_first[i]);
        }
        displacement[i] = factor * rate * velocity[i];
        velocity[i] = factor * sum;
    }
    let (now, before) = (factor * wind, factor * change);
    for ((x, g), g_before) in filters.iter_mut().zip(g).zip(g_before) {
        *x = now * g + before * g_before;
    }
}

pub(super) fn overgrown() -> Error {
    Error::Numerical("step: the motion has overflowed".into())
}

/// The power of two below a positive number.
fn power_of_two(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7FF << 52;
    f64::from_bits(x.max(f64::MIN_POSITIVE).to_bits() & EXPONENT)
}

fn row_sum(m: &DMatrix<f64>, rows: std::ops::Range<usize>) -> f64 {
    let sum = |i: usize| m.row(i).iter().map(|x| x.abs()).sum::<f64>();
    rows.map(sum).fold(0.0, f64::max)
}
