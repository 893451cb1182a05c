//! The FMI 2.0 shell around the neutral instance: C types, exports, guard, logger.
//!
//! # The contract of the C interface
//! - Every function may be called with a NULL instance and answers `fmi2Error`.
//! - Arrays of no elements may be NULL; any other NULL is an error with a logged reason, never a crash.
//! - A handle belongs to the library that made it, is used by one thread at a time and not after `fmi2FreeInstance`.
//!   Different instances may be used by different threads at the same time.
//! - No panic crosses the boundary, see `guard`.
//! - `fmi2Error` ends the run: a reset or a saved state leads out. Functions that are not offered answer it without
//!   touching the run. `fmi2Discard` means that everything is as it was.
//! - Texts that are returned live as long as the instance.

mod exports_common;
mod exports_state;
mod exports_stepping;
mod exports_variables;
pub(crate) mod guard;
pub(crate) mod logger;
#[cfg(test)]
mod tests;
pub mod types;

pub use exports_common::*;
pub use exports_state::*;
pub use exports_stepping::*;
pub use exports_variables::*;

// glibc 2.35 gave `hypot` a new version of its symbol for the same numbers. Every call of a shared library that this crate is part of goes
// to the first one (`--wrap` in the build script of `aerodeck-runtime`), so that a native build runs wherever the standard library does.
#[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
std::arch::global_asm!(
    ".symver first_hypot, hypot@GLIBC_2.2.5",
    ".globl __wrap_hypot",
    "__wrap_hypot: jmp first_hypot@PLT",
);
