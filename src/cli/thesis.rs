//! `aerodeck thesis`: the headline of the source document, repeated, with a page of its figures and tables that can be computed, its
//! numbers beside ours.

use super::stages::Stages;
use super::vocabulary::{
    Answer, Dof, Error, Figure, FlutterStudy, OutputDir, PageSection, Progress, Result,
    SectionsPage, Study, Temporary, list, rendered,
};
use super::{headline, result_files, text};
use crate::aerodynamics::laguerre::discrete_memory;
use crate::cli::compare::thesis_comparisons;
use crate::cli::laboratory::drawn;
use crate::cli::result_files::{FIGURE, RESPONSE, ROOTS};
use crate::cli::select::parameter_maps;
use crate::identification::{Grid, GridAxis, TimeWeights};
use crate::reference::{OF_THE_DECKS, first_order_example, laguerre_functions};
use crate::report::{first_order_figures, laguerre_figures};
use crate::selection::metric_grid;
use crate::study::{RecordSet, thesis_study_text};
use crate::wind_tunnel::RecordSource;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Onset printed in the thesis (Figures 4.2 and 4.3) for both models, m/s.
const PRINTED_M_S: f64 = 37.6;

/// Runs the command, which writes its page into the folder `left_in`.
pub(crate) fn run(left_in: Option<&Path>, progress: &Progress) -> Result<Answer> {
    let aside = tempfile::tempdir().map_err(|e| Error::io(std::env::temp_dir(), e))?;
    let aside = Temporary::new(aside.keep());
    let study = Study::from_toml(thesis_study_text(), PathBuf::new())?;
    let mut stages = Stages::new(study, OutputDir::new(aside.path())?, progress)?;
    let records = RecordSet::in_memory(stages.tunnel()?);
    let trained = stages.train(Some(&records))?;
    let results = stages.flutter_of(&trained)?;
    let Stages {
        study,
        mut out,
        failed,
        ..
    } = stages;
    let mut text = format!("{}\n\n", study.name);
    for t in &trained {
        text.push_str(&text::fit(&t.model.name, &t.report, &t.uncertainty));
    }
    text.push('\n');
    text.push_str(&text::onsets(&results));
    text.push_str(&text::deviations(&results));
    text.push_str(&text::failures(&failed));
    let _ = writeln!(text, "thesis: {PRINTED_M_S} m/s for both models");
    if let Some(folder) = left_in {
        result_files::flutter_figure(&study, &results, None, &mut out)?;
        result_files::write_curves(&study, &results.curves, &mut out)?;
        if let Some(own) = trained.first()
            && let Some(onset) = headline::own_onset(&results, &own.model.name)
        {
            result_files::write_response(&own.model, &onset.at, &mut out)?;
        }
        let first = records.select(Some(&[1]))?;
        let page = thesis_page(&results, &first, &out, progress)?;
        let mut left = OutputDir::new(folder)?;
        left.write("thesis.html", rendered(&page)?)?;
        text.push_str(&list(&left.commit()?));
    }
    let value =
        serde_json::json!({ "printed_m_s": PRINTED_M_S, "flutter": results, "failed": failed });
    Ok(Answer::new(text, &value)?.passed_if(failed.is_empty()))
}

/// Decimals of the numbers printed in section 2.5: bounds of α by (2.36) and (2.37), the end of the third impulse response.
const PRINTED_FIRST_ORDER: [&str; 3] = ["0.8283", "0.889", "0.0096"];

/// The page; the figure of the onsets stands in `out` as `flutter.svg`.
fn thesis_page(
    results: &FlutterStudy,
    records: &[&dyn RecordSource],
    out: &OutputDir,
    progress: &Progress,
) -> Result<SectionsPage> {
    let mut sections = vec![functions()?, first_order(progress)?];
    sections.push(parameters(records, progress)?);
    sections.extend(thesis_comparisons(progress)?);
    sections.push(onsets(results, out));
    sections.push(PageSection::table(
        "Errata that change a number",
        "equation | printed | here",
        rows_of(include_str!("thesis/errata.txt")),
    ));
    sections.push(PageSection::table(
        "Figures that are not computed",
        "figure | why",
        rows_of(include_str!("thesis/not_computed.txt")),
    ));
    let mut onsets = results.onsets.iter();
    let own = onsets.find(|o| o.at.model != "interpolated table");
    let own = own.map(|o| format!("{:.1} m/s", o.at.speed_m_s));
    let own = own.unwrap_or("no onset".to_owned());
    Ok(SectionsPage {
        title: "The thesis, computed again".to_owned(),
        subtitle:
            "Investigation of Laguerre expansion basis for modelling of bridge aeroelastic forces"
                .to_owned(),
        answer: format!("Onset of the coupled section: printed {PRINTED_M_S} m/s, here {own}"),
        sections,
        ..SectionsPage::default()
    })
}

