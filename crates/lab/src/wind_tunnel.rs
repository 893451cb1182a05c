//! Forced-vibration records: what they are, reading and writing them, and a virtual tunnel that makes them.

mod broadband;
pub mod campaign;
pub mod processing;
mod raw;
mod record_file;
mod record_format;
mod records;
mod tunnel_plan;
pub mod virtual_campaign;
mod virtual_forces;
mod virtual_tunnel;

pub(crate) use raw::CELL_CHANNELS;
pub use raw::{LoadCell, RawCampaign, RawRecording, RawRun, Rig, RunFinding};
pub(crate) use record_file::SAMPLES_AT_LEAST;
pub use record_file::{read_record, write_record};
pub use record_format::RecordFile;
pub use records::{Record, RecordHeader, RecordSource, Segment};
pub use tunnel_plan::{TrainingMotion, TunnelPlan};
pub use virtual_forces::predicted_forces;
