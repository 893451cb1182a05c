//! A force model as a linear combination of fixed functions of `p = iK`: `G_ij(p) = Σ_b θ_ijb φ_jb(p)`.

use crate::aerodynamics::{DiscreteLaguerre, LaguerreModel, RationalModel};
use crate::section::Dof;
use crate::state_space::Complex64;
use crate::units::ReducedFrequencyRange;
use nalgebra::DMatrix;

/// One function of `p`.
#[derive(Debug, Clone, PartialEq)]
enum Function {
    /// `p^n`.
    Power(i32),
    /// `p/(p + d)`.
    Lag(f64),
    /// Takenaka–Malmquist filter with the poles up to its own.
    Filter(Vec<f64>),
    /// Discrete Laguerre filter `(α, l)` whose output is held from sample to sample, a step `Δs` of dimensionless time.
    Sampled {
        alpha: f64,
        order: i32,
        delta_s: f64,
    },
}

/// Functions and coefficients of a force model. Coefficients stand by motion, then function, then force.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearForces {
    pub(super) dofs: Vec<Dof>,
    functions: Vec<Function>,
    /// First function of each motion, and one past the last.
    pub(super) starts: Vec<usize>,
    coefficients: Vec<f64>,
    /// What each coefficient is called, in the letters of its model.
    terms: Vec<String>,
    pub(super) tested: Option<ReducedFrequencyRange>,
}

impl LinearForces {
    /// The continuous Laguerre (Takenaka–Malmquist) model.
    pub fn of_laguerre(model: &LaguerreModel, tested: Option<ReducedFrequencyRange>) -> Self {
        let mut forces = Self::empty(&model.dofs, tested);
        for input in 0..model.dofs.len() {
            let powers = [("e0", &model.e0), ("e1", &model.e1), ("e2", &model.e2)];
            forces.add_powers(input, powers);
            let terms: Vec<_> = model.terms.iter().filter(|t| t.input == input).collect();
            for (t, term) in terms.iter().enumerate() {
                let poles = term.poles.poles();
                // where every transfer function has a chain of its own, a force counts the filters of its own only
                let own = |i: usize| terms.len() == 1 || term.coefficients.row(i).amax() > 0.0;
                for l in 0..poles.len() {
                    let function = Function::Filter(poles[..=l].to_vec());
                    let value = |i: usize| term.coefficients[(i, l)];
                    forces.add(function, value, |i| match own(i) {
                        true => format!("c{l}"),
                        false => format!("chain{t}.c{l}"),
                    });
                }
            }
            forces.starts.push(forces.functions.len());
        }
        forces
    }

    /// The discrete Laguerre model as a continuous force: its transfer function times that of the hold,
    /// `(1 − e^{−pΔs})/(pΔs)`. What is left out are the images of the motion at multiples of the sampling rate, which a
    /// structure does not follow; see [`at_samples`](super::at_samples).
    pub fn of_discrete_laguerre(
        model: &DiscreteLaguerre,
        tested: Option<ReducedFrequencyRange>,
    ) -> Self {
        let mut forces = Self::empty(&model.dofs, tested);
        for input in 0..model.dofs.len() {
            let terms = model.terms.iter().enumerate();
            for (t, term) in terms.filter(|(_, term)| term.input == input) {
                for (order, column) in term.coefficients.column_iter().enumerate() {
                    let function = Function::Sampled {
                        alpha: term.alpha,
                        order: order as i32,
                        delta_s: model.delta_s,
                    };
                    let name = |_| format!("chain{t}.c{order}");
                    forces.add(function, |i| column[i], name);
                }
            }
            forces.starts.push(forces.functions.len());
        }
        forces
    }

    /// Rational functions in Roger's form.
    pub fn of_rational(model: &RationalModel, tested: Option<ReducedFrequencyRange>) -> Self {
        let mut forces = Self::empty(&model.dofs, tested);
        for input in 0..model.dofs.len() {
            let powers = [("a1", &model.a1), ("a2", &model.a2), ("a3", &model.a3)];
            forces.add_powers(input, powers);
            for (l, term) in model.lag_terms.iter().enumerate() {
                for (lag, forces_of_it) in model.lag_groups(l) {
                    // where every force has a lag of its own, it counts its own term only
                    let value = |i: usize| match forces_of_it[i] {
                        true => term[(i, input)],
                        false => 0.0,
                    };
                    forces.add(Function::Lag(lag), value, |i| match forces_of_it[i] {
                        true => format!("a{}", l + 4),
                        false => format!("lag{lag}.a{}", l + 4),
                    });
                }
            }
            forces.starts.push(forces.functions.len());
        }
        forces
    }

