//! `terminalsAndIcons.xml`: which variables belong to one connection. A degree of freedom is one, with
//! its motion and the force on it, and so is the wind.

use crate::fmu::groups::array_of;
use crate::fmu::standard::{Causality, FmiVersion};
use crate::fmu::variables::{ForceOutput, GustDirection, Response, Role, VariableTable};
use crate::fmu::xml::Element;
use crate::section::Dof;
use std::collections::BTreeSet;

/// The file in the archive.
pub(super) const FILE: &str = "terminalsAndIcons/terminalsAndIcons.xml";

/// The connections of a unit.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Terminal {
    Wind,
    Motion(Dof),
}

impl Terminal {
    const ALL: [Self; 4] = [
        Self::Wind,
        Self::Motion(Dof::Vertical),
        Self::Motion(Dof::Lateral),
        Self::Motion(Dof::Torsion),
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Wind => "wind",
            Self::Motion(dof) => dof.name(),
        }
    }

    fn description(self) -> &'static str {
        match self {
            Self::Wind => "Mean wind and gusts",
            Self::Motion(Dof::Vertical) => "Vertical motion and force, positive up",
            Self::Motion(Dof::Lateral) => "Lateral motion and force, positive downwind",
            Self::Motion(Dof::Torsion) => "Rotation and moment, positive nose-up",
        }
    }
}

/// The file of the listed variables of a table. FMI 3.0 has one connection for all strips or nodes, whose members are arrays; 2.0, which
/// may have the file since 2.0.4, one for each.
pub(super) fn document(table: &VariableTable, version: FmiVersion) -> String {
    // in the order of the table
    let mut terminals: Vec<(String, Terminal, Vec<Element>)> = Vec::new();
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
        let name = [of, terminal.name()].concat();
        match terminals.iter_mut().find(|(n, ..)| *n == name) {
            Some((.., members)) => members.push(element),
            None => terminals.push((name, terminal, vec![element])),
        }
    }
    terminals.sort_by_key(|(_, terminal, _)| Terminal::ALL.iter().position(|t| t == terminal));
    let terminals = terminals.into_iter().map(|(name, terminal, members)| {
        Element::new("Terminal")
            .with("name", name)
            .with("matchingRule", "bus")
            .with("description", terminal.description())
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

/// The connection of a variable, and what it is there.
fn member(role: Role) -> Option<(Terminal, &'static str)> {
    let motion = |of, dof| {
        let member = match of {
            Response::Displacement => "displacement",
            Response::Rate => "rate",
            Response::Acceleration => "acceleration",
            Response::SelfExcitedForce => "self_excited_force",
        };
        Some((Terminal::Motion(dof), member))
    };
    match role {
        Role::WindSpeed => Some((Terminal::Wind, "speed")),
        Role::Gust(_, GustDirection::Along) => Some((Terminal::Wind, "gust_along")),
        Role::Gust(_, GustDirection::Vertical) => Some((Terminal::Wind, "gust_up")),
        Role::Response(of, dof) | Role::Motion(_, of, dof) | Role::NodeMotion(_, of, dof) => {
            motion(of, dof)
        }
        Role::ExternalForce(dof) | Role::NodeForce(_, dof) => {
            Some((Terminal::Motion(dof), "external_force"))
        }
        Role::Force(_, ForceOutput::PerLength, dof) => {
            Some((Terminal::Motion(dof), "force_per_length"))
        }
        Role::Force(_, ForceOutput::Total, dof) => Some((Terminal::Motion(dof), "force")),
        _ => None,
    }
}
