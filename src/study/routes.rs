//! The onset of a study by every route, side by side.
//!
//! Eigenvalues of each realisation, the determinant and the p-k iteration on the same `G(K)`, both on the deck itself
//! (interpolated table or exact flat plate), the low-frequency (quasi-steady) limit or static coefficients, the flat plate with the same
//! structure, and handbook formulas. Two routes on one force model must agree to rounding; between force models the
//! table shows what the choice of the model does.

mod limit;
mod steady;

use super::{Deck, SpeedRange, Study};
use crate::aerodynamics::{FlatPlate, RationalModel, Realizable, Realization, Transfer};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::{
    FlutterCurves, FlutterSearch, ModeAtOnset, OnsetMethod, classify, determinant_onset,
    divergence_by_eigenvalues, divergence_speed, divergence_with_forces, find_onset, pk_curves,
    pk_onset, trace_modes,
};
use crate::section::{Dof, Structure};
use crate::trained_model::TrainedModel;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::verdict::{SanityLines, sanity_lines};
use limit::{limit_onset, low_frequency_limit, steady_flat_plate};
use serde::Serialize;

/// Reduced frequencies from still air to nearly steady flow.
const WIDE: (f64, f64) = (0.02, 10.0);
/// A reduced frequency at which the flow is steady to rounding of `Re G` and to 1e-5 of `Im G/K`.
const NEARLY_STEADY: f64 = 1e-5;
/// Share of the kinetic energy, and onset alone over onset, from which on an instability is nearly one of a single
/// degree of freedom.
const NEARLY_ALONE: f64 = 0.8;
const ALONE_SOON: f64 = 1.5;
/// Name of the flat plate with the section's structure.
const FLAT_PLATE: &str = "flat plate, same structure";
/// Name of quasi-steady theory with static coefficients.
pub(super) const THEORY: &str = "quasi-steady theory";

/// All routes of one study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct RouteTable {
    /// One entry a route and force model.
    pub routes: Vec<Route>,
    /// Handbook formulas; `null` when they say nothing about this section.
    pub sanity: Option<SanityLines>,
    /// Modes over wind speed of one route per force model.
    pub curves: Vec<FlutterCurves>,
    /// Routes that failed, with the reason.
    pub failed: Vec<FailedRoute>,
    /// Routes that were left out, and why.
    pub left_out: Vec<String>,
}

/// A route without an answer.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct FailedRoute {
    /// Force model.
    pub model: String,
    /// How the onset was looked for; `null` where the force model itself could not be used.
    pub method: Option<OnsetMethod>,
    /// Why there is no answer.
    pub reason: String,
}

/// The answer of one route: everything on the onset card.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Route {
    /// Force model.
    pub model: String,
    /// How the onset was found.
    pub method: OnsetMethod,
    /// The onset, or the speed up to which there is none.
    pub search: FlutterSearch,
    /// `V̂ = V/(ωB) = 1/K` at onset.
    pub v_hat: Option<f64>,
    /// Kind of the instability and the mode behind it.
    pub mode: Option<ModeAtOnset>,
    /// Static divergence, m/s.
    pub divergence_m_s: Option<f64>,
    /// Reduced frequencies in which the force model was tested; `null` for an exact one.
    pub tested_range: Option<ReducedFrequencyRange>,
    /// Whether the force model is a limit for `K → 0`, which no test range bounds but the theory does.
    pub low_frequency_limit: bool,
    /// Onset of the low-frequency limit of the same force model, m/s.
    pub quasi_steady_m_s: Option<f64>,
    /// What a reader must know before using the numbers.
    pub warnings: Vec<String>,
}

/// A force model with its name and where it may be asked.
struct Forces<'a> {
    name: String,
    model: &'a dyn Transfer,
    structure: &'a Structure,
    speeds: &'a SpeedRange,
    tested: Option<ReducedFrequencyRange>,
    /// Divergence, m/s.
    divergence_m_s: Option<f64>,
    /// Onset of the low-frequency limit, m/s.
    quasi_steady_m_s: Option<f64>,
}

/// Compares all routes for the trained models of a study and its deck. A route that fails is listed with its reason and
/// takes no other with it.
pub(crate) fn route_table(
    study: &Study,
    deck: &Deck,
    trained: &[TrainedModel],
) -> Result<RouteTable> {
    let (structure, speeds) = (study.section.structure()?, &study.speeds());
    let mut table = RouteTable {
        routes: Vec::new(),
        sanity: sanity_lines(&structure),
        curves: Vec::new(),
        failed: Vec::new(),
        left_out: Vec::new(),
    };
    for model in trained {
        let added = table.add_trained(speeds, &structure, model);
        table.note_failure(&model.name, None, added);
    }
    let added = table.add_deck(speeds, deck, &structure);
    table.note_failure(&deck.own_model_name(), None, added);
    if deck.table().is_some() {
        let added = table.add_flat_plate(speeds, &structure);
        table.note_failure(FLAT_PLATE, None, added);
    }
    if let Some(block) = &study.coefficients {
        let theory = block.theory(&study.directory, &study.section.dofs())?;
        let added = table.add_static_coefficients(speeds, &structure, &theory);
        table.note_failure(THEORY, None, added);
    }
    if table.sanity.is_none() {
        table.left_out.push(
            "Selberg, Rocard: the formulas are for sections whose rotation is faster than their heave, about mid-chord with the centre of mass there".into(),
        );
    }
    for curves in &mut table.curves {
        curves.branches.retain(|b| !b.points.is_empty());
    }
    table.curves.retain(|c| !c.branches.is_empty());
    Ok(table)
}

