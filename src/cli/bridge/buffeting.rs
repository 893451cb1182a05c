//! `aerodeck bridge buffeting`: RMS and peak factors at named nodes.

use super::buffeting_page::{self, forces, of_motion};
use super::files::{BUFFETING_PAGE, BridgeArgs};
use super::flutter::renew;
use crate::cli::headline;
use crate::cli::vocabulary::{
    Answer, BridgeStudy, Error, Finding, Progress, Result, TextTable, Verdict, csv_cell, rendered,
    sentences, warn,
};
use crate::files::bridge::{FieldTable, read_field};
use crate::study::bridge::{BridgeBuffeting, BuffetingBlock};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Response of a whole bridge to turbulence at a wind speed, in the frequency and the time domain
///
/// Example: aerodeck bridge buffeting bridge.toml --speed 35 --out results
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct BridgeBuffetingArgs {
    #[command(flatten)]
    bridge: BridgeArgs,
    /// Mean wind speeds of the bridge, m/s (30,40,50); left out, those of [buffeting].
    #[arg(long, value_delimiter = ',')]
    speed: Vec<f64>,
    /// Write the turbulence of the first record as turbulence.csv: time, then u and w of every node.
    #[arg(long)]
    field: bool,
    /// Take the turbulence of this file instead of making records: written as by --field, or by TurbSim (`.bts`).
    /// One wind speed, and nothing is written.
    #[arg(long, conflicts_with_all = ["field", "out"])]
    turbulence: Option<PathBuf>,
}

/// Runs the command.
pub(super) fn run(args: &BridgeBuffetingArgs, progress: &Progress) -> Result<Answer> {
    let study = args.bridge.study(progress)?;
    let block = study.buffeting_block();
    let block = block.map_err(|e| e.in_file(&args.bridge.bridge))?;
    if let Some(path) = &args.turbulence {
        return by_file(args, &study, &block, path);
    }
    let speeds = args.speeds(&block)?;
    let mut out = args.bridge.out()?;
    let (all, unstable) = responses(&study, &block, &speeds, progress)?;
    warn(&args.bridge.bridge, &unstable);
    let (results, whole) = match &all[..] {
        [one] if speeds.len() == 1 => (serde_json::json!(one), serde_json::json!(one)),
        all => (serde_json::json!(all), serde_json::json!({ "speeds": all })),
    };
    out.write_json("bridge_buffeting.json", "bridge-buffeting-results", &whole)?;
    let mut text = String::new();
    out.outdated("bridge_spectra.csv");
    out.outdated_numbered("bridge_spectra_");
    for results in &all {
        let speed = results.frequency.speed_m_s;
        let name = match speeds.len() {
            1 => "bridge_spectra.csv".to_owned(),
            _ => format!("bridge_spectra_{speed}.csv"),
        };
        out.write(name, spectra_csv(results))?;
        let (bridge, forces, table) = (&study.file.name, forces(results), table(results));
        text += &format!("{bridge} at {speed} m/s\n{forces}\n{table}\n");
    }
    text.extend(unstable.iter().map(|why| format!("no answer: {why}\n")));
    if args.field {
        let field = study.first_field(&block, all[0].frequency.speed_m_s)?;
        out.write("turbulence.csv", field_csv(&field))?;
    }
    let file = args.bridge.text()?;
    let verdict = verdict(&study)?;
    let page = buffeting_page::page(&study, &file, &all, &unstable, verdict.as_ref())?;
    out.write(BUFFETING_PAGE, rendered(&page)?)?;
    let folder = out.target("");
    let mut json = value(&study, &study.findings, verdict.as_ref(), &results);
    if !unstable.is_empty() {
        json["unstable"] = serde_json::json!(unstable);
    }
    let text = headline::stated(&study.file.name, verdict.as_ref()) + &text;
    let answer = out.answer(text, json)?.with_outcome_of(verdict.as_ref());
    renew(&folder, &file)?;
    Ok(answer.passed_if(unstable.is_empty()))
}

/// The responses at the speeds that have one, and why the others have none.
///
/// # Errors
/// As [`BridgeStudy::buffeting`]; where no speed has a response, that of the first.
fn responses(
    study: &BridgeStudy,
    block: &BuffetingBlock,
    speeds: &[f64],
    progress: &Progress,
) -> Result<(Vec<BridgeBuffeting>, Vec<String>)> {
    let mut all = Vec::with_capacity(speeds.len());
    let mut unstable = Vec::new();
    progress.counting("records of turbulence", |on_done| {
        for (i, speed) in speeds.iter().enumerate() {
            let told = |done, of| on_done(i * of + done, speeds.len() * of);
            match study.buffeting(block, *speed, &told) {
                Ok(found) => all.push(found),
                // what the others say holds without it
                Err(Error::Unstable(why)) => unstable.push(why),
                Err(e) => return Err(e),
            }
        }
        Ok(())
    })?;
    match all.is_empty() {
        true => Err(Error::Unstable(unstable.swap_remove(0))),
        false => Ok((all, unstable)),
    }
}

impl BridgeBuffetingArgs {
    /// The speeds of the command, or else those of the file.
    fn speeds(&self, block: &BuffetingBlock) -> Result<Vec<f64>> {
        let stated = match self.speed.is_empty() {
            true => &block.speeds_m_s,
            false => &self.speed,
        };
        match stated.is_empty() {
            true => Err(Error::input(
                "--speed",
                "a wind speed, there or as `speeds_m_s` in [buffeting]",
                "none",
            )),
            false => Ok(stated.clone()),
        }
    }
}

