//! What is in the folder `resources/` of an unpacked archive.

use super::bridge_gusts::{TURBULENCE_FILE, TurbulenceOptions};
use super::bridge_options::{BRIDGE_FILE, BridgeOptions};
use super::force_options::{FORCE_FILE, ForceOptions, FurtherModel, StripsOfModel};
use super::gust_channels::GustChannels;
use super::identity;
use super::location::{MODEL_FILE, beside, folder_of, own_binary, raw_folder, refused};
use super::onset_bounds::{BOUNDS_FILE, OnsetBounds};
use super::standard::each_once;
use super::variables::VariableTable;
use crate::aerodynamics::{GustForce, Transfer};
use crate::error::{Error, Result, ensure};
use crate::response::Stepper;
use crate::trained_model::{Model, TrainedModel};
use std::io::ErrorKind;
use std::path::Path;
use uuid::Uuid;

/// The file of the gust forces in `resources/`; an archive without it takes no gusts.
pub const GUST_FILE: &str = "gusts.json";
/// Files beside the model that say what is exported of it: [`ForceOptions`], which make it a unit of forces alone, [`GustForce`],
/// [`OnsetBounds`].
pub const OPTION_FILES: [&str; 3] = [FORCE_FILE, GUST_FILE, BOUNDS_FILE];
/// Shortest step of a sampled model, in widths that the wind passes: a thousandth of the finest of wind tunnels.
const SHORTEST_SAMPLE: f64 = 1e-6;

/// What is read once, at instantiation.
#[derive(Debug)]
pub struct Resources {
    /// The trained model.
    pub model: TrainedModel,
    /// What makes it a unit of forces alone; `None` for the coupled section.
    pub force: Option<ForceOptions>,
    /// The same as exported, where an importer has chosen another number of strips.
    pub(crate) exported_force: Option<ForceOptions>,
    /// Forces of gusts; `None` where it takes no gusts.
    pub gusts: Option<GustForce>,
    /// What makes it a whole bridge; `None` for a section.
    pub bridge: Option<BridgeOptions>,
    /// What steps that bridge with the parameters of its export, and what gusts do to it.
    pub(crate) exported: Option<(Stepper, Option<GustChannels>)>,
    /// Turbulence that blows on the bridge; `None` for calm air but what the inputs bring.
    pub turbulence: Option<TurbulenceOptions>,
    /// Its variables.
    pub table: VariableTable,
    /// Identity of table and model file.
    pub guid: Uuid,
}

impl Resources {
    /// Reads `model.json` from the folder that `location` names (see `folder_of`); where it is not there, from the
    /// folder whose name is the location as it stands, since some importers write paths without coding them. An empty
    /// location means the archive in which this library lies.
    ///
    /// # Errors
    /// [`Error::Input`] for a location that is none and for a file that is no trained model, [`Error::Io`] for a file
    /// that cannot be read; both name the file.
    pub fn read(location: &str) -> Result<Self> {
        let folder = if location.is_empty() {
            own_binary()
                .and_then(|binary| beside(&binary))
                .ok_or_else(|| refused(location))?
        } else {
            folder_of(location)?
        };
        let raw = raw_folder(location).filter(|raw| raw.join(MODEL_FILE).exists());
        let folder = match raw {
            Some(raw) if !folder.join(MODEL_FILE).exists() => raw,
            _ => folder,
        };
        Self::from_files(&folder, &|file| match std::fs::read(file) {
            Err(e) if e.kind() == ErrorKind::NotFound && !file.ends_with(MODEL_FILE) => Ok(None),
            read => read.map(Some).map_err(|e| Error::io(file, e)),
        })
    }

