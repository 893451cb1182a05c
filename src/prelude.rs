//! The names of a usual session: `use aerodeck::prelude::*;`.

pub use crate::aerodynamics::derivatives::{DerivativeTable, Extrapolation, InterpolatedTable};
pub use crate::aerodynamics::{FlatPlate, LaguerreModel, RationalModel, Realizable, Transfer};
pub use crate::aeroelastic::CoupledSection;
pub use crate::error::{Error, Result};
pub use crate::flutter::{
    FlutterSearch, Onset, OnsetSearch, determinant_onset, divergence_speed, find_onset, pk_onset,
    trace_modes,
};
pub use crate::section::{Dof, SectionModel, Structure};
pub use crate::state_space::{Continuous, Damping, Discrete, StateSpace};
pub use crate::trained_model::{Model, TrainedModel};
pub use crate::units::{ReducedFrequency, ReducedFrequencyRange};

pub use crate::{
    files::derivatives::{named_table, read_table},
    fmu::package::{GrowthPolicy, write_fmu},
    identification::{Fitted, Form, FrequencyFit, TimeFit, fit_records, fit_table},
    study::Study,
    wind_tunnel::{Record, TunnelPlan},
};
