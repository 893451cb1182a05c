//! `aerodeck simulate`: a released section in steady wind, in this process.

use super::answer::Answer;
use super::common::{folder_of, motion_columns};
use super::output::{OutputDir, list};
use super::{figures, stages};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, counted, positive};
use crate::report::{PlottedSeries, TimePanel, time_history_figure};
use crate::response::{Inputs, Outputs, Stepper};
use crate::section::Dof;
use crate::trained_model::TrainedModel;
use serde::Serialize;
use serde_json::json;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Longest run that is kept in memory, in steps.
const MAX_STEPS: f64 = 1e7;

/// Release a section in steady wind and write its motion (`simulation.csv`) and a figure
///
/// Example: aerodeck simulate model.json --wind-speed 35 --stop-time 20
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct SimulateArgs {
    /// The trained model (see `train`).
    model: PathBuf,
    /// Wind speed, m/s; by default that of the model's experiment, just below the onset.
    #[arg(long)]
    wind_speed: Option<f64>,
    /// Length of the run, s.
    #[arg(long)]
    stop_time: Option<f64>,
    /// Step, s.
    #[arg(long)]
    step: Option<f64>,
    /// Where the results go; by default the folder of the model.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// A mode at the wind speed of the run.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct ModeSummary {
    /// Hz.
    frequency_hz: f64,
    /// 1/s; positive when the motion grows.
    growth_rate_per_s: f64,
    /// Of critical damping.
    damping_ratio: f64,
}

/// The modes that vibrate, the least damped first.
fn modes(section: &CoupledSection, speed: f64) -> Result<Vec<ModeSummary>> {
    let mut modes: Vec<ModeSummary> = section
        .at(speed)?
        .damp()?
        .into_iter()
        .filter(|mode| mode.pole.im > 0.0)
        .map(|mode| ModeSummary {
            frequency_hz: mode.pole.im / std::f64::consts::TAU,
            growth_rate_per_s: mode.pole.re,
            damping_ratio: mode.damping_ratio,
        })
        .collect();
    modes.sort_by(|a, b| a.damping_ratio.total_cmp(&b.damping_ratio));
    modes.truncate(section.structure().dofs.len());
    Ok(modes)
}

/// What the motion comes to.
fn verdict(modes: &[ModeSummary]) -> String {
    let Some(m) = modes.first() else {
        return "  no mode vibrates at this wind speed\n".to_owned();
    };
    let says = if m.growth_rate_per_s > 0.0 {
        "the motion GROWS"
    } else {
        "the motion dies down"
    };
    format!(
        "  {says}: least damped mode {:.4} Hz, growth {:+.4} 1/s, damping ratio {:+.3} %\n",
        m.frequency_hz,
        m.growth_rate_per_s,
        100.0 * m.damping_ratio
    )
}

/// Runs the command.
pub(crate) fn run(args: &SimulateArgs) -> Result<Answer> {
    let model = stages::read_model(&args.model)?;
    let e = &model.experiment;
    let speed = positive("--wind-speed", args.wind_speed.unwrap_or(e.wind_speed_m_s))?;
    let stop = positive("--stop-time", args.stop_time.unwrap_or(e.stop_time_s))?;
    let step = positive("--step", args.step.unwrap_or(e.step_size_s))?;
    if stop / step > MAX_STEPS {
        return Err(Error::input(
            "--step",
            format!("at most {MAX_STEPS:.0e} steps"),
            format!("{:.1e}", stop / step),
        ));
    }
    let rows = simulated(&model, speed, stop, step)?;
    let modes = modes(&section_of(&model)?, speed)?;
    let columns = columns(&model.section.dofs());
    let mut out = OutputDir::new(args.out.as_deref().unwrap_or(folder_of(&args.model)))?;
    out.write("simulation.csv", csv(&model, speed, &columns, &rows))?;
    let title = format!("{} at {speed} m/s", model.name);
    figures::write("simulation", &mut out, || {
        let runs = [(&model.name[..], &rows[..])];
        let panels = motion_panels(&model.section.dofs(), &runs);
        time_history_figure(&title, &panels, "Time t (s)")
    })?;
    let written = out.commit()?;
    let text = format!(
        "{title}: {} of {step} s\n{}{}",
        counted(rows.len() - 1, "step"),
        verdict(&modes),
        list(&written)
    );
    Answer::new(
        text,
        &json!({ "columns": columns, "rows": rows, "modes": modes }),
    )
}

