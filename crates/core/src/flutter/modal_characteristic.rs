//! The nonlinear eigenvalue problem `D(λ) v = 0` of a continuous model with many modes.
//!
//! The same `D(λ)` as that of a section, as many rows as there are modes. The filters of a bridge come in chains that are
//! alike for every mode, so one response of a chain, `x = (λB I − V A)⁻¹ b`, serves all of them and
//! `D(λ) = λ²M + λR + K − Σ_l x_l(λ) C_l` costs modes² for each filter of a chain. A mode is corrected by two-sided inverse
//! iteration (Ostrowski's, for a nonlinear problem: Schreiber, "Nonlinear eigenvalue problems: Newton-type methods and nonlinear
//! Rayleigh functionals", 2008): `D(λ) u = D'(λ) v` and `D(λ)ᵀ w = D'(λ)ᵀ v` by one elimination, `λ ← λ − (wᵀDu)/(wᵀD'u)`,
//! `v ← u/|u|`, which converges cubically and knows by its shape which mode it follows. The left shape starts from the right
//! one, which it is where the matrix is symmetric, as that of a structure alone. What is left after a round is taken away with
//! the triangles at hand (residual inverse iteration: Neumaier, SIAM J. Numer. Anal. 22, 1985), for a third of the work.

mod chains;

use super::columns::{ComplexColumns, RealColumns, Shape, Term};
use super::elimination::{Factors, solve_complex};
use crate::aerodynamics::Realization;
use crate::aeroelastic::CoupledSection;
use crate::state_space::Complex64;
use chains::{Chain, chains};
use nalgebra::DMatrix;

/// Rounds before a start is given up as too far away.
const MAX_ROUNDS: usize = 12;
/// Relative size of the last step, and of what it leaves: its cube over the square of the distance to other modes.
const TOLERANCE: f64 = 1e-5;
/// The same after a residual was taken away, which leaves its step times the step before over the distance to other modes.
const POLISHED: f64 = 1e-9;
/// What a step may leave, relatively.
const LEFT: f64 = 1e-13;
/// Part of the distance to other eigenvalues up to which a step is small.
const SMALL_PART: f64 = 0.1;
/// Part of an eigenvalue by which it is moved where the problem is exactly singular; below the tolerance, so that it settles.
const NUDGE: f64 = 1e-11;

/// Matrices of the problem, scaled to physical motion and force once.
#[derive(Debug)]
pub(super) struct ModalCharacteristic {
    width: f64,
    mass: RealColumns,
    /// Determinant of the mass.
    mass_determinant: f64,
    damping: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    /// `½ρ P(e₀)`, `½ρB P(e₁)`; the added mass is in `mass`.
    on_motion: DMatrix<f64>,
    on_rate: DMatrix<f64>,
    chains: Vec<Chain>,
}

impl ModalCharacteristic {
    /// The problem of `section`; `None` for sampled models.
    pub(super) fn new(section: &CoupledSection) -> Option<Self> {
        let Realization::Continuous(aero) = section.aerodynamics() else {
            return None;
        };
        let s = section.structure();
        let half_rho = 0.5 * s.air_density_kg_m3;
        let width = s.width_m;
        let mass = &s.mass - s.scaled(&aero.e2) * (half_rho * width * width);
        let force = |output: &DMatrix<f64>| RealColumns::new(&(s.scaled(output) * half_rho));
        Some(Self {
            width,
            mass: RealColumns::new(&mass),
            mass_determinant: mass.determinant(),
            damping: s.damping.clone(),
            stiffness: s.stiffness.clone(),
            on_motion: s.scaled(&aero.e0) * half_rho,
            on_rate: s.scaled(&aero.e1) * (half_rho * width),
            chains: chains(aero, force),
        })
    }

