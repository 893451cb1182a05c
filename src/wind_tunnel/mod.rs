//! Forced-vibration records: what they are, reading and writing them, and a virtual tunnel that makes them.

mod records;

pub use records::{Record, RecordBlock, RecordHeader, RecordSource, Segment};
