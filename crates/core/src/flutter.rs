//! Flutter: modes tracked over wind speed, onset, divergence.
//!
//! Three independent routes: eigenvalues of the coupled state matrix (for models with a realisation); the
//! determinant in `(V, ω)` and the p-k iteration (for any `G(K)`, tables and the flat plate included).

mod answer;
mod characteristic;
mod clusters;
mod columns;
mod critical;
mod critical_point;
mod curves;
mod determinant;
mod divergence;
mod dynamic_stiffness;
mod elimination;
mod following;
mod growth_band;
mod instability;
mod judged;
mod missed;
mod modal_characteristic;
mod mode_words;
mod nearby_onset;
mod onset;
mod pk;
mod pk_following;
mod present_modes;
mod quasi_pk;
mod quasi_steady;
mod scan;
mod search;
mod still_air;
mod sweep;
mod tracking;
mod unwanted;

pub use answer::{FlutterSearch, UnstableStart};
pub use critical_point::{CriticalPoint, OnsetMethod};
pub use curves::{FlutterCurves, ModeBranch, ModePoint, trace_modes, trace_modes_watched};
pub use determinant::table_tested_from;
pub use determinant::{determinant_onset, impedance};
pub use divergence::{AssumedAtRest, static_part};
pub use divergence::{divergence_by_eigenvalues, divergence_speed, divergence_with_forces};
pub use elimination::{pivots, solve_complex};
pub use growth_band::GrowthBand;
pub use instability::{Instability, ModeAtOnset, Participation, classify};
pub use judged::{FastMotion, MovedOnset, StableRange, TestedFrom};
pub use judged::{bridge_damps_fast_motion, damps_fast_motion};
pub use mode_words::the_mode;
pub use nearby_onset::{NearbyOnset, modal_shape};
pub use onset::shown_m_s;
pub use onset::{BetweenSpeeds, ErrorInterval, ErrorParts, ModeRatio, Onset, OnsetInterval};
pub use pk::{pk_curves, pk_onset, quasi_pk_mode};
pub use present_modes::{LeastDamping, smallest_damping};
pub use quasi_steady::quasi_steady_modes;
pub use quasi_steady::{QuasiSteadyOnset, quasi_steady_onset};
pub use scan::growth_scan;
pub use search::{OnsetSearch, find_onset};
pub use search::{curve_speeds_m_s, find_onset_of_modes, judged_speeds, left_tests};
pub use still_air::aliased_below;
pub use sweep::at_samples;
pub use sweep::stands_at_samples;
pub use sweep::{LinearForces, OnsetSweep, SweepOutcome, SweptOnset};
pub use unwanted::{UnwantedGrowth, unwanted_growth, unwanted_growth_below};