    /// The problem at a wind speed.
    pub(super) fn at(&self, speed: f64) -> AtSpeed<'_> {
        AtSpeed {
            problem: self,
            speed,
            damping: RealColumns::new(&(&self.damping - &self.on_rate * speed)),
            stiffness: RealColumns::new(&(&self.stiffness - &self.on_motion * (speed * speed))),
        }
    }

    /// Sizes of the poles of the filters at a wind speed, rad/s, one for each of the filters that are alike: the geometric mean.
    pub(super) fn filter_rates(&self, speed: f64) -> impl Iterator<Item = f64> {
        let rate = move |chain: &Chain| {
            let product = chain.a.determinant().abs();
            product.powf(1.0 / chain.b.len() as f64) * speed / self.width
        };
        self.chains.iter().map(rate).filter(|rate| *rate > 0.0)
    }
}

/// The problem at one wind speed.
pub(super) struct AtSpeed<'a> {
    problem: &'a ModalCharacteristic,
    speed: f64,
    damping: RealColumns,
    stiffness: RealColumns,
}

impl AtSpeed<'_> {
    /// The eigenvalue that is reached from `start` and the shape of a mode nearby, with its own shape of unit norm; `None`
    /// when the iteration does not settle. `apart` is how far other eigenvalues are, rad/s, where that is known: the last
    /// step is a small part of it, since before that the shape may be any mixture of both, and so small that what it leaves is
    /// rounding; and as long as a step is not a small part, its residual is left to a round of its own, since the triangles at
    /// hand do not tell the modes apart.
    pub(super) fn solve(
        &self,
        start: Complex64,
        near: &Shape,
        apart: Option<f64>,
    ) -> Option<(Complex64, Shape)> {
        let small = |step: Complex64| apart.is_some_and(|apart| step.norm() <= SMALL_PART * apart);
        let converged = |step: Complex64, left: f64, lambda: Complex64, tolerance: f64| {
            let (step, size) = (step.norm(), lambda.norm());
            step <= NUDGE * size || step <= tolerance * size && left <= LEFT * size
        };
        // what a step of this size leaves, as a part: nothing where no other eigenvalue is known
        let part = |step: Complex64| apart.map_or(0.0, |apart| step.norm() / apart);
        let mut lambda = start;
        let mut shape = ComplexColumns::of_column(&near.normalize());
        for _ in 0..MAX_ROUNDS {
            let terms = self.terms(lambda)?;
            let Some(round) = two_sided(terms, &shape) else {
                // an eigenvalue that is met exactly, as those of still air, cannot be solved with
                lambda *= 1.0 + NUDGE;
                continue;
            };
            lambda -= round.step;
            let part = part(round.step);
            let left = round.step.norm() * part * part;
            if converged(round.step, left, lambda, TOLERANCE) {
                return Some((lambda, round.right.to_column()));
            }
            if !small(round.step) {
                shape = round.right;
                continue;
            }
            let terms = self.terms(lambda)?;
            let (step, better) = without_residual(terms, round)?;
            lambda -= step;
            if converged(step, step.norm() * part, lambda, POLISHED) {
                return Some((lambda, better.to_column()));
            }
            shape = better;
        }
        None
    }

    /// `D(λ)⁻¹ D'(λ) U` for the columns of `U`.
    pub(super) fn inverse_iteration(
        &self,
        lambda: Complex64,
        basis: &DMatrix<Complex64>,
    ) -> Option<DMatrix<Complex64>> {
        let terms = self.terms(lambda)?;
        let basis = ComplexColumns::new(basis);
        Some(inverse_of_slope(terms, basis)?.to_matrix())
    }

    /// `det D(λ)` over that of the mass, as the product of what `each` makes of the pivots; `None` at an eigenvalue.
    pub(super) fn determinant(
        &self,
        lambda: Complex64,
        each: impl FnMut(Complex64) -> Complex64,
    ) -> Option<Complex64> {
        let terms = self.terms(lambda)?;
        let factors = triangles(terms)?;
        let product: Complex64 = factors.pivots().map(each).product();
        Some(product / self.problem.mass_determinant)
    }

    /// `D(λ)` as a sum.
    fn terms(&self, lambda: Complex64) -> Option<Vec<Term<'_>>> {
        let p = self.problem;
        let one = Complex64::from(1.0);
        let mut terms = vec![
            Term(lambda * lambda, lambda * 2.0, &p.mass),
            Term(lambda, one, &self.damping),
            Term(one, Complex64::default(), &self.stiffness),
        ];
        let cube = Complex64::from(-self.speed.powi(3));
        for chain in &p.chains {
            let (x, dx) = chain.response(lambda, p.width, self.speed)?;
            let filters = x.iter().zip(&dx).zip(&chain.outputs);
            terms.extend(filters.map(|((x, dx), output)| Term(x * cube, dx * cube, output)));
        }
        Some(terms)
    }
}

