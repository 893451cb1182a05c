//! How cost grows: every curve measured point by point, each in a process of its own, with the exponent that fits and the one
//! that theory gives; as a table and as a figure.

mod curves;

use crate::performance;
use crate::table::time_in_words;
use aerodeck::report::{GrowthPanel, growth_figure};
use curves::{CURVES, CurveKind, GrowthCurve};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

/// Points that would take longer are left out.
const LONGEST_S: f64 = 60.0;
/// What is quick is done again until it has taken so long.
const AT_LEAST_S: f64 = 0.1;
/// Only points of the upper two decades tell the exponent: below, what does not grow counts for too much.
const DECADES: f64 = 100.0;
/// An exponent may be higher than that of theory by this before the table says so.
const TOLERANCE: f64 = 0.15;

/// One point, as its process finds it.
#[derive(Serialize, Deserialize)]
struct Measurement {
    size: u64,
    seconds: f64,
    peak_mib: Option<f64>,
    answer: Vec<f64>,
}

/// A curve, measured.
struct Measured<'a> {
    curve: &'a GrowthCurve,
    points: Vec<Measurement>,
    left_out: Vec<u64>,
}

/// Does the job of a curve at one size and prints what it takes, for [`GrowthCurve::point`].
pub(crate) fn print_point(name: &str, size: &str) -> Result<(), String> {
    let named = CURVES.iter().find(|c| c.name == name);
    let curve = named.ok_or_else(|| format!("no curve `{name}`"))?;
    let size = size.parse().map_err(|e| format!("{size}: {e}"))?;
    let mut job = (curve.job)(size);
    let mut timed = |times: u32| {
        let begin = Instant::now();
        job.run(times);
        begin.elapsed().as_secs_f64()
    };
    let mut seconds = timed(1);
    // the first of many calls prepares the others
    if seconds < 1.0 || curve.kind == CurveKind::Call {
        let mut times = 1;
        while timed(times) < AT_LEAST_S {
            times *= 2;
        }
        let rounds = (0..3).map(|_| timed(times) / f64::from(times));
        seconds = rounds.fold(f64::INFINITY, f64::min);
    }
    let point = Measurement {
        size,
        seconds,
        peak_mib: crate::peak::peak_mib(),
        answer: job.answer(),
    };
    println!("{}", serde_json::json!(point));
    Ok(())
}

impl GrowthCurve {
    fn point(&self, size: u64) -> Result<Measurement, String> {
        let program = std::env::current_exe().map_err(|e| e.to_string())?;
        let mut command = Command::new(program);
        command.args(["--point", self.name, &size.to_string()]);
        if self.kind == CurveKind::Threads {
            command.env("RAYON_NUM_THREADS", size.to_string());
        }
        let output = command.stderr(Stdio::inherit()).output();
        let output = output.map_err(|e| e.to_string())?;
        serde_json::from_slice(&output.stdout)
            .map_err(|e| format!("{} at {size}: {} ({e})", self.name, output.status))
    }

    fn measured(&self) -> Result<Measured<'_>, String> {
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get() as u64);
        let sizes = match self.kind {
            CurveKind::Threads => (1..=threads).collect(),
            _ => self.sizes.to_vec(),
        };
        let (mut points, mut left_out) = (Vec::<Measurement>::new(), Vec::new());
        for size in sizes {
            let expected =
                |p: &Measurement| p.seconds * self.ratio(size, p.size).powf(self.exponent);
            if points.last().map_or(0.0, expected) > LONGEST_S {
                left_out.push(size);
                continue;
            }
            points.push(self.point(size)?);
        }
        Ok(Measured {
            curve: self,
            points,
            left_out,
        })
    }

    fn ratio(&self, size: u64, to: u64) -> f64 {
        (self.measure)(size) / (self.measure)(to)
    }
}

