//! What is lost between the points of a table: the flat plate tabulated, and its onset and divergence read back.

use super::flat_plate::{WIDE, by_determinant};
use super::{Case, Figure};
use crate::aerodynamics::derivatives::{
    DerivativeTable, Extrapolation, InterpolatedTable, Interpolation,
};
use crate::aerodynamics::{AerodynamicModel, FlatPlate};
use crate::error::{Error, Result};
use crate::flutter::{divergence_speed, static_part};
use crate::section::{Dof, SectionModel};
use crate::units::ReducedFrequency;
use std::f64::consts::TAU;

/// Range of V̂ of every table.
const RANGE: (f64, f64) = (0.6, 8.0);
/// Tables of each number of points; neighbouring points are at least this far apart and at most that.
const TABLES: usize = 12;
const POINTS: [usize; 3] = [5, 7, 10];
const RATIOS: (f64, f64) = (1.1, 5.0);

const fn error(quantity: &'static str, expected: f64) -> Figure {
    Figure::new(quantity, expected, 3, "%")
}

/// Figures about interpolation.
pub const CASES: &[Case] = &[
    Case {
        name: "flat-plate-tables",
        what: "Flat plate tabulated at 5, 7 or 10 points of V̂ between 0.6 and 8 (36 tables), sections of Table 4.1 and IABSE 1.1a: error of the onset",
        figures: &[
            error("Re G, Im G/K modified Akima over ln K: rms", 0.0)
                .within(0.4, "the promise of the default: at most 0.4 %")
                .headline(),
            error("Re G, Im G/K modified Akima over ln K: worst", 0.0)
                .within(1.6, "the promise of the default: at most 1.6 %")
                .headline(),
            error("Re G, Im G/K modified Akima over ln K: rms", AKIMA.0),
            error("Re G, Im G/K modified Akima over ln K: worst", AKIMA.1),
            error("Re G, Im G/K cubic spline over ln K: rms", SPLINE.0),
            error("Re G, Im G/K cubic spline over ln K: worst", SPLINE.1),
            error("derivatives linear over V̂: rms", LINEAR.0).headline(),
            error("derivatives linear over V̂: worst", LINEAR.1),
        ],
        compute: tables,
    },
    Case {
        name: "flat-plate-table-divergence",
        what: "Divergence of IABSE 1.1a from tables of the flat plate: static part (H3*, A3*) at the lowest K; exact 90.466 m/s",
        figures: &[
            Figure::new("table up to V̂ = 8", 95.736, 3, "m/s"),
            Figure::new("table up to V̂ = 16", 93.092, 3, "m/s"),
            Figure::new("table up to V̂ = 32", 91.738, 3, "m/s"),
        ],
        compute: divergence,
    },
];

/// Errors in per cent, root mean square and worst, computed with NumPy and SciPy on the same tables.
const AKIMA: (f64, f64) = (0.178, 0.764);
const SPLINE: (f64, f64) = (0.038, 0.153);
const LINEAR: (f64, f64) = (5.496, 15.945);

/// Random numbers that any language can repeat: the congruential generator of D. E. Knuth (MMIX), upper 53 bits.
struct Congruential(u64);

impl Congruential {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Reduced velocities of every table: both ends and, between them, logarithmically uniform points that keep apart.
fn reduced_velocities() -> Vec<Vec<f64>> {
    let mut random = Congruential(1);
    let (low, high) = RANGE;
    let mut drawn = |count: usize| {
        loop {
            let inner = (2..count).map(|_| low * (random.next() * (high / low).ln()).exp());
            let mut all: Vec<f64> = inner.chain([low, high]).collect();
            all.sort_by(f64::total_cmp);
            let ratios = || all.windows(2).map(|w| w[1] / w[0]);
            if ratios().all(|q| q > RATIOS.0 && q < RATIOS.1) {
                return all;
            }
        }
    };
    let counts = POINTS.iter().flat_map(|n| [*n; TABLES]);
    counts.map(&mut drawn).collect()
}

/// The flat plate at these reduced velocities; `B = 1 m` and `V = 1 m/s`, which have no influence.
fn tabulated(v_hats: &[f64]) -> Result<DerivativeTable> {
    let frequencies: Vec<f64> = v_hats.iter().map(|v| 1.0 / (TAU * v)).collect();
    DerivativeTable::sampled(
        "flat plate",
        &FlatPlate::default(),
        1.0,
        &[1.0],
        &frequencies,
    )
}

fn tables() -> Result<Vec<f64>> {
    let sections = [SectionModel::table_4_1(), SectionModel::iabse_1_1a()];
    let mut figures = Vec::new();
    for by in [
        Interpolation::ModifiedAkima,
        Interpolation::CubicSpline,
        Interpolation::LinearVHat,
    ] {
        let mut errors = Vec::new();
        for section in &sections {
            let exact = by_determinant(section, &FlatPlate::default(), WIDE)?.speed_m_s;
            for v_hats in reduced_velocities() {
                let table = tabulated(&v_hats)?;
                let model = InterpolatedTable::by(by, &table, &Dof::TWO, Extrapolation::Refuse)?;
                let onset = by_determinant(section, &model, model.tested_range())?.speed_m_s;
                errors.push(100.0 * (onset / exact - 1.0));
            }
        }
        let squares: f64 = errors.iter().map(|e| e * e).sum();
        let worst = errors.iter().fold(0.0_f64, |w, e| w.max(e.abs()));
        let pair = [(squares / errors.len() as f64).sqrt(), worst];
        if by == Interpolation::default() {
            figures.extend(pair);
        }
        figures.extend(pair);
    }
    Ok(figures)
}

fn divergence() -> Result<Vec<f64>> {
    let structure = SectionModel::iabse_1_1a().structure()?;
    let speed = |highest: f64| {
        let table = tabulated(&[1.0, 2.0, 4.0, highest])?;
        let model = InterpolatedTable::new(&table, &Dof::TWO, Extrapolation::Refuse)?;
        let lowest = model.transfer(ReducedFrequency::from_v_hat(highest))?;
        divergence_speed(&structure, &static_part(&Dof::TWO, &lowest))?
            .ok_or_else(|| Error::Numerical("no divergence".into()))
    };
    [8.0, 16.0, 32.0].into_iter().map(speed).collect()
}
