//! Formulas of the documentation as MathML, which browsers show without a script or network, and no links out of the book: the
//! preprocessor that `docs/book.toml` names. mdBook gives it the book as JSON and takes it back.
//!
//!     mdbook build docs        # the book stands in target/book

use pulldown_latex::config::{DisplayMode, RenderConfig};
use pulldown_latex::{Event, Parser, ParserError, Storage, push_mathml};
use serde_json::Value;

/// Opens a block of LaTeX in a page, as GitHub reads it.
const FENCE: &str = "```math\n";

/// The page with its blocks of LaTeX as MathML.
///
/// # Errors
/// The formula that is no LaTeX, and why.
pub fn converted(page: &str) -> Result<String, String> {
    let mut parts = page.split(FENCE);
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (formula, rest) = part
            .split_once("```")
            .ok_or_else(|| format!("a formula without an end: {part}"))?;
        let formula = formula.trim();
        let math = mathml(formula).map_err(|why| format!("{why} in\n{formula}"))?;
        // a page is pushed aside with a finger where a formula is wider
        text.push_str(&format!(
            "<div class=\"table-wrapper\">{math}</div>\n{rest}"
        ));
    }
    Ok(text)
}

fn mathml(formula: &str) -> Result<String, String> {
    let storage = Storage::new();
    let events: Result<Vec<Event<'_>>, _> = Parser::new(formula, &storage).collect();
    let events = events.map_err(|e| e.to_string())?;
    let config = RenderConfig {
        display_mode: DisplayMode::Block,
        ..RenderConfig::default()
    };
    let mut text = String::new();
    push_mathml(
        &mut text,
        events.into_iter().map(Ok::<_, ParserError>),
        config,
    )
    .map_err(|e| e.to_string())?;
    // as text of a page
    Ok(text.replace("<mo><</mo>", "<mo>&lt;</mo>"))
}

/// The page, which stands in the top folder of the book, with the words alone of links that lead out of the book.
fn kept_inside(page: &str) -> String {
    let mut text = page.to_owned();
    while let Some(at) = text.find("](../") {
        let (Some(start), Some(end)) = (text[..at].rfind('['), text[at..].find(')')) else {
            break;
        };
        let words = text[start + 1..at].to_owned();
        text.replace_range(start..=at + end, &words);
    }
    text
}

/// Every page in the book, however deep.
fn convert_all(book: &mut Value) -> Result<(), String> {
    match book {
        Value::Object(fields) => {
            let path = fields.get("path").and_then(Value::as_str);
            let on_top = path.is_some_and(|p| !p.contains('/'));
            for (key, value) in fields {
                match value {
                    Value::String(page) if key == "content" => {
                        *page = converted(page)?;
                        if on_top {
                            *page = kept_inside(page);
                        }
                    }
                    other => convert_all(other)?,
                }
            }
            Ok(())
        }
        Value::Array(items) => items.iter_mut().try_for_each(convert_all),
        _ => Ok(()),
    }
}

#[allow(dead_code)] // the tests take the conversion alone
fn main() -> Result<(), String> {
    // `supports RENDERER`: all are
    if std::env::args().nth(1).is_some() {
        return Ok(());
    }
    let given: Vec<Value> = serde_json::from_reader(std::io::stdin()).map_err(|e| e.to_string())?;
    let mut book = given.into_iter().nth(1).ok_or("no book was given")?;
    convert_all(&mut book)?;
    println!("{book}");
    Ok(())
}