fn section_of(model: &TrainedModel) -> Result<CoupledSection> {
    CoupledSection::with_model(&model.section.structure()?, &model.model)
}

/// Rows of time (s) and motion of the released section, as `simulation.csv` has them, up to the time `stop` (s).
pub(super) fn simulated(
    model: &TrainedModel,
    speed: f64,
    stop: f64,
    step: f64,
) -> Result<Vec<Vec<f64>>> {
    let section = section_of(model)?;
    let n = section.structure().dofs.len();
    let mut stepper = Stepper::new(section);
    let mut released = vec![0.0; n];
    released[0] = model.experiment.initial_vertical_m;
    released[n - 1] = model.experiment.initial_rotation_rad;
    let mut state = stepper.released(&released, &vec![0.0; n])?;
    let inputs = Inputs::steady(speed, n);
    let mut outputs = Outputs::default();
    let steps = (stop / step).round() as usize;
    let mut rows = Vec::with_capacity(steps + 1);
    for i in 0..=steps {
        if i > 0 {
            stepper.advance(&mut state, &inputs, step)?;
        }
        stepper.outputs(&state, &inputs, &mut outputs)?;
        let mut row = vec![i as f64 * step];
        for values in [
            &outputs.displacement,
            &outputs.rate,
            &outputs.acceleration,
            &outputs.self_excited_force,
        ] {
            row.extend_from_slice(values);
        }
        rows.push(row);
    }
    Ok(rows)
}

/// Names of the columns, with units.
fn columns(dofs: &[Dof]) -> Vec<String> {
    let mut columns = vec!["time_s".to_owned()];
    for (name, linear, angular) in [
        ("", "m", "rad"),
        ("_rate", "m_s", "rad_s"),
        ("_acceleration", "m_s2", "rad_s2"),
        ("_force", "n_m", "n_m_m"),
    ] {
        columns.extend(motion_columns(dofs, name, linear, angular));
    }
    columns
}

fn csv(model: &TrainedModel, speed: f64, columns: &[String], rows: &[Vec<f64>]) -> String {
    let mut text = format!(
        "# {}; {} at {speed} m/s\n# source: {}\n# licence: {}\n# per unit length of span; y and lift up, theta and moment nose-up\n",
        model.name.replace('\n', " "),
        model.model.kind(),
        model.provenance.source.replace('\n', " "),
        model.provenance.licence.replace('\n', " "),
    );
    let _ = writeln!(text, "{}", columns.join(","));
    for row in rows {
        let values: Vec<String> = row.iter().map(f64::to_string).collect();
        let _ = writeln!(text, "{}", values.join(","));
    }
    text
}

/// Displacements over time of runs with their labels, rows as `simulation.csv` has them: one panel per degree of freedom,
/// lengths in mm, rotations in degrees.
pub(super) fn motion_panels(dofs: &[Dof], runs: &[(&str, &[Vec<f64>])]) -> Vec<TimePanel> {
    let panel = |(i, dof): (usize, &Dof)| {
        let (scale, unit) = match dof {
            Dof::Torsion => dof.shown_in(),
            Dof::Vertical | Dof::Lateral => (1e3, "mm"),
        };
        let series = runs.iter().map(|(label, rows)| {
            let points = rows.iter().map(|row| (row[0], scale * row[1 + i]));
            PlottedSeries::new(*label, points.collect())
        });
        TimePanel {
            y_label: format!("{} {} ({unit})", dof.name(), dof.symbol()),
            series: series.collect(),
        }
    };
    dofs.iter().enumerate().map(panel).collect()
}
