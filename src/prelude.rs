//! The names of a usual session: `use aerodeck::prelude::*;`. Thirty of them, each with an example.

pub use crate::aerodynamics::derivatives::{DerivativeTable, Extrapolation, InterpolatedTable};
pub use crate::aerodynamics::{FlatPlate, RationalModel, Transfer};
pub use crate::aeroelastic::CoupledSection;
pub use crate::error::{Error, Result};
pub use crate::files::derivatives::named_table;
pub use crate::flutter::{
    FlutterSearch, Onset, OnsetSearch, determinant_onset, find_onset, trace_modes,
};
pub use crate::fmu::package::{Export, write_fmu};
pub use crate::identification::{Fitted, FrequencyFit, TimeFit, fit};
pub use crate::section::{Dof, SectionModel};
pub use crate::study::Study;
pub use crate::trained_model::{Model, TrainedModel};
pub use crate::units::{ReducedFrequency, ReducedFrequencyRange};
pub use crate::wind_tunnel::TunnelPlan;
