//! `aerodeck simulate`: a released section in steady wind, in this process.

use super::vocabulary::{
    Answer, Dof, Error, OutputDir, PlottedSeries, Result, TimePanel, TrainedModel, counted, ensure,
    folder_of, list, motion_columns, sentences, time_history_figure, warn,
};
use super::{figures, stages};
use crate::aeroelastic::{CoupledSection, CoupledSystem};
use crate::error::{non_negative, positive};
use crate::flutter::aliased_below;
use crate::plausibility::of_trained;
use crate::report::shown_in;
use crate::response::{Inputs, Outputs, Stepper};
use crate::state_space::damping_ratio;
use crate::trained_model::Experiment;
use crate::units::ReducedFrequency;
use nalgebra::Complex;
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
    /// Whether tests tell of its reduced frequency.
    in_tested_range: bool,
}

/// Growth of a real pole below this part of the fastest one is rounding.
const STATIC_GROWTH: f64 = 1e-9;

/// Wind speed, m/s, that no double tells from still air beside any structure.
const NO_WIND: f64 = 1e-100;

/// Whether no force of the wind can be told in modes: without wind, and in one so slow that a sample of the forces lasts half a period.
fn is_still(section: &CoupledSection, speed: f64) -> bool {
    speed <= aliased_below(section).unwrap_or(0.0).max(NO_WIND)
}

/// The modes that vibrate, and static divergence as one of frequency 0; the least damped first. In still air they are those of the
/// structure alone.
fn modes(model: &TrainedModel, speed: f64) -> Result<Vec<ModeSummary>> {
    let section = section_of(model)?;
    let system = match is_still(&section, speed) {
        true => CoupledSystem {
            a: section.structure_alone().a,
            step_s: None,
        },
        false => section.at(speed)?,
    };
    let all = system.eigenvalues()?;
    let fastest = all.iter().map(|z| z.norm()).fold(0.0, f64::max);
    let counts =
        |pole: &Complex<f64>| pole.im > 0.0 || pole.im == 0.0 && pole.re > STATIC_GROWTH * fastest;
    let summary = |pole: Complex<f64>| {
        let frequency_hz = pole.im / std::f64::consts::TAU;
        let k = ReducedFrequency::from_hertz(frequency_hz, model.section.width_m, speed);
        ModeSummary {
            frequency_hz,
            growth_rate_per_s: pole.re,
            damping_ratio: damping_ratio(pole),
            in_tested_range: model.tested_range.contains(k),
        }
    };
    let all = all.into_iter().filter(counts);
    let mut modes: Vec<ModeSummary> = all.map(summary).collect();
    modes.sort_by(|a, b| a.damping_ratio.total_cmp(&b.damping_ratio));
    modes.truncate(section.structure().dofs.len());
    Ok(modes)
}

/// What the motion comes to, and which modes no test looked at.
fn verdict(model: &TrainedModel, speed: f64, modes: &[ModeSummary]) -> String {
    let Some(m) = modes.first() else {
        return "  no mode vibrates at this wind speed\n".to_owned();
    };
    let (growth, hertz, percent) = (m.growth_rate_per_s, m.frequency_hz, 100.0 * m.damping_ratio);
    let damped = format!(
        "least damped mode {hertz:.4} Hz, growth {growth:+.4} 1/s, damping ratio {percent:+.3} %"
    );
    let rounding = growth.abs() <= STATIC_GROWTH * hertz;
    let mut text = match (hertz > 0.0, growth > 0.0) {
        (true, _) if rounding => {
            format!("  the motion neither grows nor dies down: {damped}\n")
        }
        (false, _) => format!(
            "  the motion GROWS without oscillating (static divergence): growth {growth:+.4} 1/s\n"
        ),
        (true, true) => format!("  the motion GROWS: {damped}\n"),
        (true, false) => format!("  the motion dies down: {damped}\n"),
    };
    if speed <= NO_WIND {
        return text + "  no wind: the structure, and the air that moves with it\n";
    }
    if section_of(model).is_ok_and(|section| is_still(&section, speed)) {
        text += "  a sample of the forces lasts half a period or more: the modes are those of the structure\n";
    }
    let tested = &model.tested_range;
    for mode in modes.iter().filter(|mode| !mode.in_tested_range) {
        let k = ReducedFrequency::from_hertz(mode.frequency_hz, model.section.width_m, speed);
        let [low, high, k_mode] = [tested.min, tested.max, k].map(|k| k.full_width());
        let gap = tested.gap_at(k).map_or("", |_| ", in a gap between tests");
        let _ = writeln!(
            text,
            "  OUTSIDE the tested range, K = ωB/V {low:.3} to {high:.3}: the mode at {:.4} Hz, K {k_mode:.3}{gap}",
            mode.frequency_hz
        );
    }
    text
}

