//! The commands: what they print and write, and what they refuse.

#[path = "../common/bridges.rs"]
#[allow(dead_code)] // each room needs a part of it
mod bridges;
#[path = "../common/browser.rs"]
mod browser;
#[path = "../common/command.rs"]
mod command;

#[path = "../common/girders.rs"]
mod girders;

mod bridge;
mod campaign;
mod compare;
mod derivatives;
#[cfg(unix)]
mod faults;
mod flags;
mod formats;
mod implausible;
mod names;
mod newcomer;
mod onsets;
mod printed;
mod process;
mod replay;
mod report;
mod required_speeds;
mod schemas;
mod select;
mod simulate;
mod templates;
mod turbulence;
mod verdicts;
mod wind;
