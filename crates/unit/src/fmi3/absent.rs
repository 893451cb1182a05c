//! Functions for what there is not: clocks, event mode of co-simulation.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use crate::fmi2::guard::not_offered;
use crate::fmi2::types::{fmi2Component, fmi2Status, fmi2ValueReference};

const NO_CLOCKS: &str = "there are no clocks";

macro_rules! absent {
    ($($name:ident, $why:expr, ($($argument:ident: $type:ty),*);)*) => {$(
        /// Not offered.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(c: fmi2Component $(, $argument: $type)*) -> fmi2Status {
            $(let _ = $argument;)*
            // SAFETY: by the contract of the interface
            unsafe { not_offered(c, &stringify!($name)["fmi3".len()..], $why) }
        }
    )*};
}

type References = *const fmi2ValueReference;

absent! {
    fmi3EnterStepMode, "co-simulation has no event mode here", ();
    fmi3EvaluateDiscreteStates, "there are no discrete states", ();
    fmi3ActivateModelPartition, "scheduled execution is not offered",
        (clock: fmi2ValueReference, time: f64);
    fmi3GetIntervalDecimal, NO_CLOCKS,
        (vr: References, nvr: usize, intervals: *mut f64, qualifiers: *mut i32);
    fmi3GetIntervalFraction, NO_CLOCKS,
        (vr: References, nvr: usize, counters: *mut u64, resolutions: *mut u64, qualifiers: *mut i32);
    fmi3GetShiftDecimal, NO_CLOCKS, (vr: References, nvr: usize, shifts: *mut f64);
    fmi3GetShiftFraction, NO_CLOCKS,
        (vr: References, nvr: usize, counters: *mut u64, resolutions: *mut u64);
    fmi3SetIntervalDecimal, NO_CLOCKS, (vr: References, nvr: usize, intervals: *const f64);
    fmi3SetIntervalFraction, NO_CLOCKS,
        (vr: References, nvr: usize, counters: *const u64, resolutions: *const u64);
    fmi3SetShiftDecimal, NO_CLOCKS, (vr: References, nvr: usize, shifts: *const f64);
    fmi3SetShiftFraction, NO_CLOCKS,
        (vr: References, nvr: usize, counters: *const u64, resolutions: *const u64);
}

/// Says that there are no clocks, for a function of another interface.
///
/// # Safety
/// A handle that has not been freed, or NULL.
pub unsafe fn no_clocks(c: fmi2Component, function: &str) -> fmi2Status {
    // SAFETY: by the contract of this function
    unsafe { not_offered(c, function, NO_CLOCKS) }
}
