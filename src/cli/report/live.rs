//! What the sliders of a report start from.

use crate::error::{Error, Result};
use crate::fmu::package::live_module;
use crate::section::SectionModel;
use crate::study::Study;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;

/// The request that is asked first, as `crate::live` takes it, and the module that answers.
#[derive(Serialize)]
struct Sliders<'a> {
    module: String,
    model: String,
    section: &'a SectionModel,
    speed_min_m_s: f64,
    speed_max_m_s: f64,
    speeds: usize,
}

/// The sliders for the exported model of a study; `None` where there is no such model, or no module to ask.
pub(super) fn sliders(study: &Study, model: Option<Vec<u8>>) -> Result<Option<String>> {
    let (Some(model), Some(module)) = (model, live_module()?) else {
        return Ok(None);
    };
    let range = study.speeds();
    let sliders = Sliders {
        module: BASE64_STANDARD.encode(module),
        model: String::from_utf8_lossy(&model).into_owned(),
        section: &study.section,
        speed_min_m_s: range.speed_min_m_s,
        speed_max_m_s: range.speed_max_m_s,
        speeds: range.speeds,
    };
    let json = serde_json::to_string(&sliders);
    json.map(Some)
        .map_err(|e| Error::Numerical(format!("report: {e}")))
}
