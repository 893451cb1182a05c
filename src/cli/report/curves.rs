//! Curves of a report, from the file that the study left.

use crate::cli::result_files::CURVES;
use crate::error::{Error, Result};
use crate::report::PageCurve;
use std::collections::BTreeMap;

/// Wind speeds and curves of `curves.csv`; `own` is the model of the answer.
pub(super) fn curves_of(text: &str, own: &str) -> Result<(Vec<f64>, Vec<PageCurve>)> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let broken =
        |found: String| Error::input(CURVES, "curves as `aerodeck study` writes them", found);
    let mut points: Vec<(String, String, f64, f64, f64)> = Vec::new();
    for row in reader.records() {
        let row = row.map_err(|e| broken(e.to_string()))?;
        let number = |i: usize| {
            let field = row.get(i).unwrap_or("");
            field
                .parse::<f64>()
                .map_err(|_| broken(format!("`{field}`")))
        };
        let name = |i: usize| row.get(i).unwrap_or("").to_owned();
        points.push((name(0), name(1), number(2)?, number(3)?, number(4)?));
    }
    let mut speeds: Vec<f64> = points.iter().map(|p| p.2).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let (mut models, mut branches) = (Vec::<String>::new(), Vec::<String>::new());
    let place = |names: &mut Vec<String>, name: &String| {
        names.iter().position(|n| n == name).unwrap_or_else(|| {
            names.push(name.clone());
            names.len() - 1
        })
    };
    let mut curves: BTreeMap<(usize, usize), PageCurve> = BTreeMap::new();
    for (model, branch, speed, frequency, damping) in &points {
        let at = (place(&mut models, model), place(&mut branches, branch));
        let curve = curves.entry(at).or_insert_with(|| PageCurve {
            model: at.0,
            branch: at.1,
            own: model == own,
            label: format!("{model}, {branch}"),
            frequency: vec![None; speeds.len()],
            damping: vec![None; speeds.len()],
        });
        let i = speeds.partition_point(|v| v < speed);
        curve.frequency[i] = Some(*frequency);
        curve.damping[i] = Some(100.0 * damping);
    }
    Ok((speeds, curves.into_values().collect()))
}
