//! What is known of a bridge, as evidence for its verdict.

use super::BridgeStudy;
use super::answers::{BridgeAnswer, BridgeFlutter, coupled};
use crate::error::Result;
use crate::flutter::judged_speeds;
use crate::units::ReducedFrequencyRange;
use crate::verdict::{
    Basis, DivergenceReading, Evidence, Failure, FlutterReading, MeanRotation, Reach, RequiredSpeed,
};

/// Whose forces the two routes take, in the order of the answers.
const TABLES: &str = "the tables";
const MODELS: &str = "the models";
/// The rotation to which derivatives belong, deg: tables do not state another.
const TESTED_ROTATION_DEG: f64 = 0.0;
/// What can fail without another answer.
const BESIDE: [&str; 4] = ["figures", "fewer modes", "scatter", "FMU"];

impl BridgeStudy {
    /// Everything that was found on the bridge; `failed` are the failures, those of the search among them.
    pub fn evidence(&self, results: &BridgeFlutter, failed: &[String]) -> Evidence {
        let required = self.file.flutter.required_speed_m_s;
        let mut flutter = self.readings(results);
        // the table is the answer where it is inside its range, the models where it ends before they flutter
        if let [tables, models] = &flutter[..]
            && tables.search.critical().is_none()
            && models.search.critical().is_some()
        {
            flutter.reverse();
        }
        let mut divergence = vec![DivergenceReading::at(MODELS, results.divergence_m_s)];
        divergence.extend(results.table_divergence.iter().map(|d| DivergenceReading {
            forces: TABLES.to_owned(),
            speed_m_s: d.speed_m_s,
            lower_m_s: d.lower_m_s,
            assumed: Some(d.assumed.clone()),
        }));
        let mut remarks = self.notes.clone();
        let ended = results.curves.ended.iter();
        remarks.extend(ended.map(|why| format!("The curves end early: {why}")));
        Evidence {
            required: required.map(|speed_m_s| RequiredSpeed { speed_m_s }),
            flutter,
            divergence,
            growth: results.growth.clone(),
            failures: failed.iter().map(|f| failure(f)).collect(),
            mean_rotation: results.mean_rotation_deg.map(|at_onset_deg| MeanRotation {
                at_onset_deg,
                tested_deg: TESTED_ROTATION_DEG,
            }),
            implausible: self.findings.clone(),
            remarks,
            ..Evidence::default()
        }
    }

    /// The speeds at which every mode is among the tests of every section.
    fn reach(&self, results: &BridgeFlutter, tested: ReducedFrequencyRange) -> Result<Reach> {
        let section = coupled(&self.by_model)?;
        let judged = judged_speeds(&section, &self.search(), Some(tested))?;
        Ok(Reach::of(judged, &results.curves, self.by_model.width_m()))
    }

    /// By the tables, where there are some, then by the models.
    fn readings(&self, results: &BridgeFlutter) -> Vec<FlutterReading> {
        let basis = match self.tested_range() {
            None => Basis::Stated,
            Some(range) => {
                let reach = self.reach(results, range);
                Basis::tested(range, reach.unwrap_or_else(|_| Reach::nowhere()))
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

fn failure(text: &str) -> Failure {
    let (stage, reason) = text.split_once(": ").unwrap_or(("the search", text));
    Failure {
        stage: stage.to_owned(),
        reason: reason.to_owned(),
        bears_on_answer: !BESIDE.contains(&stage),
    }
}
