//! `terminalsAndIcons.xml` of FMI 3.0 (2.0 knows none): which variables belong to one connection. A degree of freedom is one, with
//! its motion and the force on it, and so is the wind.

use crate::fmu::groups::{Groups, array_of};
use crate::fmu::standard::Causality;
use crate::fmu::variables::{ForceOutput, GustDirection, Response, Role, VariableTable};
use crate::fmu::xml::Element;
use crate::section::Dof;

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

/// The file of a table of variables.
pub(super) fn document(table: &VariableTable) -> String {
    let groups = Groups::new(table);
    let members = |terminal: Terminal| -> Vec<Element> {
        let of_group = |places: &Vec<u32>| {
            let variable = &table.variables()[*places.first()? as usize];
            let connected = matches!(variable.causality, Causality::Input | Causality::Output);
            let (own, member) = member(variable.role).filter(|_| connected)?;
            let name = array_of(variable.role, &variable.name);
            let name = name.unwrap_or_else(|| variable.name.as_str().into());
            (own == terminal).then(|| {
                Element::new("TerminalMemberVariable")
                    .with("variableName", name)
                    .with("memberName", member)
                    .with("variableKind", "signal")
            })
        };
        groups.all().iter().filter_map(of_group).collect()
    };
    let terminals = Terminal::ALL.into_iter().filter_map(|terminal| {
        let members = members(terminal);
        (!members.is_empty()).then(|| {
            Element::new("Terminal")
                .with("name", terminal.name())
                .with("matchingRule", "bus")
                .with("description", terminal.description())
                .containing(members)
        })
    });
    Element::new("fmiTerminalsAndIcons")
        .with("fmiVersion", "3.0")
        .containing([Element::new("Terminals").containing(terminals)])
        .document()
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
