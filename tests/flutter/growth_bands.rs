//! Two independent looks at growth: modes that are followed, and all eigenvalues.

use crate::matrix;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::derivatives::embedded;
use aerodeck::flutter::{OnsetSearch, find_onset, growth_scan};
use aerodeck::identification::{Constraints, Fitted, FrequencyFit, fit_table};
use aerodeck::section::{Dof, SectionModel};

/// Eigenvalues of the state matrix at many speeds, without any of the library's search.
fn brute(section: &CoupledSection, speed_max: f64) -> Vec<(f64, bool)> {
    (1..=400)
        .map(|i| {
            let speed = 0.02 * (speed_max / 0.02_f64).powf(f64::from(i) / 400.0);
            let eigenvalues = section.at(speed).unwrap().eigenvalues().unwrap();
            let grows =
                |z: &nalgebra::Complex<f64>| z.im > 1e-6 * z.norm() && z.re > 1e-7 * z.norm();
            (speed, eigenvalues.iter().any(grows))
        })
        .collect()
}

/// The search that follows modes, the scan of all eigenvalues and a scan of the test's own say the same over all decks and
/// sections; fits without constraints, so that there are spurious bands to be found.
#[test]
fn followed_modes_and_all_eigenvalues_agree_over_the_matrix() {
    let mut with_bands = 0;
    for table in matrix::decks() {
        for named in matrix::sections() {
            let dofs = named.section.dofs();
            let fit = FrequencyFit {
                constraints: Constraints::None,
                ..FrequencyFit::default()
            };
            let Fitted { model, report } = fit_table(&table.samples(&dofs), &dofs, &fit).unwrap();
            let structure = named.section.structure().unwrap();
            // least squares alone can give more negative added mass than the section has mass
            let Ok(section) = CoupledSection::with_model(&structure, &model) else {
                continue;
            };
            let place = format!("{}, {}", table.name, named.name);
            let speed_max = if structure.width_m > 10.0 {
                110.0
            } else {
                50.0
            };
            let search = OnsetSearch {
                speed_max_m_s: speed_max,
                ..OnsetSearch::default()
            };
            let found = find_onset("", &section, &search, Some(report.tested_range)).unwrap();
            let critical = found.critical_speed_m_s().unwrap_or(speed_max);
            let bands = growth_scan(&section, speed_max, Some(report.tested_range)).unwrap();
            for (speed, grows) in brute(&section, speed_max) {
                let inside = bands
                    .iter()
                    .any(|b| b.from_m_s <= speed && speed <= b.to_m_s);
                let edge = bands.iter().any(|b| {
                    let near = |v: f64| (v / speed - 1.0).abs() < 1e-3;
                    near(b.from_m_s) || near(b.to_m_s)
                });
                assert!(inside == grows || edge, "{place}: {speed} m/s, {bands:?}");
            }
            // the answer is the start of a band, and what lies below is named
            let below: Vec<_> = bands
                .iter()
                .filter(|b| b.from_m_s < critical * 0.999)
                .collect();
            let starts = |b: &&aerodeck::flutter::GrowthBand| {
                let same = |v: f64| (v / critical - 1.0).abs() < 1e-3;
                same(b.from_m_s) || b.tested_from_m_s.is_some_and(same)
            };
            if found.critical_speed_m_s().is_some() {
                assert!(
                    bands.iter().any(|b| starts(&b)) || below.iter().any(|b| b.to_m_s > critical),
                    "{place}: {found:?} {bands:?}"
                );
            }
            if let Some(onset) = found.onset() {
                let named = |v: f64| {
                    onset
                        .spurious_speeds_m_s
                        .iter()
                        .any(|s| (s / v - 1.0).abs() < 1e-2)
                };
                for band in &below {
                    assert!(
                        band.extrapolated() || band.to_m_s > critical,
                        "{place}: {band:?}"
                    );
                    assert!(named(band.from_m_s), "{place}: {onset:?} {band:?}");
                }
            }
            with_bands += usize::from(!below.is_empty());
        }
    }
    assert!(with_bands > 0);
}

/// Growth in a narrow band of low speeds is met however coarse the search is.
#[test]
fn bands_below_the_first_speed_are_met() {
    let table = embedded::deck("LN21-5500").unwrap();
    let fit = FrequencyFit {
        constraints: Constraints::None,
        ..FrequencyFit::default()
    };
    let Fitted { model, report } = fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &fit).unwrap();
    let structure = SectionModel::table_4_1().structure().unwrap();
    let section = CoupledSection::with_model(&structure, &model).unwrap();
    let bands = growth_scan(&section, 30.0, Some(report.tested_range)).unwrap();
    assert!(!bands.is_empty());
    let coarse = OnsetSearch {
        speed_max_m_s: 60.0,
        speeds: 4,
    };
    let found = find_onset("", &section, &coarse, Some(report.tested_range)).unwrap();
    let onset = found.onset().unwrap();
    assert!(!onset.spurious_speeds_m_s.is_empty(), "{onset:?} {bands:?}");
}
