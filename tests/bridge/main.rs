//! Whole bridges: figures, files, gusts, buffeting, and the same bridge described in two ways.

#[path = "../common/bridges.rs"]
mod bridges;
#[path = "../common/matlab.rs"]
mod matlab;

mod buffeting;
mod damper_blocks;
mod dampers;
mod files;
mod gusts;
mod identities;
mod like_modes;
mod plausibility;
mod published;
mod refused;
mod shapes;
mod stated;