impl SimulateArgs {
    /// Length of the run and step, s.
    fn stop_and_step(&self, e: &Experiment) -> Result<(f64, f64)> {
        let stop = positive("--stop-time", self.stop_time.unwrap_or(e.stop_time_s))?;
        let step = positive("--step", self.step.unwrap_or(e.step_size_s))?;
        if step > stop {
            let expected = format!("a step within the stop time of {stop} s");
            let found = format!("{step} s");
            return Err(match (self.step, self.stop_time) {
                (Some(_), _) => Error::input("--step", expected, found),
                (None, Some(_)) => Error::input("--stop-time", expected, found),
                (None, None) => {
                    Error::input("experiment.step_size_s", expected, found).in_file(&self.model)
                }
            });
        }
        let (steps, expected) = (stop / step, format!("at most {MAX_STEPS:.0e} steps"));
        let found = format_args!("{steps:.1e}");
        ensure(steps <= MAX_STEPS, "--step", expected, found)?;
        Ok((stop, step))
    }
}

/// Runs the command.
pub(crate) fn run(args: &SimulateArgs) -> Result<Answer> {
    let model = stages::read_model(&args.model)?;
    let e = &model.experiment;
    let speed = args.wind_speed.unwrap_or(e.wind_speed_m_s);
    // -0 is 0
    let speed = non_negative("--wind-speed", speed)? + 0.0;
    let (stop, step) = args.stop_and_step(e)?;
    let findings = of_trained(&model.section, &model);
    warn(&args.model, &sentences(&findings));
    let mut rows = Vec::new();
    let failed = match simulated(&model, speed, stop, step, &mut rows) {
        Err(Error::Numerical(why)) if !rows.is_empty() => vec![why],
        ended => ended.map(|()| Vec::new())?,
    };
    let modes = modes(&model, speed)?;
    let dofs = model.section.dofs();
    let columns = columns(&dofs);
    let mut out = OutputDir::new(args.out.as_deref().unwrap_or(folder_of(&args.model)))?;
    out.write("simulation.csv", csv(&model, speed, &columns, &rows))?;
    let title = format!("{} at {speed} m/s", model.name);
    figures::write("simulation", &mut out, || {
        let runs = [(&model.name[..], &rows[..])];
        let panels = motion_panels(&dofs, &runs);
        time_history_figure(&title, &panels, "Time t (s)")
    })?;
    let written = out.commit()?;
    let early = failed.iter().map(|why| format!("  ENDS EARLY: {why}\n"));
    let early: String = early.collect();
    let steps = counted(rows.len() - 1, "step");
    let verdict = verdict(&model, speed, &modes);
    let text = format!(
        "{title}: {steps} of {step} s\n{early}{verdict}{}",
        list(&written)
    );
    let value = json!({ "columns": columns, "rows": rows, "modes": modes, "findings": findings, "failed": failed });
    Ok(Answer::new(text, &value)?.passed_if(failed.is_empty()))
}

fn section_of(model: &TrainedModel) -> Result<CoupledSection> {
    CoupledSection::with_model(&model.section.structure()?, &model.model)
}

/// Adds to `rows` time (s) and motion of the released section, as `simulation.csv` has them, up to the time `stop` (s) or, with
/// an error, to where the motion overflows.
pub(super) fn simulated(
    model: &TrainedModel,
    speed: f64,
    stop: f64,
    step: f64,
    rows: &mut Vec<Vec<f64>>,
) -> Result<()> {
    let section = section_of(model)?;
    let n = section.structure().dofs.len();
    let mut stepper = Stepper::new(section);
    let mut released = vec![0.0; n];
    released[0] = model.experiment.initial_vertical_m;
    released[n - 1] = model.experiment.initial_rotation_rad;
    let mut state = stepper.released(&released, &vec![0.0; n])?;
    let inputs = Inputs::steady(speed, n);
    let mut outputs = Outputs::default();
    for i in 0..=(stop / step).round() as usize {
        let time = i as f64 * step;
        let at_time = |why: &str| {
            let why = why.trim_start_matches("step: ");
            Error::Numerical(format!("{why} at {time:.6} s"))
        };
        if i > 0 {
            let advanced = stepper.advance(&mut state, &inputs, step);
            advanced.map_err(|e| match e {
                Error::Numerical(why) => at_time(&why),
                other => other,
            })?;
        }
        stepper.outputs(&state, &inputs, &mut outputs)?;
        let mut row = vec![time];
        let motion = [&outputs.displacement, &outputs.rate, &outputs.acceleration];
        for values in motion.into_iter().chain([&outputs.self_excited_force]) {
            row.extend_from_slice(values);
        }
        if !row.iter().all(|x| x.is_finite()) {
            return Err(at_time("the motion has overflowed"));
        }
        rows.push(row);
    }
    Ok(())
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
    let of = &model.provenance;
    let [name, source, licence] =
        [&model.name, &of.source, &of.licence].map(|text| text.replace('\n', " "));
    let mut text = format!(
        "# {name}; {} at {speed} m/s\n# source: {source}\n# licence: {licence}\n# per unit length of span; y and lift up, theta and moment nose-up\n",
        model.model.kind()
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
            Dof::Torsion => shown_in(*dof),
            Dof::Vertical | Dof::Lateral => (1e3, "mm"),
        };
        let series = runs.iter().map(|(label, rows)| {
            let points = rows.iter().map(|row| (row[0], scale * row[1 + i]));
            PlottedSeries::new(*label, points.collect())
        });
        TimePanel::new(format!("{} {} ({unit})", dof.name(), dof.symbol()), series)
    };
    dofs.iter().enumerate().map(panel).collect()
}
