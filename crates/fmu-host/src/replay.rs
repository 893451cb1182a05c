//! Repeating the runs that an archive carries in `extra/org.fmi-standard.fmi-ls-ref/` (layered standard FMI-LS-REF).
//!
//! Inputs are set at the beginning of each communication step and held; outputs are compared at its end, and after the
//! initialisation.

use super::Fmu;
use super::description::{DefaultExperiment, Value, VariableType};
use super::simulation::{Times, ValueTable, run, start};
use super::slave::{Slave, find};
use super::trials::check_starts;
use crate::error::{Error, Place, Result, ensure};
use crate::xml::Element;
use serde::Serialize;

/// The folder of the files in the archive.
pub const LS_REF: &str = "extra/org.fmi-standard.fmi-ls-ref";
/// What says which they are.
pub const LS_REF_MANIFEST: &str = "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml";
/// Largest difference over the largest value of a variable at which a run counts as the same: processors multiply and add in
/// different roundings.
const SAME: f64 = 1e-9;

/// How far one run is from what the archive says of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReplayedRun {
    /// The file of its experiment, in the folder of the files.
    pub file: String,
    /// Name of the experiment.
    pub name: String,
    /// Values that were compared.
    pub values: usize,
    /// Largest difference over the largest value of its variable.
    pub difference: f64,
    /// Where that is.
    pub variable: String,
    /// When, s.
    pub time_s: f64,
    /// The value there, and what the archive says.
    pub found: f64,
    /// What the archive says.
    pub expected: f64,
    /// Whether that is the same but for rounding.
    pub same: bool,
}

/// Repeats every experiment of the archive in new instances, and compares the start values of the description with those of one.
///
/// # Errors
/// [`Error::Input`] for an archive without experiments, for start values that no instance has, and for files of it that cannot be read;
/// those of [`Fmu::instantiate`] and of a run.
pub fn replay(fmu: &Fmu) -> Result<Vec<ReplayedRun>> {
    let none =
        || Error::input("archive", "reference runs (FMI-LS-REF)", "none").in_file(fmu.path());
    if !fmu.folder().join(LS_REF_MANIFEST).is_file() {
        return Err(none());
    }
    let mut runs = Vec::new();
    let of_experiments = |e: &&Element| {
        let role = e.attribute("role").unwrap_or_default();
        role == "experiment" || role.starts_with("experiment/")
    };
    let root = element(fmu, "fmi-ls-manifest.xml", LS_REF_MANIFEST)?;
    for related in root.children_named("Related").filter(of_experiments) {
        let file = referred(fmu, related)?;
        let experiments = element(fmu, file, file)?;
        for experiment in experiments.children_named("Experiment") {
            runs.push(repeated(fmu, file, experiment)?);
        }
    }
    if runs.is_empty() {
        return Err(none());
    }
    // the runs set their own, an importer may not
    let d = fmu.model_description();
    let mut slave = fmu.instantiate(&d.model_name)?;
    check_starts(&mut slave, &Times::new(d, DefaultExperiment::default())?)?;
    Ok(runs)
}

/// The file of the archive that the attribute `source` names, relative to the folder of the files.
fn referred<'e>(fmu: &Fmu, element: &'e Element) -> Result<&'e str> {
    let name = element.attribute("source").unwrap_or_default();
    let inside = !name.is_empty() && !name.contains([':', '\\']) && !name.starts_with('/');
    let path = fmu.folder().join(LS_REF).join(name);
    // the archive itself may be named in another spelling
    let within = || {
        let folder = fmu.folder().canonicalize().ok()?;
        Some(path.canonicalize().ok()?.starts_with(folder))
    };
    if inside && within() == Some(true) {
        return Ok(name);
    }
    let place = format!("{LS_REF}, line {}, {}", element.line, element.name);
    let found = format!("`{name}`");
    let expected = "`source`, a file of the archive";
    Err(Error::input(place, expected, found))
}

/// The text of a file in the folder of the files.
fn text_of(fmu: &Fmu, name: &str) -> Result<String> {
    let path = fmu.folder().join(LS_REF).join(name);
    std::fs::read_to_string(&path).map_err(|e| Error::io(path, e))
}

fn element(fmu: &Fmu, name: &str, shown: &str) -> Result<Element> {
    Element::parse(&text_of(fmu, name)?).map_err(|e| e.in_file(shown))
}

