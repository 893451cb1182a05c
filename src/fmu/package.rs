//! Packing a trained model as an FMU: the same model and binaries always give the same bytes.
//!
//! The archive holds the description, one runtime binary per platform, the model, a page that documents it, licences and
//! an icon. The runtime for the platform of this program is embedded in it; further ones come from a folder.

mod archive_file;
mod bridge_page;
mod documentation;
pub(in crate::fmu) mod label;
mod reference_runs;
mod runtime;
mod terminals;

pub use super::standard::FmiVersion;
use reference_runs::{WASM_MANIFEST, wasm_manifest};

pub(super) use archive_file::archive;
pub use archive_file::write_archive;
pub(crate) use archive_file::{description_of, with_report};
pub use label::Label;
pub use runtime::Runtime;
pub(crate) use runtime::{COMPONENT, live_module};

use super::description::model_description;
use super::description_fmi3;
use super::location::MODEL_FILE;
use super::vocabulary::{
    BOUNDS_FILE, BRIDGE_FILE, BridgeOptions, Element, FORCE_FILE, ForceOptions, GUST_FILE,
    OPTION_FILES, OnsetBounds, Resources, TURBULENCE_FILE, TurbulenceOptions,
};
use crate::aerodynamics::GustForce;
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, ensure};
use crate::flutter::{OnsetSearch, UnwantedGrowth, unwanted_growth};
use crate::trained_model::TrainedModel;
use crate::verdict::Verdict;
use std::collections::BTreeMap;
use std::path::Path;

/// Licence texts: file below `documentation/licenses/` and contents.
const LICENCES: [(&str, &str); 3] = [
    ("LICENSE-APACHE.txt", include_str!("../../LICENSE-APACHE")),
    ("LICENSE-MIT.txt", include_str!("../../LICENSE-MIT")),
    ("THIRD-PARTY.txt", include_str!("package/THIRD-PARTY.txt")),
];

const ICON: &[u8] = include_bytes!("package/model.png");

/// What is exported of a model: its section in its forces or, with options, its forces alone, or a whole bridge.
///
/// ```
/// use aerodeck::fmu::package::Export;
///
/// let export = Export { allow_unstable: true, ..Export::default() };
/// assert!(!export.without_reference_runs);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Export {
    /// Whether a model that grows below its onset is packed; its documentation and its log then say at which speeds it grows.
    pub allow_unstable: bool,
    /// Strips for a structure outside; `None` for the coupled section.
    pub force: Option<ForceOptions>,
    /// Forces of gusts, so that gusts are inputs.
    pub gusts: Option<GustForce>,
    /// A whole bridge, of whose first section the model is.
    pub bridge: Option<BridgeOptions>,
    /// Turbulence that blows on the bridge.
    pub turbulence: Option<TurbulenceOptions>,
    /// 95 % interval of the onset of the section, where it is known.
    pub bounds: Option<OnsetBounds>,
    /// Verdict on the section, or on the bridge whose forces they are, for the page that documents it; without, what the section's own
    /// searches say.
    pub verdict: Option<Verdict>,
    /// Whether its description lists real variables only.
    pub reals_only: bool,
    /// What it says of its origin.
    pub label: Label,
    /// Of the standard.
    pub version: FmiVersion,
    /// Whether it leaves out the runs by which an importer sees that it does what it should.
    pub without_reference_runs: bool,
}

/// Growth below the onset of the section of a model, by extrapolation alone; see `unwanted_growth`.
pub(crate) fn growth_of(model: &TrainedModel) -> Result<UnwantedGrowth> {
    let section = CoupledSection::with_model(&model.section.structure()?, &model.model)?;
    let search = OnsetSearch::up_to(model.experiment.onset_search_limit_m_s);
    unwanted_growth(&section, &search, Some(model.tested_range))
}

