//! `aerodeck bridge flutter`: onset, modes that take part, curves, the motion at flutter.

use super::super::answer::Answer;
use super::super::output::{OutputDir, list};
use super::super::progress::Progress;
use super::{BridgeArgs, account, stage_figure};
use crate::error::Result;
use crate::flutter::BridgeMotion;
use crate::report::{bridge_curves_figure, flutter_motion_figure};
use crate::study::bridge::{BridgeFlutter, BridgeStudy, Scatter, ScatteredOnset, bridge_flutter};
use std::fmt::Write as _;

/// Phases of an animation over one period.
const PHASES: usize = 24;

/// Flutter of a whole bridge: onset by tables and by model, modes that take part, V-f and V-ζ, motion at flutter, divergence
///
/// Example: aerodeck bridge flutter bridge.toml --out results
/// Example: aerodeck bridge flutter bridge.toml --samples 1000 --scatter-frequency 0.02
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
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
    /// Standard deviation of the derivatives of each force by each motion over their mean.
    #[arg(long, default_value_t = 0.05)]
    scatter_derivatives: f64,
    /// Seed of the samples.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Runs the command.
pub fn run(args: &Args, progress: &Progress) -> Result<Answer> {
    let study = args.bridge.study(progress)?;
    let mut out = args.bridge.out()?;
    let results = computed(&study, progress)?;
    let mut failed = results.failed.clone();
    if let Err(e) = staged(&study, &results, &mut out) {
        failed.push(format!("figures: {e}"));
    }
    let scattered = args
        .scattered(&study, &results, progress)
        .unwrap_or_else(|e| {
            failed.push(format!("scatter: {e}"));
            None
        });
    let written = out.commit()?;
    let mut text = account::card(&study, &results);
    if let Some(s) = &scattered {
        let _ = writeln!(
            text,
            "Scatter of {} samples: {:.3} m/s, standard deviation {:.3} m/s, 95 % between {:.3} and {:.3} m/s; {} without onset",
            s.scatter.samples,
            s.mean_m_s,
            s.standard_deviation_m_s,
            s.interval_m_s[0],
            s.interval_m_s[1],
            s.without_onset
        );
    }
    for failure in &failed {
        let _ = writeln!(text, "failed: {failure}");
    }
    text.push_str(&list(&written));
    let json = serde_json::json!({
        "bridge": study.file.name, "flutter": results, "scatter": scattered, "notes": study.notes, "failed": failed, "files": written
    });
    Ok(Answer::new(text, &json)?.with_verdict(failed.is_empty()))
}

impl Args {
    fn scattered(
        &self,
        study: &BridgeStudy,
        results: &BridgeFlutter,
        progress: &Progress,
    ) -> Result<Option<ScatteredOnset>> {
        let onset = results.answers.last().and_then(|a| a.search.onset());
        let (Some(samples), Some(onset)) = (self.samples, onset) else {
            return Ok(None);
        };
        let scatter = Scatter {
            frequency: self.scatter_frequency,
            damping: self.scatter_damping,
            derivatives: self.scatter_derivatives,
            samples,
            seed: self.seed,
        };
        let stage = progress.stage("scatter of the onset");
        let found = study.scattered_onset(onset, &scatter);
        drop(stage);
        found.map(Some)
    }
}

/// The results, with progress.
pub(crate) fn computed(study: &BridgeStudy, progress: &Progress) -> Result<BridgeFlutter> {
    let stage = progress.stage("flutter of the bridge");
    let results = bridge_flutter(study);
    drop(stage);
    results
}

/// Stages figures and tables.
pub(crate) fn staged(
    study: &BridgeStudy,
    results: &BridgeFlutter,
    out: &mut OutputDir,
) -> Result<()> {
    let answer = results.answers.last();
    let motion = answer.and_then(|a| a.motion.as_ref());
    let shown: Vec<String> = motion
        .iter()
        .flat_map(|m| m.modes.iter().take(6))
        .map(|m| format!("mode {}", m.mode))
        .collect();
    let onset = answer.and_then(|a| a.search.onset()).map(|o| &o.at);
    let title = format!("{}: modes over wind speed", study.file.name);
    // where no mode can be followed there is nothing to draw; the card says so
    if results.curves.branches.iter().any(|b| !b.points.is_empty()) {
        let figure = bridge_curves_figure(&results.curves, &shown, onset, &title)?;
        stage_figure(&figure, "bridge_flutter", out)?;
        out.write("bridge_curves.csv", curves_csv(results))?;
    }
    if let Some(motion) = motion {
        let title = format!("{}: motion at flutter", study.file.name);
        let figure = flutter_motion_figure(motion, 0.5 * study.by_model.width_m(), &title)?;
        stage_figure(&figure, "flutter_motion", out)?;
        out.write("flutter_motion.csv", motion_csv(motion))?;
        out.write("flutter_animation.csv", animation_csv(motion))?;
    }
    Ok(())
}

fn curves_csv(results: &BridgeFlutter) -> String {
    let mut text = "branch,speed_m_s,frequency_hz,damping_ratio\n".to_owned();
    for branch in &results.curves.branches {
        for p in &branch.points {
            let _ = writeln!(
                text,
                "{},{},{},{}",
                branch.name, p.speed_m_s, p.frequency_hz, p.damping_ratio
            );
        }
    }
    text
}

fn motion_csv(motion: &BridgeMotion) -> String {
    let mut text = "# displacement at the time t is re*cos(omega t) - im*sin(omega t); rotations over half the width\n\
                    node,along_m,vertical_re,vertical_im,lateral_re,lateral_im,rotation_re,rotation_im\n"
        .to_owned();
    for n in &motion.nodes {
        let [y, x, t] = n.motion;
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{}",
            n.node, n.along_m, y[0], y[1], x[0], x[1], t[0], t[1]
        );
    }
    text
}

/// One row a phase and node: what a program that animates points reads.
fn animation_csv(motion: &BridgeMotion) -> String {
    let mut text = "phase,node,along_m,vertical,lateral,rotation\n".to_owned();
    for i in 0..PHASES {
        let phase = i as f64 / PHASES as f64;
        let (sin, cos) = (std::f64::consts::TAU * phase).sin_cos();
        for n in &motion.nodes {
            let [y, x, t] = n.motion.map(|z| z[0] * cos - z[1] * sin);
            let _ = writeln!(text, "{phase},{},{},{y},{x},{t}", n.node, n.along_m);
        }
    }
    text
}
