//! Onset for any `G(K)`: the impedance is singular at a real `(V, ω)`.
//!
//! At a given `K` the speed follows from the frequency, `V = ωB/K`, and the impedance becomes a quadratic eigenvalue
//! problem `ω² (M + ½ρB²/K² P(G)) − iωR − K_s = 0`. Its roots are followed over `K`; where one becomes real, the
//! section flutters (Theodorsen's method with viscous damping).

use super::answer::{Findings, FlutterSearch, UnstableStart, choose};
use super::critical_point::{CriticalPoint, OnsetMethod};
use super::judged::{Exit, FastMotion, StableRange, TestedFrom, damps_at, entry_reason};
use super::onset::Onset;
use crate::aerodynamics::{Transfer, TransferMatrix};
use crate::error::{Error, Result, ensure, positive};
use crate::section::{Dof, Structure};
use crate::state_space::{ValueAt, complex, first_order, root};
use crate::units::{LowerEnd, ReducedFrequency, ReducedFrequencyRange};
use nalgebra::{Complex, DMatrix, DVector, Schur};

/// Reduced frequencies at which the roots are looked at, logarithmically spaced over the range.
const GRID: usize = 600;
/// Steps in which the air comes to its density to name the modes.
const AIR_STEPS: usize = 40;
/// Growth up to this part of the frequency is rounding.
const ROUNDING: f64 = 1e-9;
/// A frequency below this part of the one before it is none.
const SLOWEST: f64 = 1e-6;
const MAX_SCHUR_SWEEPS: usize = 600;
/// Relative step of the differences for the damping slope: truncation 1e-10 against rounding 1e-11.
const SLOPE_STEP: f64 = 1e-5;

/// Impedance `−ω²M + iωR + K − ½ρV² P(G(ωB/V))` at speed (m/s) and circular frequency (rad/s), n×n, per unit length.
pub fn impedance(
    structure: &Structure,
    model: &dyn Transfer,
    speed_m_s: f64,
    omega: f64,
) -> Result<TransferMatrix> {
    let k = ReducedFrequency::from_circular(omega, structure.width_m, speed_m_s);
    let forces = StructureInWind { structure, model }.forces(k, speed_m_s)?;
    let (s, n) = (structure, forces.nrows());
    Ok(DMatrix::from_fn(n, n, |i, j| {
        let elastic = s.stiffness[(i, j)] - omega * omega * s.mass[(i, j)];
        Complex::new(elastic, omega * s.damping[(i, j)]) - forces[(i, j)]
    }))
}

