//! Buffeting: the response of a section or of a whole bridge to turbulence, in the frequency and in the time domain.
//!
//! Spectra are one-sided over frequency in Hz, `σ² = ∫₀^∞ S df`. The components `u` (along) and `w` (vertical) of the
//! turbulence are independent. Admittances multiply the amplitude of the gust force; spectra are multiplied by their
//! square modulus. Forces at the nodes of a bridge are correlated as the coherence of the turbulence says; a section is one node.

mod admittance;
mod coherence;
mod covariance;
mod frequency;
mod periodic;
mod problem;
mod quadrature;
mod quasi_steady;
mod response;
mod spectrum;
mod stability;
mod synthesis;
mod time;

pub use crate::aerodynamics::GustComponent;
pub use admittance::Admittance;
pub use coherence::Coherence;
pub use covariance::rms_of;
pub use frequency::FrequencyDomain;
pub use periodic::span_ensemble;
pub use periodic::{SpanEnsemble, SpanPlan, SpanRecord, span_record};
pub use problem::{BuffetingProblem, Gust, Turbulence};
pub use quasi_steady::{NonlinearRun, NonlinearSection, largest_difference};
pub use response::{BuffetingResponse, SpanResponse, SpectrumCurve};
pub use response::{part, peak_factor};
pub use spectrum::{GustSpectrum, SpectrumFormula, SpectrumShape};
pub use synthesis::turbulence_field;
pub use time::{ComponentComparison, Ensemble, compare};
pub use time::{TimePlan, check_plan, time_ensemble};
