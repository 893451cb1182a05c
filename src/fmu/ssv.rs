//! Sets of parameters: SSV of System Structure and Parameterization 1.0.

use super::description::number;
use super::vocabulary::Element;
use crate::error::Result;

const VALUES: &str = "http://ssp-standard.org/SSP1/SystemStructureParameterValues";
/// Version of the standard.
pub(super) const VERSION: &str = "1.0";

/// Start values of that name as an SSV file.
pub(super) fn parameter_set(of: &str, values: &[(String, f64)]) -> Result<String> {
    let mut all = Vec::new();
    for (name, value) in values {
        let value = Element::new("ssv:Real").with("value", number(*value)?);
        let parameter = Element::new("ssv:Parameter").with("name", name);
        all.push(parameter.containing([value]));
    }
    let root = Element::new("ssv:ParameterSet")
        .with("xmlns:ssv", VALUES)
        .with("version", VERSION)
        .with("name", of)
        .containing([Element::new("ssv:Parameters").containing(all)]);
    Ok(root.document())
}