/// Lowest speed up to `speed_max_m_s` at which the section flutters at a reduced frequency inside `range`.
///
/// Says nothing outside `range`: a table cannot be searched where it was not measured. A mode that grows already at the
/// highest `K` of the range is unstable at and below the speed that belongs to it.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::FlatPlate;
/// use aerodeck::flutter::determinant_onset;
/// use aerodeck::section::SectionModel;
/// use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
///
/// let structure = SectionModel::iabse_1_1a().structure()?;
/// let plate = FlatPlate { rotary_inertia: false };
/// let k = ReducedFrequency::from_full_width;
/// let range = ReducedFrequencyRange::between(k(0.02), k(10.0));
/// let found = determinant_onset("plate", &structure, &plate, range, 120.0)?;
/// assert!((found.onset().expect("flutter").at.speed_m_s - 77.48).abs() < 0.01);
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] for an empty range and forces that say nothing in it; [`Error::Numerical`] when the roots cannot be
/// computed.
pub fn determinant_onset(
    name: &str,
    structure: &Structure,
    model: &dyn Transfer,
    range: ReducedFrequencyRange,
    speed_max_m_s: f64,
) -> Result<FlutterSearch> {
    let place = "range of reduced frequencies";
    let k_min = positive(place, range.not_empty()?.min.full_width())?;
    let k_max = positive(place, range.max.full_width())?;
    let problem = StructureInWind::new(structure, model)?;
    let at = |i: usize| {
        // both ends exactly, so that a table is not asked beyond its last point
        match i {
            0 => k_max,
            i if i == GRID => k_min,
            i => k_max * (k_min / k_max).powf(i as f64 / GRID as f64),
        }
    };
    let width = structure.width_m;
    let exits = |roots: &[(Complex<f64>, usize)], (k, gap): LowerEnd| {
        let exit = |(omega, row): &(Complex<f64>, usize)| {
            let speed = omega.re * width / k.full_width();
            (speed, structure.branch_name(*row), Exit::at(k, gap))
        };
        roots.iter().map(exit).collect::<Vec<_>>()
    };
    // each root with its branch, as long as it stays in the right half plane
    let mut roots = problem.named_roots(k_max)?;
    let mut findings = Findings::between(StableRange::up_to(speed_max_m_s));
    for (omega, row) in &roots {
        let (speed, branch) = (omega.re * width / k_max, structure.branch_name(*row));
        findings.reach.entries.push((speed, branch.clone()));
        // growth that is known only beyond the search answers nothing that was asked
        if speed <= speed_max_m_s && omega.im < -ROUNDING * omega.norm() {
            let (method, lambda) = (OnsetMethod::Determinant, omega * Complex::i());
            let at = CriticalPoint::of_motion(name, method, structure, speed, lambda.im);
            let mut start = UnstableStart::new(at, lambda.re, branch, entry_reason(range.max));
            start.in_tested_range = Some(true);
            findings.starts.push(start);
        }
    }
    for i in 1..=GRID {
        let current = problem.frequencies(at(i), 1.0)?;
        let into_gap = |(k, gap): &LowerEnd| {
            gap.is_some() && at(i) < k.full_width() && k.full_width() <= at(i - 1)
        };
        for end in range.lower_ends().filter(into_gap) {
            findings.reach.exits.extend(exits(&roots, end));
        }
        let mut next = Vec::with_capacity(roots.len());
        for ((root, row), after) in roots.iter().copied().zip(paired(&roots, &current)) {
            let Some(after) = after else {
                continue;
            };
            if root.im > 0.0 && after.im <= 0.0 {
                let from = ValueAt::new(at(i - 1), root);
                let to = ValueAt::new(at(i), after);
                let onset = problem.refine(name, from, to, structure.branch_name(row))?;
                if onset.at.speed_m_s <= speed_max_m_s {
                    findings.crossings.push(onset);
                }
            }
            next.push((after, row));
        }
        roots = next;
    }
    // at the lowest K each root has come to a speed of its own; beyond the slowest nothing was looked at
    let exits = exits(&roots, (range.min, None));
    findings.reach.exits.extend(exits);
    Ok(choose(findings, Some(range)))
}

/// The last mode that comes to the highest `K` of a table as the wind rises, and whether the table takes energy out of motions
/// there.
///
/// # Errors
/// As [`determinant_onset`].
pub fn table_tested_from(
    structure: &Structure,
    table: &dyn Transfer,
    range: ReducedFrequencyRange,
) -> Result<Option<TestedFrom>> {
    let k = positive("range of reduced frequencies", range.max.full_width())?;
    let problem = StructureInWind::new(structure, table)?;
    let roots = problem.named_roots(k)?;
    let last = roots.iter().max_by(|a, b| a.0.re.total_cmp(&b.0.re));
    let damped = damps_at(table.dofs(), &table.transfer(range.max)?);
    Ok(last.map(|(omega, row)| TestedFrom {
        speed_m_s: omega.re * structure.width_m / k,
        branch: structure.branch_name(*row),
        below: FastMotion::new(damped.then_some(FastMotion::DampedAtTheEnd), [range]),
    }))
}

