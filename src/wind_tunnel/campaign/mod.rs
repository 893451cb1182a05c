//! The campaign file: one TOML file that says what was tested, on which rig, in which air, and where the samples are.
//!
//! `docs/campaigns.md` has a complete example. [`Campaign::read`] reads and checks the file itself,
//! [`Campaign::load`] the recordings it names; what does not stop reading is a list of [`Finding`]s.

mod air;
mod channel_map;
mod file;
mod findings;
mod load;
mod ntnu;
mod quantity;
mod recording;
mod section_forces;
mod write;

pub use air::Air;
pub use channel_map::{ChannelMap, ChannelRef};
pub use file::{
    CAMPAIGN_SCHEMA, Campaign, FileRef, RecordingBlock, RecordingLayout, RunBlock, SectionBlock,
};
pub use findings::Finding;
pub use load::{CampaignReading, RecordingSummary, RunSummary};
pub use quantity::Quantity;
pub use section_forces::SectionForces;
pub use write::{FileFormat, write_virtual_campaign};

#[cfg(test)]
mod tests;
#[cfg(test)]
mod write_tests;
