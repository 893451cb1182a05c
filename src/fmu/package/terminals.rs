//! `terminalsAndIcons.xml`: which variables belong to one connection. A degree of freedom is one, with
//! its motion and the force on it, and so is the wind.

use crate::aerodynamics::GustComponent;
use crate::fmu::vocabulary::{
    Causality, Element, FmiVersion, Response, Role, VariableTable, array_of,
};
use crate::section::Dof;
use std::collections::BTreeSet;

/// The file in the archive.
pub(super) const FILE: &str = "terminalsAndIcons/terminalsAndIcons.xml";

/// Name and description of a connection: that of a motion, or of the wind.
fn words(of: Option<Dof>) -> (&'static str, &'static str) {
    let description = match of {
        None => "Mean wind and gusts",
        Some(Dof::Vertical) => "Vertical motion and force, positive up",
        Some(Dof::Lateral) => "Lateral motion and force, positive downwind",
        Some(Dof::Torsion) => "Rotation and moment, positive nose-up",
    };
    (of.map_or("wind", Dof::name), description)
}

/// The file of the listed variables of a table. FMI 3.0 has one connection for all strips or nodes, whose members are arrays; 2.0, which
/// may have the file since 2.0.4, one for each.
pub(super) fn document(table: &VariableTable, version: FmiVersion) -> String {
    // in the order of the table
    let mut terminals: Vec<(String, Option<Dof>, Vec<Element>)> = Vec::new();
    let mut arrays = BTreeSet::new();
    for variable in table.variables() {
        let connected = matches!(variable.causality, Causality::Input | Causality::Output);
        let Some((terminal, member)) = member(variable.role).filter(|_| connected) else {
            continue;
        };
        let array = array_of(variable.role, &variable.name);
        let (of, name) = match (version, array) {
            (FmiVersion::Three, Some(array)) => ("", array.into_owned()),
            (_, array) => (
                array.map_or("", |_| strip_of(&variable.name)),
                variable.name.clone(),
            ),
        };
        if !arrays.insert(name.clone()) {
            continue;
        }
        let element = Element::new("TerminalMemberVariable")
            .with("variableName", name)
            .with("memberName", member)
            .with("variableKind", "signal");
        let name = [of, words(terminal).0].concat();
        match terminals.iter_mut().find(|(n, ..)| *n == name) {
            Some((.., members)) => members.push(element),
            None => terminals.push((name, terminal, vec![element])),
        }
    }
    terminals.sort_by_key(|(_, terminal, _)| *terminal);
    let terminals = terminals.into_iter().map(|(name, terminal, members)| {
        Element::new("Terminal")
            .with("name", name)
            .with("matchingRule", "bus")
            .with("description", words(terminal).1)
            .containing(members)
    });
    Element::new("fmiTerminalsAndIcons")
        .with("fmiVersion", "3.0")
        .containing([Element::new("Terminals").containing(terminals)])
        .document()
}

/// `node[1076].` of `node[1076].heave`.
fn strip_of(name: &str) -> &str {
    name.find("].").map_or("", |end| &name[..end + 2])
}

/// The connection of a variable, of a motion or of the wind, and what it is there.
fn member(role: Role) -> Option<(Option<Dof>, &'static str)> {
    let motion = |of, dof| {
        let member = match of {
            Response::Displacement => "displacement",
            Response::Rate => "rate",
            Response::Acceleration => "acceleration",
            Response::SelfExcitedForce => "self_excited_force",
        };
        Some((Some(dof), member))
    };
    match role {
        Role::WindSpeed => Some((None, "speed")),
        Role::Gust(_, GustComponent::Along) => Some((None, "gust_along")),
        Role::Gust(_, GustComponent::Vertical) => Some((None, "gust_up")),
        Role::Response(of, dof) | Role::Motion(_, of, dof) | Role::NodeMotion(_, of, dof) => {
            motion(of, dof)
        }
        Role::ExternalForce(dof) | Role::NodeForce(_, dof) => Some((Some(dof), "external_force")),
        Role::Force(_, dof) => Some((Some(dof), "force_per_length")),
        Role::TotalForce(_, dof) => Some((Some(dof), "force")),
        _ => None,
    }
}