/// The rows of a file of the page, a line each.
fn rows_of(file: &str) -> Vec<Vec<String>> {
    let rows = file.lines();
    rows.map(|row| row.split(" | ").map(str::to_owned).collect())
        .collect()
}

fn captioned(figures: Vec<(&'static str, Figure)>) -> Vec<(String, Figure)> {
    let one = |(number, figure): (&str, Figure)| {
        let mut captions = include_str!("thesis/captions.txt").lines();
        let known = captions.find_map(|line| line.strip_prefix(number)?.strip_prefix(" | "));
        let caption = known.unwrap_or_default();
        (format!("Figure {number}: {caption}"), figure)
    };
    figures.into_iter().map(one).collect()
}

fn functions() -> Result<PageSection> {
    let (alpha, filters) = OF_THE_DECKS;
    Ok(PageSection {
        title: "2.3 and 3.4 Laguerre functions".to_owned(),
        text: vec![format!(
            "The filters of the decks stay below 0.01 from sample {} on; the thesis reads about 40 from its Figure 3.10.",
            discrete_memory(alpha, filters)
        )],
        figures: captioned(laguerre_figures(&laguerre_functions()?)?),
        ..PageSection::default()
    })
}

/// Section 3.5.3: the metrics of the forces at the thesis's frequency over α and L.
fn parameters(records: &[&dyn RecordSource], progress: &Progress) -> Result<PageSection> {
    const FREQUENCY_HZ: f64 = 1.09;
    const FILTERS: usize = 8;
    let stage = progress.stage("parameters of the discrete model");
    let alphas: Vec<f64> = (0..20).map(|i| 0.2 + 0.04 * f64::from(i)).collect();
    let axis = GridAxis::Discrete(alphas.clone(), TimeWeights::None);
    let grid = Grid::new(records, axis, FILTERS, &|_, _| {})?;
    let mut figures = Vec::new();
    for metrics in metric_grid(&grid, records, FREQUENCY_HZ)? {
        let number = match metrics.motion {
            Dof::Vertical => "3.18",
            _ => "3.19",
        };
        let caption = format!(
            "Figure {number}: metrics of the {} force over α and L, {} motion at {:.2} Hz",
            metrics.force.name(),
            metrics.motion.name(),
            metrics.frequency_hz
        );
        figures.push((caption, parameter_maps(&alphas, FILTERS, &metrics)?));
    }
    drop(stage);
    Ok(PageSection {
        title: "3.5.3 Parameters, on rebuilt records".to_owned(),
        figures,
        ..PageSection::default()
    })
}

fn first_order(progress: &Progress) -> Result<PageSection> {
    let stage = progress.stage("first-order example");
    let results = first_order_example()?;
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
            100.0 * results.worst_in_band(&results.model)
        )],
        header: "number | thesis | here",
        rows: rows
            .map(|((what, printed), here)| vec![(*what).to_owned(), printed.to_owned(), here])
            .collect(),
        figures: captioned(figures),
    })
}

fn onsets(results: &FlutterStudy, out: &OutputDir) -> PageSection {
    let row = |o: &crate::flutter::Onset| {
        let printed = match o.at.model.as_str() {
            "interpolated table" => "–".to_owned(),
            _ => PRINTED_M_S.to_string(),
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
        header: "model | thesis, V m/s | here, V m/s | here, f Hz",
        rows: results.onsets.iter().map(row).collect(),
        figures: figures
            .into_iter()
            .filter_map(|(stem, caption)| Some((caption.to_owned(), drawn(out, stem)?)))
            .collect(),
    }
}
