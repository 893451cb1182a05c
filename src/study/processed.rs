//! The study that goes with the records of a processed campaign.

use super::{DeckSource, FlutterBlock, Study};
use crate::error::{Error, Result};
use crate::files::toml_lines;
use crate::identification::derivatives::IdentifiedDerivatives;
use crate::section::{Dof, STANDARD_AIR_DENSITY_KG_M3, SectionModel};
use crate::wind_tunnel::RawCampaign;
use serde::Deserialize;
use std::path::{Path, PathBuf};

const HEAD: &str =
    "# Records and derivatives of a processed campaign; run `aerodeck study study.toml`.\n";

/// Text of a study of `records` and `table` (paths from the folder of the study): section, models and search of `base`, or
/// the default models. `section` goes before that of `base`; with neither the text has a marked place, and
/// [`Study::from_toml`] refuses it until the section is stated there.
pub(crate) fn processed_study_text(
    raw: &RawCampaign,
    base: Option<&Study>,
    section: Option<&SectionModel>,
    table: &str,
    records: &[PathBuf],
    found: &IdentifiedDerivatives,
) -> Result<String> {
    let mut study = match base {
        Some(study) => study.clone(),
        None => default_study(found)?,
    };
    study.name.clone_from(&raw.section);
    study.deck = DeckSource {
        source: table.to_owned(),
        records: records.iter().map(|p| slashes(p)).collect(),
        ..DeckSource::default()
    };
    if let Some(section) = section {
        study.section = section.clone();
    }
    let unwritable = |e: &dyn std::fmt::Display| Error::Numerical(e.to_string());
    let mut values = toml::Table::try_from(&study).map_err(|e| unwritable(&e))?;
    let known = section.is_some() || base.is_some();
    if !known {
        values.remove("section");
    }
    let text = toml::to_string(&values).map_err(|e| unwritable(&e))?;
    let marked = match known {
        true => String::new(),
        false => marked_place(raw, &found.dofs),
    };
    Ok(format!("{HEAD}{text}{marked}"))
}

/// The default models; those of one mean speed at the first at which every motion was tested, and none where there is no such speed.
fn default_study(found: &IdentifiedDerivatives) -> Result<Study> {
    let mut study = Study::from_toml(super::demo_study_text(), PathBuf::new())?;
    // the range follows the section
    study.flutter = FlutterBlock::default();
    let groups = found.speed_groups();
    let is_whole = |group: &Vec<f64>| {
        found.dofs.iter().all(|dof| {
            let estimates = found.estimates.iter();
            let mut of_motion = estimates.filter(|e| e.derivative.motion() == *dof);
            of_motion.any(|e| group.contains(&e.mean_speed_m_s))
        })
    };
    let first = groups.iter().position(is_whole);
    let models = &mut study.models;
    models.retain(|m| m.speed_groups.is_none() || first.is_some());
    for groups in models.iter_mut().filter_map(|m| m.speed_groups.as_mut()) {
        *groups = first.iter().map(|group| group + 1).collect();
    }
    Ok(study)
}

/// The place of the section, to be filled in. It stands last, since whatever follows it would belong to it.
fn marked_place(raw: &RawCampaign, dofs: &[Dof]) -> String {
    let density = raw.runs.first().map(|run| run.air_density_kg_m3);
    let density = density.unwrap_or(STANDARD_AIR_DENSITY_KG_M3);
    let translation = "{ mass_kg_m = ?, frequency_hz = ?, damping_ratio = ? }";
    let lateral = match dofs.contains(&Dof::Lateral) {
        true => format!("# lateral = {translation}\n"),
        false => String::new(),
    };
    format!(
        "\n# STATE THE SECTION HERE: a campaign does not know the structure that is to be built. Replace every `?`, remove the\n\
         # `# ` of the lines below; until then `aerodeck study` refuses this file. (`process --section FILE` does it at once.)\n\
         # [section]\n# width_m = {}\n# air_density_kg_m3 = {density}\n# vertical = {translation}\n{lateral}\
         # torsion = {{ inertia_kg_m2_m = ?, frequency_hz = ?, damping_ratio = ? }}\n",
        raw.rig.model_width_m
    )
}

/// The section of a TOML file, for instance of a study; whatever else stands in it is not looked at.
///
/// # Errors
/// [`Error::Io`] when it cannot be read; [`Error::Input`] with file and line when its `[section]` is none.
pub(crate) fn read_section(path: &Path) -> Result<SectionModel> {
    #[derive(Deserialize)]
    struct OnlySection {
        section: SectionModel,
    }
    toml_lines::read(path, |text, _| {
        let check = |file: &mut OnlySection| file.section.structure().map(drop);
        toml_lines::parse("a file with a [section]", text, check).map(|file| file.section)
    })
}

/// The path as it is written on every system.
fn slashes(path: &Path) -> PathBuf {
    path.iter()
        .map(|part| part.to_string_lossy())
        .collect::<Vec<_>>()
        .join("/")
        .into()
}
