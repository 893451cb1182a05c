//! The page that documents the FMU of a bridge, in its archive.

use super::documentation::{GUSTS_ARE_INPUTS, gust_words, rows, sentences};
use crate::fmu::vocabulary::{BridgeOptions, Element, Resources, Role, Variable};
use crate::verdict::Verdict;

/// The page.
pub(super) fn documentation(
    resources: &Resources,
    bridge: &BridgeOptions,
    description: &Element,
    verdict: Option<&Verdict>,
) -> String {
    let model = &resources.model;
    if bridge.structure_alone {
        return structure(resources, bridge, description, verdict);
    }
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{name}</title></head><body>\n\
         <h1>{name}</h1>\n<p>A whole bridge under self-excited wind forces: {modes} modes, {nodes} nodes, {groups} groups of \
         strips. Vertical displacement and force are positive up, lateral positive downwind, rotation and moment positive \
         nose-up (windward edge up). The wind is normal to the span; the speed at a strip is its wind factor times \
         <code>wind_speed</code>.</p>\n<p>Forces: {kind}. Data: {source}. Licence: {licence}.</p>\n\
         <p>At constant wind a communication step of any size is exact for forces that are held{straight}; where \
         the wind changes the motion follows its Taylor series. The mode coordinates are those of the shapes as they were \
         given.</p>\n{gusts}<h2>Stability</h2>\n{stability}\
         ",
        name = escaped(&bridge.name),
        modes = bridge.modes.len(),
        nodes = bridge.nodes.len(),
        groups = bridge.groups.len(),
        kind = model.model.kind(),
        source = escaped(&model.provenance.source),
        licence = escaped(&model.provenance.licence),
        straight = straight_lines(description),
        gusts = gusts(resources, bridge),
        stability = stability(verdict),
    );
    page.push_str(&variables(resources, description));
    page.push_str("</body></html>\n");
    page
}

/// The page of a structure alone.
fn structure(
    resources: &Resources,
    bridge: &BridgeOptions,
    description: &Element,
    verdict: Option<&Verdict>,
) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{name}: structure</title></head><body>\n\
         <h1>{name}: structure</h1>\n<p>The structure of a bridge without its wind forces: {modes} modes, {nodes} nodes. Vertical \
         displacement and force are positive up, lateral positive downwind, rotation and moment positive nose-up (windward \
         edge up). Forces at nodes go in, the motion of the nodes comes out.</p>\n\
         <p>A communication step of any size is exact for forces that are held{straight}. The mode coordinates are \
         those of the shapes as they were given.</p>\n<h2>Stability of the whole bridge, with its wind forces</h2>\n{stability}{rows}</body></html>\n",
        name = escaped(&bridge.name),
        modes = bridge.modes.len(),
        nodes = bridge.nodes.len(),
        straight = straight_lines(description),
        stability = stability(verdict),
        rows = variables(resources, description),
    )
}

/// What is said of gusts, where any act.
fn gusts(resources: &Resources, bridge: &BridgeOptions) -> String {
    let Some(gusts) = &bridge.gusts else {
        return String::new();
    };
    let field = "A field of turbulence that lies in the archive blows on it";
    let what = match (&resources.turbulence, gusts.strips.is_empty()) {
        (None, _) => GUSTS_ARE_INPUTS.to_owned(),
        (Some(_), true) => field.to_owned(),
        (Some(_), false) => format!("{GUSTS_ARE_INPUTS}. {field}"),
    };
    let words = gust_words(&what, &gusts.source, gusts.admittance);
    format!("<p>{}</p>\n", escaped(&words))
}

/// FMI 3.0 has no derivatives of inputs.
fn straight_lines(description: &Element) -> &'static str {
    match description.attribute("fmiVersion") {
        Some("3.0") => "",
        _ => " or run on straight lines",
    }
}

/// A row of the table for each variable.
fn variables(resources: &Resources, description: &Element) -> String {
    let mut page = String::from(
        "<h2>Variables</h2>\n<table>\n<tr><th>name</th><th>type</th><th>unit</th><th>meaning</th></tr>\n",
    );
    // those of further modes differ by their number
    let further = |v: &Variable| {
        matches!(
            v.role,
            Role::Mode(1.., _) | Role::InitialMode(1..) | Role::Damper(1.., _)
        )
    };
    for row in rows(description, &resources.table, further) {
        let (name, meaning) = (escaped(row.name), escaped(row.description));
        let cells = [format!("<code>{name}</code>"), row.kind, row.unit, meaning];
        page += &format!("<tr><td>{}</td></tr>\n", cells.join("</td><td>"));
    }
    page + "</table>\n"
}

/// The verdict on the bridge as it was exported.
fn stability(verdict: Option<&Verdict>) -> String {
    let all = match verdict {
        Some(verdict) => sentences(verdict, None),
        None => vec!["Nothing was judged when this bridge was exported.".to_owned()],
    };
    let all = all.iter().map(|s| format!("<p>{}</p>\n", escaped(s)));
    all.collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
