//! Turbulence from TurbSim: binary full-field files (`.bts`), as its user's guide lays them out in Annex D (Jonkman, TurbSim User's
//! Guide 2.00, NREL, 2016): a head of counts, steps, heights, and for each component a slope and an intercept; then for every
//! time the points of the grid, row after row from the lowest, each with its three components as integers of 16 bits.
//!
//! The grid stands across the wind, so that the girder is taken along its width, at the height of the hub.

use super::field::FieldTable;
use crate::error::{Error, Result, ensure, finite};
use std::path::Path;

/// The ending of such files.
pub(super) const ENDING: &str = "bts";
/// First number of a file: not periodic, periodic.
const KINDS: [i16; 2] = [7, 8];
/// Components of the wind in a file.
const COMPONENTS: usize = 3;
/// Heights are written with 7 digits, m.
const SAME_HEIGHT: f64 = 1e-2;
/// The components that act on a girder: along the mean wind, and up.
const ALONG_AND_UP: [usize; 2] = [0, 2];

/// The next bytes, which are to be `what`.
fn take<const N: usize>(all: &[u8], at: &mut usize, what: &str) -> Result<[u8; N]> {
    let found = all.get(*at..).and_then(|rest| rest.first_chunk());
    let found = found.ok_or_else(|| {
        let place = format!("byte {at}");
        Error::input(place, what, format!("the end at {}", all.len()))
    })?;
    *at += N;
    Ok(*found)
}

/// A number of `lowest` or more.
fn count(all: &[u8], at: &mut usize, what: &str, lowest: i32) -> Result<usize> {
    let place = format!("byte {at}, {what}");
    let count = i32::from_le_bytes(take(all, at, what)?);
    match usize::try_from(count) {
        Ok(fits) if count >= lowest => Ok(fits),
        _ => {
            let expected = format!("{lowest} or more");
            Err(Error::input(place, expected, count.to_string()))
        }
    }
}

fn number(all: &[u8], at: &mut usize, what: &str) -> Result<f64> {
    let place = format!("byte {at}, {what}");
    finite(place, f64::from(f32::from_le_bytes(take(all, at, what)?)))
}

/// The head of a file.
struct TurbSimHeader {
    /// Points upwards, across, on the tower below, and in time.
    counts: [usize; 4],
    /// Distances upwards and across, m, and the time step, s.
    steps: [f64; 3],
    /// At the height of the hub.
    mean_speed_m_s: f64,
    hub_height_m: f64,
    lowest_m: f64,
    /// Slope and intercept of each component: `(integer − intercept)/slope` is in m/s.
    scales: [[f64; 2]; COMPONENTS],
    /// Where the samples begin.
    end: usize,
}

impl TurbSimHeader {
    fn read(all: &[u8]) -> Result<Self> {
        let at = &mut 0;
        let kind = i16::from_le_bytes(take(all, at, "the kind of file")?);
        let expected = "7 or 8, a full-field file of TurbSim";
        ensure(KINDS.contains(&kind), "byte 0", expected, kind)?;
        let counts = [
            count(all, at, "points upwards", 1)?,
            count(all, at, "points across", 2)?,
            count(all, at, "points of the tower", 0)?,
            count(all, at, "time steps", 3)?,
        ];
        let steps = [
            number(all, at, "distance upwards")?,
            number(all, at, "distance across")?,
            number(all, at, "time step")?,
        ];
        let mean_speed_m_s = number(all, at, "mean wind")?;
        let hub_height_m = number(all, at, "height of the hub")?;
        let lowest_m = number(all, at, "lowest height")?;
        let mut scales = [[0.0; 2]; COMPONENTS];
        for scale in &mut scales {
            *scale = [number(all, at, "slope")?, number(all, at, "intercept")?];
        }
        let text = count(all, at, "characters of the description", 0)?;
        let head = Self {
            counts,
            steps,
            mean_speed_m_s,
            hub_height_m,
            lowest_m,
            scales,
            end: at.saturating_add(text),
        };
        head.check(all.len())?;
        Ok(head)
    }

    fn check(&self, length: usize) -> Result<()> {
        let positive = |what: &str, x: f64| ensure(x > 0.0, what, "a number above 0", x);
        positive("distance across", self.steps[1])?;
        positive("time step", self.steps[2])?;
        positive("mean wind", self.mean_speed_m_s)?;
        let top = self.lowest_m + (self.counts[0] - 1) as f64 * self.steps[0];
        let rows = (self.lowest_m - SAME_HEIGHT)..=(top + SAME_HEIGHT);
        let (hub, lowest) = (self.hub_height_m, self.lowest_m);
        let inside = self.counts[0] == 1 || rows.contains(&hub);
        let expected = format_args!("one within the grid, {lowest} to {top} m");
        let found = format_args!("{hub} m");
        ensure(inside, "height of the hub", expected, found)?;
        for c in ALONG_AND_UP {
            let place = format_args!("slope of component {}", c + 1);
            let is_any = self.scales[c][0] != 0.0;
            ensure(is_any, place, "a number other than 0", "0")?;
        }
        let samples = self.record().saturating_mul(self.counts[3]);
        let expected = self.end.saturating_add(samples);
        let holds = length == expected;
        let expected = format_args!("{expected} bytes, as the head of the file says");
        ensure(holds, "", expected, length)
    }

    /// Bytes of one time.
    fn record(&self) -> usize {
        let [up, across, tower, _] = self.counts;
        let points = up.saturating_mul(across).saturating_add(tower);
        points.saturating_mul(2 * COMPONENTS)
    }

