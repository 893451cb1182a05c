//! The campaign file: one TOML file that says what was tested, on which rig, in which air, and where the samples are.
//!
//! `docs/campaigns.md` has a complete example. `Campaign::read` reads and checks the file itself,
//! `Campaign::load` the recordings it names; what does not stop reading is a list of findings.

mod air;
mod channel;
mod channel_map;
mod file;
mod findings;
mod ntnu;
mod recording;
mod write;

pub use channel_map::{SAME_RATE, sampling_by_time};
pub use file::Campaign;
pub use write::FileFormat;
pub use write::write_virtual_campaign;

#[cfg(test)]
mod tests;
