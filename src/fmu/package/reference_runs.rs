//! `extra/org.fmi-standard.fmi-ls-ref/`: runs of the unit as its exporter meant it, which any importer can repeat. The layout is that of
//! the layered standard FMI-LS-REF; what is run is computed here, by the code that the binaries hold.

mod plan;
mod unit;

use crate::error::Result;
use crate::fmu::importer::{LS_REF, LS_REF_MANIFEST};
use crate::fmu::ssv::parameter_set;
use crate::fmu::vocabulary::{BOUNDS_FILE, Element, FmiVersion, OnsetBounds, Resources};
use plan::PARAMETERS;
use std::collections::BTreeMap;
use unit::ReferenceUnit;

/// Type of a file of experiments, and the name space of the attributes of a manifest.
const EXPERIMENTS: &str = "application/x-ma-hs-experiments";
const NAMESPACE: &str = "http://fmi-standard.org/fmi-ls-manifest";

type ArchiveFiles = BTreeMap<String, Vec<u8>>;

/// The files of a unit; `reals_only` where its description lists no other variables.
pub(super) fn files(
    resources: Resources,
    bounds: Option<&OnsetBounds>,
    reals_only: bool,
    version: FmiVersion,
) -> Result<ArchiveFiles> {
    let mut files = ArchiveFiles::new();
    let unit = ReferenceUnit::new(resources, reals_only, version)?;
    let mut entries = Vec::new();
    let mut put = |entry: [&str; 4], text: String| {
        files.insert(format!("{LS_REF}/{}", entry[0]), text.into_bytes());
        entries.push(related(entry));
    };
    put(
        [
            PARAMETERS,
            "parameter",
            "application/x-ssp-parameter-set",
            "Every parameter as it was exported",
        ],
        parameter_set("as_exported", &unit.parameters())?,
    );
    let of_run = [
        [
            "in",
            "other",
            "Inputs, set at the beginning of each step and held",
        ],
        ["out", "result", "Outputs at the end of each step"],
    ];
    for set in unit.sets(bounds)? {
        let mut experiments = Vec::new();
        for planned in &set.runs {
            let Some(texts) = unit.run(planned)? else {
                continue;
            };
            experiments.push(planned.element()?);
            for ([part, role, meaning], text) in of_run.into_iter().zip(texts) {
                put([&planned.file(part), role, "text/csv", meaning], text);
            }
        }
        if experiments.is_empty() {
            continue;
        }
        let root = Element::new("Experiments")
            .with("name", set.title)
            .with("description", set.meaning)
            .containing(experiments);
        let file = format!("{}.exp", set.name);
        put([&file, set.role, EXPERIMENTS, set.meaning], root.document());
    }
    put(
        [
            "replay.py",
            "other",
            "text/x-python",
            "Runs all experiments in FMPy: python replay.py unit.fmu",
        ],
        include_str!("replay.py").to_owned(),
    );
    entries.push(related([
        "../../resources/model.json",
        "model",
        "application/json",
        "Force model and section, and where they come from",
    ]));
    entries.push(related([
        "../../documentation/index.html",
        "document",
        "text/html",
        "What this unit is, and where it is valid",
    ]));
    if bounds.is_some() {
        entries.push(related([
            &format!("../../resources/{BOUNDS_FILE}"),
            "meta-data",
            "application/json",
            "95 % interval of the onset by the scatter of the data and the form of the model",
        ]));
    }
    files.insert(LS_REF_MANIFEST.to_owned(), manifest(entries).into_bytes());
    files.insert(
        "documentation/fmi-ls-ref.txt".to_owned(),
        include_str!("fmi-ls-ref.txt").into(),
    );
    Ok(files)
}

fn manifest(related: Vec<Element>) -> String {
    let description = "Layered Standard providing information on related files included in an FMU.";
    let standard = ["org.fmi-standard.fmi-ls-ref", "1.0.0-alpha.1", description];
    announced("fmiReferences", standard)
        .containing(related)
        .document()
}

/// The manifest of a layered standard: its name, version and description.
fn announced(root: &str, [name, version, description]: [&str; 3]) -> Element {
    Element::new(root)
        .with("xmlns:fmi-ls", NAMESPACE)
        .with("fmi-ls:fmi-ls-name", name)
        .with("fmi-ls:fmi-ls-version", version)
        .with("fmi-ls:fmi-ls-description", description)
}

/// Where an archive says that it holds a component for WebAssembly, by the draft FMI-LS-WASM.
pub(super) const WASM_MANIFEST: &str = "extra/org.modelica.fmi-ls-wasm/manifest.xml";

pub(super) fn wasm_manifest() -> String {
    let description = "FMI Layered Standard for WebAssembly";
    let standard = ["org.modelica.fmi-ls-wasm", "0.1.0", description];
    announced("fmiLayeredStandardManifest", standard).document()
}

/// An entry of the manifest.
fn related([source, role, kind, meaning]: [&str; 4]) -> Element {
    Element::new("Related")
        .with("type", kind)
        .with("source", source)
        .with("role", role)
        .with("description", meaning)
}

/// The manifest with a report of the study in which the unit was made.
pub(super) fn manifest_with_report(manifest: &str, report: &str) -> Result<String> {
    let mut root = Element::parse(manifest)?;
    let entry = [report, "report", "text/html", "Report of the study"];
    root.children.push(related(entry));
    Ok(root.document())
}
