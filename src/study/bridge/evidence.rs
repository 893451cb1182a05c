//! What is known of a bridge, as evidence for its verdict: what was found, parts of it that no test stands behind, and what its onset is with
//! other forces and with modes that are left out.

use crate::bridge::{Bridge, BridgeMode, StripGroup};
use crate::error::Result;
use crate::flutter::{
    FastMotion, FlutterSearch, bridge_damps_fast_motion, find_onset, judged_speeds,
};
use crate::plausibility::is_same_mode;
use crate::study::bridge::BridgeStudy;
use crate::study::bridge::answers::{BridgeAnswer, BridgeFlutter, bridge_flutter, coupled};
use crate::units::ReducedFrequencyRange;
use crate::verdict::{
    CriticalSpeed, Divergence, Evidence, FlutterReading, ForceBasis, MeanRotation, ModesLeftOut,
    Reach, StageFailure, UntestedPart, UntestedParts, Verdict,
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
        let mut divergence = vec![Divergence::at(MODELS, results.divergence_m_s)];
        divergence.extend(results.table_divergence.iter().map(|d| Divergence {
            lower_m_s: d.lower_m_s,
            assumed: Some(d.assumed.clone()),
            ..Divergence::at(TABLES, d.speed_m_s)
        }));
        let mut remarks = self.notes.clone();
        let stated = self.sections.iter().all(|s| s.angle_deg.is_some());
        let sections = self.sections.iter();
        let amplitudes_deg = sections.filter_map(|s| s.rotation_amplitude_deg);
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
                tested_deg: mean.tested_deg.filter(|_| stated),
                ..mean
            }),
            // the section that was moved least is what the answer rests on
            tested_rotation_deg: amplitudes_deg.reduce(f64::min),
            untested: results.untested.clone(),
            modes_left_out: results.modes_left_out.clone(),
            galloping: results
                .galloping_m_s
                .map(|speed_m_s| CriticalSpeed::galloping("static coefficients", speed_m_s)),
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
        let (range, mut from) = judged_speeds(&section, &self.search(), Some(tested))?;
        if let Some(from) = &mut from {
            let damped = bridge_damps_fast_motion(&self.by_model, tested.max)?;
            let damped = damped.then_some(FastMotion::Damped);
            from.below = FastMotion::new(damped, self.section_ranges());
        }
        let width_m = self.by_model.width_m();
        Ok(Reach::new(range, from, &results.curves, width_m))
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

fn failure(text: &str) -> StageFailure {
    let (stage, reason) = text.split_once(": ").unwrap_or(("the search", text));
    StageFailure {
        beside_answer: BESIDE.contains(&stage),
        ..StageFailure::new(stage, reason)
    }
}

/// Name of the strips at nodes that no section takes.
const IN_NO_SECTION: &str = "nodes in no section";

impl BridgeStudy {
    /// Parts of the onset's energy that nothing was tested for; `None` where every part was tested, or none: then the whole answer is in doubt.
    ///
    /// # Errors
    /// As [`find_onset`].
    pub(super) fn untested(&self, found: &FlutterSearch) -> Result<Option<UntestedParts>> {
        let blocks = || self.file.sections.iter().zip(&self.sections);
        let is_tested = |group: &StripGroup| {
            let own = blocks().find(|(block, _)| block.name == group.name);
            own.is_some_and(|(_, section)| section.tested.is_some())
        };
        let bridge = &self.by_model;
        let forces = bridge.forces();
        let tested = forces.shares().into_iter().filter(|(g, _)| is_tested(g));
        let Some((main, _)) = tested.max_by(|a, b| a.1.total_cmp(&b.1)) else {
            return Ok(None);
        };
        let with_main = |group: &StripGroup| match is_tested(group) {
            true => group.clone(),
            false => group.with_forces(main.forces.clone()),
        };
        let mut as_tested: Vec<StripGroup> = bridge.groups.iter().map(with_main).collect();
        as_tested.extend(self.in_no_section(main));
        let as_tested = self.with_groups(as_tested)?;
        let parts = self.parts(&as_tested);
        if parts.is_empty() {
            return Ok(None);
        }
        let tested = bridge.groups.iter().filter(|g| is_tested(g)).cloned();
        let in_still_air = self.with_groups(tested.collect())?;
        Ok(Some(UntestedParts {
            parts,
            as_it_is_m_s: found.critical_speed_m_s(),
            tested: main.name.clone(),
            as_tested_m_s: self.onset_m_s(&as_tested)?,
            in_still_air_m_s: self.onset_m_s(&in_still_air)?,
        }))
    }

