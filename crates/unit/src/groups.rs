//! Variables as FMI 3.0 lists them: what all strips, modes or nodes have is one array.

use super::refusal::{CallResult, Refusal};
use super::variables::{Role, VariableTable};
use std::borrow::Cow;
use std::collections::HashMap;
use std::ffi::CString;

/// Indices in the table of each listed variable; the value reference is the index in this list, and the one behind the last is
/// the time.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Groups {
    groups: Vec<Vec<u32>>,
    /// Value reference of each index in the table; none of those that are not listed.
    references: Vec<Option<usize>>,
    /// Whether references are other numbers than indices.
    are_other: bool,
    /// Arrays of the names of nodes and modes, behind the time.
    names: Vec<ElementNames>,
    /// The number of strips, where an importer may choose it.
    strips: Option<usize>,
}

/// Which element of an array is which: the names of nodes or modes, itself an array.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ElementNames {
    /// Name of the array: `node_name` of all nodes, `node_name_2` and so on of those nodes that have something others have not.
    pub name: String,
    /// What is named: `node`, `mode`.
    pub kind: &'static str,
    /// The names, in the order of all arrays that have these elements.
    pub of: Vec<CString>,
    /// Value references of those arrays.
    pub arrays: Vec<usize>,
}

impl ElementNames {
    /// Of the arrays of this kind: those of all elements first.
    fn of_kind(kind: &'static str, groups: &[Vec<u32>], table: &VariableTable) -> Vec<Self> {
        let element = |index: u32| {
            let of = table.variables()[index as usize].name.as_str();
            let number = of.strip_prefix(kind)?.strip_prefix('[')?;
            Some(number.split_once("].")?.0)
        };
        let all = groups.iter().enumerate();
        let all = all.filter(|(_, indices)| element(indices[0]).is_some());
        let most = all.clone().map(|(_, indices)| indices.len()).max();
        let mut sets: Vec<(Vec<&str>, Vec<usize>)> = Vec::new();
        for (reference, indices) in all {
            let of = || indices.iter().filter_map(|p| element(*p));
            // as many as there are at most are all, which saves a look
            let same = |(set, _): &&mut (Vec<&str>, Vec<usize>)| {
                set.len() == indices.len()
                    && (Some(set.len()) == most || of().eq(set.iter().copied()))
            };
            match sets.iter_mut().find(same) {
                Some((_, arrays)) => arrays.push(reference),
                None => sets.push((of().collect(), vec![reference])),
            }
        }
        sets.sort_by_key(|(set, _)| std::cmp::Reverse(set.len()));
        let name = |i: usize| match i {
            0 => format!("{kind}_name"),
            _ => format!("{kind}_name_{}", i + 1),
        };
        let sets = sets.into_iter().enumerate().map(|(i, (set, arrays))| Self {
            name: name(i),
            kind,
            of: set.iter().filter_map(|s| CString::new(*s).ok()).collect(),
            arrays,
        });
        sets.collect()
    }
}

impl Groups {
    /// The listed variables of a table.
    pub fn new(table: &VariableTable) -> Self {
        let mut groups: Vec<Vec<u32>> = Vec::new();
        let mut arrays: HashMap<Cow<'_, str>, usize> = HashMap::new();
        let listed = table.variables().iter().enumerate();
        for (index, variable) in listed.filter(|(_, v)| v.is_listed) {
            let index = u32::try_from(index).unwrap_or(u32::MAX);
            match array_of(variable.role, &variable.name) {
                Some(name) => match arrays.get(&name) {
                    Some(group) => groups[*group].push(index),
                    None => {
                        arrays.insert(name, groups.len());
                        groups.push(vec![index]);
                    }
                },
                None => groups.push(vec![index]),
            }
        }
        let mut references = vec![None; table.variables().len()];
        for (reference, indices) in groups.iter().enumerate() {
            for index in indices {
                references[*index as usize] = Some(reference);
            }
        }
        let kinds = ["node", "mode"].into_iter();
        let names = kinds.flat_map(|kind| ElementNames::of_kind(kind, &groups, table));
        // strips that are counted, not those of nodes
        let counted = |indices: &&Vec<u32>| {
            let v = &table.variables()[indices[0] as usize];
            matches!(v.role, Role::Strip(..)) && v.name.starts_with("strip[")
        };
        Self {
            names: names.collect(),
            strips: groups.iter().find(counted).map(Vec::len),
            are_other: groups.len() < references.len(),
            references,
            groups,
        }
    }

