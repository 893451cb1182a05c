//! The variables of an FMU, as its own description names them.

use crate::fmu::importer::{Causality, Fmu, ScalarVariable};
use std::collections::HashMap;

/// Members of an array that stand in rows of their own.
const SINGLE: usize = 3;

/// Name, causality, unit and meaning of each variable of an FMU; of a long array one row.
pub(super) fn variables_of(fmu: &Fmu) -> Vec<[String; 4]> {
    let description = fmu.model_description();
    let types = description.types_by_name();
    let variables = &description.variables;
    let mut arrays: HashMap<String, Vec<&ScalarVariable>> = HashMap::new();
    for v in variables {
        arrays.entry(pattern(&v.name)).or_default().push(v);
    }
    let rows = variables.iter().filter_map(|v| {
        let own = &arrays[&pattern(&v.name)];
        let meaning = v.description.as_deref().unwrap_or_default();
        let (name, meaning) = match own.len() > SINGLE {
            true if own[0].name != v.name => return None,
            true => {
                let last = own[own.len() - 1];
                let of_last = last.description.as_deref().unwrap_or_default();
                (joined(&v.name, &last.name), shared(meaning, of_last))
            }
            false => (v.name.clone(), meaning.to_owned()),
        };
        let unit = v.attribute(&types, |a| a.unit.clone());
        let unit = unit.unwrap_or_else(|| "–".to_owned());
        Some([name, causality(v.causality).to_owned(), unit, meaning])
    });
    rows.collect()
}

/// The words with which both texts begin.
fn shared(first: &str, last: &str) -> String {
    if first == last {
        return first.to_owned();
    }
    let words = first.split(' ').zip(last.split(' '));
    let same = words.take_while(|(a, b)| a == b).map(|(a, _)| a);
    let same: Vec<&str> = same.collect();
    format!("{} …", same.join(" "))
}

/// The name without the number of the member: `mode[7].frequency` is `mode[].frequency`.
fn pattern(name: &str) -> String {
    match brackets(name) {
        Some((before, _, after)) => format!("{before}[]{after}"),
        None => name.to_owned(),
    }
}

/// What stands before, in and after the brackets around a number.
fn brackets(name: &str) -> Option<(&str, &str, &str)> {
    let (before, rest) = name.split_once('[')?;
    let (inside, after) = rest.split_once(']')?;
    let number = !inside.is_empty() && inside.bytes().all(|b| b.is_ascii_digit());
    number.then_some((before, inside, after))
}

/// `mode[1 … 39].frequency` of the first and the last member.
fn joined(first: &str, last: &str) -> String {
    match (brackets(first), brackets(last)) {
        (Some((before, from, after)), Some((_, to, _))) => {
            format!("{before}[{from} … {to}]{after}")
        }
        _ => first.to_owned(),
    }
}

fn causality(causality: Causality) -> &'static str {
    match causality {
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculated parameter",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Independent => "time",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_of_an_array_have_one_pattern() {
        assert_eq!(pattern("mode[7].frequency"), "mode[].frequency");
        assert_eq!(pattern("node[deck].lift"), "node[deck].lift");
        assert_eq!(joined("mode[1].x", "mode[39].x"), "mode[1 … 39].x");
        assert_eq!(
            shared("Rate of mode 1", "Rate of mode 19"),
            "Rate of mode …"
        );
        assert_eq!(shared("Rate", "Rate"), "Rate");
    }
}
