//! The figures and tables of the thesis that can be computed, its numbers beside ours.

use super::compare::thesis_comparisons;
use super::evidence::{RESPONSE, ROOTS};
use super::laboratory::svg;
use super::output::OutputDir;
use super::progress::Progress;
use super::stages::FIGURE;
use crate::error::Result;
use crate::reference::FirstOrderExample;
use crate::report::{PageSection, SectionsPage, first_order_figures};
use crate::study::FlutterStudy;

/// Decimals of the numbers printed in section 2.5: bounds of α by (2.36) and (2.37), the end of the third impulse response.
const PRINTED_FIRST_ORDER: [&str; 3] = ["0.8283", "0.889", "0.0096"];

/// The page; the figure of the onsets stands in `out` as `flutter.svg`.
pub(super) fn thesis_page(
    results: &FlutterStudy,
    printed_m_s: f64,
    out: &OutputDir,
    progress: &Progress,
) -> Result<SectionsPage> {
    let mut sections = vec![first_order(progress)?];
    sections.extend(thesis_comparisons(progress)?);
    sections.push(onsets(results, printed_m_s, out));
    sections.push(errata());
    let own = results
        .onsets
        .iter()
        .find(|o| o.at.model != "interpolated table");
    let own = own.map_or("no onset".to_owned(), |o| {
        format!("{:.1} m/s", o.at.speed_m_s)
    });
    Ok(SectionsPage {
        title: "The thesis, computed again".to_owned(),
        subtitle:
            "Investigation of Laguerre expansion basis for modelling of bridge aeroelastic forces"
                .to_owned(),
        answer: format!("Onset of the coupled section: printed {printed_m_s} m/s, here {own}"),
        sections,
    })
}

fn first_order(progress: &Progress) -> Result<PageSection> {
    let stage = progress.stage("first-order example");
    let results = FirstOrderExample::default().run()?;
    let figures = first_order_figures(&results)?;
    drop(stage);
    let (lower, upper) = results.alpha_bounds;
    let here = [
        format!("{lower:.4}"),
        format!("{upper:.4}"),
        format!("{:.4}", results.last_value),
    ];
    let what = [
        "lower bound of α, (2.36)",
        "upper bound of α, (2.37)",
        "third impulse response at the end of the memory",
    ];
    let rows = what.iter().zip(PRINTED_FIRST_ORDER).zip(here);
    Ok(PageSection {
        title: "2.5 A first-order system".to_owned(),
        text: vec![format!(
            "Predicted output off by {:.1} %, transfer function by at most {:.1} % in the trained band.",
            100.0 * results.validation_error,
            100.0 * results.model.worst_in_band
        )],
        header: vec!["number", "thesis", "here"],
        rows: rows
            .map(|((what, printed), here)| vec![(*what).to_owned(), printed.to_owned(), here])
            .collect(),
        figures: figures
            .into_iter()
            .map(|f| (format!("Figure {}", f.number), f.figure.svg().to_owned()))
            .collect(),
    })
}

fn onsets(results: &FlutterStudy, printed_m_s: f64, out: &OutputDir) -> PageSection {
    let row = |o: &crate::flutter::Onset| {
        let trained = o.at.model != "interpolated table";
        let printed = if trained {
            format!("{printed_m_s}")
        } else {
            "–".to_owned()
        };
        vec![
            format!("{} ({})", o.at.model, o.at.method.name()),
            printed,
            format!("{:.3}", o.at.speed_m_s),
            format!("{:.4}", o.at.frequency_hz),
        ]
    };
    let deviations = results.deviations.iter().map(|d| d.explain());
    let figures = [
        (
            RESPONSE,
            "Figure 4.2: the discrete Laguerre model, released below, at and above the onset",
        ),
        (
            ROOTS,
            "Figure 4.3: eigenvalues as the wind rises, discrete ones converted to continuous time",
        ),
        (
            FIGURE,
            "Figures 4.4 and 4.5: frequency and damping over wind speed",
        ),
    ];
    PageSection {
        title: "4 Onset of a section with two degrees of freedom".to_owned(),
        text: deviations
            .chain([
                "Table 4.1's wind speeds are 17 to 40 m/s; the curves here begin at the lowest speed that can be judged. The thesis prints \
                 no number of its Figures 4.2 to 4.5 but the onset."
                    .to_owned(),
            ])
            .collect(),
        header: vec!["model", "thesis, V m/s", "here, V m/s", "here, f Hz"],
        rows: results.onsets.iter().map(row).collect(),
        figures: figures
            .into_iter()
            .filter_map(|(stem, caption)| Some((caption.to_owned(), svg(out, stem)?)))
            .collect(),
    }
}

/// Corrections of printed equations that change a number.
fn errata() -> PageSection {
    let rows = [
        (
            "(1.24)",
            "H1* with a factor V̂²",
            "H1* with a factor V̂: −1.0464 where the printed form gives −2.1975",
        ),
        (
            "(1.29) to (1.34)",
            "lag terms enter with a plus",
            "with a minus: as printed all lag forces have the wrong sign",
        ),
        (
            "(3.3), (3.4)",
            "forces over ρLBV² and ρLB²V²",
            "over half of it, as (1.17) and (B.3) have it",
        ),
        (
            "(4.8a), (B.2a)",
            "the force of a sample is held over the step",
            "a delay of half a step, stated beside each onset",
        ),
        (
            "(B.4)",
            "lower right block without the output matrix of the motion",
            "with it; as printed the units do not match",
        ),
        (
            "(C.1)",
            "2πf, and ½ρV²B for the moment",
            "K = 2πfB/V, and ½ρV²B² for the moment",
        ),
        ("(C.2)", "V* = V/(ωB)", "V* = V/(fB)"),
        (
            "(C.3)",
            "p1, p4 for sway and p5, p6 for heave",
            "p1, p4 belong to heave and p5, p6 to sway",
        ),
    ];
    PageSection {
        title: "Errata that change a number".to_owned(),
        header: vec!["equation", "printed", "here"],
        rows: rows
            .map(|(a, b, c)| [a, b, c].map(str::to_owned).to_vec())
            .to_vec(),
        ..PageSection::default()
    }
}