fn repeated(fmu: &Fmu, file: &str, experiment: &Element) -> Result<ReplayedRun> {
    let read = |name: &str| {
        let child = experiment.child(name);
        child.map(|e| referred(fmu, e)).transpose()
    };
    let references = read("References")?
        .ok_or_else(|| Error::input(file, "<References> of each experiment", "none"))?;
    let expected = table(fmu, references)?;
    let stimuli = match read("Stimuli")? {
        Some(of) => table(fmu, of)?,
        None => ValueTable::default(),
    };
    let values = match read("Parameters")? {
        Some(of) => parameters(&element(fmu, of, of)?).map_err(|e| e.in_file(of))?,
        None => Vec::new(),
    };
    let times = times(fmu, experiment)?;
    // before a run of as many steps as may be
    let rows = times.steps() + 1;
    let (outputs, found) = (expected.names.len() - 1, expected.rows.len());
    let wanted = format_args!("outputs beside the time, in {rows} rows");
    let fits = outputs > 0 && found == rows;
    let found = format_args!("{outputs} outputs, {found} rows");
    ensure(fits, "<References>", wanted, found).map_err(|e| e.in_file(file))?;
    let found = in_new_instance(fmu, &times, values, &stimuli, &expected)?;
    let name = experiment.attribute("name").unwrap_or_default();
    compared(file, name, &expected, &found).map_err(|e| e.in_file(file))
}

/// Of the latest draft, or of the one before, where the times are the experiment's own.
fn times(fmu: &Fmu, experiment: &Element) -> Result<Times> {
    let simulation = experiment.child("TransientSimulation");
    let of = simulation.unwrap_or(experiment);
    let number = |name: &str| of.attribute(name).and_then(|text| text.trim().parse().ok());
    let stated = DefaultExperiment {
        start_time: number("startTime"),
        stop_time: number("stopTime"),
        step_size: number("stepSize"),
        tolerance: None,
    };
    Times::new(fmu.model_description(), stated)
}

/// The real parameters of an SSV file, which holds no others.
fn parameters(root: &Element) -> Result<Vec<(String, Value)>> {
    let mut found = Vec::new();
    let local = |e: &Element, name: &str| e.name.rsplit(':').next() == Some(name);
    let list = root.children.iter().filter(|e| local(e, "Parameters"));
    for parameter in list.flat_map(|list| &list.children) {
        let value = parameter.children.iter().find(|e| local(e, "Real"));
        let number = value.and_then(|e| e.attribute("value")?.trim().parse().ok());
        let (Some(name), Some(number)) = (parameter.attribute("name"), number) else {
            let name = parameter.attribute("name").unwrap_or_default();
            let place = format!("line {}, parameter `{name}`", parameter.line);
            let expected = "a name, and a `Real` with its `value`";
            return Err(Error::input(place, expected, "none"));
        };
        found.push((name.to_owned(), Value::Real(number)));
    }
    Ok(found)
}

/// A CSV of numbers: names in quotes or without, the time first.
fn table(fmu: &Fmu, name: &str) -> Result<ValueTable> {
    let text = text_of(fmu, name)?;
    let mut lines = text.lines().enumerate();
    let refused = |line: usize, expected: &str, found: &str| {
        Error::input(Place::line(line + 1), expected, format!("`{found}`")).in_file(name)
    };
    let head = lines.next().map_or("", |(_, head)| head);
    let names = split(head);
    if !names[0].eq_ignore_ascii_case("time") {
        return Err(refused(0, "`time` as the first column", head));
    }
    let mut rows = Vec::new();
    for (at, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let numbers = line.split(',').map(|cell| cell.trim().parse::<f64>());
        let row = numbers.collect::<std::result::Result<Vec<f64>, _>>();
        match row {
            Ok(row) if row.len() == names.len() => rows.push(row),
            _ => return Err(refused(at, "a number in each column", line)),
        }
    }
    Ok(ValueTable { names, rows })
}

/// Names of columns, which may hold commas inside quotes.
fn split(head: &str) -> Vec<String> {
    let (mut names, mut quoted) = (vec![String::new()], false);
    for c in head.trim().chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => names.push(String::new()),
            c => names.last_mut().into_iter().for_each(|name| name.push(c)),
        }
    }
    names
}

