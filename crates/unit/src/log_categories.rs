//! Categories of log messages, for the description and for the logger.

use std::ffi::CStr;

/// Categories of log messages with their descriptions, under the names of the standard.
pub const LOG_CATEGORIES: [(&CStr, &str); 6] = [
    (c"logEvents", "Instantiation, initialisation, reset"),
    (
        c"logStatusWarning",
        "Something unexpected that does not stop the run, such as an onset outside the tested range",
    ),
    (
        c"logStatusDiscard",
        "A value or a step that was refused; everything is as it was before",
    ),
    (
        c"logStatusError",
        "A call that failed; the instance has to be reset or set back to a saved state",
    ),
    (
        c"logStatusFatal",
        "A defect of the program; the instance cannot be used any more",
    ),
    (c"logAll", "Everything"),
];
