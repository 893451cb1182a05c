//! The FMI 2.0 shell around the neutral instance: C types, exports, guard, logger.

/// Categories of log messages with their descriptions, under the names of the standard.
pub const LOG_CATEGORIES: [(&str, &str); 6] = [
    (
        "logEvents",
        "Instantiation, initialisation, changed parameters, onset search",
    ),
    (
        "logStatusWarning",
        "Something unexpected that does not stop the run",
    ),
    (
        "logStatusDiscard",
        "A value or a step that was refused; everything is as it was before",
    ),
    (
        "logStatusError",
        "A call that failed; the instance has to be reset or set back to a saved state",
    ),
    (
        "logStatusFatal",
        "A defect of the program; the instance cannot be used any more",
    ),
    ("logAll", "Everything"),
];