    /// The onset with the modes of the file that are left out, but for those that would be counted twice; `None` where none are.
    ///
    /// # Errors
    /// As [`find_onset`].
    pub(super) fn with_all_modes(&self, found: &FlutterSearch) -> Result<Option<ModesLeftOut>> {
        let b = &self.by_model;
        let other = |m: &&BridgeMode| !b.modes.iter().any(|own| is_same_mode(&b.nodes, own, m));
        let left_out: Vec<&BridgeMode> = self.left_out.iter().filter(other).collect();
        if left_out.is_empty() {
            return Ok(None);
        }
        let mut modes = b.modes.clone();
        modes.extend(left_out.iter().map(|m| (*m).clone()));
        modes.sort_by_key(|m| m.number);
        let whole = self.rebuilt(modes, b.groups.clone())?;
        Ok(Some(ModesLeftOut {
            modes: left_out.iter().map(|m| m.number).collect(),
            as_it_is_m_s: found.critical_speed_m_s(),
            with_all_m_s: self.onset_m_s(&whole)?,
        }))
    }

    fn onset_m_s(&self, bridge: &Bridge) -> Result<Option<f64>> {
        let section = coupled(bridge)?;
        let found = find_onset("model", &section, &self.search(), self.tested_range())?;
        Ok(found.critical_speed_m_s())
    }

    /// The nodes that no section takes, as strips like those of `main` in the mean of their winds.
    fn in_no_section(&self, main: &StripGroup) -> Option<StripGroup> {
        let bridge = &self.by_model;
        let taken: Vec<usize> = bridge.groups.iter().flat_map(|g| g.nodes.clone()).collect();
        let bare = |n: &usize| !taken.contains(n) && bridge.nodes[*n].length_m > 0.0;
        let nodes: Vec<usize> = (0..bridge.nodes.len()).filter(bare).collect();
        let factors = nodes.iter();
        let factors = factors.map(|n| self.file.wind.factor(bridge.nodes[*n].along_m));
        let wind_factor = factors.sum::<f64>() / nodes.len() as f64;
        (!nodes.is_empty()).then(|| StripGroup {
            name: IN_NO_SECTION.to_owned(),
            wind_factor,
            nodes,
            ..main.clone()
        })
    }

    /// What was not tested, with its share of a bridge that has forces everywhere.
    fn parts(&self, bridge: &Bridge) -> Vec<UntestedPart> {
        let forces = bridge.forces();
        let shares = forces.shares();
        let share = |name: &str| {
            let own = shares.iter().filter(|(group, _)| group.name == name);
            own.map(|(_, share)| share).sum()
        };
        let blocks = self.file.sections.iter().zip(&self.sections);
        let untested = blocks.filter(|(_, section)| section.tested.is_none());
        let mut parts: Vec<UntestedPart> = untested
            .map(|(block, section)| UntestedPart {
                part: format!("section {}", block.name),
                forces: format!("those of {}", section.method),
                share: share(&block.name),
            })
            .collect();
        let bare = bridge.groups.iter().find(|g| g.name == IN_NO_SECTION);
        parts.extend(bare.map(|group| {
            let names = group.nodes.iter().map(|n| bridge.nodes[*n].name.as_str());
            let names: Vec<&str> = names.collect();
            UntestedPart {
                part: format!("the nodes {}, which no section takes", names.join(", ")),
                forces: "none".to_owned(),
                share: share(IN_NO_SECTION),
            }
        }));
        parts
    }

    /// The bridge by its models with other strips.
    pub(super) fn with_groups(&self, groups: Vec<StripGroup>) -> Result<Bridge> {
        self.rebuilt(self.by_model.modes.clone(), groups)
    }

    fn rebuilt(&self, modes: Vec<BridgeMode>, groups: Vec<StripGroup>) -> Result<Bridge> {
        let b = &self.by_model;
        let (name, density) = (b.name.clone(), b.air_density_kg_m3);
        Bridge::new(name, density, b.nodes.clone(), modes, groups)?.with_dampers(b.dampers.clone())
    }
}
