//! Small trained models of the flat plate, one of each kind: the committed fixtures and where they come from.

use aerodeck::aerodynamics::laguerre::FilterTerm;
use aerodeck::aerodynamics::{
    DiscreteLaguerre, FilterBank, FlatPlate, LaguerreModel, RationalModel, Transfer,
};
use aerodeck::section::{Dof, SectionModel};
use aerodeck::trained_model::{Experiment, Model, Provenance, SCHEMA_VERSION, TrainedModel};
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::{Complex, DMatrix, DVector};
use std::path::{Path, PathBuf};

/// Kinds of the fixtures: file stems in `tests/data/models` and `modelDescription`.
pub const KINDS: [&str; 3] = ["continuous_laguerre", "rational", "discrete_laguerre"];

/// The committed model file of a kind.
pub fn model_file(kind: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/models/{kind}.json"))
}

/// The model of a kind, made anew.
pub fn generate(kind: &str) -> TrainedModel {
    let model = match kind {
        "continuous_laguerre" => Model::Laguerre(continuous_laguerre()),
        "rational" => Model::Rational(RationalModel::jones_flat_plate()),
        "discrete_laguerre" => Model::DiscreteLaguerre(discrete_laguerre()),
        other => panic!("no fixture `{other}`"),
    };
    let [first, .., last] = test_points();
    TrainedModel {
        schema_version: SCHEMA_VERSION,
        name: "Flat plate, section of Table 4.1".into(),
        section: SectionModel::table_4_1(),
        model,
        tested_range: ReducedFrequencyRange::between(first, last),
        provenance: Provenance {
            source: "flat plate in potential flow, Theodorsen, NACA Report 496 (1935)".into(),
            licence: "none needed: closed form".into(),
            method: "least squares on the transfer matrix (tests/common/models.rs)".into(),
            aerodeck_version: env!("CARGO_PKG_VERSION").into(),
            notes: vec![],
        },
        experiment: Experiment {
            // just below the onset of each: 39.5 m/s, and 4.5 % lower for the discrete model
            wind_speed_m_s: if kind == "discrete_laguerre" {
                36.0
            } else {
                38.0
            },
            initial_vertical_m: 0.01,
            initial_rotation_rad: 0.01,
            stop_time_s: 10.0,
            step_size_s: 0.01,
            onset_search_limit_m_s: 100.0,
        },
    }
}

/// Twelve reduced frequencies from 0.1 to 1.5.
fn test_points() -> [ReducedFrequency; 12] {
    std::array::from_fn(|i| ReducedFrequency::from_full_width(0.1 * 15f64.powf(i as f64 / 11.0)))
}

/// `x` minimising `|Σ x_l basis_l(K) − G_ij(K)|²` over the test points, for every entry of `G`: a 2×2 matrix a basis
/// function.
fn fit(basis: impl Fn(f64) -> Vec<Complex<f64>>) -> Vec<DMatrix<f64>> {
    let points = test_points();
    let rows: Vec<_> = points.iter().map(|k| basis(k.full_width())).collect();
    let g: Vec<_> = points
        .iter()
        .map(|k| FlatPlate::default().transfer(*k).unwrap())
        .collect();
    let real_rows = |entry: &dyn Fn(usize, usize) -> Complex<f64>, columns: usize| {
        DMatrix::from_fn(2 * points.len(), columns, |i, j| {
            let z = entry(i / 2, j);
            if i % 2 == 0 { z.re } else { z.im }
        })
    };
    let design = real_rows(&|i, j| rows[i][j], rows[0].len()).svd(true, true);
    let mut terms = vec![DMatrix::zeros(2, 2); rows[0].len()];
    for entry in 0..4 {
        let (row, column) = (entry / 2, entry % 2);
        let right = real_rows(&|i, _| g[i][(row, column)], 1);
        let x: DVector<f64> = design.solve(&right, 1e-14).unwrap().column(0).into();
        for (term, value) in terms.iter_mut().zip(x.iter()) {
            term[(row, column)] = *value;
        }
    }
    terms
}

/// Column `motion` of each term, side by side: n×L.
fn column_of(terms: &[DMatrix<f64>], motion: usize) -> DMatrix<f64> {
    DMatrix::from_fn(2, terms.len(), |i, l| terms[l][(i, motion)])
}

/// Four filters with the pole 0.35 and feed-through e₀, e₁, e₂: 12 states with the section's four.
fn continuous_laguerre() -> LaguerreModel {
    let bank = FilterBank::laguerre(0.35, 4).unwrap();
    let terms = fit(|k| {
        let p = Complex::new(0.0, k);
        let mut basis = vec![Complex::new(1.0, 0.0), p, p * p];
        basis.extend(bank.response(p));
        basis
    });
    LaguerreModel {
        dofs: Dof::TWO.to_vec(),
        e0: terms[0].clone(),
        e1: terms[1].clone(),
        e2: terms[2].clone(),
        terms: (0..2)
            .map(|input| FilterTerm {
                input,
                poles: bank.clone(),
                coefficients: column_of(&terms[3..], input),
            })
            .collect(),
    }
}

/// Three filters, α = 0.6, sampled as at 200 Hz and 8.17 m/s on a width of 0.5 m.
fn discrete_laguerre() -> DiscreteLaguerre {
    let delta_s = 8.17 / 200.0 / 0.5;
    let single = |l: usize| {
        let mut coefficients = vec![DMatrix::zeros(1, 3)];
        coefficients[0][(0, l)] = 1.0;
        DiscreteLaguerre::shared(vec![Dof::Vertical], 0.6, delta_s, coefficients, vec![0.0])
    };
    let terms = fit(|k| {
        let k = ReducedFrequency::from_full_width(k);
        (0..3)
            .map(|l| single(l).transfer(k).unwrap()[(0, 0)])
            .collect()
    });
    DiscreteLaguerre::shared(
        Dof::TWO.to_vec(),
        0.6,
        delta_s,
        (0..2).map(|motion| column_of(&terms, motion)).collect(),
        vec![0.0; 2],
    )
}
