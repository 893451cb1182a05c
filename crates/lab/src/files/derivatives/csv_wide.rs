//! Tables as laboratories and papers keep them: one row per reduced velocity, one column per derivative.
//!
//! ```text
//! # notation: scanlan
//! v_hat,H1,H2,H3,A1,A2,A3
//! 2.0,-9.1,0.8,13.6,-2.4,-0.6,3.5
//! ```
//!
//! The first row names the columns: derivatives as in the notation, with or without a star; the argument (`v_hat`,
//! `v_star`, `k_full`, `k_semi`, or any name when the argument is stated and one column is left over); `mean_speed_m_s` if
//! it is known. Where several columns hold the argument each derivative has the last one before it. A cell may be empty where a derivative was not measured. Semicolons between the cells, then also decimal
//! commas (in all numbers or in none), and tabs are understood. The `# key: value` lines of the long form may stand above,
//! all of them optional but what states the convention.

use crate::aerodynamics::derivatives::notation::{Argument, Convention, ExpressedPoint, Notation};
use crate::aerodynamics::derivatives::table::{check_point_count, check_points};
use crate::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable};
use crate::error::{Error, Place, Result, counted, ensure, positive};
use crate::files::derivatives::csv_header::{
    ReadOptions, WIDTH_ASSUMED, fill_in, provenance, read_head, stated, width_stated,
};
use crate::files::header_csv::CommentHeader;
use crate::files::header_csv::number;
use crate::files::text::{is_blank, separator};
use std::collections::BTreeMap;

const SPEED: &str = "mean_speed_m_s";

type Points = BTreeMap<Derivative, Vec<DerivativePoint>>;
/// Points of one derivative and the lines they stand on.
pub(super) type Rows = BTreeMap<Derivative, (Vec<DerivativePoint>, Vec<usize>)>;

/// Where the numbers stand, and how they are written.
struct WideColumns<'a> {
    names: Vec<&'a str>,
    /// Those of the argument; a derivative has the last one before it.
    arguments: Vec<usize>,
    speed: Option<usize>,
    derivatives: Vec<(usize, Derivative)>,
    /// Names of columns that mean nothing here.
    others: Vec<String>,
    /// Whether numbers of the file have decimal commas.
    decimal_comma: bool,
}

fn cells(row: &str, separator: char) -> Vec<&str> {
    let bare = |cell: &str| -> usize { cell.len() - cell.trim_start_matches(['"', ' ']).len() };
    row.split(separator)
        .map(|cell| cell[bare(cell)..].trim_end_matches(['"', ' ', '\r']))
        .collect()
}

/// Whether the first row after the header is that of a wide table: no column `derivative`.
pub(super) fn is_wide(text: &str) -> bool {
    let mut rows = text.lines().filter(|l| !l.starts_with('#') && !is_blank(l));
    rows.next()
        .is_some_and(|row| !cells(row, separator(row.as_bytes()).into()).contains(&"derivative"))
}

/// The table in `text`; `stem` names it when the header does not.
///
/// # Errors
/// [`Error::Input`] naming line, column, expectation and finding.
pub(super) fn parse(
    text: &str,
    stem: &str,
    options: &ReadOptions,
) -> Result<(DerivativeTable, Convention)> {
    let text = text.trim_start_matches('\u{feff}');
    let head = read_head(text)?;
    let lines = (1..).zip(text.lines()).skip(head.lines());
    let mut lines = lines.filter(|l| !is_blank(l.1));
    let empty = || Error::input("", "a row of column names", "an empty file");
    let (line, row) = lines.next().ok_or_else(empty)?;
    let between = char::from(separator(row.as_bytes()));
    let names: Vec<&str> = cells(row, between).into_iter().map(without_unit).collect();
    let mut in_file = stated(&head)?;
    let said = options.convention.argument;
    in_file.argument =
        argument_of(&names, said, in_file.argument).map_err(|e| e.at(Place::line(line)))?;
    let convention = options.convention.with_file(in_file)?;
    let mut columns = find_columns(names, line, &convention)?;
    let is_one = |c: &str| c.contains(',') && c.replace(',', ".").parse::<f64>().is_ok();
    let mut numbers = lines.clone().flat_map(|(_, row)| cells(row, between));
    columns.decimal_comma = between != ',' && numbers.any(is_one);
    let mut rows = Rows::new();
    for (line, text) in lines {
        columns.enter(line, &cells(text, between), &convention, &mut rows)?;
    }
    let points = checked(rows, &convention)?;
    let table = finished(&head, points, columns.others, stem, options)?;
    Ok((table, convention))
}