/// For every root the nearest of `current` that is not nearer to another; `None` where there are too few.
fn paired(roots: &[(Complex<f64>, usize)], current: &[Complex<f64>]) -> Vec<Option<Complex<f64>>> {
    let all = roots.iter().enumerate().flat_map(|(i, (a, _))| {
        let to = current.iter().enumerate();
        to.map(move |(j, b)| ((a - b).norm(), i, j))
    });
    let mut distances: Vec<(f64, usize, usize)> = all.collect();
    distances.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut pairs = vec![None; roots.len()];
    let mut taken = vec![false; current.len()];
    for (_, i, j) in distances {
        if pairs[i].is_none() && !taken[j] {
            pairs[i] = Some(current[j]);
            taken[j] = true;
        }
    }
    pairs
}

/// A structure in the forces of a model.
#[derive(Clone, Copy)]
pub(super) struct StructureInWind<'a> {
    pub(super) structure: &'a Structure,
    pub(super) model: &'a dyn Transfer,
}

impl<'a> StructureInWind<'a> {
    /// Refuses forces of other motions than those of the structure.
    pub(super) fn new(structure: &'a Structure, model: &'a dyn Transfer) -> Result<Self> {
        let expected = format_args!("those of {} motion", Dof::names(&structure.dofs));
        let same = structure.dofs == model.dofs();
        ensure(same, "forces", expected, Dof::names(model.dofs()))?;
        Ok(Self { structure, model })
    }

    /// Roots at the reduced frequency `k` with the rows whose modes they are: those of the structure without air, followed
    /// while the air comes to its density.
    fn named_roots(&self, k: f64) -> Result<Vec<(Complex<f64>, usize)>> {
        let mut still = self.frequencies(k, 0.0)?;
        still.sort_by(|a, b| a.re.total_cmp(&b.re));
        let rows = self.structure.rows_by_frequency();
        let mut named: Vec<_> = still.into_iter().zip(rows).collect();
        for i in 1..=AIR_STEPS {
            let current = self.frequencies(k, i as f64 / AIR_STEPS as f64)?;
            let pairs = paired(&named, &current).into_iter().zip(named);
            named = pairs
                .filter_map(|(root, (_, row))| Some((root?, row)))
                .collect();
        }
        Ok(named)
    }

    /// Roots `ω` with positive real part at the reduced frequency `k`, rad/s, in air of this part of its density.
    fn frequencies(&self, k: f64, part: f64) -> Result<Vec<Complex<f64>>> {
        let s = self.structure;
        let failed = |what: &str| Error::Numerical(format!("determinant: {what} at K = {k}"));
        let g = self.model.transfer(ReducedFrequency::from_full_width(k))?;
        let air = 0.5 * part * s.air_density_kg_m3 * (s.width_m / k).powi(2);
        let mass = complex(&s.mass) + s.to_physical(&g) * Complex::new(air, 0.0);
        let inverse = mass.try_inverse().ok_or_else(|| failed("singular"))?;
        let on_rate = complex(&s.damping) * Complex::i();
        let companion = first_order(&inverse, &complex(&s.stiffness), &on_rate);
        if !companion.iter().all(|z| z.is_finite()) {
            return Err(failed("the model is not finite"));
        }
        let schur = Schur::try_new(companion, f64::EPSILON, MAX_SCHUR_SWEEPS);
        let (_, triangular) = schur.ok_or_else(|| failed("no roots"))?.unpack();
        let diagonal = triangular.diagonal();
        let all = diagonal.iter().copied();
        Ok(all.filter(|omega| omega.re > 0.0).collect())
    }

