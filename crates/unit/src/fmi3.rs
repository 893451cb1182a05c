//! The FMI 3.0 shell around the same instance. The contract is that of [`super::fmi2`]; a status has the same numbers.
//!
//! There are no clocks and no events of our own: functions for them answer with an error and leave the run alone.

/// Functions that are those of FMI 2.0 under another name: arguments behind the handle, and what is passed on of them.
macro_rules! as_in_fmi2 {
    ($($(#[$text:meta])* $name:ident($($argument:ident: $type:ty),*) => $two:ident($($passed:expr),*);)*) => {$(
        $(#[$text])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            c: $crate::fmi2::types::fmi2Component
            $(, $argument: $type)*
        ) -> $crate::fmi2::types::fmi2Status {
            // SAFETY: by the contract of the interface
            unsafe { $crate::fmi2::$two(c $(, $passed)*) }
        }
    )*};
}

mod absent;
mod life;
mod states;
mod stepping;
mod structure;
#[cfg(test)]
mod tests;
mod values;

pub use crate::fmi2::logger::PlainLogger;
pub use absent::*;
pub use life::*;
pub use states::*;
pub use stepping::*;
pub use structure::*;
pub use values::*;

/// Truth value of C: any byte but zero is true.
pub(crate) type Fmi3Boolean = u8;