impl Measured<'_> {
    fn last(&self) -> &Measurement {
        &self.points[self.points.len() - 1]
    }

    /// Slope of the logarithms by least squares, in the upper decades.
    fn exponent(&self) -> f64 {
        let near = |p: &&Measurement| self.curve.ratio(self.last().size, p.size) <= DECADES;
        let places = self.points.iter().filter(near);
        let logarithm = |p: &Measurement| ((self.curve.measure)(p.size).ln(), p.seconds.ln());
        let places: Vec<(f64, f64)> = places.map(logarithm).collect();
        let count = places.len() as f64;
        let (x, y) = places
            .iter()
            .fold((0.0, 0.0), |s, p| (s.0 + p.0 / count, s.1 + p.1 / count));
        let products = places.iter().map(|p| (p.0 - x) * (p.1 - y));
        let squares = places.iter().map(|p| (p.0 - x).powi(2));
        products.sum::<f64>() / squares.sum::<f64>()
    }

    /// What the curve should be and is not, in words.
    fn findings(&self) -> Vec<String> {
        let (curve, found) = (self.curve, self.exponent());
        let mut findings = Vec::new();
        if curve.kind != CurveKind::Threads && found > curve.exponent + TOLERANCE {
            let why = Some(curve.beyond).filter(|why| !why.is_empty());
            let why = why.map_or(String::new(), |why| format!(": {why}"));
            findings.push(format!("grows faster than its theory{why}"));
        }
        let peaks: Vec<f64> = self.points.iter().filter_map(|p| p.peak_mib).collect();
        let most = peaks.iter().copied().fold(0.0, f64::max);
        let grown = most > 2.0 * peaks.first().copied().unwrap_or(most);
        match curve.kind {
            CurveKind::Streamed if grown => {
                findings.push(format!(
                    "memory grows by {:.1} bytes each",
                    self.bytes_each()
                ));
            }
            CurveKind::Streamed => findings.push(format!("memory at most {most:.0} MiB")),
            CurveKind::Threads if self.points.iter().any(|p| p.answer != self.last().answer) => {
                findings.push("other bits for another number of threads".to_owned());
            }
            CurveKind::Threads if !self.last().answer.is_empty() => {
                findings.push("the same bits for each".to_owned());
            }
            _ => {}
        }
        if let (Some(first), Some(last)) = (self.left_out.first(), self.left_out.last()) {
            let range = match first == last {
                true => first.to_string(),
                false => format!("{first} to {last}"),
            };
            findings.push(format!("{range} left out"));
        }
        findings
    }

    /// CurveKind of the peak between the two largest sizes, over that of the size.
    fn bytes_each(&self) -> f64 {
        let [.., before, last] = &self.points[..] else {
            return f64::NAN;
        };
        let mib = |p: &Measurement| p.peak_mib.unwrap_or(f64::NAN);
        (mib(last) - mib(before)) * 1024.0 * 1024.0 / (last.size - before.size) as f64
    }

    /// What goes into so many seconds, by the steeper of the two exponents.
    fn fits_into(&self, seconds: f64) -> String {
        let (curve, last) = (self.curve, self.last());
        let more = seconds / last.seconds;
        match curve.kind {
            CurveKind::Call => format!("{} at {} {}", power(more), last.size, unit(curve)),
            CurveKind::Threads => "–".to_owned(),
            CurveKind::Whole | CurveKind::Streamed => {
                let exponent = self.exponent().max(curve.exponent);
                let measure = (curve.measure)(last.size) * more.powf(1.0 / exponent);
                format!("{} {}", power(measure), short(curve.of))
            }
        }
    }

    fn row(&self) -> String {
        let (curve, last) = (self.curve, self.last());
        let cells = [
            format!("`{}` {}", curve.name, curve.what),
            format!("{} to {} {}", self.points[0].size, last.size, unit(curve)),
            time_in_words(last.seconds),
            format!("{:.2}", self.exponent()),
            format!("{:.0}: {}", curve.exponent, curve.reason),
            self.fits_into(60.0),
            self.fits_into(3600.0),
            self.findings().join("; "),
        ];
        format!("| {} |\n", cells.join(" | "))
    }

    fn panel(&self) -> GrowthPanel {
        let (curve, last) = (self.curve, self.last());
        let found = self.exponent();
        let place = |p: &Measurement| ((curve.measure)(p.size), p.seconds);
        let line = |exponent: f64| {
            let end = place(last);
            let start = (curve.measure)(self.points[0].size);
            vec![(start, end.1 * (start / end.0).powf(exponent)), end]
        };
        GrowthPanel {
            title: format!("{}: {found:.2} ({:.0})", curve.what, curve.exponent),
            x_label: match self.left_out.is_empty() {
                true => curve.of.to_owned(),
                false => format!("{} (larger ones left out)", curve.of),
            },
            measured: self.points.iter().map(place).collect(),
            fitted: line(found),
            expected: line(curve.exponent),
        }
    }
}

/// A number as a table wants it, to two digits.
fn power(x: f64) -> String {
    let digits = format!("{x:.1e}");
    let (lead, exponent) = digits.split_once('e').unwrap_or((&digits, "0"));
    format!("{lead}·10^{exponent}")
}

/// What the sizes themselves count.
fn unit(curve: &GrowthCurve) -> &str {
    if curve.of.contains("nodes") {
        "modes"
    } else {
        short(curve.of)
    }
}

fn short(of: &str) -> &str {
    of.split([',', ' '])
        .next()
        .filter(|_| !of.contains('×'))
        .unwrap_or(of)
}

const HEAD: [&str; 8] = [
    "what",
    "measured",
    "at the largest",
    "exponent",
    "theory",
    "in a minute",
    "in an hour",
    "",
];

/// Measures the curves of these names, or all, and prints a row for each; with `write` also into the page, with the figure.
pub(crate) fn run(names: &[&str], write: bool) -> Result<(), String> {
    let mut text = format!("| {} |\n|{}\n", HEAD.join(" | "), "---|".repeat(HEAD.len()));
    print!("{text}");
    let mut panels = Vec::new();
    let wanted = |c: &&GrowthCurve| names.is_empty() || names.iter().any(|n| c.name.starts_with(n));
    for curve in CURVES.iter().filter(wanted) {
        let measured = curve.measured()?;
        let row = measured.row();
        print!("{row}");
        text += &row;
        panels.push(measured.panel());
    }
    if !write {
        return Ok(());
    }
    let title = "How cost grows: exponent as fitted (by theory)";
    let figure = growth_figure(title, &panels, "seconds").map_err(|e| e.to_string())?;
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    figure.write(docs, "growth").map_err(|e| e.to_string())?;
    performance::write("growth", &performance::head(), &text)
}
