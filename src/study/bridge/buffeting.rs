//! The block `[buffeting]` of a bridge file, computed in both domains.

use super::BridgeStudy;
use super::envelope::{SpanEnvelope, envelope};
use crate::aerodynamics::quasi_steady::LinearQuasiSteady;
use crate::bridge::Bridge;
use crate::buffeting::{
    BuffetingProblem, Coherence, FrequencyDomain, Gust, SpanEnsemble, SpanPlan, SpanRecord,
    SpanResponse, SpectrumCurve, Turbulence, check_plan, part, span_ensemble, span_record,
    turbulence_field,
};
use crate::error::{Error, Result};
use crate::files::bridge::FieldTable;
use crate::numbered::OnDone;
use crate::plausibility::{Finding, of_turbulence};
use crate::section::Dof;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What the block states.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BuffetingBlock {
    /// Names of the nodes whose response is wanted; left out, mid-span and both quarter points.
    #[serde(default)]
    pub nodes: Vec<String>,
    /// `u`, along the mean wind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub along: Option<Gust>,
    /// `w`, upwards.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vertical: Option<Gust>,
    /// Coherence along the span.
    #[serde(default)]
    pub coherence: Coherence,
    /// Records in the time domain.
    #[serde(default)]
    pub time: SpanPlan,
    /// Mean wind speeds of the bridge, m/s, where the command names none.
    #[serde(default)]
    pub speeds_m_s: Vec<f64>,
    /// File of the section forces of the modes: `mode,element,…`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub section_forces: Option<PathBuf>,
}

/// Both domains at one wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BridgeBuffeting {
    /// Names of the nodes.
    pub nodes: Vec<String>,
    /// Frequency domain, by tables between their points where there are some.
    pub frequency: SpanResponse,
    /// The models that are stepped in time, where tables are the answer.
    pub models: Option<ModelsBesideTables>,
    /// Mean and turbulent motion along the span, accelerations, section forces.
    pub envelope: SpanEnvelope,
    /// Expected peak factors in the length of a record, from the frequency domain.
    pub expected_peak_factor: Vec<[f64; 3]>,
    /// Spectra of the nodes; too many numbers for the JSON of a command.
    #[serde(skip)]
    pub spectra: SpectrumCurve,
    /// Time domain, by models.
    pub time: Option<SpanEnsemble>,
    /// Why there is none in time.
    pub no_time: Option<String>,
}

/// How far the response by models is from that by tables, both in the frequency domain.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelsBesideTables {
    /// How the model of each section was made, section by section.
    pub fits: Vec<String>,
    /// Response by the models; `None` where they are unstable.
    pub response: Option<SpanResponse>,
    /// Root mean square by the models over that by the tables, less 1, of each node.
    pub change: Option<Vec<[f64; 3]>>,
}

impl ModelsBesideTables {
    /// The change of the largest size, with the places of its node and of its motion.
    pub fn largest(&self) -> Option<(usize, usize, f64)> {
        let changes = self.change.iter().flatten().enumerate();
        let all = changes.flat_map(|(n, of)| (0..3).map(move |i| (n, i, of[i])));
        all.filter(|c| c.2.is_finite())
            .max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()))
    }
}

impl BridgeStudy {
    /// The block, read and checked.
    ///
    /// # Errors
    /// [`Error::Input`] for a file without the block and for values that cannot be.
    pub fn buffeting_block(&self) -> Result<BuffetingBlock> {
        let wrong = |expected: &str, found: &str| Error::input("buffeting", expected, found);
        let none = || wrong("a block [buffeting] with the turbulence", "none");
        let table = self.file.buffeting.clone().ok_or_else(none)?;
        let block: BuffetingBlock = table.try_into().map_err(|e: toml::de::Error| {
            wrong(
                "turbulence, coherence and plan",
                &e.message().replace('\n', " "),
            )
        })?;
        block.coherence.validate("buffeting.coherence")?;
        let (duration_s, step_s) = (block.time.duration_s, Some(block.time.step_s));
        check_plan("buffeting.time", block.time.records, duration_s, step_s)?;
        Ok(block)
    }

    /// Buffeting matrix of each group: rows vertical, lateral, rotation; columns `u/V`, `w/V`.
    pub(super) fn gust_matrices(&self) -> Result<Vec<[[f64; 2]; 3]>> {
        let matrix = |section: &usize| {
            let stated = &self.file.sections[*section];
            let statics = stated.statics.as_ref().ok_or_else(|| {
                let expected = "`static` coefficients, from which the gust forces follow";
                Error::input(format!("section[{section}]"), expected, "none")
            })?;
            let theory =
                LinearQuasiSteady::new(&Dof::THREE, statics.arms, 0.0, statics.coefficients());
            let forces = &theory.buffeting;
            let mut matrix = [[0.0; 2]; 3];
            for (row, dof) in Dof::THREE.into_iter().enumerate() {
                matrix[dof as usize] = [forces[(row, 0)], forces[(row, 1)]];
            }
            Ok(matrix)
        };
        self.section_of_group.iter().map(matrix).collect()
    }

