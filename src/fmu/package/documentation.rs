//! `documentation/index.html` of an exported section, made from the variable table and the trained model.

use super::runtime::Runtime;
use crate::aerodynamics::{Realizable, Transfer};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{Onset, OnsetSearch, find_onset};
use crate::fmu::force_options::ForceOptions;
use crate::fmu::resources::Resources;
use crate::fmu::standard::FmiVersion;
use crate::fmu::variables::{
    Causality, Listing, Role, SectionParameter, StartValue, Variability, Variable,
};
use crate::plausibility::of_trained;
use crate::section::Dof;
use crate::trained_model::{Model, TrainedModel};
use crate::units::{ReducedFrequency, ReducedVelocity};
use crate::verdict::{Evidence, Phenomenon, Severity, Verdict};
use askama::Template;

/// The page: one file, nothing loaded from elsewhere.
///
/// # Errors
/// [`Error::Input`] and [`Error::Numerical`] when the onset of the default section cannot be computed.
pub fn documentation(
    resources: &Resources,
    runtimes: &[Runtime],
    listing: Listing,
    verdict: Option<&Verdict>,
) -> Result<String> {
    let model = &resources.model;
    let parts = resources.parts();
    let firsts: Vec<usize> = parts.iter().map(|p| p.strips.start).collect();
    let page = DocumentationPage {
        model,
        name: resources.words(|m| &m.name),
        kind: resources.words(|m| m.model.kind()),
        guid: resources.guid.to_string(),
        version: env!("CARGO_PKG_VERSION"),
        filters: resources
            .models()
            .map(|m| m.model.realize().states())
            .max()
            .unwrap_or(0),
        initial_rotation_deg: digits(model.experiment.initial_rotation_rad.to_degrees()),
        lateral: resources.models().any(|m| m.section.lateral.is_some()),
        platforms: runtimes
            .iter()
            .map(|r| (r.path_in_archive(FmiVersion::Two), r.platform_words()))
            .collect(),
        groups: groups(resources.table.listed(listing).table.variables(), &firsts),
        models: resources.models().map(ModelText::new).collect(),
        stability: match &resources.force {
            None => stability(model, verdict)?,
            Some(_) => Vec::new(),
        },
        force: resources.force.as_ref(),
        sampling: resources.models().find_map(SamplingText::new),
    };
    page.render()
        .map_err(|e| Error::Numerical(format!("documentation page: {e}")))
}

#[derive(Template)]
#[template(path = "fmu_documentation.html")]
struct DocumentationPage<'a> {
    model: &'a TrainedModel,
    name: String,
    kind: String,
    guid: String,
    version: &'static str,
    filters: usize,
    initial_rotation_deg: String,
    lateral: bool,
    platforms: Vec<(String, &'static str)>,
    groups: Vec<Group>,
    models: Vec<ModelText<'a>>,
    stability: Vec<String>,
    force: Option<&'a ForceOptions>,
    sampling: Option<SamplingText>,
}

/// Where a model holds, and how it was made.
struct ModelText<'a> {
    model: &'a TrainedModel,
    range: Range,
    speeds: Vec<Speeds>,
}

impl<'a> ModelText<'a> {
    fn new(model: &'a TrainedModel) -> Self {
        Self {
            model,
            range: Range::new(model),
            speeds: speeds(model),
        }
    }
}

/// Variables of one role.
struct Group {
    title: &'static str,
    note: &'static str,
    rows: Vec<Row>,
}

struct Row {
    name: String,
    kind: &'static str,
    unit: String,
    start: String,
    limits: String,
    description: String,
}

/// Of several strips those of these alone: all strips of a model have the same variables.
fn groups(variables: &[Variable], strips: &[usize]) -> Vec<Group> {
    let is_shown = |v: &Variable| match v.role {
        Role::Motion(s, ..) | Role::Force(s, ..) | Role::OfStrip(s, _) | Role::Strip(s, _) => {
            strips.contains(&s)
        }
        _ => true,
    };
    let group = |title, note, belongs: &dyn Fn(&Variable) -> bool| Group {
        title,
        note,
        rows: variables
            .iter()
            .filter(|v| belongs(v) && is_shown(v))
            .map(row)
            .collect(),
    };
    vec![
        group(
            "Inputs",
            "Continuous: held over a communication step, or on a straight line when the importer sets input derivatives.",
            &|v| v.causality == Causality::Input,
        ),
        group("Outputs", "At the communication points.", &|v| {
            v.causality == Causality::Output
        }),
        group(
            "Parameters that may be changed while running",
            "A change holds from the next communication step on and updates the calculated parameters.",
            &|v| v.causality == Causality::Parameter && v.variability == Variability::Tunable,
        ),
        group("Parameters that are fixed once initialised", "", &|v| {
            v.causality == Causality::Parameter && v.variability == Variability::Fixed
        }),
        group(
            "Calculated parameters",
            "From the current parameters; available from the initialisation mode on.",
            &|v| v.causality == Causality::CalculatedParameter,
        ),
        group("Constants", "", &|v| v.causality == Causality::Local),
    ]
}

fn row(v: &Variable) -> Row {
    let unit = v.unit.map_or("–", |u| u.name);
    let limit = |sign: &str, value: Option<f64>| value.map(|x| format!("{sign} {x}"));
    let limits: Vec<_> = limit("≥", v.min)
        .into_iter()
        .chain(limit("≤", v.max))
        .collect();
    Row {
        name: v.name.clone(),
        kind: v.value.type_name(),
        unit: v.display_unit.map_or_else(
            || unit.to_owned(),
            |shown| format!("{unit} (shown in {shown})"),
        ),
        start: match &v.value {
            StartValue::Real(start) => start.map(|x| x.to_string()),
            StartValue::Integer(start) => start.map(|x| x.to_string()),
            StartValue::Boolean(start) => start.map(|x| x.to_string()),
            StartValue::String(text) => Some(text.clone()),
        }
        .unwrap_or_default(),
        limits: limits.join(", "),
        description: v.description.clone(),
    }
}

