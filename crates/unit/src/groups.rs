//! Variables as FMI 3.0 lists them: what all strips, modes or nodes have is one array.

use super::refusal::{CallResult, Refusal};
use super::variables::{Role, VariableTable};
use std::borrow::Cow;
use std::collections::HashMap;

/// Places in the table of each listed variable; the value reference is the place in this list, and the one behind the last is
/// the time.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Groups {
    groups: Vec<Vec<u32>>,
    /// Value reference of each place in the table; none of those that are not listed.
    references: Vec<Option<usize>>,
    /// Whether references are other numbers than places.
    are_other: bool,
}

impl Groups {
    /// The listed variables of a table.
    pub fn new(table: &VariableTable) -> Self {
        let mut groups: Vec<Vec<u32>> = Vec::new();
        let mut arrays: HashMap<Cow<'_, str>, usize> = HashMap::new();
        let listed = table.variables().iter().enumerate();
        for (place, variable) in listed.filter(|(_, v)| v.is_listed) {
            let place = u32::try_from(place).unwrap_or(u32::MAX);
            match array_of(variable.role, &variable.name) {
                Some(name) => match arrays.get(&name) {
                    Some(group) => groups[*group].push(place),
                    None => {
                        arrays.insert(name, groups.len());
                        groups.push(vec![place]);
                    }
                },
                None => groups.push(vec![place]),
            }
        }
        let mut references = vec![None; table.variables().len()];
        for (reference, places) in groups.iter().enumerate() {
            for place in places {
                references[*place as usize] = Some(reference);
            }
        }
        Self {
            are_other: groups.len() < references.len(),
            references,
            groups,
        }
    }

    /// Places in the table, by value reference.
    pub fn all(&self) -> &[Vec<u32>] {
        &self.groups
    }

    /// Value reference of the time, s.
    pub fn time(&self) -> u32 {
        u32::try_from(self.groups.len()).unwrap_or(u32::MAX)
    }

    /// Value reference of the variable to which a place in the table belongs, if it is listed.
    pub fn reference_of(&self, place: usize) -> Option<usize> {
        self.references.get(place).copied().flatten()
    }

    /// The places of these references, one number each.
    ///
    /// # Errors
    /// A reference that is none, or that of the time, where only variables are allowed.
    pub fn places<'a>(&self, references: &'a [u32]) -> CallResult<Cow<'a, [u32]>> {
        if let Some(wrong) = references.iter().find(|r| **r >= self.time()) {
            return Err(Refusal::error(format!(
                "value reference {wrong}: there is no such variable to be set or differentiated, the last one is {}",
                self.time().saturating_sub(1)
            )));
        }
        if !self.are_other {
            return Ok(Cow::Borrowed(references));
        }
        let places = references.iter().flat_map(|r| &self.groups[*r as usize]);
        Ok(Cow::Owned(places.copied().collect()))
    }
}

/// The name of the array to which a variable of named strips, modes or nodes belongs: `heave` of strips, `mode.coordinate`.
pub fn array_of(role: Role, name: &str) -> Option<Cow<'_, str>> {
    if let Some(state) = name
        .strip_prefix("der(")
        .filter(|n| n.starts_with("strip[") || n.starts_with("node["))
    {
        let (_, rest) = state.split_once("].")?;
        return Some(format!("der({rest}").into());
    }
    let (of, rest) = name.split_once("].")?;
    let (kind, _) = of.split_once('[')?;
    match role {
        Role::Filter(_) | Role::FilterRate(_) if matches!(kind, "mode" | "damper") => {
            Some(format!("{kind}.{rest}").into())
        }
        Role::Motion(..) | Role::Gust(..) | Role::Force(..) | Role::Strip(..) | Role::Filter(_) => {
            matches!(kind, "strip" | "node").then_some(rest.into())
        }
        Role::Mode(..)
        | Role::InitialMode(_)
        | Role::ModeParameter(..)
        | Role::Damper(..)
        | Role::DamperParameter(_)
        | Role::NodeForce(..)
        | Role::NodeMotion(..) => Some(format!("{kind}.{rest}").into()),
        _ => None,
    }
}
