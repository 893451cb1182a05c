//! Evidence of one section in the forces of one model, from the searches alone.

use super::evidence::{Divergence, Evidence, FlutterReading, ForceBasis, Reach, StageFailure};
use crate::aerodynamics::{Transfer, TransferMatrix};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{
    AssumedAtRest, FlutterSearch, OnsetSearch, divergence_speed, judged_speeds, static_part,
    table_tested_from, trace_modes, unwanted_growth_below,
};
use crate::section::Structure;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};

impl Evidence {
    /// What a section in forces that were `tested` answers beside what was `found` for it: how far tests reach, growth, static
    /// divergence with the forces `at_rest` (`G` at `K = 0`, n×n). What cannot be computed is a failure in it.
    pub fn of_section(
        forces: &str,
        section: &CoupledSection,
        at_rest: &TransferMatrix,
        tested: ReducedFrequencyRange,
        search: &OnsetSearch,
        found: FlutterSearch,
    ) -> Self {
        let mut evidence = Self {
            searched_to_m_s: Some(search.speed_max_m_s),
            ..Self::default()
        };
        let structure = section.structure();
        let judged = judged_speeds(section, search, Some(tested));
        let reach = judged.and_then(|(range, tested_from)| {
            let curves = trace_modes(forces, section, &search.speeds_m_s()?)?;
            Ok(Reach::new(range, tested_from, &curves, structure.width_m))
        });
        let reach = evidence.noted("modes over wind speed", reach);
        let growth = unwanted_growth_below(Some(&found), section, search, Some(tested));
        evidence.growth = evidence.noted("scan for growth", growth);
        evidence.flutter.push(FlutterReading {
            forces: forces.to_owned(),
            search: found,
            basis: ForceBasis::tested(tested, reach.unwrap_or_else(Reach::nowhere)),
        });
        evidence.with_divergence(forces, divergence_speed(structure, at_rest))
    }

    /// What a structure in the forces of a table, tested in `range`, answers beside what was `found` for it by a search that ends
    /// where the table does. A table says nothing of steady flow: divergence is by its slopes at the lowest `K`.
    pub fn of_table(
        forces: &str,
        structure: &Structure,
        table: &dyn Transfer,
        range: ReducedFrequencyRange,
        found: FlutterSearch,
    ) -> Self {
        let mut evidence = Self::default();
        let tested_from = table_tested_from(structure, table, range);
        let tested_from = evidence.noted("modes at the highest K", tested_from);
        evidence.flutter.push(FlutterReading {
            forces: forces.to_owned(),
            search: found,
            basis: ForceBasis::tested(range, Reach::of_table(tested_from.flatten())),
        });
        let divergence = table.transfer(range.min).and_then(|lowest| {
            let speed = divergence_speed(structure, &static_part(table.dofs(), &lowest))?;
            Ok((speed, AssumedAtRest::below(range.min)?))
        });
        if let Some((speed_m_s, assumed)) = evidence.noted("divergence", divergence) {
            evidence.divergence.push(Divergence {
                lower_m_s: speed_m_s.map(|v| assumed.lower_m_s(v)),
                assumed: Some(assumed.explain()),
                ..Divergence::at(forces, speed_m_s)
            });
        }
        evidence
    }

    /// The same for forces that hold at every reduced frequency.
    pub fn of_exact(
        forces: &str,
        structure: &Structure,
        exact: &dyn Transfer,
        found: FlutterSearch,
    ) -> Self {
        let reading = FlutterReading {
            forces: forces.to_owned(),
            search: found,
            basis: ForceBasis::Exact,
        };
        let evidence = Self {
            flutter: vec![reading],
            ..Self::default()
        };
        let at_rest = exact.transfer(ReducedFrequency::from_full_width(0.0));
        let divergence = at_rest.and_then(|g| divergence_speed(structure, &g));
        evidence.with_divergence(forces, divergence)
    }

    /// With static divergence by these forces, or why it is not known.
    fn with_divergence(mut self, forces: &str, found: Result<Option<f64>>) -> Self {
        let reading = |speed_m_s| Divergence::at(forces, speed_m_s);
        let known = self.noted("divergence", found);
        self.divergence.extend(known.map(reading));
        self
    }

    /// The value of a stage; a failure is one of the evidence.
    fn noted<T>(&mut self, stage: &str, result: Result<T>) -> Option<T> {
        let failed = |e: &Error| self.failures.push(StageFailure::new(stage, e));
        result.inspect_err(failed).ok()
    }
}
