//! Buffeting: the response of the coupled section to turbulence, in the frequency and in the time domain.
//!
//! Spectra are one-sided over frequency in Hz, `σ² = ∫₀^∞ S df`. The components `u` (along) and `w` (vertical) of the
//! turbulence are independent. Admittances multiply the amplitude of the gust force; spectra are multiplied by their
//! square modulus. Forces and motion of a section are fully correlated along its length; those of a whole bridge (`span`) as the
//! coherence of the turbulence says.

mod admittance;
mod frequency;
mod problem;
mod quadrature;
mod span;
mod spectrum;
mod stability;
mod synthesis;
mod time;

pub use admittance::Admittance;
pub use frequency::BuffetingResponse;
pub(crate) use frequency::{buffeting_response, response_spectrum};
pub(crate) use problem::{BuffetingProblem, GustForces};
pub use problem::{Gust, Turbulence};
pub use span::{
    Coherence, SpanEnsemble, SpanPlan, SpanProblem, SpanRecord, SpanResponse, SpanSpectra,
    TurbulenceField, span_record, turbulence_field,
};
pub(crate) use span::{ModalCovariance, SpanFrequency, peak_factor, span_ensemble};
pub use spectrum::{GustComponent, GustSpectrum, SpectrumFormula, SpectrumShape};
pub(crate) use stability::unstable_roots;
pub(crate) use synthesis::synthesise;
pub use time::{ComponentComparison, Ensemble, compare};
pub(crate) use time::{TimePlan, time_ensemble};
