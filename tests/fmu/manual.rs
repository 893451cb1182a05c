//! The page of the manual that lists every variable is made from the tables of variables.

use crate::bridges::{TWO, langenuen_text, read};
use crate::dampers::BLOCKS;
use crate::matrix_fmus::plate_gusts;
use crate::three_dof;
use aerodeck::fmu::force_options::ForceOptions;
use aerodeck::fmu::onset_bounds::OnsetBounds;
use aerodeck::fmu::resources::Resources;
use aerodeck::fmu::standard::FmiTerm;
use aerodeck::fmu::variables::{Variable, VariableTable};
use aerodeck::identification::Form;
use aerodeck::study::bridge::BridgeExportOptions;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

const UPDATE: &str = "AERODECK_UPDATE";

/// `strip[3].heave` as `strip[i].heave`: all strips, nodes, modes and filters have the same variables.
fn numbered(name: &str) -> String {
    let mut parts = name.split('[');
    let mut all = parts.next().unwrap().to_owned();
    for part in parts {
        let (number, rest) = part.split_once(']').unwrap();
        let is_number = number.bytes().all(|b| b.is_ascii_digit());
        let inside = if is_number { "i" } else { number };
        write!(all, "[{inside}]{rest}").unwrap();
    }
    all
}

fn table(title: &str, note: &str, variables: &[Variable]) -> String {
    let mut text = format!("## {title}\n\n{note}\n\n");
    text.push_str("| name | causality | variability | unit | what |\n|---|---|---|---|---|\n");
    let mut seen = BTreeSet::new();
    for v in variables {
        let name = numbered(&v.name);
        if !seen.insert(name.clone()) {
            continue;
        }
        let (causality, variability) = (v.causality.word(), v.variability.word());
        let unit = match v.value.type_name() {
            "Real" => v.unit.map_or("–", |u| u.name),
            other => other,
        };
        // of the first of many nodes
        let description = v.description.split(", at node ").next().unwrap();
        let row = format!("| `{name}` | {causality} | {variability} | {unit} | {description} |");
        writeln!(text, "{row}").unwrap();
    }
    text
}

fn tables() -> String {
    let mut model = three_dof::trained(Form::default(), 1.4);
    let gusts = plate_gusts(&model);
    let bounds = OnsetBounds {
        low_m_s: 30.0,
        high_m_s: 40.0,
        undetermined: None,
    };
    model.section.axis_offset_m = Some(0.01);
    model.section.mass_offset_m = Some(0.01);
    let section = VariableTable::new(&model, None, Some(&gusts), Some(bounds)).unwrap();
    let mut options = ForceOptions::single(model.section.width_m);
    options.named_strips = true;
    let force = VariableTable::new(&model, Some(&options), Some(&gusts), None).unwrap();
    let text = langenuen_text("LN21-5200", TWO, "modified_akima");
    let study = read(&(text + BLOCKS));
    let (model, export) = study.export(&BridgeExportOptions::default()).unwrap();
    let (model, bridge) = (model.to_json(), export.bridge.unwrap().to_json());
    let bridge = Resources::of_bridge(model.unwrap().as_bytes(), bridge.unwrap().as_bytes(), None);
    [
        table(
            "A coupled section",
            "Of three degrees of freedom and a continuous model; one of two has nothing of the sway. Gusts are there with `--gusts`, ends of the \
             interval where it is known, offsets where the section states some.",
            section.variables(),
        ),
        table(
            "Forces alone",
            "Of strips that have names; a single strip may go without (`heave`), and at the nodes of a bridge it is `node[…]`. Gusts are there with `--gusts`.",
            force.variables(),
        ),
        table(
            "A whole bridge",
            "The suspension bridge of the demo with dampers, its nodes named by their numbers.",
            bridge.unwrap().table.variables(),
        ),
    ]
    .join("\n")
}

/// `AERODECK_UPDATE=1 cargo test --test fmu manual` writes the page.
#[test]
fn the_manual_lists_every_variable() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/variables.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (head, listed) = page.split_once("\n## ").unwrap();
    let tables = tables();
    if std::env::var_os(UPDATE).is_some() {
        std::fs::write(&path, format!("{head}\n{tables}")).unwrap();
        return;
    }
    assert_eq!(
        format!("## {listed}"),
        tables,
        "{UPDATE}=1 cargo test --test fmu manual"
    );
}
