//! The self-excited forces of one section of a bridge file.

use super::super::{KnownUncertainty, uncertainty_beside};
use crate::aerodynamics::derivatives::{
    DerivativeTable, Extrapolation, InterpolatedTable, TableHeader,
};
use crate::aerodynamics::quasi_steady::LinearQuasiSteady;
use crate::aerodynamics::{FlatPlate, Lags, RationalModel, Transfer};
use crate::error::{Error, Result};
use crate::files::bridge::{BridgeSectionBlock, StaticBlock};
use crate::files::derivatives::named_table_in;
use crate::identification::{FeedThrough, Fitted, Form, FrequencyFit, fit_table};
use crate::plausibility::{Finding, of_model, of_table};
use crate::section::Dof;
use crate::trained_model::{Model, TrainedModel};
use crate::uncertainty::{CoefficientUncertainty, DerivativeInterval, table_uncertainty};
use crate::units::ReducedFrequencyRange;
use nalgebra::DMatrix;
use std::path::Path;
use std::sync::Arc;

/// The word for Theodorsen's plate instead of a table.
const FLAT_PLATE: &str = "flat plate";

/// Forces of a section, by table and by model.
#[derive(Clone)]
pub struct SectionForceModels {
    /// Between the points of the table, or the flat plate, exactly.
    pub table: Option<Arc<dyn Transfer>>,
    /// With a realisation.
    pub model: Arc<dyn Transfer>,
    /// What it is saved as.
    pub saved: Option<Model>,
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
    /// How far the data leave the coefficients of the model open, or why that is not known; `None` for stated coefficients.
    pub uncertainty: std::result::Result<Option<CoefficientUncertainty>, String>,
    /// Degrees of freedom of the onset of the section that a model was trained for: they stand for those of the bridge's where
    /// a covariance on file no longer knows its data.
    pub degrees_of_freedom: Option<f64>,
}

