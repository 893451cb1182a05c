//! Models that take energy out of fast motion: no growth below the onset, on every deck, section and form.
//!
//! `cargo test --release --test identification -- dissipative:: --ignored --nocapture` prints what the constraints change, as a table.

use crate::fits::{assert_stable_below_onset, bands, fitted, forms, objective, onset_m_s, sources};
use crate::matrix::{decks, sections_of_three, sections_of_two};
use aerodeck::aerodynamics::{FlatPlate, Transfer};
use aerodeck::identification::{
    Constraints, Fitted, Form, FrequencyFit, TimeFit, fit_records, fit_table, sample_model,
};
use aerodeck::section::Dof;
use aerodeck::trained_model::Model;
use aerodeck::units::ReducedFrequency;
use aerodeck::wind_tunnel::TunnelPlan;

#[test]
fn nothing_grows_below_the_onset_with_two_motions() {
    for table in decks() {
        for form in forms() {
            let model = fitted(&table, &Dof::TWO, &form, Constraints::Dissipative).model;
            for named in sections_of_two() {
                let what = format!("{}, {}", table.name, form.describe());
                assert_stable_below_onset(&what, &model, &named);
            }
        }
    }
}

#[test]
fn nothing_grows_below_the_onset_with_three_motions() {
    for table in decks() {
        for form in forms() {
            let model = fitted(&table, &Dof::THREE, &form, Constraints::Dissipative).model;
            for named in sections_of_three() {
                let what = format!("{}, {}", table.name, form.describe());
                assert_stable_below_onset(&what, &model, &named);
            }
        }
    }
}

/// The default of fits to records.
#[test]
fn nothing_grows_below_the_onset_by_records() {
    for (dofs, sections) in [
        (&Dof::TWO[..], sections_of_two()),
        (&Dof::THREE[..], sections_of_three()),
    ] {
        for table in decks() {
            let records = TunnelPlan::default()
                .records_from_table(&table, dofs)
                .unwrap();
            let fit = TimeFit::default();
            let model = fit_records(&sources(&records), &fit, &|_, _| ())
                .unwrap()
                .model;
            for named in &sections {
                let what = format!("{}, {} motions, records", table.name, dofs.len());
                assert_stable_below_onset(&what, &model, named);
            }
        }
    }
}

/// What three filters of measured decks may cost: 2 % of the onset, 2 percentage points of the residual that the fit
/// minimises.
#[test]
fn three_filters_cost_little() {
    for table in decks() {
        let Fitted {
            model: alone,
            report: before,
        } = fitted(&table, &Dof::TWO, &Form::laguerre(3), Constraints::None);
        let Fitted {
            model: held,
            report: after,
        } = fitted(
            &table,
            &Dof::TWO,
            &Form::laguerre(3),
            Constraints::Dissipative,
        );
        for named in sections_of_two() {
            let (without, with) = (onset_m_s(&alone, &named), onset_m_s(&held, &named));
            let moved = with / without - 1.0;
            println!("{}, {}: {without:.3} {with:.3}", table.name, named.name);
            assert!(
                moved.abs() <= 0.02,
                "{}, {}: {without} {with}",
                table.name,
                named.name
            );
        }
        let rise = objective(&after) - objective(&before);
        println!(
            "{}: {} {}",
            table.name,
            objective(&before),
            objective(&after)
        );
        assert!((0.0..=0.02).contains(&rise), "{}: {rise}", table.name);
    }
}

/// A flat plate takes energy out of fast motion by itself.
#[test]
fn a_flat_plate_does_not_feel_the_constraints() {
    let ks: Vec<_> = (0..8)
        .map(|i| ReducedFrequency::from_full_width(0.19 * 1.35_f64.powi(i)))
        .collect();
    let samples = sample_model(&FlatPlate::default(), &ks).unwrap();
    for form in forms() {
        let fit = |constraints| {
            let options = FrequencyFit {
                form: form.clone(),
                constraints,
                ..FrequencyFit::default()
            };
            fit_table(&samples, FlatPlate::default().dofs(), &options).unwrap()
        };
        let (alone, held) = (fit(Constraints::None), fit(Constraints::Dissipative));
        for named in sections_of_two() {
            let moved = onset_m_s(&held.model, &named) / onset_m_s(&alone.model, &named) - 1.0;
            let tolerance = if form == Form::laguerre(3) {
                2e-4
            } else {
                2e-3
            };
            assert!(moved.abs() <= tolerance, "{}: {moved}", form.describe());
        }
    }
}

/// Without constraints these models grow where nothing does: the table would pass a test that cannot fail otherwise.
#[test]
fn without_constraints_measured_decks_grow_in_slow_wind() {
    let sections = sections_of_two();
    let growing = decks()
        .iter()
        .filter(|table| {
            let model = fitted(table, &Dof::TWO, &Form::laguerre(3), Constraints::None).model;
            sections.iter().any(|s| bands(&model, s).len() > 1)
        })
        .count();
    assert!(growing >= 3, "{growing}");
}

#[test]
#[ignore = "prints a table"]
fn what_the_constraints_change() {
    println!(
        "| deck | form | section | grows without, m/s | with | onset without | with | moved | residual rises by |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (dofs, sections) in [
        (&Dof::TWO[..], sections_of_two()),
        (&Dof::THREE[..], sections_of_three()),
    ] {
        for table in decks() {
            for form in forms() {
                let Fitted {
                    model: alone,
                    report: before,
                } = fitted(&table, dofs, &form, Constraints::None);
                let Fitted {
                    model: held,
                    report,
                } = fitted(&table, dofs, &form, Constraints::Dissipative);
                let rise = 100.0 * (objective(&report) - objective(&before));
                for named in &sections {
                    let below = |m: &Model| {
                        let all = bands(m, named);
                        let shown = all[..all.len().saturating_sub(1)].iter();
                        let text: Vec<_> = shown.map(|(a, b)| format!("{a:.1}–{b:.1}")).collect();
                        if text.is_empty() {
                            "nowhere".to_owned()
                        } else {
                            text.join(", ")
                        }
                    };
                    let (without, with) = (onset_m_s(&alone, named), onset_m_s(&held, named));
                    println!(
                        "| {} | {} | {} | {} | {} | {without:.2} | {with:.2} | {:+.2} % | {:+.2} |",
                        table.name,
                        form.describe(),
                        named.name,
                        below(&alone),
                        below(&held),
                        100.0 * (with / without - 1.0),
                        rise,
                    );
                }
                for sentence in report.constraints.iter().flat_map(|c| &c.sentences) {
                    println!("<!-- {sentence} -->");
                }
            }
        }
    }
}
