//! Onsets: every route, every answer, and two looks at the same growth.

#[path = "../common/command.rs"]
#[allow(dead_code)] // each room needs a part of it
mod command;
#[path = "../common/matrix.rs"]
#[allow(dead_code)]
mod matrix;
#[path = "../common/three_dof.rs"]
#[allow(dead_code)]
mod three_dof;

mod all_speeds;
mod answers;
mod gaps;
mod growth_bands;
mod quasi_steady;
mod reference_onsets;
mod routes;
