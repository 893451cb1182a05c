//! How far constraints move onsets, on every embedded deck and section, beside the onset of the table itself.
//!
//! `cargo test --release --test identification -- moved_onsets:: --ignored --nocapture` prints the whole table.

use crate::fits::{bands, fastest_m_s, fitted, onset_m_s, rational};
use crate::matrix::{NamedSection, decks, sections_of_three, sections_of_two};
use aerodeck::aerodynamics::derivatives::{
    DerivativeTable, Extrapolation, InterpolatedTable, Interpolation,
};
use aerodeck::flutter::determinant_onset;
use aerodeck::identification::{Constraints, FitReport, Form};
use aerodeck::section::Dof;
use std::time::Instant;

/// Onset of the table itself by the determinant.
fn table_onset_m_s(table: &DerivativeTable, dofs: &[Dof], named: &NamedSection) -> f64 {
    let between =
        InterpolatedTable::by(Interpolation::default(), table, dofs, Extrapolation::Hold).unwrap();
    let structure = named.section.structure().unwrap();
    let range = table.tested_range(dofs);
    let found = determinant_onset("", &structure, &between, range, fastest_m_s(named)).unwrap();
    found.onset().map_or(f64::NAN, |o| o.at.speed_m_s)
}

/// The sections with which motions of a deck are looked at.
fn cases() -> [(&'static [Dof], Vec<NamedSection>); 2] {
    [
        (&Dof::TWO[..], sections_of_two()),
        (&Dof::THREE[..], sections_of_three()),
    ]
}

/// Residuals of all transfer functions, per cent, row by row.
fn residuals(report: &FitReport) -> String {
    let each = report.entries.iter();
    let shown = each.map(|e| format!("{:.1}", 100.0 * e.relative_rms.unwrap_or(f64::NAN)));
    shown.collect::<Vec<_>>().join(" ")
}

#[test]
#[ignore = "prints a table"]
fn onsets_with_and_without_constraints_and_of_the_table() {
    let asked = std::env::var("FORMS").unwrap_or_default();
    let forms: Vec<Form> = if asked.is_empty() {
        let rest = [Form::laguerre(3), rational(2)];
        std::iter::once(Form::default()).chain(rest).collect()
    } else {
        let of = |s: &str| match s.split_at(1) {
            ("a", _) => Form::default(),
            ("l", n) => Form::laguerre(n.parse().unwrap()),
            (_, n) => rational(n.parse().unwrap()),
        };
        asked.split(',').map(of).collect()
    };
    println!(
        "| deck | form | section | free | constrained | table | constrained to free | to table | grows below | ms | residuals |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for (dofs, sections) in cases() {
        for table in decks() {
            for form in &forms {
                let start = Instant::now();
                let held = fitted(&table, dofs, form, Constraints::Dissipative);
                let took = start.elapsed().as_secs_f64() * 1e3;
                let free = match &held.report.constraints {
                    Some(c) => c.unconstrained.as_deref().unwrap(),
                    None => &held.model,
                };
                for named in &sections {
                    let without = onset_m_s(free, named);
                    let with = onset_m_s(&held.model, named);
                    let measured = table_onset_m_s(&table, dofs, named);
                    let below = bands(&held.model, named).len() - 1;
                    println!(
                        "| {} | {} | {} | {without:.3} | {with:.3} | {measured:.3} | {:+.2} % | {:+.2} % | {below} | {took:.0} | {} |",
                        table.name,
                        held.report.entries[0].poles.len(),
                        named.name,
                        100.0 * (with / without - 1.0),
                        100.0 * (with / measured - 1.0),
                        residuals(&held.report),
                    );
                }
            }
        }
    }
}