/// The FMU of a trained model as the bytes of its archive, with these runtimes in it.
///
/// # Errors
/// [`Error::Input`] for a model or a bridge that cannot be exported, for no runtime at all, and for two of one platform;
/// [`Error::Numerical`] for a model that grows where it should not, unless that is allowed. What a bridge does below its onset is for
/// the caller to judge.
pub fn package(model: &TrainedModel, runtimes: &[Runtime], export: Export) -> Result<Vec<u8>> {
    if export.reals_only && export.version == FmiVersion::Three {
        let place = "real variables only";
        return Err(Error::input(place, "FMI 2.0", "FMI 3.0"));
    }
    let of_section = export.force.is_some() || export.gusts.is_some() || export.bounds.is_some();
    let mixed = match export.bridge {
        Some(_) => of_section,
        None => export.turbulence.is_some(),
    };
    let expected = "a bridge with its turbulence, or a section or forces with gusts and interval";
    ensure(!mixed, "FMU", expected, "both")?;
    let further = export.force.iter().flat_map(|force| &force.further);
    for model in std::iter::once(model).chain(further.map(|f| &f.model)) {
        let growth = (!export.allow_unstable).then(|| growth_of(model));
        if let Some(growth) = growth.transpose()?.filter(|growth| !growth.is_none()) {
            let why = format!("{} is not exported: it {}", model.name, growth.explain());
            return Err(Error::Unstable(why));
        }
    }
    let expected = "a runtime for at least one platform";
    ensure(!runtimes.is_empty(), "FMU", expected, "none")?;
    let files = option_files(model, &export)?;
    let bytes = |name: &str| files.get(name).map(|text| text.as_bytes());
    let model = bytes(MODEL_FILE).unwrap_or_default();
    let resources = match bytes(BRIDGE_FILE) {
        Some(bridge) => Resources::of_bridge(model, bridge, bytes(TURBULENCE_FILE))?,
        None => Resources::from_bytes(model, OPTION_FILES.map(bytes))?,
    };
    assembled(resources, files, runtimes, &export)
}

/// The model and what is exported of it as the texts that the unit reads, by the names of their files.
fn option_files(model: &TrainedModel, export: &Export) -> Result<BTreeMap<&'static str, String>> {
    let failed = |e: serde_json::Error| Error::Numerical(e.to_string());
    let field = export.turbulence.as_ref().map(serde_json::to_string);
    let gusts = export.gusts.as_ref().map(serde_json::to_string_pretty);
    let bounds = export.bounds.as_ref().map(serde_json::to_string_pretty);
    let all = [
        (MODEL_FILE, Some(model.to_json())),
        (FORCE_FILE, export.force.as_ref().map(ForceOptions::to_json)),
        (
            BRIDGE_FILE,
            export.bridge.as_ref().map(BridgeOptions::to_json),
        ),
        (GUST_FILE, gusts.map(|text| text.map_err(failed))),
        (BOUNDS_FILE, bounds.map(|text| text.map_err(failed))),
        (TURBULENCE_FILE, field.map(|text| text.map_err(failed))),
    ];
    let all = all.into_iter();
    all.filter_map(|(name, text)| Some(text?.map(|text| (name, text))))
        .collect()
}

/// The archive of `resources` and of the files that they are read from.
fn assembled(
    resources: Resources,
    options: BTreeMap<&str, String>,
    runtimes: &[Runtime],
    export: &Export,
) -> Result<Vec<u8>> {
    let (reals_only, version) = (export.reals_only, export.version);
    let verdict = export.verdict.as_ref();
    let xml = match version {
        FmiVersion::Two => model_description(&resources, reals_only, &export.label),
        FmiVersion::Three => description_fmi3::model_description(&resources, &export.label),
    }?;
    let described = Element::parse(&xml)?;
    let page = match &resources.bridge {
        Some(bridge) => bridge_page::documentation(&resources, bridge, &described, verdict),
        None => documentation::documentation(&resources, runtimes, &described, verdict)?,
    };
    let mut files: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    files.insert("modelDescription.xml".into(), xml.into_bytes());
    let icon = match version {
        FmiVersion::Two => "model.png",
        FmiVersion::Three => "terminalsAndIcons/icon.png",
    };
    files.insert(icon.into(), ICON.to_vec());
    let (listed, _) = resources.table.listed(reals_only);
    let text = terminals::document(&listed, version);
    files.insert(terminals::FILE.into(), text.into_bytes());
    let options = options.into_iter();
    files.extend(options.map(|(name, text)| (format!("resources/{name}"), text.into_bytes())));
    files.insert("documentation/index.html".into(), page.into_bytes());
    let licences = "documentation/licenses";
    files.insert(
        format!("{licences}/license.txt"),
        licence(&resources).into_bytes(),
    );
    for (name, text) in LICENCES {
        files.insert(format!("{licences}/{name}"), text.into());
    }
    files.extend(binaries(runtimes, version)?);
    if !export.without_reference_runs {
        let bounds = export.bounds.as_ref();
        files.extend(reference_runs::files(
            resources, bounds, reals_only, version,
        )?);
    }
    archive(&files)
}