impl std::fmt::Debug for SectionForceModels {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SectionForces")
            .field("tested", &self.tested)
            .finish_non_exhaustive()
    }
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
        let of_table = block
            .derivatives
            .as_ref()
            .map(|name| by_table(block, name, directory, trained.is_none(), findings));
        let (table, fitted) = of_table.transpose()?.unzip();
        let (angle_deg, rotation_amplitude_deg) = match &table {
            Some(Tabulated { header, .. }) => (header.angle_deg, header.rotation_amplitude_deg),
            None => (block.angle_deg, None),
        };
        let table = table.map(|t: Tabulated| Arc::new(t.between) as Arc<dyn Transfer>);
        if let Some((trained, known)) = trained {
            let model = Arc::new(trained.model.clone());
            return Ok(Self {
                table,
                model,
                saved: Some(trained.model),
                method: trained.provenance.method,
                source: trained.provenance.source,
                licence: trained.provenance.licence,
                tested: Some(trained.tested_range),
                angle_deg,
                rotation_amplitude_deg,
                notes: Vec::new(),
                unconstrained: None,
                degrees_of_freedom: known
                    .as_ref()
                    .ok()
                    .and_then(|known| Some(known.onset.as_ref()?.degrees_of_freedom)),
                uncertainty: known.map(|known| Some(known.coefficients)),
            });
        }
        if let Some(Some(fitted)) = fitted {
            return Ok(Self {
                table,
                angle_deg,
                rotation_amplitude_deg,
                ..fitted
            });
        }
        let Some(statics) = &block.statics else {
            return Err(Error::input(
                format!("section {}", block.name),
                "one of `derivatives`, `model`, `static`",
                "none",
            ));
        };
        Ok(Self::quasi_steady(block, statics))
    }

    /// Theodorsen's plate where frequencies are asked for, Jones's rational functions where a realisation is.
    fn flat_plate(block: &BridgeSectionBlock) -> Result<Self> {
        let place = format!("section {}", block.name);
        if block.motions != Dof::TWO {
            let expected = "vertical and torsional motion with the flat plate";
            return Err(Error::input(place, expected, Dof::names(&block.motions)));
        }
        if !block.convention.is_empty() {
            let expected = "a table in a file (.csv, .xlsx)";
            return Err(Error::input(
                format!("{place}: convention"),
                expected,
                format!("`{FLAT_PLATE}`"),
            ));
        }
        let jones = RationalModel::jones_flat_plate();
        Ok(Self {
            table: Some(Arc::new(FlatPlate::default())),
            method: "Jones's rational functions of the flat plate".to_owned(),
            source: "flat plate, Theodorsen's theory".to_owned(),
            licence: "none needed: a formula".to_owned(),
            ..Self::stated(Arc::new(jones.clone()), jones)
        })
    }

    /// A model that is stated and not fitted: nothing was tested.
    fn stated(model: Arc<dyn Transfer>, saved: RationalModel) -> Self {
        Self {
            table: None,
            model,
            saved: Some(Model::Rational(saved)),
            method: String::new(),
            source: String::new(),
            licence: String::new(),
            tested: None,
            angle_deg: None,
            rotation_amplitude_deg: None,
            notes: Vec::new(),
            unconstrained: None,
            uncertainty: Ok(None),
            degrees_of_freedom: None,
        }
    }

    /// Forces of a section of which no more than static coefficients are known.
    fn quasi_steady(block: &BridgeSectionBlock, statics: &StaticBlock) -> Self {
        let theory =
            LinearQuasiSteady::new(&block.motions, statics.arms, 0.0, statics.coefficients());
        // rational functions without lags say the same in a form that is saved
        let (e0, e1) = theory.feed_through();
        let saved = RationalModel {
            dofs: block.motions.clone(),
            a1: e0.clone(),
            a2: e1.clone(),
            a3: DMatrix::zeros(e0.nrows(), e0.ncols()),
            lags: Lags::Shared(Vec::new()),
            lag_terms: Vec::new(),
        };
        Self {
            method: "quasi-steady theory".to_owned(),
            source: format!("static coefficients of {}", block.name),
            licence: "that of the bridge file".to_owned(),
            ..Self::stated(Arc::new(theory), saved)
        }
    }

    /// The derivatives of the model with their 95 % intervals; none where its covariance is not known.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the covariance cannot be carried to them.
    pub(crate) fn derivative_intervals(&self) -> Result<Vec<DerivativeInterval>> {
        match (&self.uncertainty, self.tested) {
            (Ok(Some(known)), Some(tested)) => known.derivatives(tested),
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

/// A table between its points, with what it says of its tests.
struct Tabulated {
    between: InterpolatedTable,
    header: TableHeader,
}

/// The table between its points, and the model fitted to it.
fn by_table(
    block: &BridgeSectionBlock,
    name: &str,
    directory: &Path,
    fit: bool,
    findings: &mut Vec<Finding>,
) -> Result<(Tabulated, Option<SectionForceModels>)> {
    let mut table = block_table(block, name, directory)?;
    let key = format!("section {}: angle_deg", block.name);
    table.header.state_angle(&key, block.angle_deg)?;
    let convention = block.convention.or_usual();
    let odd = of_table(&table, &convention).into_iter();
    findings.extend(odd.map(|f| of_block(block, f)));
    let between = InterpolatedTable::by(
        block.interpolation,
        &table,
        &block.motions,
        Extrapolation::Hold,
    )?;
    let header = table.header.clone();
    if !fit {
        return Ok((Tabulated { between, header }, None));
    }
    let options = match &block.fit {
        Some(stated) => stated.clone().try_into().map_err(|e: toml::de::Error| {
            let place = format!("section {}: fit", block.name);
            Error::input(place, "a fit to a table", e.message().replace('\n', " "))
        })?,
        None => FrequencyFit {
            form: Form::Laguerre {
                filters: Some(block.filters),
                feed_through: FeedThrough::default(),
                pole_per_transfer_function: false,
            },
            ..FrequencyFit::default()
        },
    };
    let samples = table.samples(&block.motions);
    let Fitted { model, report } = fit_table(&samples, &block.motions, &options)?;
    let uncertainty = table_uncertainty(&samples, &block.motions, &options, &report);
    let forces = SectionForceModels {
        table: None,
        model: Arc::new(model.clone()),
        saved: Some(model),
        method: report.method.clone(),
        source: header.source.clone(),
        licence: header.licence.clone(),
        tested: Some(between.tested_range()),
        angle_deg: None,
        rotation_amplitude_deg: None,
        notes: report
            .notes
            .iter()
            .map(|n| format!("section {}: {n}", block.name))
            .collect(),
        unconstrained: report
            .constraints
            .and_then(|held| Some(Arc::from(held.unconstrained? as Box<dyn Transfer>))),
        uncertainty: uncertainty.map(Some).map_err(|e| e.to_string()),
        degrees_of_freedom: None,
    };
    Ok((Tabulated { between, header }, Some(forces)))
}
