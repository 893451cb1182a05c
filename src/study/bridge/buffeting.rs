//! The block `[buffeting]` of a bridge file, computed in both domains.

use super::BridgeStudy;
use crate::aerodynamics::quasi_steady::LinearQuasiSteady;
use crate::bridge::motion_index;
use crate::buffeting::{
    Coherence, Gust, SpanEnsemble, SpanPlan, SpanProblem, SpanRecord, SpanResponse, SpanSpectra,
    Turbulence, TurbulenceField, span_ensemble, span_record, span_response, span_spectra,
    turbulence_field,
};
use crate::error::{Error, Result, positive};
use crate::files::bridge::FieldTable;
use crate::section::Dof;
use serde::{Deserialize, Serialize};

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
}

/// Both domains at one wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BridgeBuffeting {
    /// Names of the nodes.
    pub nodes: Vec<String>,
    /// Frequency domain.
    pub frequency: SpanResponse,
    /// Expected peak factors in the length of a record, from the frequency domain.
    pub expected_peak_factor: Vec<[f64; 3]>,
    /// Spectra of the nodes; too many numbers for the JSON of a command.
    #[serde(skip)]
    pub spectra: SpanSpectra,
    /// Time domain.
    pub time: SpanEnsemble,
}

/// Response to turbulence of a file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BridgeRecord {
    /// Names of the nodes.
    pub nodes: Vec<String>,
    /// Response of each.
    #[serde(flatten)]
    pub record: SpanRecord,
}

impl BridgeStudy {
    /// The block, read and checked.
    ///
    /// # Errors
    /// [`Error::Input`] for a file without the block and for values that cannot be.
    pub fn buffeting_block(&self) -> Result<BuffetingBlock> {
        let table = self.file.buffeting.clone();
        let table = table.ok_or_else(|| {
            Error::input(
                "buffeting",
                "a block [buffeting] with the turbulence",
                "none",
            )
        })?;
        let block: BuffetingBlock = table.try_into().map_err(|e: toml::de::Error| {
            Error::input(
                "buffeting",
                "turbulence, coherence and plan",
                e.message().replace('\n', " "),
            )
        })?;
        block.coherence.validate("buffeting.coherence")?;
        positive("buffeting.time.duration_s", block.time.duration_s)?;
        positive("buffeting.time.step_s", block.time.step_s)?;
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
            let forces = theory.buffeting();
            let mut matrix = [[0.0; 2]; 3];
            for (row, dof) in Dof::THREE.into_iter().enumerate() {
                matrix[motion_index(dof)] = [forces[(row, 0)], forces[(row, 1)]];
            }
            Ok(matrix)
        };
        self.section_of_group.iter().map(matrix).collect()
    }

    fn problem(&self, block: &BuffetingBlock) -> Result<SpanProblem<'_>> {
        Ok(SpanProblem {
            bridge: &self.by_model,
            gust_matrices: self.gust_matrices()?,
            turbulence: Turbulence {
                along: block.along,
                vertical: block.vertical,
            },
            coherence: block.coherence,
        })
    }

    /// A field at the nodes of the bridge.
    pub(super) fn at_nodes(&self, field: &FieldTable) -> Result<FieldTable> {
        let nodes = self.by_model.nodes.iter();
        field.at(&nodes.map(|n| n.along_m).collect::<Vec<_>>())
    }

    /// Response at the nodes of the block at a wind speed, in both domains.
    ///
    /// # Errors
    /// [`Error::Input`] with the key of the block that cannot be; [`Error::Unstable`] when the bridge is unstable at this
    /// speed.
    pub fn buffeting(
        &self,
        block: &BuffetingBlock,
        speed_m_s: f64,
        progress: &dyn Fn(usize, usize),
    ) -> Result<BridgeBuffeting> {
        let problem = self.problem(block)?;
        let nodes = self.named(&block.nodes)?;
        let frequency = span_response(&problem, &nodes, speed_m_s)?;
        let time = span_ensemble(&problem, &nodes, speed_m_s, &block.time, progress)?;
        Ok(BridgeBuffeting {
            nodes: nodes
                .iter()
                .map(|n| self.by_model.nodes[*n].name.clone())
                .collect(),
            expected_peak_factor: frequency.peak_factors(block.time.duration_s),
            frequency,
            spectra: span_spectra(&problem, &nodes, speed_m_s)?,
            time,
        })
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
    ) -> Result<BridgeRecord> {
        let field = self.at_nodes(field)?;
        let field = TurbulenceField {
            step_s: field.step_s,
            along_m: field.along_m,
            gusts: field.gusts,
        };
        let places = self.named(&block.nodes)?;
        Ok(BridgeRecord {
            nodes: places
                .iter()
                .map(|n| self.by_model.nodes[*n].name.clone())
                .collect(),
            record: span_record(&self.problem(block)?, &places, speed_m_s, &field)?,
        })
    }

    /// The turbulence of the first record.
    ///
    /// # Errors
    /// [`Error::Input`] with the key of the block that cannot be.
    pub fn first_field(&self, block: &BuffetingBlock, speed_m_s: f64) -> Result<TurbulenceField> {
        let plan = &block.time;
        let samples = 2 * (0.5 * plan.duration_s / plan.step_s).round() as usize;
        turbulence_field(
            &self.problem(block)?,
            speed_m_s,
            (plan.step_s, samples),
            plan.seed,
        )
    }
}
