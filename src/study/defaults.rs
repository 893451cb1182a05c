//! The study that the demo runs and leaves with the user.

/// Text of the demo's study file.
pub fn demo_study_text() -> &'static str {
    include_str!("demo_study.toml")
}

/// Text of the study that repeats the thesis's headline.
pub(crate) fn thesis_study_text() -> &'static str {
    include_str!("thesis_study.toml")
}
