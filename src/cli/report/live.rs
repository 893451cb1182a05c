//! What the sliders of a report start from.

use crate::error::Result;
use crate::fmu::package::live_module;
use crate::study::Study;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use serde_json::json;

/// The sliders for the exported model of a study: the request that is asked first, as `crate::live` takes it, and the module that
/// answers; `None` where there is no such model, or no module to ask.
pub(super) fn sliders(study: &Study, model: Option<Vec<u8>>) -> Result<Option<String>> {
    let (Some(model), Some(module)) = (model, live_module()?) else {
        return Ok(None);
    };
    let range = study.speeds();
    let sliders = json!({
        "module": BASE64_STANDARD.encode(module),
        "model": String::from_utf8_lossy(&model),
        "section": study.section,
        "speed_min_m_s": range.speed_min_m_s,
        "speed_max_m_s": range.speed_max_m_s,
        "speeds": range.speeds,
    });
    Ok(Some(sliders.to_string()))
}
