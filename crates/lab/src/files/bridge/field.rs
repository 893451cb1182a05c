//! Turbulence along the span as a file: `time_s,u[x1],u[x2],…,w[x1],…`, m/s, the places along the girder in metres.

use super::table::Table;
use crate::error::{Error, Place, Result, ensure};
use crate::plausibility::{ratio_hint, significant};
use std::path::Path;

/// Nodes and columns this close are at one place, m: places are written with a few digits.
const SAME_PLACE: f64 = 1e-3;
/// Mean speeds farther apart than this deserve a word, and beyond that are different ones, as those of a recording.
const SPEED_OFF_AT_MOST: f64 = 0.05;
const ANOTHER_SPEED: f64 = 0.2;
/// Steps may differ by this part: times are written with a few digits.
const SAME_STEP: f64 = 1e-6;

/// Turbulence at places along a girder.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldTable {
    /// Time step, s.
    pub step_s: f64,
    /// Places of the columns, m.
    pub along_m: Vec<f64>,
    /// Whether places count from the middle of the bridge; else they are those of the girder.
    pub from_middle: bool,
    /// Mean wind speed of the turbulence, m/s, where the file says it.
    pub mean_speed_m_s: Option<f64>,
    /// `u` then `w`: a row of samples per place.
    pub gusts: [Vec<Vec<f64>>; 2],
}

/// Reads a table of columns.
pub(super) fn read(path: &Path) -> Result<FieldTable> {
    Table::read(path, parse)
}

impl FieldTable {
    /// What is odd about these gusts in a mean wind of `speed_m_s`, m/s: the file says another.
    ///
    /// # Errors
    /// [`Error::Input`] for a speed that is wholly another.
    pub fn odd_speed(&self, speed_m_s: f64) -> Result<Option<String>> {
        let Some(mean) = self.mean_speed_m_s else {
            return Ok(None);
        };
        let off = (speed_m_s / mean - 1.0).abs();
        let expected = format_args!("about the {mean:.3} m/s of the turbulence");
        let found = format_args!("{speed_m_s} m/s{}", ratio_hint(speed_m_s / mean));
        ensure(off <= ANOTHER_SPEED, "mean wind speed", expected, found)?;
        let odd = off > SPEED_OFF_AT_MOST;
        Ok(odd.then(|| {
            format!("the turbulence is that of {mean:.3} m/s, the response at {speed_m_s} m/s")
        }))
    }

    /// Samples at each place.
    pub fn samples(&self) -> usize {
        self.gusts[0].first().map_or(0, Vec::len)
    }

    /// Length, s.
    pub fn duration_s(&self) -> f64 {
        self.step_s * self.samples() as f64
    }

    /// Standard deviations of `u` and `w`, m/s, from the mean of each place.
    pub fn deviations_m_s(&self) -> [f64; 2] {
        let variance = |row: &Vec<f64>| {
            let mean = row.iter().sum::<f64>() / row.len() as f64;
            row.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / row.len() as f64
        };
        let deviation = |rows: &[Vec<f64>]| {
            let sum: f64 = rows.iter().map(variance).sum();
            (sum / rows.len() as f64).sqrt()
        };
        [deviation(&self.gusts[0]), deviation(&self.gusts[1])]
    }

    /// The field at other places, m: its own where a place is one of them, else on the straight line between its neighbours.
    ///
    /// # Errors
    /// [`Error::Input`] for places of the file that do not rise, and for wanted ones beyond them.
    pub fn at(&self, wanted: &[f64]) -> Result<Self> {
        let ends = (wanted.first().copied(), wanted.last().copied());
        let (Some(first), Some(last)) = ends else {
            return Err(Error::input("places", "one or more", "none"));
        };
        let shift = match self.from_middle {
            true => 0.5 * (first + last),
            false => 0.0,
        };
        let own: Vec<f64> = self.along_m.iter().map(|x| x + shift).collect();
        for (x, along) in own.windows(2).zip(self.along_m.windows(2)) {
            let place = format_args!("heading, u[{}]", along[1]);
            let found = format_args!("after {}", along[0]);
            ensure(x[1] > x[0], place, "places that rise", found)?;
        }
        let covered = (own[0] - SAME_PLACE)..=(own[own.len() - 1] + SAME_PLACE);
        let holds = wanted.iter().all(|x| covered.contains(x));
        let expected = format_args!("{first} to {last} m, where the nodes of the bridge are");
        let found = format_args!("{} to {} m", own[0], own[own.len() - 1]);
        ensure(holds, "places of the turbulence", expected, found)?;
        let of = |rows: &Vec<Vec<f64>>| wanted.iter().map(|x| between(&own, rows, *x)).collect();
        Ok(Self {
            step_s: self.step_s,
            along_m: wanted.to_vec(),
            from_middle: false,
            mean_speed_m_s: self.mean_speed_m_s,
            gusts: [of(&self.gusts[0]), of(&self.gusts[1])],
        })
    }
}

/// A row at `x` among those at rising `places`.
fn between(places: &[f64], rows: &[Vec<f64>], x: f64) -> Vec<f64> {
    if let Some(same) = places.iter().position(|p| (p - x).abs() < SAME_PLACE) {
        return rows[same].clone();
    }
    let above = places
        .partition_point(|p| *p < x)
        .clamp(1, places.len() - 1);
    let share = (x - places[above - 1]) / (places[above] - places[above - 1]);
    let both = rows[above - 1].iter().zip(&rows[above]);
    both.map(|(a, b)| a + share * (b - a)).collect()
}

