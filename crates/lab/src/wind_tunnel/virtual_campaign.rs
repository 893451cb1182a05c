//! A virtual raw campaign: what two load cells would say of a known deck, and the truth behind it.
//!
//! A run is one motion at one speed, as in [`TunnelPlan`]: a recording in wind and one of the same motion in still
//! air. The model is a rigid body of span `L`; about its centre of rotation, which moves with heave and sway, it
//! pushes on the rig with (equation 3.1 of the thesis)
//!
//! | part | force | moment |
//! |---|---|---|
//! | gravity | `m L g` down | `r × F`, `r` from the centre of rotation to that of gravity, turning with the model |
//! | inertia | `−m L (a + α × r + ω × (ω × r))` | `r × F − J L α` |
//! | static wind | `½ρV²BL (C_D, C_L)` | `½ρV²B²L C_M` |
//! | buffeting | quasi-steady, of the gusts `u`, `w` | likewise |
//! | self-excited | those of [`TunnelPlan`] times `L` | likewise |
//!
//! Two cells share the sum. Clamping adds equal and opposite forces and moments. What a cell says is turned into its
//! own axes, with noise, drift and spikes on top. The air at rest is taken to be without mass: still-air runs hold
//! gravity and inertia only, so that in wind minus still air is the self-excited force as the truth has it. (In a real
//! tunnel the subtraction also takes the added mass of the air away.)

mod forces;
mod make;
mod plan;

pub use make::VirtualCampaign;
pub use plan::{
    AppliedDisturbances, AppliedSpike, Disturbances, ModelBody, Spike, StaticWind, Support,
    TruthPoint, TunnelTurbulence, VirtualCampaignPlan,
};

#[cfg(doc)]
use super::TunnelPlan;

#[cfg(test)]
mod tests;