    /// The same where the importer reads the files of the folder: their bytes, or none for what is not there.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn from_files(
        folder: &Path,
        read: &dyn Fn(&Path) -> Result<Option<Vec<u8>>>,
    ) -> Result<Self> {
        let beside = |name: &str| read(&folder.join(name));
        let file = folder.join(MODEL_FILE);
        let model = read(&file)?
            .ok_or_else(|| Error::input("resources", MODEL_FILE, "none").in_file(folder))?;
        if let Some(bridge) = beside(BRIDGE_FILE)? {
            let turbulence = beside(TURBULENCE_FILE)?;
            return Self::of_bridge(&model, &bridge, turbulence.as_deref())
                .map_err(|e| e.in_file(folder.join(BRIDGE_FILE)));
        }
        let [force, gusts, bounds] = OPTION_FILES.map(beside);
        let options = [force?, gusts?, bounds?];
        let options = options.each_ref().map(Option::as_deref);
        Self::from_bytes(&model, options).map_err(|e| e.in_file(&file))
    }

    /// The same from the bytes of the model's file and of the [`OPTION_FILES`] beside it.
    ///
    /// # Errors
    /// [`Error::Input`] for bytes that are no trained model, or no options that fit it.
    pub fn from_bytes(bytes: &[u8], options: [Option<&[u8]>; 3]) -> Result<Self> {
        let [force, gusts, bounds] = options;
        let model = TrainedModel::from_json(text(bytes)?)?;
        check_sampling(&model)?;
        let force = beside_model(FORCE_FILE, force, ForceOptions::from_json)?;
        let gusts = beside_model(GUST_FILE, gusts, |text| gust_force(text, &model))?;
        for further in force.iter().flat_map(|f| &f.further) {
            check_further(further, gusts.is_some()).map_err(|e| e.within(FORCE_FILE))?;
        }
        let bounds = beside_model(BOUNDS_FILE, bounds, OnsetBounds::from_json)?;
        let table = VariableTable::new(&model, force.as_ref(), gusts.as_ref(), bounds)?;
        let files = std::iter::once(bytes);
        let files: Vec<&[u8]> = files.chain(options.into_iter().flatten()).collect();
        let guid = identity::guid(&table, &files);
        Ok(Self {
            force,
            gusts,
            ..Self::of_section(model, table, guid)
        })
    }

    /// Of a coupled section without gusts.
    fn of_section(model: TrainedModel, table: VariableTable, guid: Uuid) -> Self {
        Self {
            model,
            force: None,
            exported_force: None,
            gusts: None,
            bridge: None,
            exported: None,
            turbulence: None,
            table,
            guid,
        }
    }

    /// The trained model, and those of further strips.
    pub fn models(&self) -> impl Iterator<Item = &TrainedModel> {
        let further = self.force.iter().flat_map(|force| &force.further);
        std::iter::once(&self.model).chain(further.map(|f| &f.model))
    }

    /// What its models are, or what is said of them, each once.
    pub fn words(&self, of: fn(&TrainedModel) -> &str) -> String {
        each_once(self.models().map(of))
    }

    /// The strips of each model of a unit of forces; none of other units.
    pub fn parts(&self) -> Vec<StripsOfModel<'_>> {
        let force = self.force.iter();
        let parts = force.flat_map(|f| f.parts(&self.model, self.gusts.as_ref()));
        parts.collect()
    }

    /// The same forces on another number of strips, or on those of the export; those beyond them are like the last.
    ///
    /// # Errors
    /// [`Error::Input`] for what has no strips to count, and for too many.
    pub(crate) fn with_strips(&self, strips: Option<usize>) -> Result<Self> {
        let exported = self.exported_force.as_ref().or(self.force.as_ref());
        let exported = exported.filter(|force| force.nodes.is_empty() && force.named_strips);
        let exported =
            exported.ok_or_else(|| Error::input("strips", "a unit of strips", "none"))?;
        let mut force = exported.clone();
        let last = force.strips[force.strips.len() - 1].clone();
        force
            .strips
            .resize(strips.unwrap_or(force.strips.len()), last);
        force.validate()?;
        let table = VariableTable::new(&self.model, Some(&force), self.gusts.as_ref(), None)?;
        Ok(Self {
            exported_force: (force != *exported).then(|| exported.clone()),
            force: Some(force),
            gusts: self.gusts.clone(),
            ..Self::of_section(self.model.clone(), table, self.guid)
        })
    }

    /// A whole bridge from the bytes of the file of the model of its girder, of the bridge's own, and of its turbulence.
    ///
    /// # Errors
    /// [`Error::Input`] for bytes that are no trained model, or no bridge.
    pub fn of_bridge(bytes: &[u8], bridge: &[u8], turbulence: Option<&[u8]>) -> Result<Self> {
        let model = TrainedModel::from_json(text(bytes)?)?;
        let options = BridgeOptions::from_json(text(bridge)?)?;
        let field = |json| {
            let (nodes, gusts) = (options.nodes.len(), options.gusts.as_ref());
            TurbulenceOptions::from_json(text(json)?, nodes, gusts)
                .map_err(|e| e.at(TURBULENCE_FILE))
        };
        let field = turbulence.map(field).transpose()?;
        let exported = options.stepper(&options.bridge()?)?;
        let table = VariableTable::of_bridge(&model, &options, &exported.0, field.is_some())?;
        let files: Vec<&[u8]> = [bytes, bridge].into_iter().chain(turbulence).collect();
        let guid = identity::guid(&table, &files);
        Ok(Self {
            bridge: Some(options),
            exported: Some(exported),
            turbulence: field,
            ..Self::of_section(model, table, guid)
        })
    }
}