fn parse(table: &Table) -> Result<FieldTable> {
    let time = table.required(&["time_s"])?;
    let columns = |name: &str| -> Result<Vec<(usize, f64)>> {
        let named = table.heading.iter().enumerate().filter_map(|(i, h)| {
            let inner = h.strip_prefix(name)?.strip_prefix('[')?.strip_suffix(']')?;
            Some((i, inner))
        });
        let along = |(i, place): (usize, &str)| {
            let at = format!("heading, column {}", i + 1);
            let expected = "a place along the girder, m";
            let along = place.parse();
            let along = along.map_err(|_| Error::input(at, expected, format!("`{place}`")));
            Ok((i, along?))
        };
        named.map(along).collect()
    };
    let (u, w) = (columns("u")?, columns("w")?);
    let places = |columns: &[(usize, f64)]| -> Vec<f64> { columns.iter().map(|c| c.1).collect() };
    let same = !u.is_empty() && places(&u) == places(&w);
    let expected = "columns u[x] and w[x] at the same places";
    let found = format_args!("{} columns u[…] and {} columns w[…]", u.len(), w.len());
    ensure(same, "heading", expected, found)?;
    let column =
        |c: usize| -> Result<Vec<f64>> { table.rows.iter().map(|r| r.number(c)).collect() };
    let step_s = step(&column(time)?, table)?;
    let samples = |columns: &[(usize, f64)]| -> Result<Vec<Vec<f64>>> {
        columns.iter().map(|c| column(c.0)).collect()
    };
    Ok(FieldTable {
        step_s,
        along_m: places(&u),
        from_middle: false,
        mean_speed_m_s: None,
        gusts: [samples(&u)?, samples(&w)?],
    })
}

fn step(times: &[f64], table: &Table) -> Result<f64> {
    ensure(times.len() >= 3, "", "three samples or more", times.len())?;
    // the usual step: rows that are missing, or one wrong time, are found where they are
    let mut steps: Vec<f64> = times.windows(2).map(|t| t[1] - t[0]).collect();
    let middle = steps.len() / 2;
    let usual = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    let wrong = |t: &[f64]| (t[1] - t[0] - usual).abs() > SAME_STEP * usual.abs().max(t[1].abs());
    match times.windows(2).position(wrong) {
        None if usual > 0.0 => Ok((times[times.len() - 1] - times[0]) / (times.len() - 1) as f64),
        at => {
            let wrong = at.unwrap_or(0) + 1;
            let place = Place::line(table.rows[wrong].line).column("time_s");
            let expected = format!("times that rise by {} s", significant(usual));
            Err(Error::input(place, expected, times[wrong].to_string()))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_by_their_headings() {
        let text = "# a comment\ntime_s,u[-10],u[10.5],w[-10],w[10.5]\n0,1,2,3,4\n0.1,5,6,7,8\n0.2,9,10,11,12\n";
        let field = parse(&Table::parse(text).unwrap()).unwrap();
        assert_eq!(field.along_m, [-10.0, 10.5]);
        assert!((field.step_s - 0.1).abs() < 1e-15);
        assert_eq!(field.gusts[1][1], [4.0, 8.0, 12.0]);
        for (from, to, expected) in [
            ("w[10.5]", "w[11]", "u[x] and w[x] at the same places"),
            (
                "0.1,",
                "0.15,",
                "line 5, column time_s: expected times that rise by",
            ),
            ("u[-10]", "u[here]", "heading, column 2: expected a place"),
        ] {
            let message = parse(&Table::parse(&text.replace(from, to)).unwrap())
                .unwrap_err()
                .to_string();
            assert!(message.contains(expected), "{message}");
        }
    }

    /// The mean of all steps named the first of the right ones.
    #[test]
    fn a_gap_is_found_where_it_is() {
        let row = |i: usize| format!("{},1,2\n", 0.1 * i as f64);
        let rows: String = (0..60).filter(|i| !(40..45).contains(i)).map(row).collect();
        let table = Table::parse(&format!("time_s,u[0],w[0]\n{rows}")).unwrap();
        let message = parse(&table).unwrap_err().to_string();
        let expected = "line 42, column time_s: expected times that rise by 0.1 s, found 4.5";
        assert_eq!(message, expected);
    }

    #[test]
    fn fields_are_taken_to_other_places() {
        let field = FieldTable {
            step_s: 0.1,
            along_m: vec![-10.0, 0.0, 20.0],
            from_middle: true,
            mean_speed_m_s: None,
            gusts: [
                vec![vec![1.0, 2.0], vec![3.0, 4.0], vec![7.0, 9.0]],
                vec![vec![0.0, 0.0]; 3],
            ],
        };
        let moved = field.at(&[90.0, 100.0, 105.0, 110.0]).unwrap();
        let u = &moved.gusts[0];
        assert_eq!(u[0], [1.0, 2.0]);
        assert_eq!(u[1], [3.0, 4.0]);
        assert_eq!(u[2], [4.0, 5.25]);
        let message = field.at(&[-30.0, 30.0]).unwrap_err().to_string();
        assert!(message.contains("expected -30 to 30 m"), "{message}");
        assert!(message.contains("found -10 to 20 m"), "{message}");
        let falling = FieldTable {
            along_m: vec![0.0, -10.0, 20.0],
            ..field
        };
        let message = falling.at(&[0.0]).unwrap_err().to_string();
        assert!(message.contains("places that rise"), "{message}");
    }
}