/// What the columns and the head say of the argument, where `stated` is what the caller says; of several columns the one is meant that
/// either names.
fn argument_of(
    names: &[&str],
    stated: Option<Argument>,
    head: Option<Argument>,
) -> Result<Option<Argument>> {
    let is_there = |a: &Argument| names.iter().any(|n| is_argument(n, *a));
    let column = Argument::ALL.into_iter().find(is_there);
    let Some(column) = column.filter(|_| !stated.or(head).as_ref().is_some_and(is_there)) else {
        return Ok(head);
    };
    if let Some(head) = head {
        let expected = format_args!("a column `{head}` as the header says");
        ensure(head == column, "", expected, format_args!("`{column}`"))?;
    }
    Ok(Some(column))
}

impl WideColumns<'_> {
    fn place(&self, line: usize, column: usize) -> Place {
        Place::line(line).column(self.names[column])
    }

    /// The number in a cell; `None` for an empty one.
    fn number(&self, line: usize, column: usize, text: &str) -> Result<Option<f64>> {
        let place = self.place(line, column);
        if text.is_empty() {
            return Ok(None);
        }
        // 1.234 among them may be a thousand
        let fits = !self.decimal_comma || !text.contains('.');
        let expected = "a number with a decimal comma, as others of the file have";
        ensure(fits, &place, expected, format_args!("`{text}`"))?;
        let text = match self.decimal_comma {
            true => text.replace(',', "."),
            false => text.to_owned(),
        };
        number(place, &text).map(Some)
    }

    /// Adds the points of a line.
    fn enter(
        &self,
        line: usize,
        cells: &[&str],
        convention: &Convention,
        rows: &mut Rows,
    ) -> Result<()> {
        let columns = counted(self.names.len(), "column");
        let is_whole = cells.len() == self.names.len();
        ensure(is_whole, Place::line(line), columns, cells.len())?;
        let number = |column: usize| self.number(line, column, cells[column]);
        let arguments = self.arguments.iter().map(|a| Ok((*a, number(*a)?)));
        let arguments = arguments.collect::<Result<Vec<_>>>()?;
        let mean_speed_m_s = self.speed.map(number).transpose()?.flatten();
        for (column, derivative) in &self.derivatives {
            let Some(value) = number(*column)? else {
                continue;
            };
            let before = arguments.iter().rev().find(|(a, _)| a < column);
            let (own, argument) = before.unwrap_or(&arguments[0]);
            let argument = argument.unwrap_or(f64::NAN);
            positive(self.place(line, *own), argument)?;
            let point = ExpressedPoint {
                mean_speed_m_s,
                argument,
                value,
            };
            let (points, lines) = rows.entry(*derivative).or_default();
            points.push(convention.read_point(*derivative, &point));
            lines.push(line);
            check_point_count(self.names[*column], points.len())?;
        }
        Ok(())
    }
}

/// The points, each derivative's own checked.
pub(super) fn checked(rows: Rows, convention: &Convention) -> Result<Points> {
    for (derivative, (points, lines)) in &rows {
        let name = convention.notation.name_of(*derivative);
        check_points(points, |i| Place::line(lines[i]).about(name))?;
    }
    Ok(rows.into_iter().map(|(d, (p, _))| (d, p)).collect())
}

/// The table, with notes on what had to be taken for granted.
fn finished(
    head: &CommentHeader,
    mut points: Points,
    others: Vec<String>,
    stem: &str,
    options: &ReadOptions,
) -> Result<DerivativeTable> {
    let mut header = provenance(head)?;
    header.notes.extend(fill_in(&mut points, options.missing));
    if !others.is_empty() {
        let note = format!("columns that were not read: {}", others.join(", "));
        header.notes.push(note);
    }
    if header.source.is_empty() {
        header.source = format!("table {stem}");
    }
    let stated = width_stated(head, options.width_m)?;
    if stated.is_none() {
        header.notes.push(WIDTH_ASSUMED.to_owned());
    }
    let name = head.required("name");
    let name = name.map_or_else(|_| stem.to_owned(), |line| line.value.clone());
    DerivativeTable::new(name, stated.unwrap_or(1.0), header, points)
}

