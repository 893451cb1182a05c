//! The section that the current parameters describe, and what follows from it alone: onset and divergence.

use crate::aerodynamics::{AerodynamicModel, Realization};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::{OnsetSearch, divergence_speed, find_onset};
use crate::fmu::variables::{Calculated, Role, SectionParameter, VariableTable};
use crate::section::{Dof, SectionModel};
use crate::trained_model::TrainedModel;
use crate::units::ReducedFrequency;

/// The section of the model with the parameters in `values` (one number a variable of `table`).
///
/// A support whose three numbers are the start values stays as the model states it, so that an unchanged section is
/// the model's own to the last bit even where that states a stiffness.
fn section_model(model: &TrainedModel, table: &VariableTable, values: &[f64]) -> SectionModel {
    let mut section = model.section.clone();
    let value = |p: SectionParameter| {
        let start = p.value_in(&model.section);
        table.find(Role::Section(p)).map_or(start, |i| values[i])
    };
    section.width_m = value(SectionParameter::Width);
    section.air_density_kg_m3 = value(SectionParameter::AirDensity);
    for dof in model.section.dofs() {
        let parameters = [
            SectionParameter::Inertia(dof),
            SectionParameter::Frequency(dof),
            SectionParameter::DampingRatio(dof),
        ];
        let start = parameters.map(|p| p.value_in(&model.section));
        let now = parameters.map(value);
        if start.map(f64::to_bits) != now.map(f64::to_bits) {
            set_support(&mut section, dof, now);
        }
    }
    section
}

fn set_support(section: &mut SectionModel, dof: Dof, [inertia, frequency, damping]: [f64; 3]) {
    // no frequency is no spring: that cannot be said as a frequency
    let (frequency_hz, stiffness) = if frequency > 0.0 {
        (Some(frequency), None)
    } else {
        (None, Some(0.0))
    };
    let translation = match dof {
        Dof::Torsion => {
            let s = &mut section.torsion;
            (s.inertia_kg_m2_m, s.damping_ratio) = (inertia, damping);
            (s.frequency_hz, s.stiffness_n) = (frequency_hz, stiffness);
            return;
        }
        Dof::Vertical => Some(&mut section.vertical),
        Dof::Lateral => section.lateral.as_mut(),
    };
    if let Some(s) = translation {
        (s.mass_kg_m, s.damping_ratio) = (inertia, damping);
        (s.frequency_hz, s.stiffness_n_m2) = (frequency_hz, stiffness);
    }
}

/// The coupled section of the parameters in `values`.
///
/// # Errors
/// Those of [`SectionModel::structure`] and [`CoupledSection::new`].
pub(super) fn coupled_section(
    model: &TrainedModel,
    table: &VariableTable,
    aerodynamics: &Realization,
    values: &[f64],
) -> Result<CoupledSection> {
    let structure = section_model(model, table, values).structure()?;
    CoupledSection::new(structure, aerodynamics.clone())
}

/// Onset and divergence of a section.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OnsetCard {
    onset_speed: f64,
    onset_frequency: f64,
    onset_reduced_velocity: f64,
    divergence_speed: f64,
    pub onset_found: bool,
    onset_in_tested_range: bool,
    pub divergence_found: bool,
    /// What a reader must know before using the numbers.
    pub warnings: Vec<String>,
}

impl OnsetCard {
    /// Searches up to `limit` m/s. What is not found is the limit itself, with frequency and reduced velocity zero.
    ///
    /// # Errors
    /// Those of the searches.
    pub fn search(model: &TrainedModel, section: &CoupledSection, limit: f64) -> Result<Self> {
        let search = OnsetSearch {
            speed_max_m_s: limit,
            ..OnsetSearch::default()
        };
        let found = find_onset(
            model.model.kind(),
            section,
            &search,
            Some(model.tested_range),
        )?;
        let steady = model
            .model
            .transfer(ReducedFrequency::from_full_width(0.0))?;
        let divergence = divergence_speed(section.structure(), &steady)?.filter(|v| *v <= limit);
        let onset = found.onset();
        Ok(Self {
            onset_speed: onset.map_or(limit, |o| o.speed_m_s),
            onset_frequency: onset.map_or(0.0, |o| o.frequency_hz),
            onset_reduced_velocity: onset.map_or(0.0, |o| o.reduced_velocity.v_star()),
            divergence_speed: divergence.unwrap_or(limit),
            onset_found: onset.is_some(),
            onset_in_tested_range: onset.is_some_and(|o| o.in_tested_range == Some(true)),
            divergence_found: divergence.is_some(),
            warnings: onset.map_or_else(Vec::new, |o| o.warnings.clone()),
        })
    }

    /// One of its numbers; truth values are 0 and 1.
    pub fn value(&self, which: Calculated) -> f64 {
        let flag = |b: bool| f64::from(u8::from(b));
        match which {
            Calculated::OnsetSpeed => self.onset_speed,
            Calculated::OnsetFrequency => self.onset_frequency,
            Calculated::OnsetReducedVelocity => self.onset_reduced_velocity,
            Calculated::DivergenceSpeed => self.divergence_speed,
            Calculated::OnsetFound => flag(self.onset_found),
            Calculated::OnsetInTestedRange => flag(self.onset_in_tested_range),
            Calculated::DivergenceFound => flag(self.divergence_found),
        }
    }
}
