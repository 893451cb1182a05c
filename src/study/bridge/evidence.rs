//! What is known of a bridge, as evidence for its verdict.

use super::BridgeStudy;
use super::answers::{BridgeAnswer, BridgeFlutter, bridge_flutter, coupled};
use crate::error::Result;
use crate::flutter::{FastMotion, FlutterSearch, bridge_damps_fast_motion, judged_speeds};
use crate::units::ReducedFrequencyRange;
use crate::verdict::{
    DivergenceReading, Evidence, Failure, FlutterReading, ForceBasis, GallopingReading,
    MeanRotation, Reach, Verdict,
};

/// Whose forces the two routes take, in the order of the answers.
const TABLES: &str = "the tables";
const MODELS: &str = "the models";
/// What can fail without another answer.
const BESIDE: [&str; 5] = ["figures", "fewer modes", "constraints", "scatter", "FMU"];

impl BridgeStudy {
    /// Everything that was found on the bridge; `failed` are the failures, those of the search among them.
    pub fn evidence(&self, results: &BridgeFlutter, failed: &[String]) -> Evidence {
        let mut flutter = self.readings(results);
        // the table is the answer where it is inside its range, the models where it ends before they flutter or judges nothing
        if let [tables, models] = &flutter[..]
            && tables.search.critical().is_none()
            && (models.search.critical().is_some() || judges_nothing(&tables.search))
        {
            flutter.reverse();
        }
        let mut divergence = vec![DivergenceReading::at(MODELS, results.divergence_m_s)];
        divergence.extend(results.table_divergence.iter().map(|d| DivergenceReading {
            lower_m_s: d.lower_m_s,
            assumed: Some(d.assumed.clone()),
            ..DivergenceReading::at(TABLES, d.speed_m_s)
        }));
        let mut remarks = self.notes.clone();
        let stated = self.sections.iter().all(|s| s.angle_deg.is_some());
        let ended = results.curves.ended.iter();
        remarks.extend(ended.map(|why| format!("The curves end early: {why}")));
        Evidence {
            required: self.required(),
            flutter,
            searched_to_m_s: Some(self.search().speed_max_m_s),
            divergence,
            growth: results.growth.clone(),
            constraints: results.constraints,
            failures: failed.iter().map(|f| failure(f)).collect(),
            mean_rotation: results.mean_rotation.map(|mean| MeanRotation {
                speed_m_s: mean.speed_m_s,
                at_onset_deg: mean.rotation_deg,
                tested_deg: stated.then_some(mean.tested_deg),
            }),
            // the section that was moved least is what the answer rests on
            tested_rotation_deg: self
                .sections
                .iter()
                .filter_map(|s| s.rotation_amplitude_deg)
                .reduce(f64::min),
            untested: results.untested.clone(),
            modes_left_out: results.modes_left_out.clone(),
            galloping: results.galloping_m_s.map(|speed_m_s| GallopingReading {
                forces: "static coefficients".to_owned(),
                speed_m_s,
            }),
            implausible: self.findings.clone(),
            remarks,
            ..Evidence::default()
        }
    }

    /// What everything that is found on the bridge amounts to.
    ///
    /// # Errors
    /// As [`bridge_flutter`].
    pub fn verdict(&self) -> Result<Verdict> {
        let results = bridge_flutter(self)?;
        Ok(Verdict::judge(&self.evidence(&results, &results.failed)))
    }

    /// The speeds at which every mode is among the tests of every section.
    fn reach(&self, results: &BridgeFlutter, tested: ReducedFrequencyRange) -> Result<Reach> {
        let tested = tested.not_empty()?;
        let section = coupled(&self.by_model)?;
        let mut judged = judged_speeds(&section, &self.search(), Some(tested))?;
        if let Some(from) = &mut judged.tested_from {
            let damped = bridge_damps_fast_motion(&self.by_model, tested.max)?;
            let damped = damped.then_some(FastMotion::Damped);
            from.below = FastMotion::new(damped, self.section_ranges());
        }
        Ok(Reach::new(judged, &results.curves, self.by_model.width_m()))
    }

    /// By the tables, where there are some, then by the models.
    fn readings(&self, results: &BridgeFlutter) -> Vec<FlutterReading> {
        let basis = match self.tested_range() {
            None => ForceBasis::Stated,
            Some(range) => {
                let reach = self.reach(results, range);
                ForceBasis::tested(range, reach.unwrap_or_else(|_| Reach::nowhere()))
            }
        };
        let reading = |forces: &str, answer: &BridgeAnswer| FlutterReading {
            forces: forces.to_owned(),
            search: answer.search.clone(),
            basis: basis.clone(),
        };
        match &results.answers[..] {
            [tables, models] => vec![reading(TABLES, tables), reading(MODELS, models)],
            all => all.iter().map(|models| reading(MODELS, models)).collect(),
        }
    }
}

fn judges_nothing(search: &FlutterSearch) -> bool {
    matches!(search, FlutterSearch::StableUpTo(range) if range.is_empty())
}

fn failure(text: &str) -> Failure {
    let (stage, reason) = text.split_once(": ").unwrap_or(("the search", text));
    Failure {
        stage: stage.to_owned(),
        reason: reason.to_owned(),
        bears_on_answer: !BESIDE.contains(&stage),
    }
}
