//! `extra/org.fmi-standard.fmi-ls-ref/`: runs of the unit as its exporter meant it, which any importer can repeat. The layout is that of
//! the layered standard FMI-LS-REF; what is run is computed here, by the code that the binaries hold.

mod plan;
mod unit;

use crate::error::Result;
use crate::fmu::importer::{LS_REF, LS_REF_MANIFEST};
use crate::fmu::onset_bounds::{BOUNDS_FILE, OnsetBounds};
use crate::fmu::resources::Resources;
use crate::fmu::ssv::parameter_set;
use crate::fmu::standard::FmiVersion;
use crate::fmu::variables::Listing;
use crate::fmu::xml::Element;
use plan::PARAMETERS;
use std::collections::BTreeMap;
use unit::ReferenceUnit;

/// Type of a file of experiments, and the name space of the attributes of a manifest.
const EXPERIMENTS: &str = "application/x-ma-hs-experiments";
const NAMESPACE: &str = "http://fmi-standard.org/fmi-ls-manifest";

type ArchiveFiles = BTreeMap<String, Vec<u8>>;

/// The files of a unit; `listed` says which variables its description lists.
pub(super) fn files(
    resources: Resources,
    bounds: Option<OnsetBounds>,
    listing: Listing,
    version: FmiVersion,
) -> Result<ArchiveFiles> {
    let mut files = ArchiveFiles::new();
    let unit = ReferenceUnit::new(resources, listing, version)?;
    let mut related = Vec::new();
    let mut put = |files: &mut ArchiveFiles, entry: RelatedFile<'_>, text: String| {
        files.insert(format!("{LS_REF}/{}", entry.source), text.into_bytes());
        related.push(entry.element());
    };
    let parameters = parameter_set("as_exported", &unit.parameters())?;
    let entry = RelatedFile::new(PARAMETERS, "parameter", "application/x-ssp-parameter-set");
    put(
        &mut files,
        entry.saying("Every parameter as it was exported"),
        parameters,
    );
    for set in unit.sets(bounds.as_ref())? {
        let mut experiments = Vec::new();
        for planned in &set.runs {
            let Some(run) = unit.run(planned)? else {
                continue;
            };
            experiments.push(planned.element()?);
            let entry = RelatedFile::new(&planned.file("in"), "other", "text/csv");
            put(
                &mut files,
                entry.saying("Inputs, set at the beginning of each step and held"),
                run.inputs,
            );
            let entry = RelatedFile::new(&planned.file("out"), "result", "text/csv");
            put(
                &mut files,
                entry.saying("Outputs at the end of each step"),
                run.outputs,
            );
        }
        if experiments.is_empty() {
            continue;
        }
        let root = Element::new("Experiments")
            .with("name", set.title)
            .with("description", set.meaning)
            .containing(experiments);
        let entry = RelatedFile::new(&format!("{}.exp", set.name), set.role, EXPERIMENTS);
        put(&mut files, entry.saying(set.meaning), root.document());
    }
    let entry = RelatedFile::new("replay.py", "other", "text/x-python");
    let entry = entry.saying("Runs all experiments in FMPy: python replay.py unit.fmu");
    put(&mut files, entry, include_str!("replay.py").to_owned());
    for (source, role, kind, meaning) in [
        (
            "../../resources/model.json",
            "model",
            "application/json",
            "Force model and section, and where they come from",
        ),
        (
            "../../documentation/index.html",
            "document",
            "text/html",
            "What this unit is, and where it is valid",
        ),
    ] {
        related.push(
            RelatedFile::new(source, role, kind)
                .saying(meaning)
                .element(),
        );
    }
    if bounds.is_some() {
        let source = format!("../../resources/{}", BOUNDS_FILE);
        let entry = RelatedFile::new(&source, "meta-data", "application/json");
        related.push(
            entry
                .saying("95 % interval of the onset by the scatter of the data")
                .element(),
        );
    }
    files.insert(LS_REF_MANIFEST.to_owned(), manifest(related).into_bytes());
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
struct RelatedFile<'a> {
    source: String,
    role: &'a str,
    kind: &'a str,
    meaning: &'a str,
}

impl<'a> RelatedFile<'a> {
    fn new(source: &str, role: &'a str, kind: &'a str) -> Self {
        let source = source.to_owned();
        Self {
            source,
            role,
            kind,
            meaning: "",
        }
    }

    fn saying(self, meaning: &'a str) -> Self {
        Self { meaning, ..self }
    }

    fn element(&self) -> Element {
        Element::new("Related")
            .with("type", self.kind)
            .with("source", &self.source)
            .with("role", self.role)
            .with("description", self.meaning)
    }
}

/// The manifest with a report of the study in which the unit was made.
pub(super) fn manifest_with_report(manifest: &str, report: &str) -> Result<String> {
    let mut root = Element::parse(manifest)?;
    let entry = RelatedFile::new(report, "report", "text/html");
    root.children
        .push(entry.saying("Report of the study").element());
    Ok(root.document())
}