    /// The problem with the forces of a bridge: by models, or by tables.
    fn problem(
        &self,
        bridge: &Bridge,
        block: &BuffetingBlock,
    ) -> Result<BuffetingProblem<'static>> {
        let (along, vertical) = (block.along, block.vertical);
        let turbulence = Turbulence { along, vertical };
        BuffetingProblem::of_bridge(bridge, &self.gust_matrices()?, turbulence, block.coherence)
    }

    /// A field at the nodes of the bridge.
    pub(super) fn at_nodes(&self, field: &FieldTable) -> Result<FieldTable> {
        let nodes = self.by_model.nodes.iter();
        field.at(&nodes.map(|n| n.along_m).collect::<Vec<_>>())
    }

    /// Response at the nodes of the block at a wind speed, in both domains: by tables between their points in the frequency
    /// domain where there are some, by models in time.
    ///
    /// # Errors
    /// [`Error::Input`] with the key of the block that cannot be; [`Error::Unstable`] when the bridge is unstable at this
    /// speed.
    pub fn buffeting(
        &self,
        block: &BuffetingBlock,
        speed_m_s: f64,
        progress: OnDone<'_>,
    ) -> Result<BridgeBuffeting> {
        let nodes = self.named(&block.nodes)?;
        let models = self.problem(&self.by_model, block)?;
        let tables = self.by_table.as_ref();
        let tables = tables.map(|bridge| self.problem(bridge, block));
        let tables = tables.transpose()?;
        let problem = tables.as_ref().unwrap_or(&models);
        let known = problem.model().known_range();
        let of_frequencies = || -> Result<_> {
            let domain = FrequencyDomain::new(problem, speed_m_s)?;
            let frequency = domain.response(&nodes, known.or_else(|| self.tested_range()))?;
            let beside = tables.is_some();
            let beside = beside.then(|| self.beside_tables(&models, &frequency));
            let spectra = domain.spectra(&nodes)?;
            let (peak_s, forces) = (block.time.peak_s(), block.section_forces.as_deref());
            let envelope = envelope(self, &domain, speed_m_s, peak_s, forces)?;
            Ok((frequency, beside.transpose()?, spectra, envelope))
        };
        let (of_frequencies, time) = rayon::join(of_frequencies, || {
            span_ensemble(&models, &nodes, speed_m_s, &block.time, progress)
        });
        let (frequency, beside, spectra, envelope) = of_frequencies?;
        let (time, no_time) = match time {
            Ok(time) => (Some(time), None),
            // the tables know of no growth at this speed
            Err(Error::Unstable(_)) if beside.is_some() => {
                (None, Some(format!("the models grow at {speed_m_s} m/s")))
            }
            Err(e) => return Err(e),
        };
        Ok(BridgeBuffeting {
            nodes: problem.names_of(&nodes),
            expected_peak_factor: frequency.peak_factors(block.time.peak_s()),
            envelope,
            spectra,
            models: beside,
            frequency,
            time,
            no_time,
        })
    }

    /// The models in the frequency domain, where the tables have given `answer`.
    fn beside_tables(
        &self,
        problem: &BuffetingProblem<'_>,
        answer: &SpanResponse,
    ) -> Result<ModelsBesideTables> {
        let response = match FrequencyDomain::new(problem, answer.speed_m_s) {
            Ok(domain) => Some(domain.response(&answer.nodes, self.tested_range())?),
            Err(Error::Unstable(_)) => None,
            Err(e) => return Err(e),
        };
        let change = response.as_ref().map(|by_model| {
            let both = by_model.rms.iter().zip(&answer.rms);
            both.map(|(m, t)| std::array::from_fn(|i| part(m[i], t[i], 1.0) - 1.0))
                .collect()
        });
        let sections = self.file.sections.iter().zip(&self.sections);
        let fits = sections.map(|(block, forces)| format!("{}: {}", block.name, forces.method));
        Ok(ModelsBesideTables {
            fits: fits.collect(),
            response,
            change,
        })
    }

    /// What is odd about the turbulence of a file, in a mean wind of `speed_m_s`, m/s, where that is known.
    pub fn findings_of(&self, field: &FieldTable, speed_m_s: Option<f64>) -> Vec<Finding> {
        // a block that cannot be read states nothing here; whoever needs it says why
        let block = self.buffeting_block().ok();
        let block = block.as_ref();
        let stated = [block.and_then(|b| b.along), block.and_then(|b| b.vertical)];
        let stated = stated.map(|gust| gust.map(|g| g.spectrum.intensity));
        let (modes, deviations_m_s) = (&self.by_model.modes, field.deviations_m_s());
        let (step_s, duration_s) = (field.step_s, field.duration_s());
        of_turbulence(modes, step_s, duration_s, deviations_m_s, speed_m_s, stated)
    }

    /// Response to the turbulence of a file, at the nodes of the bridge.
    ///
    /// # Errors
    /// [`Error::Input`] for a field that does not reach over the bridge, and with the key of the block that cannot be.
    pub fn buffeting_by(
        &self,
        block: &BuffetingBlock,
        speed_m_s: f64,
        field: &FieldTable,
    ) -> Result<SpanRecord> {
        let field = self.at_nodes(field)?;
        let problem = self.problem(&self.by_model, block)?;
        let nodes = self.named(&block.nodes)?;
        span_record(&problem, &nodes, speed_m_s, field.step_s, &field.gusts)
    }

    /// The turbulence of the first record.
    ///
    /// # Errors
    /// [`Error::Input`] with the key of the block that cannot be.
    pub fn first_field(&self, block: &BuffetingBlock, speed_m_s: f64) -> Result<FieldTable> {
        let plan = &block.time;
        let problem = self.problem(&self.by_model, block)?;
        let samples = plan.record_samples(&problem, speed_m_s)?;
        let gusts = turbulence_field(&problem, speed_m_s, plan.step_s, samples, plan.seed)?;
        Ok(FieldTable {
            step_s: plan.step_s,
            along_m: self.by_model.nodes.iter().map(|n| n.along_m).collect(),
            from_middle: false,
            mean_speed_m_s: Some(speed_m_s),
            gusts,
        })
    }
}