    fn empty(dofs: &[Dof], tested: Option<ReducedFrequencyRange>) -> Self {
        Self {
            dofs: dofs.to_vec(),
            functions: Vec::new(),
            starts: vec![0],
            coefficients: Vec::new(),
            terms: Vec::new(),
            tested,
        }
    }

    fn add_powers(&mut self, input: usize, terms: [(&str, &DMatrix<f64>); 3]) {
        for ((name, matrix), power) in terms.into_iter().zip(0..) {
            let value = |i: usize| matrix[(i, input)];
            self.add(Function::Power(power), value, |_| name.to_owned());
        }
    }

    fn add(
        &mut self,
        function: Function,
        value: impl Fn(usize) -> f64,
        term: impl Fn(usize) -> String,
    ) {
        self.functions.push(function);
        for i in 0..self.dofs.len() {
            self.terms.push(term(i));
            self.coefficients.push(value(i));
        }
    }

    /// The coefficients of the model.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Their names, `force.motion.term`, e.g. `vertical.torsion.e0`.
    pub fn names(&self) -> Vec<String> {
        let count = self.dofs.len();
        let name = |(place, term): (usize, &String)| {
            let (function, force) = (place / count, self.dofs[place % count].name());
            let motion = self.starts[1..].partition_point(|end| *end <= function);
            format!("{force}.{}.{term}", self.dofs[motion].name())
        };
        self.terms.iter().enumerate().map(name).collect()
    }

    pub(super) fn count(&self) -> usize {
        self.functions.len()
    }

    /// Values of all functions at `p`.
    pub(super) fn values(&self, p: Complex64, out: &mut [Complex64]) {
        for (function, out) in self.functions.iter().zip(out) {
            *out = function.at(p).0;
        }
    }

    /// `G` and `dG/dp` at `p` with other coefficients.
    pub(super) fn transfer<const N: usize>(
        &self,
        p: Complex64,
        coefficients: &[f64],
    ) -> ([[Complex64; N]; N], [[Complex64; N]; N]) {
        let zero = Complex64::new(0.0, 0.0);
        let (mut g, mut slope) = ([[zero; N]; N], [[zero; N]; N]);
        for j in 0..N {
            for b in self.starts[j]..self.starts[j + 1] {
                let (value, rate) = self.functions[b].at(p);
                for i in 0..N {
                    let theta = coefficients[b * N + i];
                    g[i][j] += value * theta;
                    slope[i][j] += rate * theta;
                }
            }
        }
        (g, slope)
    }
}

impl Function {
    /// Value and derivative at `p` off the real axis; where only one is used, the other costs nothing.
    #[inline(always)]
    fn at(&self, p: Complex64) -> (Complex64, Complex64) {
        match self {
            Self::Power(0) => (Complex64::new(1.0, 0.0), Complex64::new(0.0, 0.0)),
            Self::Power(1) => (p, Complex64::new(1.0, 0.0)),
            Self::Power(n) => (p.powi(*n), p.powi(n - 1) * f64::from(*n)),
            Self::Lag(d) => {
                let inverse = (p + d).inv();
                (p * inverse, inverse * inverse * *d)
            }
            Self::Filter(poles) => {
                let (before, own) = poles.split_at(poles.len() - 1);
                let inverse = (p + own[0]).inv();
                let mut value = inverse * (2.0 * own[0]).sqrt();
                let mut logarithmic = -inverse;
                for pole in before {
                    let (plus, minus) = ((p + pole).inv(), (p - pole).inv());
                    value *= (p - pole) * plus;
                    logarithmic += minus - plus;
                }
                (value, value * logarithmic)
            }
            Self::Sampled {
                alpha,
                order,
                delta_s,
            } => sampled(*alpha, *order, *delta_s, p),
        }
    }
}

/// `√(1−α)/D (N/D)^l (1 − b)/(pΔs)` with `b = e^{−pΔs}`, `D = 1 − √α b`, `N = √α − b`, and its derivative.
#[inline(always)]
fn sampled(alpha: f64, order: i32, step: f64, p: Complex64) -> (Complex64, Complex64) {
    let root = alpha.sqrt();
    let back = (-p * step).exp();
    let one = Complex64::new(1.0, 0.0);
    let (below, above) = (one - back * root, back * -1.0 + root);
    let hold = (one - back) / (p * step);
    let filter = below.inv() * (1.0 - alpha).sqrt() * (above / below).powi(order);
    let (count, slope) = (f64::from(order), back * step);
    // zero of the filter itself: the derivative below does not need its logarithm
    let of_filter = filter * (slope * (-root * (count + 1.0)) / below)
        + below.inv()
            * (1.0 - alpha).sqrt()
            * (above / below).powi((order - 1).max(0))
            * (slope / below)
            * count;
    let of_hold = slope / (p * step) - hold / p;
    (filter * hold, of_filter * hold + filter * of_hold)
}
