//! The self-excited forces of one section of a bridge file.

use super::super::{KnownUncertainty, uncertainty_beside};
use crate::aerodynamics::derivatives::{DerivativeTable, Extrapolation, InterpolatedTable};
use crate::aerodynamics::quasi_steady::LinearQuasiSteady;
use crate::aerodynamics::{FlatPlate, RationalModel, Transfer};
use crate::error::{Error, Result, ensure};
use crate::files::bridge::{BridgeSectionBlock, StaticBlock};
use crate::files::derivatives::{named_table_in, state_angle};
use crate::identification::{Form, FrequencyFit};
use crate::plausibility::{Finding, of_model, of_table};
use crate::section::Dof;
use crate::trained_model::{Model, TrainedModel};
use crate::uncertainty::{DerivativeInterval, FormEnsemble, ModelOfData, ModelUncertainty};
use crate::units::ReducedFrequencyRange;
use std::path::Path;
use std::sync::Arc;

/// The word for Theodorsen's plate instead of a table.
const FLAT_PLATE: &str = "flat plate";

/// Forces of a section, by table and by model.
#[derive(Debug, Clone)]
pub struct SectionForceModels {
    /// Between the points of the table, or the flat plate, exactly.
    pub table: Option<Arc<dyn Transfer>>,
    /// With a realisation.
    pub model: Arc<dyn Transfer>,
    /// What it is saved as.
    pub saved: Model,
    /// How the model was made, in words.
    pub method: String,
    /// Where the data come from.
    pub source: String,
    /// Licence of the data.
    pub licence: String,
    /// Reduced frequencies of the tests, of the section.
    pub tested: Option<ReducedFrequencyRange>,
    /// Mean angle of the section in the tests, deg, nose-up positive; `None` where it is not stated.
    pub angle_deg: Option<f64>,
    /// Largest amplitude of rotation in the tests, deg; `None` where it is not stated.
    pub rotation_amplitude_deg: Option<f64>,
    /// What a user should know of the fit.
    pub notes: Vec<String>,
    /// What the data alone would give where constraints hold the fit; `None` where none do, or a model was read from a file.
    pub unconstrained: Option<Arc<dyn Transfer>>,
    /// How far the data leave the model open, or why that is not known; `None` for stated coefficients.
    pub uncertainty: std::result::Result<Option<Box<ModelUncertainty>>, String>,
}

impl SectionForceModels {
    pub(super) fn new(
        block: &BridgeSectionBlock,
        trained: Option<(TrainedModel, KnownUncertainty)>,
        directory: &Path,
        findings: &mut Vec<Finding>,
    ) -> Result<Self> {
        let trained = match (&block.model, trained) {
            (_, Some(trained)) => Some(trained),
            (Some(path), None) => {
                let path = directory.join(path);
                let model = TrainedModel::read(&path)?;
                let known = uncertainty_beside(&path, &model)?;
                Some((model, known))
            }
            (None, None) => None,
        };
        let plate = |name: &&String| name.eq_ignore_ascii_case(FLAT_PLATE);
        if block.derivatives.as_ref().filter(plate).is_some() && trained.is_none() {
            return Self::flat_plate(block);
        }
        if let (Some((model, _)), None) = (&trained, &block.derivatives) {
            let odd = of_model(&model.name, &model.model, model.tested_range, &[]);
            findings.extend(odd.into_iter().map(|f| of_block(block, f)));
        }
        let read = |name: &String| checked_table(block, name, directory, findings);
        let table = block.derivatives.as_ref().map(read).transpose()?;
        let (by, motions) = (block.interpolation, &block.motions);
        let between =
            |table| InterpolatedTable::by(by, table, motions, Extrapolation::Hold).map(Arc::new);
        let between = table.as_ref().map(between).transpose()?;
        let forces = match (trained, table.as_ref().zip(between.as_ref())) {
            (Some((trained, known)), _) => Self::trained(trained, known),
            (None, Some((table, between))) => Self::fitted(block, table, between.tested_range())?,
            (None, None) => {
                let statics = block.statics.as_ref();
                let place = format!("section {}", block.name);
                let expected = "one of `derivatives`, `model`, `static`";
                let statics = statics.ok_or_else(|| Error::input(place, expected, "none"))?;
                return Ok(Self::quasi_steady(block, statics));
            }
        };
        let header = table.map(|table| table.header);
        let stated = header.as_ref();
        Ok(Self {
            table: between.map(|between| between as Arc<dyn Transfer>),
            angle_deg: stated.map_or(block.angle_deg, |header| header.angle_deg),
            rotation_amplitude_deg: stated.and_then(|header| header.rotation_amplitude_deg),
            ..forces
        })
    }

    /// A model as it was saved, with what is known of its scatter.
    fn trained(trained: TrainedModel, known: KnownUncertainty) -> Self {
        Self {
            method: trained.provenance.method,
            source: trained.provenance.source,
            licence: trained.provenance.licence,
            tested: Some(trained.tested_range),
            uncertainty: known.map(Some),
            ..Self::of(Arc::new(trained.model.clone()), trained.model)
        }
    }

