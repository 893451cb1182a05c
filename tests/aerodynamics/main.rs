//! Force models and tables of derivatives through the whole chain.

#[path = "../common/command.rs"]
mod command;
#[allow(dead_code)] // each room needs a part of it
#[path = "../common/matrix.rs"]
mod matrix;
#[path = "../common/three_dof.rs"]
mod three_dof;

mod notation;
mod plausibility;
mod quasi_steady;
mod tables;
mod three_motions;