/// What a round of two-sided inverse iteration finds.
struct Round {
    /// What is to be taken from the eigenvalue.
    step: Complex64,
    factors: Factors,
    /// The better shape, of unit norm.
    right: ComplexColumns,
    left: ComplexColumns,
    /// `wᵀ D' u` of the two.
    scale: Complex64,
}

vectorised! {
    /// `D⁻¹ D' U`.
    fn inverse_of_slope<'a>(terms: Vec<Term<'a>>, basis: ComplexColumns) -> Option<ComplexColumns> {
        let (value, slope) = ComplexColumns::sum(&terms);
        Some(value.factors()?.solve(slope.times(&basis)))
    }

    /// `D` as a product of triangles.
    fn triangles<'a>(terms: Vec<Term<'a>>) -> Option<Factors> {
        ComplexColumns::value(&terms).factors()
    }

    /// A round of two-sided inverse iteration from a shape of unit norm; `None` where it is not finite.
    fn two_sided<'a>(terms: Vec<Term<'a>>, shape: &'a ComplexColumns) -> Option<Round> {
        let (value, slope) = ComplexColumns::sum(&terms);
        let factors = value.factors()?;
        let side = slope.times(shape);
        let left = factors.solve_transposed(&slope.transposed_times(shape));
        // `D u` is the right-hand side
        let applied = left.dot(&side);
        let mut right = factors.solve(side);
        let scale = left.dot(&slope.times(&right));
        let step = applied / scale;
        let size = right.normalise();
        let finite = step.re.is_finite() && step.im.is_finite() && size > 0.0;
        finite.then(|| Round {
            step,
            factors,
            right,
            left,
            scale: scale / size,
        })
    }

    /// A residual taken away with the triangles of the round before: `z = D(λ₀)⁻¹ D(λ) u`, `u ← u − z`,
    /// `λ ← λ − (wᵀDu)/(wᵀD'u)`: what is to be taken from the eigenvalue, and the better shape; `None` where they are not finite.
    fn without_residual<'a>(terms: Vec<Term<'a>>, round: Round) -> Option<(Complex64, ComplexColumns)> {
        let value = ComplexColumns::value(&terms);
        let Round { factors, mut right, left, scale, .. } = round;
        let residual = value.times(&right);
        let from_left = value.transposed_times(&left);
        let before = left.dot(&residual);
        let change = factors.solve(residual);
        let step = (before - from_left.dot(&change)) / scale;
        right.subtract(&change);
        let size = right.normalise();
        let finite = step.re.is_finite() && step.im.is_finite() && size > 0.0;
        finite.then_some((step, right))
    }
}

/// One step of inverse iteration with `D`, `D' v` and the shape `v`, which it improves: what is to be taken from the
/// eigenvalue, `(vᴴv)/(vᴴu)`. `None` when the step is not finite.
pub(super) fn inverse_step(
    value: &DMatrix<Complex64>,
    slope: Shape,
    shape: &mut Shape,
) -> Option<Complex64> {
    let slope = DMatrix::from_columns(&[slope]);
    let better = solve_complex(value, &slope)?.column(0).into_owned();
    let step = shape.dotc(&better).inv();
    let size = better.norm();
    (step.is_finite() && size > 0.0).then(|| {
        *shape = better.unscale(size);
        step
    })
}
