//! Self-excited wind forces on bridge decks: models, coupling, flutter, FMU.
//!
//! Every aerodynamic model is a transfer matrix `q̂(K) = G(K) r̂(K)` and, where it has one, a state-space realisation. A
//! structure is `(M, R, K)`. Their coupling at a wind speed is one linear system; flutter, response and the FMU only
//! ever see that system. So: data → identification → model → coupling → {flutter, response, FMU}.
//!
//! # From a deck to its onset
//!
//! ```
//! use aerodeck::prelude::*;
//!
//! # fn main() -> Result<()> {
//! let table = named_table("LN21-5200", "".as_ref())?; // or "workbook.xlsx"
//! let Fitted { model, report } = fit(&table.samples(&Dof::TWO)[..], &FrequencyFit::default())?;
//!
//! let structure = SectionModel::table_4_1().structure()?;
//! let section = CoupledSection::with_model(&structure, &model)?;
//! let search = OnsetSearch { speed_max_m_s: 60.0, ..OnsetSearch::default() };
//! let found = find_onset("LN21-5200", &section, &search, Some(report.tested_range))?;
//!
//! let onset = found.onset().expect("this deck flutters");
//! assert!((onset.at.speed_m_s - 36.92).abs() < 0.01);
//! assert!(onset.headline().ends_with("inside the tested range"));
//! # Ok(())
//! # }
//! ```
//!
//! # Conventions
//!
//! | quantity | symbol | convention | unit |
//! |---|---|---|---|
//! | deck width | `B` | full width; semi-chord `b = B/2` | m |
//! | vertical displacement, lift | `y`, `F_y` | positive up | m, N/m |
//! | lateral displacement, drag | `x`, `F_x` | positive downwind | m, N/m |
//! | rotation, moment | `θ`, `M` | positive nose-up (windward edge up) | rad, N·m/m |
//! | forces | | per unit length of span | |
//! | dimensionless time | `s` | `V t / B` | – |
//! | reduced frequency | `K` | `ωB/V`; see [`units`] for `k`, `V̂`, `V*` | – |
//! | dimensionless motion | `r` | `(y/B, x/B, θ)`, in this order everywhere | – |
//! | dimensionless force | `q` | `F/(½ρV²B)`, `M/(½ρV²B²)` | – |
//!
//! # Map
//!
//! [`plausibility`] judges what is given, [`aerodynamics`] holds the force models, [`section`] the structure, [`bridge`] the modes of a whole one, [`aeroelastic`] their coupling, [`flutter`] modes and
//! onsets, [`response`] the exact steps, [`trained_model`] what is saved, [`fmu`] the co-simulation slave with its
//! packing and importer. `wind_tunnel` leads from load cells to records, `identification` from records and tables to
//! derivatives and models, `uncertainty` from their scatter, and that of the section, to intervals, `selection` to one model among many;
//! `files` reads and writes tables, `comparison` compares time histories, `buffeting` adds gusts. `study` runs the
//! whole chain, `report` draws it, [`live`] answers its sliders and `cli` is the program.
// the program in the README is compiled and run with the tests
#![cfg_attr(doctest, doc = include_str!("../README.md"))]
#![deny(unsafe_code, missing_docs)]
// what is public can be reached from outside
#![deny(unreachable_pub)]
// the process is the caller's: no abrupt end, and no word on its terminal
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::todo,
        clippy::unimplemented,
        clippy::unreachable,
        clippy::print_stdout,
        clippy::print_stderr,
        clippy::dbg_macro
    )
)]

#[allow(clippy::print_stdout, clippy::print_stderr)]
pub mod cli;
pub mod fmu;
pub mod prelude;
pub mod reference;
pub mod report;
pub mod study;

#[cfg(test)]
mod tests;

pub use aerodeck_buffeting::buffeting;
pub use aerodeck_fit::{comparison, identification, numbered, selection, uncertainty};
pub use aerodeck_lab::{files, wind_tunnel};
pub use aerodeck_live as live;
pub use aerodeck_signal::signal;

pub use aerodeck_core::{
    Error, Result, aerodynamics, aeroelastic, bridge, error, flutter, json, response, section,
    state_space, trained_model, units,
};
pub use aerodeck_judgement::{plausibility, verdict};
