//! The study that goes with the records of a processed campaign.

use super::{DeckSource, Study};
use crate::aerodynamics::derivatives::notation::StatedConvention;
use crate::error::{Error, Result};
use crate::section::{Dof, SectionModel, Translation};
use crate::wind_tunnel::RawCampaign;
use std::path::{Path, PathBuf};

const HEAD: &str =
    "# Records and derivatives of a processed campaign; run `aerodeck study study.toml`.\n";
const PLACEHOLDER: &str = "# The section is that of Table 4.1 of the thesis, with the width of the model and the air of the first run:\n# put the one that is to be built in its place.\n";

/// Text of a study of `records` and `table` (paths from the folder of the study): section, models and search of `base`, or the
/// section of Table 4.1 with the default models.
///
/// # Errors
/// [`Error::Numerical`] when the study cannot be written.
pub fn processed_study_text(
    raw: &RawCampaign,
    base: Option<&Study>,
    table: &str,
    records: &[PathBuf],
    dofs: &[Dof],
) -> Result<String> {
    let mut study = match base {
        Some(study) => study.clone(),
        None => Study {
            section: placeholder(raw, dofs),
            ..Study::from_toml(super::demo_study_text(), PathBuf::new())?
        },
    };
    study.name.clone_from(&raw.section);
    study.deck = DeckSource {
        convention: StatedConvention::default(),
        source: table.to_owned(),
        speed_groups: None,
        records: records.iter().map(|p| slashes(p)).collect(),
    };
    let text = toml::to_string(&study).map_err(|e| Error::Numerical(e.to_string()))?;
    let note = if base.is_some() { "" } else { PLACEHOLDER };
    Ok(format!("{HEAD}{note}{text}"))
}

/// Table 4.1 with the width of the model; sway, which the thesis does not give, with the mass and damping of heave and a
/// quarter of its frequency.
fn placeholder(raw: &RawCampaign, dofs: &[Dof]) -> SectionModel {
    let mut section = SectionModel::table_4_1();
    section.width_m = raw.rig.model_width_m;
    if let Some(run) = raw.runs.first() {
        section.air_density_kg_m3 = run.air_density_kg_m3;
    }
    if dofs.contains(&Dof::Lateral) {
        section.lateral = Some(Translation {
            frequency_hz: section.vertical.frequency_hz.map(|f| 0.25 * f),
            ..section.vertical.clone()
        });
    }
    section
}

/// The path as it is written on every system.
fn slashes(path: &Path) -> PathBuf {
    path.iter()
        .map(|part| part.to_string_lossy())
        .collect::<Vec<_>>()
        .join("/")
        .into()
}
