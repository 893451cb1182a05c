//! The study that goes with the records of a processed campaign.

use super::{DeckSource, FlutterBlock, Study};
use crate::aerodynamics::derivatives::Interpolation;
use crate::aerodynamics::derivatives::notation::StatedConvention;
use crate::error::{Error, Result};
use crate::files::toml_lines;
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
    dofs: &[Dof],
) -> Result<String> {
    let mut study = match base {
        Some(study) => study.clone(),
        None => Study {
            // the range follows the section
            flutter: FlutterBlock::default(),
            ..Study::from_toml(super::demo_study_text(), PathBuf::new())?
        },
    };
    study.name.clone_from(&raw.section);
    study.deck = DeckSource {
        convention: StatedConvention::default(),
        interpolation: Interpolation::default(),
        width_m: None,
        angle_deg: None,
        missing: None,
        source: table.to_owned(),
        speed_groups: None,
        records: records.iter().map(|p| slashes(p)).collect(),
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
    let marked = if known {
        String::new()
    } else {
        marked_place(raw, dofs)
    };
    Ok(format!("{HEAD}{text}{marked}"))
}

/// The place of the section, to be filled in. It stands last, since whatever follows it would belong to it.
fn marked_place(raw: &RawCampaign, dofs: &[Dof]) -> String {
    let density = raw.runs.first().map(|run| run.air_density_kg_m3);
    let density = density.unwrap_or(STANDARD_AIR_DENSITY_KG_M3);
    let translation = "{ mass_kg_m = ?, frequency_hz = ?, damping_ratio = ? }";
    let lateral = if dofs.contains(&Dof::Lateral) {
        format!("# lateral = {translation}\n")
    } else {
        String::new()
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
