//! Whole bridges: figures, files, gusts, buffeting, and the same bridge described in two ways.

#![cfg(feature = "cli")]

#[path = "../common/bridges.rs"]
mod bridges;
#[path = "../common/matlab.rs"]
mod matlab;

mod buffeting;
mod files;
mod gusts;
mod identities;
mod published;
mod stated;
