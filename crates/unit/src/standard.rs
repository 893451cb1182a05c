//! Versions of the FMI standard, and its words that describe a variable, as both the exported description and the importer use them.

/// Version of the standard; the runtime speaks all of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FmiVersion {
    /// FMI 2.0.
    #[default]
    Two,
    /// FMI 3.0.
    Three,
}

/// Whether XML 1.0, and with it a description, can hold a character.
pub fn is_printable(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r' | '\u{20}'..='\u{D7FF}' | '\u{E000}'..='\u{FFFD}' | '\u{10000}'..)
}

/// A text without the characters that a description cannot hold.
pub fn printable(text: &str) -> String {
    text.chars().filter(|c| is_printable(*c)).collect()
}

/// Words in their order, those that come again left out.
pub fn each_once<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let mut all: Vec<&str> = Vec::new();
    for word in words {
        if !all.contains(&word) {
            all.push(word);
        }
    }
    all.join("; ")
}

/// Role of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Causality {
    /// Set by the user, constant during a run unless tunable.
    Parameter,
    /// Computed from parameters.
    CalculatedParameter,
    /// Comes from outside.
    Input,
    /// Goes outside.
    Output,
    /// Inside only.
    Local,
    /// Time.
    Independent,
}

/// When a variable may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Variability {
    /// Never.
    Constant,
    /// Not after initialisation.
    Fixed,
    /// Between communication points, by the user.
    Tunable,
    /// At events or communication points.
    Discrete,
    /// Always.
    Continuous,
}

/// How a variable gets its first value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Initial {
    /// It is the start value.
    Exact,
    /// An iteration begins at the start value.
    Approx,
    /// From other variables.
    Calculated,
}

/// A word of the standard and what it means.
pub trait FmiTerm: Copy + PartialEq + 'static {
    /// All words.
    const ALL: &'static [(&'static str, Self)];

    /// The word.
    fn word(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, meaning)| *meaning == self);
        found.map_or("", |(word, _)| word)
    }
}

impl FmiTerm for Causality {
    const ALL: &'static [(&'static str, Self)] = &[
        ("parameter", Self::Parameter),
        ("calculatedParameter", Self::CalculatedParameter),
        ("input", Self::Input),
        ("output", Self::Output),
        ("local", Self::Local),
        ("independent", Self::Independent),
    ];
}

impl FmiTerm for Variability {
    const ALL: &'static [(&'static str, Self)] = &[
        ("constant", Self::Constant),
        ("fixed", Self::Fixed),
        ("tunable", Self::Tunable),
        ("discrete", Self::Discrete),
        ("continuous", Self::Continuous),
    ];
}

impl FmiTerm for Initial {
    const ALL: &'static [(&'static str, Self)] = &[
        ("exact", Self::Exact),
        ("approx", Self::Approx),
        ("calculated", Self::Calculated),
    ];
}