/// The runtimes in their places, with what announces one for WebAssembly.
fn binaries(runtimes: &[Runtime], version: FmiVersion) -> Result<BTreeMap<String, Vec<u8>>> {
    let mut files = BTreeMap::new();
    for runtime in runtimes {
        if runtime.is_component() {
            if version == FmiVersion::Two {
                let expected = "FMI 3.0 (`--fmi 3`): there are no components in FMI 2.0";
                return Err(Error::input("platform", expected, runtime.platform));
            }
            files.insert(WASM_MANIFEST.to_owned(), wasm_manifest().into_bytes());
        }
        let place = runtime.path_in_archive(version);
        if files.insert(place, runtime.bytes.to_vec()).is_some() {
            let found = format!("two for {}", runtime.platform);
            return Err(Error::input("FMU", "one runtime for each platform", found));
        }
    }
    Ok(files)
}

/// Packs the model and writes the archive: first beside its place, then moved there, so that no half a file is ever
/// seen.
///
/// ```
/// use aerodeck::fmu::package::{Export, Runtime, write_fmu};
/// use aerodeck::prelude::*;
/// use aerodeck::trained_model::{Experiment, Provenance, SCHEMA_VERSION};
///
/// let k = ReducedFrequency::from_full_width;
/// let model = TrainedModel {
///     schema_version: SCHEMA_VERSION,
///     name: "flat plate".into(),
///     section: SectionModel::iabse_1_1a(),
///     model: Model::Rational(RationalModel::jones_flat_plate()),
///     tested_range: ReducedFrequencyRange::between(k(0.02), k(10.0)),
///     provenance: Provenance {
///         source: "NACA Report 681".into(),
///         licence: "none needed: a formula".into(),
///         method: "Jones's approximation".into(),
///         aerodeck_version: env!("CARGO_PKG_VERSION").into(),
///         notes: Vec::new(),
///     },
///     experiment: Experiment {
///         wind_speed_m_s: 30.0,
///         initial_vertical_m: 0.1,
///         initial_rotation_rad: 0.0,
///         stop_time_s: 60.0,
///         step_size_s: 0.05,
///         onset_search_limit_m_s: 100.0,
///     },
/// };
/// let folder = tempfile::tempdir().map_err(|e| Error::io("temporary folder", e))?;
/// let fmu = folder.path().join("plate.fmu");
/// let runtimes = Runtime::available()?;
/// write_fmu(&fmu, &model, &runtimes, false, Export::default())?;
/// // a file that is there is not lost
/// assert!(write_fmu(&fmu, &model, &runtimes, false, Export::default()).is_err());
/// # Ok::<(), Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] for a model that cannot be exported, and when the file is there and is not to be replaced;
/// [`Error::Numerical`] for a model that grows where it should not; [`Error::Io`].
pub fn write_fmu(
    path: &Path,
    model: &TrainedModel,
    runtimes: &[Runtime],
    replace: bool,
    export: Export,
) -> Result<()> {
    write_archive(path, &package(model, runtimes, export)?, replace)
}

fn licence(resources: &Resources) -> String {
    let data = |model: &TrainedModel| {
        format!(
            "\nThe model in resources/ was made from data of this source:\n    {}\nunder this licence:\n    {}\n",
            model.provenance.source, model.provenance.licence
        )
    };
    let mut texts: Vec<String> = resources.models().map(data).collect();
    texts.dedup();
    format!(
        "The program in binaries/ is part of aerodeck and is licensed under MIT (LICENSE-MIT.txt) or Apache-2.0\n\
         (LICENSE-APACHE.txt), at your choice. It contains software of others: THIRD-PARTY.txt.\n{}",
        texts.concat()
    )
}

#[cfg(test)]
mod tests;
