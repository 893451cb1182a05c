//! Flutter: modes tracked over wind speed, onset, divergence.
//!
//! Two independent routes: eigenvalues of the coupled state matrix (for models with a realisation), and the
//! determinant in `(V, ω)` (for any `G(K)`, tables and the flat plate included).

mod characteristic;
mod curves;
mod determinant;
mod divergence;
mod onset;
mod quasi_pk;
mod search;
mod tracking;

pub use curves::{FlutterCurves, ModeBranch, ModePoint, trace_modes};
pub use determinant::{determinant_onset, impedance};
pub use divergence::divergence_speed;
pub use onset::{FlutterSearch, Onset, OnsetInterval, OnsetMethod};
pub use quasi_pk::quasi_pk_mode;
pub use search::{OnsetSearch, find_onset};