    /// The model fitted to a table.
    fn fitted(
        block: &BridgeSectionBlock,
        table: &DerivativeTable,
        tested: ReducedFrequencyRange,
    ) -> Result<Self> {
        let options = match &block.fit {
            Some(stated) => stated.clone().try_into().map_err(|e: toml::de::Error| {
                let place = format!("section {}: fit", block.name);
                Error::input(place, "a fit to a table", e.message().replace('\n', " "))
            })?,
            None => FrequencyFit {
                form: Form::laguerre(block.filters),
                ..FrequencyFit::default()
            },
        };
        let samples = table.samples(&block.motions);
        let deck = Some(table.name.as_str());
        let found = ModelOfData::of_table(&samples, &block.motions, &options, deck)?;
        let (model, mut report) = (found.fitted.model, found.fitted.report);
        let known = found.estimate.and_then(|known| {
            let forms = FormEnsemble::or_noted(found.forms, &mut report)?;
            ModelUncertainty::of_data(known, forms, tested)
        });
        let notes = report.notes.iter();
        let notes = notes.map(|n| format!("section {}: {n}", block.name));
        let alone = report.constraints.and_then(|held| held.unconstrained);
        Ok(Self {
            method: report.method,
            source: table.header.source.clone(),
            licence: table.header.licence.clone(),
            tested: Some(tested),
            notes: notes.collect(),
            unconstrained: alone.map(|model| Arc::from(model as Box<dyn Transfer>)),
            uncertainty: known.map(|k| Some(Box::new(k))).map_err(|e| e.to_string()),
            ..Self::of(Arc::new(model.clone()), model)
        })
    }

    /// Theodorsen's plate where frequencies are asked for, Jones's rational functions where a realisation is.
    fn flat_plate(block: &BridgeSectionBlock) -> Result<Self> {
        let place = format!("section {}", block.name);
        let expected = "vertical and torsional motion with the flat plate";
        let (two, found) = (block.motions == Dof::TWO, Dof::names(&block.motions));
        ensure(two, place.as_str(), expected, found)?;
        let expected = "a table in a file (.csv, .xlsx)";
        let place = format!("{place}: convention");
        let found = format_args!("`{FLAT_PLATE}`");
        ensure(block.convention.is_empty(), place, expected, found)?;
        let jones = RationalModel::jones_flat_plate();
        Ok(Self {
            table: Some(Arc::new(FlatPlate::default())),
            method: "Jones's rational functions of the flat plate".to_owned(),
            source: "flat plate, Theodorsen's theory".to_owned(),
            licence: "none needed: a formula".to_owned(),
            ..Self::of(Arc::new(jones.clone()), Model::Rational(jones))
        })
    }

    /// A model of which no more is known: nothing was tested.
    fn of(model: Arc<dyn Transfer>, saved: Model) -> Self {
        Self {
            table: None,
            model,
            saved,
            method: String::new(),
            source: String::new(),
            licence: String::new(),
            tested: None,
            angle_deg: None,
            rotation_amplitude_deg: None,
            notes: Vec::new(),
            unconstrained: None,
            uncertainty: Ok(None),
        }
    }

    /// Forces of a section of which no more than static coefficients are known.
    fn quasi_steady(block: &BridgeSectionBlock, statics: &StaticBlock) -> Self {
        let theory =
            LinearQuasiSteady::new(&block.motions, statics.arms, 0.0, statics.coefficients());
        // rational functions without lags say the same in a form that is saved
        let saved =
            RationalModel::without_lags(&block.motions, theory.e0.clone(), theory.e1.clone());
        Self {
            method: "quasi-steady theory".to_owned(),
            source: format!("static coefficients of {}", block.name),
            licence: "that of the bridge file".to_owned(),
            ..Self::of(Arc::new(theory), Model::Rational(saved))
        }
    }

    /// The derivatives of the model with their 95 % intervals; none where its covariance is not known.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the covariance cannot be carried to them.
    pub(crate) fn derivative_intervals(&self) -> Result<Vec<DerivativeInterval>> {
        match (&self.uncertainty, self.tested) {
            (Ok(Some(known)), Some(tested)) => known.coefficients.derivatives(tested),
            _ => Ok(Vec::new()),
        }
    }

    /// By the table where there is one and it is wanted, else by the model.
    pub(super) fn forces(&self, table: bool) -> Arc<dyn Transfer> {
        match &self.table {
            Some(found) if table => found.clone(),
            _ => self.model.clone(),
        }
    }
}

/// The table of a section, in the convention of this project.
pub(crate) fn block_table(
    block: &BridgeSectionBlock,
    name: &str,
    directory: &Path,
) -> Result<DerivativeTable> {
    let place = format!("section {}: convention", block.name);
    named_table_in(name, directory, block.convention, &place)
}

/// A finding with the section that it is of.
fn of_block(block: &BridgeSectionBlock, found: Finding) -> Finding {
    Finding {
        place: format!("section {}: {}", block.name, found.place),
        ..found
    }
}

/// The table of a section, which states the angle of its tests as the bridge file does; what looks wrong in it is among the `findings`.
fn checked_table(
    block: &BridgeSectionBlock,
    name: &str,
    directory: &Path,
    findings: &mut Vec<Finding>,
) -> Result<DerivativeTable> {
    let mut table = block_table(block, name, directory)?;
    let key = format!("section {}: angle_deg", block.name);
    state_angle(&mut table.header, &key, block.angle_deg)?;
    let odd = of_table(&table, &block.convention.or_usual()).into_iter();
    findings.extend(odd.map(|f| of_block(block, f)));
    Ok(table)
}
