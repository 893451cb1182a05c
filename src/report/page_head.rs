//! The verdict at the head of a page, what stands at the edges of a printed one, and the list of what is in it.

use super::vocabulary::outcome_colour;
use crate::error::{Error, Result};
use crate::files::report_block::ReportBlock;
use crate::verdict::{Doubt, Outcome, Severity, Verdict};
use askama::Template;
use std::fmt::Write as _;

/// Where the list of contents goes.
const CONTENTS: &str = "<!-- contents -->";
const HEADING: &str = "<h2>";

/// Class of the card of a verdict; nothing where nothing is required.
pub(super) fn class(of: &Verdict) -> &'static str {
    match of.outcome {
        Some(Outcome::Met) => "met",
        Some(Outcome::NotMet { .. }) => "not-met",
        Some(Outcome::CannotBeJudged { .. }) => "open",
        None => "",
    }
}

/// Colour of the line that marks the required speed.
pub(super) fn required_colour(of: &Verdict) -> &'static str {
    of.outcome.as_ref().map_or("#000", outcome_colour)
}

/// The doubts with which nothing is met, or those that are to be known.
pub(super) fn doubts(of: &Verdict, severity: Severity) -> Vec<&Doubt> {
    let all = of.doubts.iter();
    all.filter(|d| d.severity == severity).collect()
}

/// `text` with a capital first letter.
pub(super) fn capital(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|c| c.to_uppercase().to_string());
    first.unwrap_or_default() + characters.as_str()
}

/// Name and value of what is stated.
pub(super) fn stated(of: &ReportBlock) -> Vec<(&'static str, &str)> {
    let all = [
        ("project", &of.project),
        ("author", &of.author),
        ("revision", &of.revision),
        ("date", &of.date),
    ];
    let stated = all.into_iter();
    let stated = stated.filter_map(|(name, value)| Some((name, value.as_deref()?)));
    stated.collect()
}

/// The rule for printed pages: project and revision above, author, date, program and number of the page below.
pub(super) fn at_edges(of: &ReportBlock, title: &str, generator: &str) -> String {
    let text = |parts: &[Option<String>]| {
        let parts: Vec<&str> = parts.iter().flatten().map(String::as_str).collect();
        quoted(&parts.join(" · "))
    };
    let named = |name: &str, of: &Option<String>| of.as_ref().map(|of| format!("{name} {of}"));
    let project = of.project.clone().filter(|p| p != title);
    format!(
        "@page {{ @top-left {{ content: {}; }} @top-right {{ content: {}; white-space: nowrap; }} @bottom-left {{ content: {}; }} }}",
        text(&[project, Some(title.to_owned())]),
        text(&[named("revision", &of.revision), of.date.clone()]),
        text(&[of.author.clone(), Some(generator.to_owned())]),
    )
}

/// A string of CSS that may stand in a page: what could end the string or its element is written as a number.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        let _ = match c {
            '"' | '\\' | '<' | '>' | '&' => write!(quoted, "\\{:x} ", u32::from(c)),
            c if c.is_control() => write!(quoted, " "),
            c => write!(quoted, "{c}"),
        };
    }
    quoted + "\""
}

/// A page as HTML text, with its list of contents; the same page always gives the same bytes.
pub(crate) fn rendered(page: &impl Template) -> Result<String> {
    let text = page.render();
    let text = text.map_err(|e| Error::Numerical(format!("report: {e}")))?;
    Ok(with_contents(&text))
}

/// The page with a name for every heading and the list of them where it is wanted; texts of users hold no `<`.
fn with_contents(page: &str) -> String {
    let mut parts = page.split(HEADING);
    let mut whole = parts.next().unwrap_or_default().to_owned();
    let mut list = String::new();
    for (i, part) in parts.enumerate() {
        let title = part.split("</h2>").next().unwrap_or_default();
        let _ = write!(list, "<li><a href=\"#part-{i}\">{title}</a></li>");
        let _ = write!(whole, "<h2 id=\"part-{i}\">{part}");
    }
    let list = format!("<nav><ol>{list}</ol></nav>");
    whole.replace(CONTENTS, &list)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_ends_no_string_and_no_element() {
        let of = ReportBlock {
            project: Some("a\"; } </style>\\".to_owned()),
            revision: Some("B".to_owned()),
            ..ReportBlock::default()
        };
        let css = at_edges(&of, "deck", "aerodeck 1");
        assert!(
            css.contains(r#""a\22 ; } \3c /style\3e \5c  · deck""#),
            "{css}"
        );
        assert!(
            css.contains("\"revision B\"") && !css.contains("</"),
            "{css}"
        );
    }

    #[test]
    fn every_heading_is_in_the_list() {
        let page = with_contents("<!-- contents --><h2>One</h2>1<h2>Two</h2>2");
        let expected = "<nav><ol><li><a href=\"#part-0\">One</a></li><li><a href=\"#part-1\">Two</a></li></ol></nav>\
                        <h2 id=\"part-0\">One</h2>1<h2 id=\"part-1\">Two</h2>2";
        assert_eq!(page, expected);
    }
}
