//! The discrete Laguerre model of the thesis (2.16, 2.33, 4.2): filters advancing by one `Δs`, no feed-through.

use super::bank::side_by_side;
use super::continuous::not_fitting;
use crate::aerodynamics::{DiscreteRealization, Realizable, Realization, Transfer, TransferMatrix};
use crate::error::{Result, ensure, finite_numbers, positive};
use crate::section::Dof;
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// One chain of filters driven by one motion, with its coefficients for every force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DiscreteTerm {
    /// Index into the model's degrees of freedom of the motion that drives the chain.
    pub input: usize,
    /// Decay factor `0 < α < 1`; it belongs to one `Δs`.
    pub alpha: f64,
    /// `c`, one row per force, one column per filter (n×L); rows of zeros where another chain serves the force.
    #[serde(with = "crate::state_space::rows")]
    pub coefficients: DMatrix<f64>,
}

/// Discrete Laguerre model.
///
/// One [`DiscreteTerm`] a motion when the parameters are shared, as in the thesis; more where a transfer function has a
/// decay factor or a number of filters of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "SavedModel", into = "SavedModel")]
pub struct DiscreteLaguerre {
    /// Degrees of freedom of rows and columns.
    pub dofs: Vec<Dof>,
    /// Step in dimensionless time, `Δs = VΔt/B`.
    pub delta_s: f64,
    /// Filter chains.
    pub terms: Vec<DiscreteTerm>,
    /// Static term of each force (the constant of 2.23), dimensionless; a deviation from equilibrium leaves it out.
    pub static_term: Vec<f64>,
}

/// The recursion (2.33) of a chain of filters with the decay factor `α`, `x_0[k] = √α x_0[k−1] + √(1−α) v[k]` and
/// `x_l[k] = √α x_l[k−1] + √α x_{l−1}[k] − x_{l−1}[k−1]`: carries the filter states on over the samples of a motion and writes every
/// filter's output to a stretch of `stride` numbers. One filter after the other, each over all samples: the recursions only look back.
pub fn advance_filters(
    alpha: f64,
    state: &mut [f64],
    motion: &[f64],
    out: &mut [f64],
    stride: usize,
) {
    let (root, gain) = (alpha.sqrt(), (1.0 - alpha).sqrt());
    let rows = motion.len();
    let Some(mut last) = state.first().copied() else {
        return;
    };
    for (x, v) in out[..rows].iter_mut().zip(motion) {
        last = root * last + gain * v;
        *x = last;
    }
    let mut before = std::mem::replace(&mut state[0], last);
    for l in 1..state.len() {
        let (head, tail) = out.split_at_mut(l * stride);
        let below = &head[(l - 1) * stride..][..rows];
        let (mut last, mut previous) = (state[l], before);
        for (x, b) in tail[..rows].iter_mut().zip(below) {
            last = root * (last + b) - previous;
            previous = *b;
            *x = last;
        }
        before = std::mem::replace(&mut state[l], last);
    }
}

/// `A_L` (L×L) and `B_L` (L) of equation (4.2): `S(k+1) = A_L S(k) + B_L v(k+1)`.
pub fn discrete_filter_matrices(alpha: f64, count: usize) -> (DMatrix<f64>, DVector<f64>) {
    let next = |mut state: Vec<f64>, sample: f64| {
        advance_filters(alpha, &mut state, &[sample], &mut vec![0.0; count], 1);
        state
    };
    let unit = |l: usize| (0..count).map(|j| f64::from(u8::from(j == l))).collect();
    let columns = (0..count).flat_map(|l| next(unit(l), 0.0));
    let a = DMatrix::from_iterator(count, count, columns);
    (a, DVector::from_vec(next(vec![0.0; count], 1.0)))
}

/// Impulse responses `g_0[k] … g_{L−1}[k]` for `k = 0 … samples−1`, as an L×samples matrix.
pub fn impulse_response(alpha: f64, count: usize, samples: usize) -> DMatrix<f64> {
    let (a, mut state) = discrete_filter_matrices(alpha, count);
    let mut g = DMatrix::zeros(count, samples);
    for k in 0..samples {
        g.column_mut(k).copy_from(&state);
        state = &a * state;
    }
    g
}

