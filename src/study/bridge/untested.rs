//! Parts of a bridge that no test stands behind, modes that are left out, and what its onset is with other forces and with all modes.

use super::BridgeStudy;
use super::answers::coupled;
use crate::bridge::{Bridge, BridgeMode, StripGroup};
use crate::error::Result;
use crate::flutter::{FlutterSearch, find_onset};
use crate::plausibility::is_same_mode;
use crate::verdict::{ModesLeftOut, UntestedPart, UntestedParts};

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
            false => StripGroup {
                forces: main.forces.clone(),
                ..group.clone()
            },
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
        let (nodes, groups) = (b.nodes.clone(), b.groups.clone());
        let whole = Bridge::new(b.name.clone(), b.air_density_kg_m3, nodes, modes, groups)?
            .with_dampers(b.dampers.clone())?;
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
        let factors = nodes
            .iter()
            .map(|n| self.file.wind.factor(bridge.nodes[*n].along_m));
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
        let b = &self.by_model;
        let (nodes, modes) = (b.nodes.clone(), b.modes.clone());
        Bridge::new(b.name.clone(), b.air_density_kg_m3, nodes, modes, groups)?
            .with_dampers(b.dampers.clone())
    }
}
