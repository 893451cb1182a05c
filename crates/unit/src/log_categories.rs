//! Categories of log messages, for the description and for the logger.

/// Categories of log messages with their descriptions, under the names of the standard.
pub const LOG_CATEGORIES: [(&str, &str); 6] = [
    ("logEvents", "Instantiation, initialisation, reset"),
    (
        "logStatusWarning",
        "Something unexpected that does not stop the run, such as an onset outside the tested range",
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
