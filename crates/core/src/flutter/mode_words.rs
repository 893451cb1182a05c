//! How modes are called.

/// The name of a branch as one says it: "torsion mode", "mode 17".
pub(super) fn mode_in_words(branch: &str) -> String {
    match branch.starts_with("mode ") {
        true => branch.to_owned(),
        false => format!("{branch} mode"),
    }
}

/// The same in a sentence: "the torsion mode", "mode 17".
pub fn the_mode(branch: &str) -> String {
    match branch.starts_with("mode ") {
        true => branch.to_owned(),
        false => format!("the {branch} mode"),
    }
}
