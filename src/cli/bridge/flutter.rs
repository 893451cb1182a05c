//! `aerodeck bridge flutter`: onset, modes that take part, curves, the motion at flutter.

use super::files::{
    BridgeArgs, CURVES, DERIVATIVES_FIGURE, FLUTTER_FIGURE, MOTION_FIGURE, RESPONSE_FIGURE,
    ROOTS_FIGURE,
};
use super::summary::{BridgeSummary, leave_inputs};
use super::text;
use crate::cli::figures;
use crate::cli::report::folder::{REPORT, SUMMARY, is_of_a_study};
use crate::cli::report::{self, page_of};
use crate::cli::result_files::{beside_models, curves_csv, over_v_hat};
use crate::cli::text::ending;
use crate::cli::vocabulary::{
    Answer, BridgeStudy, OutputDir, PlottedSeries, Progress, Result, TimePanel, Verdict, csv_cell,
    derivative_lines,
};
use crate::flutter::ModePoint;
use crate::report::{
    bridge_curves_figure, bridge_roots_figure, flutter_motion_figure, scaled_history_figure,
};
use crate::study::bridge::BridgeMotion;
use crate::study::bridge::{
    BridgeFlutter, DerivativeScatter, Scatter, block_table, bridge_flutter,
};
use crate::uncertainty::SampledOnsets;
use nalgebra::Complex;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

/// Phases of an animation over one period.
const PHASES: usize = 24;
/// Speeds over the onset.
const AROUND: [f64; 3] = [0.95, 1.0, 1.05];
/// Periods that are shown, and points of each.
const PERIODS: (usize, usize) = (16, 40);
/// Rotation at the release, degrees.
const RELEASED_DEG: f64 = 1.0;

