//! Exported units: their description, what they calculate and answer, and our own importer of any FMU.

#[path = "../common/bridges.rs"]
#[allow(dead_code)] // each room needs a part of it
mod bridges;
#[path = "../common/matrix.rs"]
#[allow(dead_code)] // each room needs a part of it
mod matrix;
#[path = "../common/matrix_fmus.rs"]
mod matrix_fmus;
#[path = "../common/models.rs"]
mod models;
#[path = "../common/patchwork.rs"]
mod patchwork;
#[path = "../common/three_dof.rs"]
mod three_dof;
#[path = "../common/trained.rs"]
mod trained;

mod beside_a_structure;
mod bridge;
mod calculated_onset;
mod dampers;
mod dependencies;
mod description;
mod importer;
mod manual;
mod one_row;
mod parts;
mod replay;
mod stepped_answers;