/// The tested range in the three ways of writing it.
struct Range {
    k: [String; 2],
    v_star: [String; 2],
    v_hat: [String; 2],
}

impl Range {
    fn new(model: &TrainedModel) -> Self {
        let (low, high) = (model.tested_range.min, model.tested_range.max);
        let v_star = |k: ReducedFrequency| ReducedVelocity::from(k).v_star();
        Self {
            k: [low.full_width(), high.full_width()].map(digits),
            v_star: [v_star(high), v_star(low)].map(digits),
            v_hat: [high.v_hat(), low.v_hat()].map(digits),
        }
    }
}

/// Wind speeds of the tested range for a mode that vibrates at its frequency in still air.
struct Speeds {
    motion: &'static str,
    frequency_hz: String,
    from_m_s: String,
    to_m_s: String,
}

fn speeds(model: &TrainedModel) -> Vec<Speeds> {
    let section = &model.section;
    let speed = |frequency_hz: f64, k: ReducedFrequency| {
        let v_star = ReducedVelocity::from(k).v_star();
        digits(v_star * frequency_hz * section.width_m)
    };
    section
        .dofs()
        .into_iter()
        .map(|dof: Dof| {
            let frequency_hz = SectionParameter::Frequency(dof).value_in(section);
            Speeds {
                motion: dof.name(),
                frequency_hz: digits(frequency_hz),
                from_m_s: speed(frequency_hz, model.tested_range.max),
                to_m_s: speed(frequency_hz, model.tested_range.min),
            }
        })
        .collect()
}

/// Sentences on the section as exported: the verdict that goes with it, or what its own searches amount to.
fn stability(model: &TrainedModel, verdict: Option<&Verdict>) -> Result<Vec<String>> {
    let structure = model.section.structure()?;
    let search = OnsetSearch {
        speed_max_m_s: model.experiment.onset_search_limit_m_s,
        ..OnsetSearch::default()
    };
    let section = CoupledSection::with_model(&structure, &model.model)?;
    let found = match find_onset(&model.name, &section, &search, Some(model.tested_range)) {
        Ok(found) => found,
        // a page that says so is better than no FMU
        Err(e) => return Ok(vec![format!("Flutter onset could not be determined: {e}.")]),
    };
    let motion = found.onset().map(motion);
    let own;
    let verdict = match verdict {
        Some(verdict) => verdict,
        None => {
            let at_rest = ReducedFrequency::from_full_width(0.0);
            let at_rest = model.model.transfer(at_rest)?;
            let tested = model.tested_range;
            let evidence =
                Evidence::of_section("the model", &section, &at_rest, tested, &search, found);
            own = Verdict::judge(&Evidence {
                implausible: of_trained(&model.section, model),
                ..evidence
            });
            &own
        }
    };
    Ok(sentences(verdict, motion))
}

/// A verdict, sentence by sentence, with what is known of the motion at the onset.
pub(super) fn sentences(verdict: &Verdict, motion: Option<String>) -> Vec<String> {
    let mut sentences = vec![
        format!("{}.", verdict.headline),
        verdict.explanation.clone(),
    ];
    sentences.extend(motion);
    let divergence = verdict.critical.all();
    let divergence = divergence.filter(|c| c.phenomenon == Phenomenon::Divergence);
    sentences.extend(divergence.map(|c| {
        format!(
            "Static divergence at {} m/s by {}.",
            digits(c.best_m_s),
            c.forces
        )
    }));
    sentences.extend(verdict.doubts.iter().map(|d| match d.severity {
        Severity::Severe => format!("Severe doubt: {}.", d.text),
        Severity::Minor => format!("To be known: {}.", d.text),
    }));
    sentences
}

/// The motion at the onset.
fn motion(onset: &Onset) -> String {
    format!(
        "Flutter onset at {} m/s with {} Hz, V* = {}, K = {}; {}.",
        digits(onset.at.speed_m_s),
        digits(onset.at.frequency_hz),
        digits(onset.at.reduced_velocity.v_star()),
        digits(onset.at.reduced_frequency.full_width()),
        onset.mode_in_words(),
    )
}

/// What the discrete model does between its samples.
struct SamplingText {
    delta_s: String,
    speed_m_s: String,
    step_s: String,
}

impl SamplingText {
    fn new(model: &TrainedModel) -> Option<Self> {
        let Model::DiscreteLaguerre(discrete) = &model.model else {
            return None;
        };
        let speed = model.experiment.wind_speed_m_s;
        Some(Self {
            delta_s: digits(discrete.delta_s),
            speed_m_s: digits(speed),
            step_s: digits(discrete.delta_s * model.section.width_m / speed),
        })
    }
}

/// Four significant digits.
fn digits(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return x.to_string();
    }
    let before = x.abs().log10().floor() as i32 + 1;
    let decimals = usize::try_from(4 - before).unwrap_or(0);
    format!("{x:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::digits;

    #[test]
    fn four_digits_whatever_the_size() {
        for (x, text) in [
            (39.468_2, "39.47"),
            (0.091_234_5, "0.09123"),
            (-123.456, "-123.5"),
            (12_345.6, "12346"),
            (0.0, "0"),
        ] {
            assert_eq!(digits(x), text);
        }
    }
}
