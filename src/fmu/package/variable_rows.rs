//! The variables of an archive as its own description lists them, for the page that documents it.

use crate::fmu::variables::{Variable, VariableTable};
use crate::fmu::xml::Element;

/// A variable, or an array of them, in the words of the description.
#[derive(Debug, Clone)]
pub(super) struct Row<'a> {
    pub name: &'a str,
    pub kind: String,
    pub unit: String,
    pub start: String,
    pub limits: String,
    pub description: &'a str,
    pub causality: &'a str,
    pub variability: &'a str,
}

/// All but the variables of the `table` that are `left_out`.
pub(super) fn rows<'a>(
    description: &'a Element,
    table: &VariableTable,
    left_out: impl Fn(&Variable) -> bool,
) -> Vec<Row<'a>> {
    let out = table.variables().iter().filter(|v| left_out(v));
    let out: std::collections::HashSet<&str> = out.map(|v| v.name.as_str()).collect();
    let all = || description.child("ModelVariables").into_iter();
    let all = || all().flat_map(|list| &list.children);
    let named = |reference: &str| {
        let mut all = all();
        let found = all.find(|e| e.attribute("valueReference") == Some(reference));
        found.and_then(|e| e.attribute("name"))
    };
    all()
        .map(|element| row(element, &named))
        .filter(|row| !out.contains(row.name))
        .collect()
}

fn row<'a>(element: &'a Element, named: &dyn Fn(&str) -> Option<&'a str>) -> Row<'a> {
    // FMI 2.0 has the type inside of the variable, FMI 3.0 in its place
    let typed = match element.name.as_str() {
        "ScalarVariable" => element.children.first().unwrap_or(element),
        _ => element,
    };
    let of = |name: &str| element.attribute(name).unwrap_or_default();
    let size = |d: &'a Element| {
        let of_another = || named(d.attribute("valueReference")?);
        d.attribute("start").or_else(of_another)
    };
    let sizes = element.children_named("Dimension").filter_map(size);
    let sizes = sizes.map(|size| format!("[{size}]"));
    let texts = element.children_named("Start");
    let mut starts: Vec<&str> = texts.filter_map(|e| e.attribute("value")).collect();
    starts.extend(
        typed
            .attribute("start")
            .iter()
            .flat_map(|s| match typed.name.as_str() {
                "String" => vec![*s],
                _ => s.split(' ').collect(),
            }),
    );
    // what all elements of an array begin with stands once
    starts.dedup();
    let unit = typed.attribute("unit").unwrap_or("–");
    let limit = |sign: &str, name: &str| Some(format!("{sign} {}", typed.attribute(name)?));
    let limits = [limit("≥", "min"), limit("≤", "max")];
    Row {
        name: of("name"),
        kind: typed.name.clone() + &sizes.collect::<String>(),
        unit: match typed.attribute("displayUnit") {
            Some(shown) => format!("{unit} (shown in {shown})"),
            None => unit.to_owned(),
        },
        start: starts.join(", "),
        limits: limits.into_iter().flatten().collect::<Vec<_>>().join(", "),
        description: of("description"),
        causality: of("causality"),
        variability: of("variability"),
    }
}