impl RouteTable {
    /// What was found, or a line among those that failed.
    fn note_failure<T>(
        &mut self,
        model: &str,
        method: Option<OnsetMethod>,
        found: Result<T>,
    ) -> Option<T> {
        let failed = |reason: crate::Error| FailedRoute {
            model: model.to_owned(),
            method,
            reason: reason.to_string(),
        };
        found.map_err(|e| self.failed.push(failed(e))).ok()
    }

    /// The route of what a search found, if it found an answer.
    fn answered(
        &mut self,
        forces: &Forces<'_>,
        method: OnsetMethod,
        found: Result<FlutterSearch>,
    ) -> Option<Route> {
        let route = found.and_then(|search| forces.route(method, search));
        self.note_failure(&forces.name, Some(method), route)
    }

    /// Curves over wind speed, with the points inside the tested range marked; or why there are none.
    fn draw(&mut self, forces: &Forces<'_>, curves: Result<FlutterCurves>) {
        let name = &forces.name;
        match curves {
            Ok(curves) => {
                let ended = curves.ended.iter();
                let ended = ended.map(|why| format!("curves of {name} end: {why}"));
                self.left_out.extend(ended);
                let curves = curves.marked(forces.structure.width_m, forces.tested);
                self.curves.push(curves);
            }
            Err(e) => self.left_out.push(format!("curves of {name}: {e}")),
        }
    }

    fn add_trained(
        &mut self,
        speeds: &SpeedRange,
        structure: &Structure,
        model: &TrainedModel,
    ) -> Result<()> {
        let section = CoupledSection::with_model(structure, &model.model)?;
        let k = ReducedFrequency::from_full_width(NEARLY_STEADY);
        let limit = low_frequency_limit(&model.model, k)?;
        let forces = Forces {
            name: model.name.clone(),
            model: &model.model,
            structure,
            speeds,
            tested: Some(model.tested_range),
            divergence_m_s: divergence_with_forces(structure, &model.model)?,
            quasi_steady_m_s: limit_onset(speeds, structure, &limit)?,
        };
        let found = find_onset(&model.name, &section, &speeds.search(), forces.tested);
        if let Some(mut route) = self.answered(&forces, OnsetMethod::Eigenvalues, found) {
            let highest = speeds.searched_to_m_s.max(beyond(&forces));
            route.divergence_m_s = divergence_by_eigenvalues(&section, highest)?;
            self.routes.push(route);
        }
        let curves = trace_modes(&model.name, &section, &speeds.curve_speeds_m_s());
        self.draw(&forces, curves);
        let sampled = matches!(model.model.realize(), Realization::Discrete(_));
        self.add_transfer_routes(&forces, sampled);
        Ok(())
    }

    /// Determinant and p-k iteration on one `G(K)`.
    fn add_transfer_routes(&mut self, forces: &Forces<'_>, sampled: bool) {
        let (name, s, model) = (&forces.name, forces.structure, forces.model);
        let search = forces.speeds.search();
        let inside = determinant_onset(name, s, model, forces.range(), search.speed_max_m_s);
        let iterated = pk_onset(name, s, model, &search, forces.tested);
        for (method, found) in [
            (OnsetMethod::Determinant, inside),
            (OnsetMethod::PkIteration, iterated),
        ] {
            let Some(mut route) = self.answered(forces, method, found) else {
                continue;
            };
            if sampled {
                route.warnings.push(
                    "the transfer matrix without the hold of the force over each step".into(),
                );
            }
            self.routes.push(route);
        }
    }

