//! The shared library that every FMU holds: the C interfaces of `aerodeck-unit`, and nothing else.

// its functions are exported by their names alone
extern crate aerodeck_unit;

// glibc 2.35 gave `hypot` a new version of its symbol for the same numbers. Every call goes to the first one (`--wrap` in build.rs), so
// that a native build runs wherever the standard library does.
#[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
std::arch::global_asm!(
    ".symver first_hypot, hypot@GLIBC_2.2.5",
    ".globl __wrap_hypot",
    "__wrap_hypot: jmp first_hypot@PLT",
);
