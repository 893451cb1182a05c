//! The campaign file: one TOML file that says what was tested, on which rig, in which air, and where the samples are.
//!
//! `docs/campaigns.md` has a complete example. `Campaign::read` reads and checks the file itself,
//! `Campaign::load` the recordings it names; what does not stop reading is a list of findings.

mod air;
mod channel;
mod channel_map;
mod file;
mod findings;
mod load;
mod ntnu;
mod quantity;
mod recording;
mod section_forces;
mod write;

pub(crate) use file::Campaign;
pub(crate) use load::{CampaignReading, RecordingSummary};
pub use load::{LoadedCampaign, read_campaign};
pub(crate) use write::{FileFormat, write_virtual_campaign};

#[cfg(test)]
mod tests;