impl DiscreteLaguerre {
    /// A model whose transfer functions share `α` and the number of filters: `coefficients[j][(i, l)]` is filter `l` of
    /// motion `j` in force `i` (one n×L matrix per motion).
    pub fn shared(
        dofs: Vec<Dof>,
        alpha: f64,
        delta_s: f64,
        coefficients: Vec<DMatrix<f64>>,
        static_term: Vec<f64>,
    ) -> Self {
        let term = |(input, coefficients)| DiscreteTerm {
            input,
            alpha,
            coefficients,
        };
        Self {
            dofs,
            delta_s,
            terms: coefficients.into_iter().enumerate().map(term).collect(),
            static_term,
        }
    }

    /// `α` and the number of filters `L` when all transfer functions share them.
    pub fn shared_parameters(&self) -> Option<(f64, usize)> {
        let first = self.terms.first()?;
        let filters = first.coefficients.ncols();
        let one_a_motion = self.terms.len() == self.dofs.len();
        let alike = |(j, t): (usize, &DiscreteTerm)| {
            t.input == j && t.alpha == first.alpha && t.coefficients.ncols() == filters
        };
        let shared = one_a_motion && self.terms.iter().enumerate().all(alike);
        shared.then_some((first.alpha, filters))
    }

    /// Checks ranges and shapes.
    pub fn validate(&self) -> Result<()> {
        positive("discrete Laguerre model: delta_s", self.delta_s)?;
        let n = self.dofs.len();
        for (i, term) in self.terms.iter().enumerate() {
            let (alpha, c) = (term.alpha, &term.coefficients);
            let place = |key| format!("discrete Laguerre model: terms[{i}].{key}");
            let inside = alpha > 0.0 && alpha < 1.0;
            ensure(inside, place("alpha"), "0 < alpha < 1", alpha)?;
            let fits = c.nrows() == n && c.ncols() > 0 && c.iter().all(|x| x.is_finite());
            ensure(
                term.input < n && fits,
                place("coefficients"),
                format_args!(
                    "an input below {n} and {n} rows of finite numbers, at least one filter"
                ),
                not_fitting(term.input, c),
            )?;
        }
        ensure(
            (0..n).all(|j| self.terms.iter().any(|t| t.input == j)),
            "discrete Laguerre model: terms",
            "filters for every motion",
            "a motion without any",
        )?;
        finite_numbers("discrete Laguerre model: static_term", &self.static_term, n)
    }
}

impl Transfer for DiscreteLaguerre {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    /// `G_0 = √(1−α)/(1 − √α z⁻¹)`, `G_l = G_{l−1} (√α − z⁻¹)/(1 − √α z⁻¹)` at `z = e^{iKΔs}` (2.17).
    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let back = Complex::new(0.0, -k.full_width() * self.delta_s).exp();
        let n = self.dofs.len();
        let mut g = DMatrix::zeros(n, n);
        for term in &self.terms {
            let root = term.alpha.sqrt();
            let denominator = -back * root + 1.0;
            let mut filter = denominator.inv() * (1.0 - term.alpha).sqrt();
            for column in term.coefficients.column_iter() {
                for (i, c) in column.iter().enumerate() {
                    g[(i, term.input)] += filter * *c;
                }
                filter *= (-back + root) / denominator;
            }
        }
        Ok(g)
    }

    fn realizable(&self) -> Option<&dyn Realizable> {
        Some(self)
    }
}

impl Realizable for DiscreteLaguerre {
    /// One bank a term: the four banks of the thesis repeat the same states.
    fn realize(&self) -> Realization {
        let chains = self.terms.iter().map(|t| {
            let chain = discrete_filter_matrices(t.alpha, t.coefficients.ncols());
            (t.input, chain, &t.coefficients)
        });
        let [a, b, c] = side_by_side(self.dofs.len(), chains);
        Realization::Discrete(DiscreteRealization {
            a,
            b,
            c,
            delta_s: self.delta_s,
        })
    }
}

/// How the model stands in a file: one `alpha` and one coefficient matrix per motion where all transfer functions share
/// their filters, a list of `terms` where they do not.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SavedModel {
    dofs: Vec<Dof>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    alpha: Option<f64>,
    delta_s: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    coefficients: Option<Matrices>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    terms: Option<Vec<DiscreteTerm>>,
    static_term: Vec<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(transparent)]
