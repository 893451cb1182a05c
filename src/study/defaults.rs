//! The studies that come with the program, as text.

use crate::files::derivatives::StatedConvention;

/// Text of the demo's study file.
pub fn demo_study_text() -> &'static str {
    include_str!("demo_study.toml")
}

/// Text of the study that repeats the thesis's headline.
pub(crate) fn thesis_study_text() -> &'static str {
    include_str!("thesis_study.toml")
}

/// Text of a new study of `source`: an embedded deck, the flat plate, or a table; with a comment at every key that is
/// left out most often.
pub(crate) fn new_study_text(source: &str, convention: &StatedConvention) -> String {
    let name = source.rsplit('/').next().unwrap_or(source);
    let stated = [
        convention
            .notation
            .map(|n| format!("notation = \"{}\"", n.name())),
        convention
            .argument
            .map(|a| format!("argument = \"{}\"", a.name())),
        convention.axes.map(|a| format!("axes = \"{}\"", a.name())),
    ];
    let stated: Vec<String> = stated.into_iter().flatten().collect();
    let line = match stated.is_empty() {
        true => String::new(),
        false => format!("convention = {{ {} }}\n", stated.join(", ")),
    };
    include_str!("new_study.toml")
        .replace(
            "source = \"{source}\"\n",
            &format!("source = \"{{source}}\"\n{line}"),
        )
        .replace("{name}", &escaped(name))
        .replace("{source}", &escaped(source))
}

/// For a text between quotation marks in TOML.
fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;

    /// Comments say what is so: with every commented key switched on the study is the same.
    #[test]
    fn commented_keys_are_the_defaults() {
        let text = new_study_text("LN21-5200", &StatedConvention::default());
        let plain = Study::from_toml(&text, "".into()).unwrap();
        let on: Vec<&str> = text
            .lines()
            .map(|l| l.strip_prefix("#: ").unwrap_or(l))
            .collect();
        let all = Study::from_toml(&on.join("\n"), "".into()).unwrap();
        assert_eq!(plain, all);
        // otherwise nothing has been switched on
        assert!(text.lines().filter(|l| l.starts_with("#: ")).count() > 10);
    }
}