    fn add_deck(&mut self, speeds: &SpeedRange, deck: &Deck, structure: &Structure) -> Result<()> {
        let (model, tested) = deck.model()?;
        let still = ReducedFrequency::from_full_width(NEARLY_STEADY);
        let steady_k = tested.map_or(still, |range| range.min);
        let (static_transfer, assumed) = deck.static_transfer()?;
        let limit = if tested.is_some() {
            RationalModel {
                a1: static_transfer.map(|z| z.re),
                ..low_frequency_limit(model.as_ref(), steady_k)?
            }
        } else {
            steady_flat_plate()
        };
        let forces = Forces {
            name: deck.own_model_name(),
            model: model.as_ref(),
            structure,
            speeds,
            tested,
            divergence_m_s: divergence_speed(structure, &static_transfer)?,
            quasi_steady_m_s: limit_onset(speeds, structure, &limit)?,
        };
        let from = self.routes.len();
        self.add_transfer_routes(&forces, false);
        let own = deck.own_onset(structure, speeds.searched_to_m_s);
        let own = own.as_ref().ok().and_then(FlutterSearch::onset);
        for route in &mut self.routes[from..] {
            if let (FlutterSearch::Onset(onset), Some(own)) = (&mut route.search, own) {
                onset.interval = own.interval.clone();
            }
            let assumed = assumed.map(|a| format!("divergence: {}", a.explain()));
            route.warnings.extend(assumed);
        }
        let of_curves = speeds.curve_speeds_m_s();
        let curves = pk_curves(&forces.name, structure, model.as_ref(), &of_curves);
        self.draw(&forces, curves);
        self.add_quasi_steady(speeds, structure, &limit, tested.map(|range| range.min))
    }

    fn add_flat_plate(&mut self, speeds: &SpeedRange, structure: &Structure) -> Result<()> {
        let two = structure.only(&Dof::TWO);
        let plate = FlatPlate::default();
        let forces = Forces {
            name: FLAT_PLATE.into(),
            model: &plate,
            structure: &two,
            speeds,
            tested: None,
            divergence_m_s: divergence_with_forces(&two, &plate)?,
            quasi_steady_m_s: limit_onset(speeds, &two, &steady_flat_plate())?,
        };
        let from = self.routes.len();
        self.add_transfer_routes(&forces, false);
        if structure.dofs.len() > two.dofs.len() {
            for route in &mut self.routes[from..] {
                let text = "heave and rotation only: a plate has no drag";
                route.warnings.push(text.to_owned());
            }
        }
        let curves = pk_curves(FLAT_PLATE, &two, &plate, &speeds.curve_speeds_m_s());
        self.draw(&forces, curves);
        Ok(())
    }
}

/// Twice the divergence speed in closed form, so that the search by eigenvalues reaches it.
fn beyond(forces: &Forces<'_>) -> f64 {
    forces.divergence_m_s.map_or(0.0, |v| 2.0 * v)
}

impl Forces<'_> {
    /// Where the determinant may be searched.
    fn range(&self) -> ReducedFrequencyRange {
        self.tested.unwrap_or(ReducedFrequencyRange::between(
            ReducedFrequency::from_full_width(WIDE.0),
            ReducedFrequency::from_full_width(WIDE.1),
        ))
    }

    fn route(&self, method: OnsetMethod, mut search: FlutterSearch) -> Result<Route> {
        // exact at every K: there is no tested range to leave
        match (&mut search, self.tested) {
            (FlutterSearch::Onset(onset), None) => onset.in_tested_range = None,
            (FlutterSearch::UnstableAtOrBelow(start), None) => start.in_tested_range = None,
            _ => {}
        }
        let onset = search.onset();
        let speed_max = self.speeds.searched_to_m_s;
        let mode = onset.map(|o| classify(self.structure, self.model, o, self.range(), speed_max));
        let mode = mode.transpose()?;
        let mut warnings = match &search {
            FlutterSearch::Onset(onset) => onset.warnings.clone(),
            FlutterSearch::UnstableAtOrBelow(start) => start.warnings.clone(),
            FlutterSearch::StableUpTo(_) => Vec::new(),
        };
        if let (Some(onset), Some(divergence)) = (onset, self.divergence_m_s)
            && divergence < onset.at.speed_m_s
        {
            let text = format!("static divergence at {divergence:.3} m/s comes before flutter");
            warnings.push(text);
        }
        let single = mode.as_ref().zip(onset);
        warnings.extend(single.and_then(|(m, onset)| nearly_single(m, onset.at.speed_m_s)));
        Ok(Route {
            model: self.name.clone(),
            method,
            v_hat: onset.map(|o| o.at.reduced_frequency.v_hat()),
            mode,
            divergence_m_s: self.divergence_m_s,
            tested_range: self.tested,
            low_frequency_limit: false,
            quasi_steady_m_s: self.quasi_steady_m_s,
            warnings,
            search,
        })
    }
}

/// A warning for coupled flutter close to one of a single degree of freedom.
fn nearly_single(mode: &ModeAtOnset, onset_m_s: f64) -> Option<String> {
    let near = mode.participation.iter().find(|p| {
        p.energy_share > NEARLY_ALONE && p.alone_m_s.is_some_and(|v| v < ALONE_SOON * onset_m_s)
    })?;
    (!mode.kind.single_dof()).then(|| {
        format!(
            "nearly a one-degree-of-freedom instability: {} carries {:.0} % of the kinetic energy and flutters alone at {:.3} m/s",
            near.dof.name(),
            100.0 * near.energy_share,
            near.alone_m_s.unwrap_or(f64::NAN)
        )
    })
}
