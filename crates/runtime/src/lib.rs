//! The shared library that every FMU holds: the C interfaces of `aerodeck-unit`, and nothing else.

// its functions are exported by their names alone
extern crate aerodeck_unit;