/// A model that samples the motion so often is none that can be stepped: its step is cut into more samples than a step may
/// have, and its eigenvalues are rounding.
fn check_sampling(model: &TrainedModel) -> Result<()> {
    let Model::DiscreteLaguerre(m) = &model.model else {
        return Ok(());
    };
    ensure(
        m.delta_s >= SHORTEST_SAMPLE,
        "model: delta_s",
        format_args!("at least {SHORTEST_SAMPLE} widths from sample to sample in an FMU"),
        m.delta_s,
    )
}

/// A further model is one that can be stepped, and its strips feel gusts where the others do.
fn check_further(further: &FurtherModel, gusts: bool) -> Result<()> {
    check_sampling(&further.model)?;
    let dofs = further.model.model.dofs();
    match &further.gusts {
        Some(force) if gusts => force.validate(dofs),
        None if !gusts => Ok(()),
        _ => {
            let place = format!("gusts on {}", further.model.name);
            Err(Error::input(
                place,
                "forces of gusts on the strips of all models, or of none",
                "some",
            ))
        }
    }
}

/// What stands in a file beside the model, where it is there.
fn beside_model<T>(
    file: &str,
    bytes: Option<&[u8]>,
    read: impl Fn(&str) -> Result<T>,
) -> Result<Option<T>> {
    let text = bytes.map(text).transpose()?;
    text.map(|text| read(text).map_err(|e| e.within(file)))
        .transpose()
}

fn gust_force(text: &str, model: &TrainedModel) -> Result<GustForce> {
    let force: GustForce =
        serde_json::from_str(text).map_err(|e| Error::json("forces of gusts", &e))?;
    force.validate(model.model.dofs())?;
    Ok(force)
}

fn text(bytes: &[u8]) -> Result<&str> {
    std::str::from_utf8(bytes).map_err(|e| {
        Error::input(
            format!("byte {}", e.valid_up_to()),
            "UTF-8 text",
            "other bytes",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::location::location_of;

    /// Of a file that was changed by hand the key is named.
    #[test]
    fn wrong_options_of_forces_are_named() {
        let model = format!(
            "{}/../../tests/data/models/rational.json",
            env!("CARGO_MANIFEST_DIR")
        );
        let model = std::fs::read(model).unwrap();
        let options = ForceOptions::single(31.0).to_json().unwrap();
        let options = options.replacen("31.0", "-1.0", 1);
        let files = [Some(options.as_bytes()), None, None];
        let said = Resources::from_bytes(&model, files)
            .err()
            .map(|e| e.to_string());
        let expected = "force.json, strip 1: width: expected a positive number, found -1";
        assert_eq!(said.as_deref(), Some(expected));
    }

    /// `%20` may be coded, or part of the folder's name.
    #[test]
    fn uncoded_locations_are_tried_second() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("a%20b");
        std::fs::create_dir(&place).unwrap();
        let model = format!(
            "{}/../../tests/data/models/rational.json",
            env!("CARGO_MANIFEST_DIR")
        );
        std::fs::copy(&model, place.join(MODEL_FILE)).unwrap();
        let coded = location_of(&place).unwrap();
        let raw = format!("file://{}", place.display());
        assert_ne!(coded, raw);
        for location in [coded, raw] {
            assert!(Resources::read(&location).is_ok(), "{location}");
        }
    }
}