/// The verdict on what the file requires: judged where it is stated, also beside a response to turbulence.
fn verdict(study: &BridgeStudy) -> Result<Option<Verdict>> {
    let required = study.file.flutter.required_speed_m_s;
    required.map(|_| study.verdict()).transpose()
}

/// What the answer holds.
fn value(
    study: &BridgeStudy,
    findings: &[Finding],
    verdict: Option<&Verdict>,
    results: &impl Serialize,
) -> serde_json::Value {
    serde_json::json!({
        "verdict": verdict, "buffeting": results, "notes": study.warnings(), "findings": findings
    })
}

/// The response to the turbulence of a file.
fn by_file(
    args: &BridgeBuffetingArgs,
    study: &BridgeStudy,
    block: &BuffetingBlock,
    path: &Path,
) -> Result<Answer> {
    let speeds = args.speeds(block)?;
    let [speed] = speeds[..] else {
        let expected = "one wind speed with --turbulence, that of its file";
        return Err(Error::input("--speed", expected, speeds.len().to_string()));
    };
    let field = read_field(path)?;
    let odd = field.odd_speed(speed).map_err(|e| e.in_file(path))?;
    let of_field = study.findings_of(&field, Some(speed));
    warn(path, &[Vec::from_iter(odd), sentences(&of_field)].concat());
    let found = study.buffeting_by(block, speed, &field);
    let found = found.map_err(|e| e.in_file(path))?;
    let of_nodes = rows(">RMS | >peak f.", &found.nodes, |n, i| {
        let (rms, peak) = (found.rms[n][i], found.peak_factor[n][i]);
        vec![format!("{rms:.5e}"), of_motion(rms, format!("{peak:.3}"))]
    });
    let short = found.too_short.as_ref();
    let text = format!(
        "{} at {speed} m/s in the turbulence of {}\n{}{of_nodes}",
        study.file.name,
        path.display(),
        short.map(|why| format!("{why}\n")).unwrap_or_default()
    );
    let verdict = verdict(study)?;
    let findings = [&study.findings[..], &of_field].concat();
    let json = value(study, &findings, verdict.as_ref(), &found);
    let text = headline::stated(&study.file.name, verdict.as_ref()) + &text;
    Ok(Answer::new(text, &json)?.with_outcome_of(verdict.as_ref()))
}

const MOTIONS: [&str; 3] = ["vertical m", "lateral m", "rotation rad"];

/// A line for each motion of each node, with the figures that `of` has of them.
fn rows(heads: &str, nodes: &[String], of: impl Fn(usize, usize) -> Vec<String>) -> String {
    let mut table = TextTable::new(&format!("node | motion | {heads}"));
    for (n, name) in nodes.iter().enumerate() {
        for (i, motion) in MOTIONS.into_iter().enumerate() {
            let name = [name.clone(), motion.to_owned()];
            table.row(name.into_iter().chain(of(n, i)));
        }
    }
    table.text()
}

fn table(results: &BridgeBuffeting) -> String {
    let heads = ">RMS, freq. | >crossing Hz | >expected | >RMS, time | >std. error | >peak f. | >accel., /s²";
    let frequency = &results.frequency;
    rows(heads, &results.nodes, |n, i| {
        let time = results.time.as_ref().map(|time| {
            [
                format!("{:.5e}", time.rms[n][i]),
                format!("{:.2e}", time.standard_error[n][i]),
                of_motion(time.rms[n][i], format!("{:.3}", time.peak_factor[n][i])),
            ]
        });
        let rms = frequency.rms[n][i];
        let mut cells = vec![
            format!("{rms:.5e}"),
            of_motion(rms, format!("{:.4}", frequency.crossing_frequency_hz[n][i])),
            of_motion(rms, format!("{:.3}", results.expected_peak_factor[n][i])),
        ];
        cells.extend(time.unwrap_or(["–"; 3].map(str::to_owned)));
        let acceleration = results.envelope.acceleration_rms[frequency.nodes[n]][i];
        cells.push(format!("{acceleration:.4e}"));
        cells
    })
}

fn spectra_csv(results: &BridgeBuffeting) -> String {
    let mut text = "# one-sided spectra of the displacements\nfrequency_hz".to_owned();
    for name in &results.nodes {
        for motion in ["vertical_m2_hz", "lateral_m2_hz", "rotation_rad2_hz"] {
            let _ = write!(text, ",{}", csv_cell(&format!("node[{name}].{motion}")));
        }
    }
    text.push('\n');
    let spectra = &results.spectra;
    for (i, frequency) in spectra.frequency_hz.iter().enumerate() {
        let _ = write!(text, "{frequency}");
        for density in &spectra.motion {
            let _ = write!(text, ",{:e}", density[i]);
        }
        text.push('\n');
    }
    text
}

fn field_csv(field: &FieldTable) -> String {
    let mut text = "# turbulence along the span, m/s; u along the wind, w up; columns by the place along the girder, m\ntime_s".to_owned();
    for (name, rows) in ["u", "w"].into_iter().zip(&field.gusts) {
        for along in field.along_m.iter().take(rows.len()) {
            let _ = write!(text, ",{name}[{along}]");
        }
    }
    text.push('\n');
    for i in 0..field.samples() {
        let _ = write!(text, "{}", i as f64 * field.step_s);
        for row in field.gusts.iter().flatten() {
            let _ = write!(text, ",{:.6}", row[i]);
        }
        text.push('\n');
    }
    text
}