struct Matrices(#[serde(with = "crate::state_space::rows::list")] Vec<DMatrix<f64>>);

impl From<DiscreteLaguerre> for SavedModel {
    fn from(model: DiscreteLaguerre) -> Self {
        let shared = model.shared_parameters();
        let (coefficients, terms) = match shared {
            Some(_) => {
                let all = model.terms.into_iter().map(|t| t.coefficients);
                (Some(Matrices(all.collect())), None)
            }
            None => (None, Some(model.terms)),
        };
        Self {
            dofs: model.dofs,
            alpha: shared.map(|(alpha, _)| alpha),
            delta_s: model.delta_s,
            coefficients,
            terms,
            static_term: model.static_term,
        }
    }
}

impl TryFrom<SavedModel> for DiscreteLaguerre {
    type Error = String;

    fn try_from(layout: SavedModel) -> std::result::Result<Self, String> {
        match (layout.alpha, layout.coefficients, layout.terms) {
            (Some(alpha), Some(Matrices(coefficients)), None) => Ok(Self::shared(
                layout.dofs,
                alpha,
                layout.delta_s,
                coefficients,
                layout.static_term,
            )),
            (None, None, Some(terms)) => Ok(Self {
                dofs: layout.dofs,
                delta_s: layout.delta_s,
                terms,
                static_term: layout.static_term,
            }),
            _ => Err("expected either `alpha` and `coefficients`, or `terms`".into()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_are_those_of_equation_4_2() {
        let (a, b) = discrete_filter_matrices(0.6, 3);
        let r = 0.6_f64.sqrt();
        let expected = [r, 0.0, 0.0, -0.4, r, 0.0, -0.4 * r, -0.4, r];
        for (i, e) in expected.iter().enumerate() {
            assert!((a[(i / 3, i % 3)] - e).abs() < 1e-15);
        }
        assert!((b[0] - 0.4_f64.sqrt()).abs() < 1e-15);
        assert!((b[2] - 0.4_f64.sqrt() * 0.6).abs() < 1e-15);
    }

    fn model(own: bool) -> DiscreteLaguerre {
        let coefficients = (0..2)
            .map(|j| DMatrix::from_fn(2, 3, |i, l| 1.0 + i as f64 - 0.5 * l as f64 * j as f64));
        let mut model = DiscreteLaguerre::shared(
            Dof::TWO.to_vec(),
            0.6,
            0.08,
            coefficients.collect(),
            vec![0.1, -0.2],
        );
        if own {
            // the moment due to rotation gets two slower filters of its own
            model.terms[1].coefficients.row_mut(1).fill(0.0);
            model.terms.push(DiscreteTerm {
                input: 1,
                alpha: 0.9,
                coefficients: DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.7, -0.3]),
            });
        }
        model.validate().unwrap();
        model
    }

    #[test]
    fn realisation_and_closed_form_agree() {
        for own in [false, true] {
            let model = model(own);
            assert_eq!(model.shared_parameters(), (!own).then_some((0.6, 3)));
            let realization = model.realize();
            assert_eq!(realization.states(), if own { 8 } else { 6 });
            for k in [0.1, 0.7, 1.4] {
                let k = ReducedFrequency::from_full_width(k);
                let difference = model.transfer(k).unwrap() - realization.transfer(k).unwrap();
                assert!(difference.iter().all(|z| z.norm() < 1e-12));
            }
        }
    }

    #[test]
    fn both_layouts_survive_the_round_trip() {
        for own in [false, true] {
            let model = model(own);
            let text = serde_json::to_string(&model).unwrap();
            assert_eq!(text.contains("terms"), own, "{text}");
            assert_eq!(text.contains("\"alpha\":0.6,\"delta_s\""), !own, "{text}");
            assert_eq!(
                serde_json::from_str::<DiscreteLaguerre>(&text).unwrap(),
                model
            );
        }
        let shared = serde_json::to_string(&model(false)).unwrap();
        let both = shared.replacen('{', "{\"terms\":[],", 1);
        let message = serde_json::from_str::<DiscreteLaguerre>(&both).unwrap_err();
        assert!(message.to_string().contains("either"), "{message}");
    }

    #[test]
    fn impossible_models_are_refused() {
        let message = |change: fn(&mut DiscreteLaguerre)| {
            let mut model = model(true);
            change(&mut model);
            model.validate().unwrap_err().to_string()
        };
        assert!(
            message(|m| m.terms[2].alpha = 1.0).contains("terms[2].alpha: expected 0 < alpha < 1")
        );
        assert!(message(|m| m.terms[0].input = 2).contains("input below 2"));
        assert!(message(|m| drop(m.terms.remove(0))).contains("a motion without any"));
        assert!(message(|m| m.static_term.clear()).contains("static_term"));
    }
}
