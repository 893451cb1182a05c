//! The FMI 3.0 shell around the same instance. The contract is that of [`super::fmi2`]; a status has the same numbers.
//!
//! There are no clocks and no events of our own: functions for them answer with an error and leave the run alone.

mod absent;
mod life;
mod model_exchange;
mod states;
mod stepping;
mod structure;
#[cfg(test)]
mod tests;
mod values;

pub use crate::fmi2::logger::PlainLogger;
pub use absent::*;
pub use life::*;
pub use model_exchange::*;
pub use states::*;
pub use stepping::*;
pub use structure::*;
pub use values::*;

/// Truth value of C: any byte but zero is true.
pub(crate) type Fmi3Boolean = u8;