    /// Indices in the table, by value reference.
    pub fn all(&self) -> &[Vec<u32>] {
        &self.groups
    }

    /// Value reference of the time, s.
    pub fn time(&self) -> u32 {
        u32::try_from(self.groups.len()).unwrap_or(u32::MAX)
    }

    /// Arrays of names, with their value references: those behind the time.
    pub fn names(&self) -> impl Iterator<Item = (u32, &ElementNames)> {
        (self.time() + 1..).zip(&self.names)
    }

    /// The array of names with this value reference.
    pub(crate) fn names_at(&self, reference: u32) -> Option<&ElementNames> {
        let mut all = self.names();
        all.find(|(r, _)| *r == reference).map(|(_, names)| names)
    }

    /// Number of strips, where it may be chosen.
    pub fn strips(&self) -> Option<usize> {
        self.strips
    }

    /// Value reference of that number: the one behind all others.
    pub fn strips_reference(&self) -> Option<u32> {
        let last = self.names().last().map_or(self.time(), |(r, _)| r);
        self.strips.map(|_| last + 1)
    }

    /// Whether a reference is that of the time, of names or of the number of strips.
    pub(crate) fn is_known(&self, reference: u32) -> bool {
        (self.time() as usize..=self.last()).contains(&(reference as usize))
    }

    /// The last value reference.
    fn last(&self) -> usize {
        self.time() as usize + self.names.len() + usize::from(self.strips.is_some())
    }

    /// Value reference of a listed variable, and which of its numbers an index in the table is.
    pub(crate) fn element_of(&self, index: usize) -> Option<(u32, usize)> {
        let reference = self.reference_of(index)?;
        let element = self.groups[reference].binary_search(&u32::try_from(index).ok()?);
        Some((u32::try_from(reference).ok()?, element.ok()?))
    }

    /// Value reference of the variable to which an index in the table belongs, if it is listed.
    pub fn reference_of(&self, index: usize) -> Option<usize> {
        self.references.get(index).copied().flatten()
    }

    /// The indices of these references, one number each.
    ///
    /// # Errors
    /// A reference that is none, or that of the time, where only variables are allowed.
    pub fn indices<'a>(&self, references: &'a [u32]) -> CallResult<Cow<'a, [u32]>> {
        if let Some(wrong) = references.iter().find(|r| **r >= self.time()) {
            let why = match self.is_known(*wrong) {
                true => {
                    "the time, names and the number of strips are not what this call takes".into()
                }
                false => format!("there is no such variable, the last one is {}", self.last()),
            };
            return Err(Refusal::error(format!("value reference {wrong}: {why}")));
        }
        if !self.are_other {
            return Ok(Cow::Borrowed(references));
        }
        let indices = references.iter().flat_map(|r| &self.groups[*r as usize]);
        Ok(Cow::Owned(indices.copied().collect()))
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
        Role::Motion(..)
        | Role::Gust(..)
        | Role::Force(..)
        | Role::TotalForce(..)
        | Role::OfStrip(..)
        | Role::Strip(..)
        | Role::Filter(_) => matches!(kind, "strip" | "node").then_some(rest.into()),
        Role::Mode(..)
        | Role::InitialMode(_)
        | Role::ModeFrequency(_)
        | Role::ModeDamping(_)
        | Role::Damper(..)
        | Role::DamperParameter(_)
        | Role::NodeForce(..)
        | Role::NodeMotion(..) => Some(format!("{kind}.{rest}").into()),
        _ => None,
    }
}