/// `H1` of `H1 [-]`.
fn without_unit(name: &str) -> &str {
    let units = ["[-]", "(-)", "[1]", "[–]", "(–)", "[ - ]"];
    let bare = units.iter().find_map(|unit| name.strip_suffix(unit));
    bare.unwrap_or(name).trim()
}

/// A name as it is written in cells, as the notation writes it: `H₁*`, `H_1*`, `H 1*` and `H1* [-]` are `H1`.
pub(super) fn plain_name(name: &str, notation: Notation) -> String {
    let name = without_unit(name.trim());
    if notation == Notation::Starossek {
        return name.to_owned();
    }
    let plain = |c: char| match c {
        '₀'..='₉' => char::from_u32(c as u32 - '₀' as u32 + '0' as u32),
        '*' | '∗' | '_' | '^' | ' ' | '\u{a0}' => None,
        other => Some(other),
    };
    name.chars().filter_map(plain).collect()
}

/// Whether a column of this name holds the argument. `Vred` and the like do not say which they are.
fn is_argument(name: &str, argument: Argument) -> bool {
    let said: String = name.chars().filter(|c| !c.is_whitespace()).collect();
    let said = said
        .replace('U', "V")
        .replace('ω', "w")
        .replace("omega", "w")
        .replace('·', "");
    let words: &[&str] = match argument {
        Argument::VHat => &["V\u{302}", "V̂", "Vhat", "V/(wB)", "V/wB", "V/(Bw)"],
        Argument::VStar => &["V*", "Vstar", "V/(fB)", "V/fB", "V/(nB)", "V/nB", "V/(Bf)"],
        Argument::KFull => &["K", "wB/V", "Bw/V"],
        // `k` is that of the full width for some
        Argument::KSemi => &["wb/V", "bw/V"],
    };
    name.eq_ignore_ascii_case(argument.name())
        || name == argument.definition()
        || words.contains(&said.as_str())
}

fn find_columns<'a>(
    names: Vec<&'a str>,
    line: usize,
    convention: &Convention,
) -> Result<WideColumns<'a>> {
    let mut columns = WideColumns {
        arguments: Vec::new(),
        speed: None,
        derivatives: Vec::new(),
        others: Vec::new(),
        decimal_comma: false,
        names,
    };
    let names = &columns.names;
    let mut unnamed = Vec::new();
    for (i, name) in names.iter().enumerate() {
        let plain = plain_name(name, convention.notation);
        if let Ok(derivative) = convention.notation.derivative(&plain) {
            let is_new = columns.derivatives.iter().all(|(_, d)| *d != derivative);
            let expected = format_args!("`{name}` once");
            ensure(is_new, Place::line(line), expected, "it twice")?;
            columns.derivatives.push((i, derivative));
        } else if is_argument(name, convention.argument) {
            columns.arguments.push(i);
        } else if name.eq_ignore_ascii_case(SPEED) {
            let before = columns.speed.replace(i);
            let expected = format_args!("`{name}` once");
            ensure(before.is_none(), Place::line(line), expected, "it twice")?;
        } else {
            unnamed.push(i);
        }
    }
    if columns.arguments.is_empty() {
        // the argument is stated: the only column that is nothing else is its
        let [only] = unnamed[..] else {
            let expected = format!(
                "a column `{}`, and derivatives named {}",
                convention.argument.name(),
                convention.notation.names()
            );
            let unnamed: Vec<&str> = unnamed.iter().map(|i| names[*i]).collect();
            let found = format!("`{}` besides the derivatives", unnamed.join("`, `"));
            return Err(Error::input(Place::line(line), expected, found));
        };
        columns.arguments.push(only);
        unnamed.clear();
    }
    let (first, own) = (columns.arguments[0], columns.arguments.len() > 1);
    let behind = columns.derivatives.iter().any(|(i, _)| *i < first);
    let expected = "one column of the argument, or one before every derivative";
    ensure(!(own && behind), Place::line(line), expected, "one behind")?;
    let any = !columns.derivatives.is_empty();
    let expected = format_args!("columns of derivatives, {}", convention.notation.names());
    let found = format_args!("`{}`", names.join(","));
    ensure(any, Place::line(line), expected, found)?;
    columns.others = unnamed.into_iter().map(|i| names[i].to_owned()).collect();
    Ok(columns)
}

#[cfg(test)]
mod tests;
