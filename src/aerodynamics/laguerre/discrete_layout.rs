//! How a discrete Laguerre model stands in a file: one `alpha` and one coefficient matrix a motion where all transfer
//! functions share their filters, a list of `terms` where they do not.

use super::discrete::{DiscreteLaguerre, DiscreteTerm};
use crate::section::Dof;
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// Either `alpha` and `coefficients`, or `terms`.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Layout {
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

impl From<DiscreteLaguerre> for Layout {
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

impl TryFrom<Layout> for DiscreteLaguerre {
    type Error = String;

    fn try_from(layout: Layout) -> Result<Self, String> {
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