fn in_new_instance(
    fmu: &Fmu,
    times: &Times,
    mut values: Vec<(String, Value)>,
    stimuli: &ValueTable,
    expected: &ValueTable,
) -> Result<ValueTable> {
    let d = fmu.model_description();
    let real = |name: &String| match find(d, name)? {
        v if v.kind == VariableType::Real => Ok(v),
        _ => {
            let place = format!("variable `{name}`");
            Err(Error::input(place, "a real number", "another type"))
        }
    };
    let reals = |names: &[String]| names.iter().map(real).collect::<Result<Vec<_>>>();
    let record = reals(&expected.names[1..])?;
    let of_inputs = stimuli.names.get(1..).unwrap_or_default();
    let inputs = reals(of_inputs)?.into_iter();
    let references: Vec<u32> = inputs.map(|v| v.value_reference).collect();
    if let Some(first) = stimuli.rows.first() {
        let initial = of_inputs.iter().zip(&first[1..]);
        values.extend(initial.map(|(name, x)| (name.clone(), Value::Real(*x))));
    }
    let mut slave = fmu.instantiate(&d.model_name)?;
    start(&mut slave, times, &values)?;
    let mut rows = stimuli.rows.iter().peekable();
    let mut now: Option<&Vec<f64>> = None;
    let before = |slave: &mut Slave, time: f64| {
        // the last row that is not later
        while let Some(row) = rows.next_if(|row| row[0] <= time + 1e-9 * times.step) {
            now = Some(row);
        }
        match now {
            Some(row) => slave.set_real(&references, &row[1..]),
            None => Ok(()),
        }
    };
    let found = run(&mut slave, times, &record, before)?;
    slave.terminate()?;
    Ok(found)
}

/// The largest difference of all values.
fn compared(
    file: &str,
    name: &str,
    expected: &ValueTable,
    found: &ValueTable,
) -> Result<ReplayedRun> {
    for (said, is) in expected.rows.iter().zip(&found.rows) {
        let same = (said[0] - is[0]).abs() <= SAME * is[0].abs().max(1.0);
        let at = format_args!("outputs at {} s", is[0]);
        ensure(same, "reference run", at, format_args!("at {} s", said[0]))?;
    }
    let mut worst = ReplayedRun {
        file: file.to_owned(),
        name: name.to_owned(),
        values: expected.rows.len() * (expected.names.len() - 1),
        difference: 0.0,
        variable: expected.names.get(1).cloned().unwrap_or_default(),
        time_s: 0.0,
        found: 0.0,
        expected: 0.0,
        same: true,
    };
    for (column, variable) in expected.names.iter().enumerate().skip(1) {
        let sizes = expected.rows.iter().map(|row| row[column].abs());
        let largest = sizes.fold(0.0, f64::max);
        let scale = if largest > 0.0 { largest } else { 1.0 };
        for (said, is) in expected.rows.iter().zip(&found.rows) {
            let difference = (said[column] - is[column]).abs() / scale;
            // what is no number differs from everything
            if difference > worst.difference || difference.is_nan() {
                worst.difference = match difference.is_nan() {
                    true => f64::INFINITY,
                    false => difference,
                };
                variable.clone_into(&mut worst.variable);
                worst.time_s = said[0];
                (worst.found, worst.expected) = (is[column], said[column]);
            }
        }
    }
    worst.same = worst.difference <= SAME;
    Ok(worst)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_columns_may_hold_commas() {
        assert_eq!(
            split("\"time\",\"filter[1,2]\",plain"),
            ["time", "filter[1,2]", "plain"]
        );
    }

    #[test]
    fn the_largest_difference_is_found_and_what_is_no_number_is_one() {
        let table = |values: [f64; 2]| ValueTable {
            names: vec!["time".into(), "x".into()],
            rows: vec![vec![0.0, values[0]], vec![1.0, values[1]]],
        };
        let worst = compared("", "", &table([1.0, -2.0]), &table([1.0, -2.0 + 1e-6])).unwrap();
        assert_eq!(
            (worst.variable.as_str(), worst.time_s, worst.same),
            ("x", 1.0, false)
        );
        assert!((worst.difference - 5e-7).abs() < 1e-12);
        assert!(
            compared("", "", &table([1.0, 2.0]), &table([1.0, 2.0]))
                .unwrap()
                .same
        );
        assert!(
            !compared("", "", &table([1.0, 2.0]), &table([f64::NAN, 2.0]))
                .unwrap()
                .same
        );
    }
}