    /// The row below the hub, and the share of the row above it.
    fn row(&self) -> (usize, f64) {
        let up = self.counts[0];
        if up == 1 || self.steps[0] <= 0.0 {
            return (0, 0.0);
        }
        let place = (self.hub_height_m - self.lowest_m) / self.steps[0];
        let place = place.clamp(0.0, (up - 1) as f64);
        let below = (place.floor() as usize).min(up - 2);
        (below, place - below as f64)
    }
}

/// Reads a file: `u` without its mean at each point, and `w`, at the height of the hub.
pub(super) fn read(path: &Path) -> Result<FieldTable> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    parse(&bytes).map_err(|e| e.in_file(path))
}

fn parse(bytes: &[u8]) -> Result<FieldTable> {
    let head = TurbSimHeader::read(bytes)?;
    let [_, across, _, times] = head.counts;
    let (below, share) = head.row();
    let sample = |time: usize, row: usize, point: usize, component: usize| -> f64 {
        let place = (row * across + point) * COMPONENTS + component;
        let at = head.end + time * head.record() + 2 * place;
        let [slope, intercept] = head.scales[component];
        (f64::from(i16::from_le_bytes([bytes[at], bytes[at + 1]])) - intercept) / slope
    };
    let at_hub = |time: usize, point: usize, component: usize| {
        let low = sample(time, below, point, component);
        match share {
            0.0 => low,
            share => low + share * (sample(time, below + 1, point, component) - low),
        }
    };
    let gusts = ALONG_AND_UP.map(|component| {
        let row = |point| (0..times).map(move |time| at_hub(time, point, component));
        let rows = (0..across).map(|point| without_mean(row(point).collect()));
        rows.collect::<Vec<_>>()
    });
    let middle = 0.5 * (across - 1) as f64;
    let along = |point: usize| (point as f64 - middle) * head.steps[1];
    Ok(FieldTable {
        step_s: head.steps[2],
        along_m: (0..across).map(along).collect(),
        from_middle: true,
        mean_speed_m_s: Some(head.mean_speed_m_s),
        gusts,
    })
}

fn without_mean(mut samples: Vec<f64>) -> Vec<f64> {
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    samples.iter_mut().for_each(|x| *x -= mean);
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field of 2 rows of 3 points and one of the tower, 4 times: `u = 20 + t + 10 p + 100 r`, `w = −u/2`.
    fn file() -> Vec<u8> {
        let mut bytes = Vec::new();
        bytes.extend(7_i16.to_le_bytes());
        for count in [2_i32, 3, 1, 4] {
            bytes.extend(count.to_le_bytes());
        }
        for number in [10.0_f32, 50.0, 0.25, 20.0, 62.5, 60.0] {
            bytes.extend(number.to_le_bytes());
        }
        for scale in [100.0_f32, -5000.0, 1.0, 0.0, 200.0, 7.0] {
            bytes.extend(scale.to_le_bytes());
        }
        bytes.extend(2_i32.to_le_bytes());
        bytes.extend(b"ab");
        let mut put = |x: f32, slope: f32, intercept: f32| {
            bytes.extend(((x * slope + intercept) as i16).to_le_bytes());
        };
        for t in 0..4 {
            for point in 0..7 {
                let u = 20.0 + t as f32 + 10.0 * (point % 3) as f32 + 100.0 * (point / 3) as f32;
                put(u, 100.0, -5000.0);
                put(0.0, 1.0, 0.0);
                put(-0.5 * u, 200.0, 7.0);
            }
        }
        bytes
    }

    #[test]
    fn a_field_is_read_at_the_height_of_the_hub() {
        let field = parse(&file()).unwrap();
        assert_eq!(field.along_m, [-50.0, 0.0, 50.0]);
        assert!((field.step_s - 0.25).abs() < 1e-7);
        assert!(field.from_middle);
        assert_eq!(field.mean_speed_m_s, Some(20.0));
        assert_eq!(field.odd_speed(20.9).unwrap(), None);
        let odd = field.odd_speed(22.0).unwrap().unwrap();
        assert_eq!(
            odd,
            "the turbulence is that of 20.000 m/s, the response at 22 m/s"
        );
        let refused = field.odd_speed(72.0).unwrap_err().to_string();
        assert_eq!(
            refused,
            "mean wind speed: expected about the 20.000 m/s of the turbulence, found 72 m/s (3.6 times that: km/h for m/s?)"
        );
        for point in 0..3 {
            for t in 0..4 {
                // the mean over the times is taken off; what remains is the same in every row
                let expected = t as f64 - 1.5;
                assert!((field.gusts[0][point][t] - expected).abs() < 1e-9);
                assert!((field.gusts[1][point][t] + 0.5 * expected).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn what_is_no_such_file_is_refused_with_its_place() {
        let changed = |at: usize, to: &[u8]| {
            let mut bytes = file();
            bytes[at..at + to.len()].copy_from_slice(to);
            bytes
        };
        for (bytes, expected) in [
            (changed(0, &[1, 0]), "byte 0: expected 7 or 8"),
            (
                changed(6, &(-1_i32).to_le_bytes()),
                "byte 6, points across: expected 2 or more, found -1",
            ),
            (
                changed(26, &0.0_f32.to_le_bytes()),
                "time step: expected a number above 0",
            ),
            (
                changed(26, &f32::NAN.to_le_bytes()),
                "byte 26, time step: expected a finite number",
            ),
            (
                changed(34, &75.0_f32.to_le_bytes()),
                "height of the hub: expected one within the grid, 60 to 70 m, found 75 m",
            ),
            (
                changed(42, &0.0_f32.to_le_bytes()),
                "slope of component 1: expected a number other than 0",
            ),
            (file()[..40].to_vec(), "byte 38: expected lowest height"),
            (file()[..100].to_vec(), "as the head of the file says"),
            (Vec::new(), "byte 0: expected the kind of file"),
        ] {
            let message = parse(&bytes).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