    /// The reduced frequency at which the root becomes real, and the onset there.
    fn refine(
        &self,
        name: &str,
        before: ValueAt<Complex<f64>>,
        after: ValueAt<Complex<f64>>,
        branch: String,
    ) -> Result<Onset> {
        let root_at = |k: f64| -> Result<Complex<f64>> {
            // the roots move little over one cell of the grid: nearest to the straight line between its ends
            let share = (k - before.at) / (after.at - before.at);
            let guess = before.value + (after.value - before.value) * share;
            let all = self.frequencies(k, 1.0)?.into_iter();
            let nearest = all.min_by(|a, b| (a - guess).norm().total_cmp(&(b - guess).norm()));
            nearest.ok_or_else(|| Error::Numerical(format!("determinant: no root at K = {k}")))
        };
        let imaginary = |end: ValueAt<Complex<f64>>| ValueAt::new(end.at, -end.value.im);
        let k = root(imaginary(before), imaginary(after), |k| Ok(-root_at(k)?.im))?;
        let omega = root_at(k)?.re;
        let s = self.structure;
        if omega < SLOWEST * before.value.norm() {
            return Err(Error::Numerical(format!(
                "determinant: the frequency of {branch} vanishes at K = {k}; forces of a model or table without measure"
            )));
        }
        let speed = omega * s.width_m / k;
        let shape = self.shape(speed, omega)?;
        let at = CriticalPoint::of_motion(name, OnsetMethod::Determinant, s, speed, omega);
        let mut onset = Onset::new(at, s, &shape, branch);
        onset.damping_slope_s_m = self.damping_slope(speed, omega);
        Ok(onset)
    }

    /// Self-excited forces of unit motions, `½ρV² P(G(K))`: N/m and N·m/m for m and rad.
    pub(super) fn forces(&self, k: ReducedFrequency, speed_m_s: f64) -> Result<TransferMatrix> {
        let pressure = 0.5 * self.structure.air_density_kg_m3 * speed_m_s * speed_m_s;
        Ok(self.structure.to_physical(&self.model.transfer(k)?) * Complex::from(pressure))
    }

    /// `dζ/dV` (s/m) at an onset, from the determinant `d(V, ω)` of the impedance alone: with `λ = iω` on the axis,
    /// `dλ/dV = −d_V/d_λ = −i d_V/d_ω` and `dζ/dV = −Re(dλ/dV)/ω`, central differences. `None` where the model does not
    /// answer on both sides (a table at the end of its range).
    pub(super) fn damping_slope(&self, speed_m_s: f64, omega: f64) -> Option<f64> {
        let determinant = |speed: f64, omega: f64| {
            let z = impedance(self.structure, self.model, speed, omega).ok()?;
            Some(z.determinant())
        };
        let (more, less) = (1.0 + SLOPE_STEP, 1.0 - SLOPE_STEP);
        let over_speed =
            determinant(speed_m_s * more, omega)? - determinant(speed_m_s * less, omega)?;
        let over_omega =
            determinant(speed_m_s, omega * more)? - determinant(speed_m_s, omega * less)?;
        let rate = Complex::new(0.0, -1.0) * (over_speed / speed_m_s) / (over_omega / omega);
        let slope = -rate.re / omega;
        slope.is_finite().then_some(slope)
    }

    /// The motion (m, rad) that the impedance at a speed (m/s) and a circular frequency resists least: the right singular vector
    /// of the smallest singular value. Rows and columns are scaled by the root of the typical impedance of each degree of freedom,
    /// `K_ii + ω² M_ii`, since heave and rotation have different units; a row by its own size would hide a degree of freedom that
    /// is alone.
    pub(super) fn shape(&self, speed_m_s: f64, omega: f64) -> Result<DVector<Complex<f64>>> {
        let s = self.structure;
        let impedance = impedance(s, self.model, speed_m_s, omega)?;
        let scale = |i: usize| {
            let typical = s.stiffness[(i, i)] + omega * omega * s.mass[(i, i)];
            typical.sqrt().recip()
        };
        let n = impedance.nrows();
        let scaled = DMatrix::from_fn(n, n, |i, j| impedance[(i, j)] * (scale(i) * scale(j)));
        let singular = || Error::Numerical("determinant: no mode shape at the onset".into());
        let svd = scaled.try_svd(false, true, f64::EPSILON, MAX_SCHUR_SWEEPS);
        let svd = svd.ok_or_else(singular)?;
        let smallest = svd.singular_values.imin();
        let shape = svd.v_t.ok_or_else(singular)?.row(smallest).adjoint();
        Ok(DVector::from_fn(n, |i, _| {
            shape[i] * Complex::from(scale(i))
        }))
    }
}
