//! Section forces of modes: what a unit of each modal coordinate does to elements of the structure.

use crate::error::{Error, Result};
use std::collections::BTreeMap;
use std::path::Path;

/// Section forces per unit of the modal coordinates, as shapes and generalised masses are scaled.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModalSectionForces {
    /// Names of the forces, as the columns say them (`my_nm`).
    pub names: Vec<String>,
    /// Elements by name in the order of the file, each with one number a force by the number of the mode.
    pub elements: Vec<(String, BTreeMap<usize, Vec<f64>>)>,
}

/// Reads `mode,element,…`, with a column per force.
///
/// # Errors
/// [`Error::Io`] when it cannot be read; [`Error::Input`] with the line of what is wrong in it.
pub fn read_section_forces(path: &Path) -> Result<ModalSectionForces> {
    let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
    parsed(&text).map_err(|e| e.in_file(path))
}

/// What the name of a force may end with.
const UNITS: [&str; 12] = [
    "n", "kn", "mn", "nm", "knm", "mnm", "pa", "kpa", "mpa", "m", "mm", "rad",
];

fn states_its_unit(name: &str) -> bool {
    name.rsplit_once('_')
        .is_some_and(|(_, last)| UNITS.iter().any(|unit| last.eq_ignore_ascii_case(unit)))
}

fn parsed(text: &str) -> Result<ModalSectionForces> {
    let wrong = |line: usize, expected: &str, found: &str| {
        Error::input(format!("line {line}"), expected, format!("`{found}`"))
    };
    let lines = text.lines().enumerate();
    let mut lines = lines.filter(|(_, l)| !l.trim().is_empty() && !l.starts_with('#'));
    let (first, header) = lines.next().unwrap_or_default();
    let cells = |line: &str| -> Vec<String> { line.split(',').map(|c| c.trim().into()).collect() };
    let header = cells(header);
    if header.len() < 3 || header[..2] != ["mode", "element"] {
        let expected = "columns mode, element and one a force";
        return Err(wrong(first + 1, expected, &header.join(",")));
    }
    if let Some(bare) = header[2..].iter().find(|name| !states_its_unit(name)) {
        let expected = format!(
            "names that end with their unit, as my_nm ({})",
            UNITS.join(", ")
        );
        return Err(wrong(first + 1, &expected, bare));
    }
    let mut all = ModalSectionForces {
        names: header[2..].to_vec(),
        elements: Vec::new(),
    };
    for (i, line) in lines {
        let row = cells(line);
        if row.len() != header.len() {
            return Err(wrong(i + 1, "as many cells as columns", line));
        }
        let mode = row[0].parse::<usize>();
        let mode = mode.map_err(|_| wrong(i + 1, "the number of a mode", &row[0]))?;
        let number = |cell: &String| {
            let value = cell.parse::<f64>().ok().filter(|x| x.is_finite());
            value.ok_or_else(|| wrong(i + 1, "a number", cell))
        };
        let forces = row[2..].iter().map(number).collect::<Result<Vec<f64>>>()?;
        let known = all.elements.iter().position(|(name, _)| *name == row[1]);
        let at = known.unwrap_or_else(|| {
            all.elements.push((row[1].clone(), BTreeMap::new()));
            all.elements.len() - 1
        });
        if all.elements[at].1.insert(mode, forces).is_some() {
            return Err(wrong(i + 1, "a mode and an element once", line));
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_read_and_what_is_wrong_has_a_line() {
        let all = parsed("mode,element,my_nm\n1,mid,2.5\n2,mid,-1\n").unwrap();
        assert_eq!(all.names, ["my_nm"]);
        assert_eq!(all.elements[0].1[&2], [-1.0]);
        for wrong in [
            "mode,element\n",
            "mode,element,my\n1,a,1\n",
            "mode,element,n_kn\n1,a,x\n",
            "mode,element,n_kn\n1,a,1\n1,a,1\n",
        ] {
            let said = parsed(wrong).unwrap_err().to_string();
            assert!(said.contains("line"), "{said}");
        }
    }
}