/// Flutter of a whole bridge: onset by tables and by model, modes that take part, V-f and V-ζ, motion at flutter, divergence
///
/// Example: aerodeck bridge flutter bridge.toml --out results
/// Example: aerodeck bridge flutter bridge.toml --samples 1000 --scatter-frequency 0.02
/// Example: aerodeck bridge flutter bridge.toml --samples 1000 --scatter-derivatives measured
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct BridgeFlutterArgs {
    #[command(flatten)]
    bridge: BridgeArgs,
    /// Samples of a bridge whose frequencies, damping and derivatives scatter; without, none.
    #[arg(long)]
    samples: Option<usize>,
    /// Standard deviation of each natural frequency over its mean.
    #[arg(long, default_value_t = 0.02)]
    scatter_frequency: f64,
    /// Standard deviation of each damping ratio over its mean.
    #[arg(long, default_value_t = 0.3)]
    scatter_damping: f64,
    /// Standard deviation of the derivatives of each force by each motion over their mean; `measured` for the covariance of the
    /// models' fits.
    #[arg(long, default_value = "0.05")]
    scatter_derivatives: DerivativeScatter,
    /// Seed of the samples.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Runs the command.
pub(super) fn run(args: &BridgeFlutterArgs, progress: &Progress) -> Result<Answer> {
    let scatter = args.scatter()?;
    let study = args.bridge.study(progress)?;
    let mut out = args.bridge.out()?;
    let (results, mut failed) = computed(&study, &mut out, progress)?;
    let scattered = scatter.zip(results.onset()).map(|(scatter, onset)| {
        progress.counting("samples of the bridge", |on_done| {
            study.scattered_onset(onset, &scatter, on_done)
        })
    });
    let scattered = scattered.transpose().unwrap_or_else(|e| {
        failed.push(format!("scatter: {e}"));
        None
    });
    let verdict = Verdict::judge(&study.evidence(&results, &failed));
    let mut text = text::text(&study, &results, &verdict, progress.verbose);
    let no_onset = args.samples.filter(|_| results.onset().is_none());
    let no_onset = no_onset.map(|_| "Scatter: none, the models have no onset".to_owned());
    let line = scattered.as_ref().map(scatter_line).or(no_onset);
    text.extend(line.iter().map(|line| format!("{line}\n")));
    let inputs = leave_inputs(&args.bridge.bridge, &study.file, &mut out)?;
    text.extend(failed.iter().map(|failed| format!("failed: {failed}\n")));
    if is_of_a_study(&out.target(SUMMARY)) {
        text.push_str("The folder already holds the report of a study, which was kept; --out with another folder writes the report of the bridge\n");
    } else {
        let mut summary = BridgeSummary {
            bridge_file: args.bridge.text()?,
            command: args.command(scattered.is_some()),
            inputs,
            failed: failed.clone(),
            ..BridgeSummary::new(&study, &results, &verdict)?
        };
        summary.comparisons.extend(line);
        leave(&mut summary, &mut out)?;
    }
    let mut json = serde_json::json!({
        "bridge": study.file.name, "verdict": verdict, "onsets": results.onsets().collect::<Vec<_>>(), "flutter": results, "scatter": scattered, "notes": study.warnings(), "findings": study.findings, "failed": failed
    });
    if scattered.is_some() {
        json["scatter"]["scatter"] = serde_json::json!(scatter);
    }
    let written = out.commit()?;
    text.push_str(&ending(&written, text::MORE, progress.verbose));
    json["files"] = serde_json::json!(written);
    Ok(Answer::new(text, &json)?
        .passed_if(failed.is_empty())
        .with_outcome_of(&verdict))
}

impl BridgeFlutterArgs {
    /// What makes the results again, in the folder of the bridge file.
    fn command(&self, scattered: bool) -> String {
        let file = self.bridge.bridge.file_name().unwrap_or_default();
        let scatter = match self.samples.filter(|_| scattered) {
            None => String::new(),
            Some(samples) => format!(
                " --samples {samples} --scatter-frequency {} --scatter-damping {} --scatter-derivatives {} --seed {}",
                self.scatter_frequency, self.scatter_damping, self.scatter_derivatives, self.seed
            ),
        };
        format!(
            "aerodeck bridge flutter {}{scatter} --out results",
            file.display()
        )
    }

    /// What scatters, where samples are asked for.
    fn scatter(&self) -> Result<Option<Scatter>> {
        let Some(samples) = self.samples else {
            return Ok(None);
        };
        let scatter = Scatter {
            frequency: self.scatter_frequency,
            damping: self.scatter_damping,
            derivatives: self.scatter_derivatives,
            samples,
            seed: self.seed,
        };
        scatter.check([
            "--scatter-frequency",
            "--scatter-damping",
            "--scatter-derivatives",
            "--samples",
        ])?;
        Ok(Some(scatter))
    }
}

fn scatter_line(onsets: &SampledOnsets) -> String {
    let (mean, deviation) = (onsets.mean_m_s, onsets.standard_deviation_m_s);
    let ([low, high], with) = (onsets.interval_m_s, onsets.speeds_m_s.len());
    let samples = with + onsets.without_onset;
    format!(
        "Scatter of {samples} samples, {with} of them with an onset: {mean:.3} m/s, standard deviation {deviation:.3} m/s, 95 % of these between {low:.3} and {high:.3} m/s"
    )
}

/// The results, with figures and tables in `out`, and what failed.
pub(super) fn computed(
    study: &BridgeStudy,
    out: &mut OutputDir,
    progress: &Progress,
) -> Result<(BridgeFlutter, Vec<String>)> {
    let results = progress.during("flutter of the bridge", || bridge_flutter(study))?;
    let mut failed = results.failed.clone();
    if let Err(e) = staged(study, &results, out) {
        failed.push(format!("figures: {e}"));
    }
    Ok((results, failed))
}

/// Leaves the summary and the page that is made from it, with the names of all files in the summary.
pub(super) fn leave(summary: &mut BridgeSummary, out: &mut OutputDir) -> Result<()> {
    out.stage(REPORT)?;
    out.stage(SUMMARY)?;
    summary.files = out.targets();
    out.write_json(SUMMARY, "summary", summary)?;
    report::leave(out)
}

/// Writes the report of `folder` again where it is of the bridge file with this text: it takes up what was computed since.
pub(super) fn renew(folder: &Path, text: &str) -> Result<()> {
    let summary = std::fs::read_to_string(folder.join(SUMMARY)).unwrap_or_default();
    let summary = serde_json::from_str::<serde_json::Value>(&summary).unwrap_or_default();
    if summary["bridge_file"] != text {
        return Ok(());
    }
    let page = page_of(folder)?;
    let mut out = OutputDir::new(folder)?;
    out.write(REPORT, page)?;
    out.commit().map(drop)
}

/// Stages figures and tables.
fn staged(study: &BridgeStudy, results: &BridgeFlutter, out: &mut OutputDir) -> Result<()> {
    for stem in [FLUTTER_FIGURE, ROOTS_FIGURE, RESPONSE_FIGURE, MOTION_FIGURE] {
        figures::outdated(stem, out);
    }
    for name in [CURVES, "flutter_motion.csv", "flutter_animation.csv"] {
        out.outdated(name);
    }
    out.outdated_numbered(DERIVATIVES_FIGURE);
    let verdict = &Verdict::judge(&study.evidence(results, &results.failed));
    let title = format!("{}: modes over wind speed", study.file.name);
    // where no mode can be followed there is nothing to draw; the card says so
    if results.curves.branches.iter().any(|b| !b.points.is_empty()) {
        let draw = || bridge_curves_figure(results, verdict, &title);
        figures::write(FLUTTER_FIGURE, out, draw)?;
        let title = format!("{}: eigenvalues as the wind rises", study.file.name);
        figures::write(ROOTS_FIGURE, out, || bridge_roots_figure(results, &title))?;
        let curves = std::slice::from_ref(&results.curves);
        out.write(CURVES, curves_csv(&study.file.name, curves))?;
    }
    if let Some(panels) = panels(results) {
        let title = format!("{}: the mode that flutters", study.file.name);
        let draw = || scaled_history_figure(&title, &panels, "Time t (s)", 2);
        figures::write(RESPONSE_FIGURE, out, draw)?;
    }
    for number in 0..study.sections.len() {
        write_derivatives(study, number, out)?;
    }
    if let Some(motion) = results.answers.last().and_then(|a| a.motion.as_ref()) {
        let title = format!("{}: motion at flutter", study.file.name);
        let draw = || flutter_motion_figure(motion, 0.5 * study.by_model.width_m(), &title);
        figures::write(MOTION_FIGURE, out, draw)?;
        out.write("flutter_motion.csv", motion_csv(motion))?;
        out.write("flutter_animation.csv", animation_csv(motion))?;
    }
    Ok(())
}

/// The model of a section beside the derivatives that were measured; nothing for one of static coefficients.
fn write_derivatives(study: &BridgeStudy, number: usize, out: &mut OutputDir) -> Result<()> {
    let (block, forces) = (&study.file.sections[number], &study.sections[number]);
    let Some(tested) = forces.tested else {
        return Ok(());
    };
    let table = block.derivatives.as_ref();
    let table = table.map(|name| block_table(block, name, &study.file.directory));
    let table = table.transpose()?;
    let model = forces.model.as_ref();
    let lines = derivative_lines(model, tested.min.v_hat())?;
    let fitted = vec![("model".to_owned(), lines)];
    let intervals = forces.derivative_intervals()?;
    let (table, dofs) = (table.as_ref(), model.dofs());
    let one = |d| beside_models(d, table, dofs, &fitted, &Vec::new(), &intervals);
    let title = format!("{}: measured derivatives and the model", block.name);
    let bars = "95 % interval of the model";
    let stem = format!("{DERIVATIVES_FIGURE}{}", number + 1);
    figures::write(&stem, out, || over_v_hat(&title, bars, one))
}

fn motion_csv(motion: &BridgeMotion) -> String {
    let mut text = "# displacement at the time t is re*cos(omega t) - im*sin(omega t); rotations over half the width\n\
                    node,along_m,vertical_re,vertical_im,lateral_re,lateral_im,rotation_re,rotation_im\n"
        .to_owned();
    for n in &motion.nodes {
        let parts = n.motion.as_flattened().iter().map(f64::to_string);
        let parts = parts.collect::<Vec<_>>().join(",");
        let _ = writeln!(text, "{},{},{parts}", csv_cell(&n.node), n.along_m);
    }
    text
}

/// One row per phase and node, for programs that animate points.
fn animation_csv(motion: &BridgeMotion) -> String {
    let mut text = "phase,node,along_m,vertical,lateral,rotation\n".to_owned();
    for i in 0..PHASES {
        let phase = i as f64 / PHASES as f64;
        let (sin, cos) = (TAU * phase).sin_cos();
        for n in &motion.nodes {
            let [y, x, t] = n.motion.map(|z| z[0] * cos - z[1] * sin);
            let (node, along_m) = (csv_cell(&n.node), n.along_m);
            let _ = writeln!(text, "{phase},{node},{along_m},{y},{x},{t}");
        }
    }
    text
}

/// Vertical and lateral displacement (m) and rotation (degrees) of the node that turns most, by the shape at the onset and the
/// eigenvalues at the speeds of the curves nearest to those around it; `None` where no mode that flutters was followed.
fn panels(results: &BridgeFlutter) -> Option<Vec<TimePanel>> {
    let onset = results.onset()?;
    let z = displaced(results.answers.last()?.motion.as_ref()?)?;
    let mut branches = results.curves.branches.iter();
    let branch = branches.find(|b| b.name == onset.branch)?;
    let mut runs = Vec::with_capacity(AROUND.len());
    for factor in AROUND {
        let wanted = factor * onset.at.speed_m_s;
        let distance = |p: &&ModePoint| (p.speed_m_s - wanted).abs();
        let nearest = branch.points.iter();
        let nearest = nearest.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        runs.push(if factor == 1.0 {
            let label = format!("{:.1} m/s, the onset", onset.at.speed_m_s);
            (label, Complex::new(0.0, TAU * onset.at.frequency_hz))
        } else {
            let (speed, lambda) = (nearest.speed_m_s, nearest.eigenvalue);
            let percent = 100.0 * (speed / onset.at.speed_m_s - 1.0);
            let label = format!("{speed:.1} m/s ({percent:+.1} %)");
            (label, Complex::new(lambda.re, lambda.im))
        });
    }
    let period = TAU / runs[0].1.im;
    let names = ["vertical y (m)", "lateral x (m)", "rotation θ (°)"];
    let panel = |(i, name): (usize, &str)| {
        let series = runs.iter().map(|(label, lambda)| {
            let points = (0..=PERIODS.0 * PERIODS.1).map(|n| {
                let t = period * n as f64 / PERIODS.1 as f64;
                (t, (z[i] * (lambda * t).exp()).re)
            });
            PlottedSeries::new(label.clone(), points.collect())
        });
        TimePanel::new(name, series)
    };
    Some(names.into_iter().enumerate().map(panel).collect())
}

/// Motion of the node that turns most, with that rotation 1° and real.
fn displaced(motion: &BridgeMotion) -> Option<[Complex<f64>; 3]> {
    let [y, x, theta] = motion.turning_most()?;
    let unit = theta / RELEASED_DEG.to_radians();
    Some([y / unit, x / unit, theta / unit * 1f64.to_degrees()])
}
