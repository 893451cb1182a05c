//! `aerodeck quasi-steady`: equilibrium, linear model, onset and a nonlinear run from static coefficients.

use super::vocabulary::{
    Answer, DerivativePlot, Dof, Error, Figure, FlutterSearch, FlutterStudy, OutputDir,
    PlottedSeries, Progress, Result, TextTable, TimePanel, WindStudy, attempt, counted,
    motion_columns, time_history_figure,
};
use super::wind::WindArgs;
use super::{figures, headline, text};
use crate::aerodynamics::GustSeries;
use crate::aerodynamics::quasi_steady::{CoefficientRow, CoefficientsAt};
use crate::files::gusts::write_gusts;
use crate::report::{derivatives_figure, equilibrium_figure, shown_in, vf_vg_figure};
use crate::study::{QuasiSteadyStudy, SimulatedMotion, quasi_steady_study, simulated_motion};
use std::fmt::Write as _;

/// Stem of the nonlinear run, and the gusts in it.
const RUN: &str = "quasi_steady_run";
const GUSTS: &str = "gusts.csv";
/// Lines of the table at most.
const TABLE_LINES: usize = 15;

/// Runs the command.
pub(crate) fn run(args: &WindArgs, progress: &Progress) -> Result<Answer> {
    let (study, mut out) = args.open()?;
    let what = "equilibria and modes over wind speed";
    let results = progress.during(what, || quasi_steady_study(&study))?;
    let run = progress.during("nonlinear run", || simulated_motion(&study));
    let mut failed = Vec::new();
    // a run that leaves the tested angles takes neither equilibria nor onset with it
    let run = attempt(&mut failed, "nonlinear run", run)?.flatten();
    out.write_json("quasi_steady.json", "quasi-steady-results", &results)?;
    draw(&study, &results, &mut out)?;
    // gusts.csv may be the user's own
    out.outdated(RUN.to_owned() + ".csv");
    figures::outdated(RUN, &mut out);
    if let Some(run) = &run {
        write_run(&study, run, &mut out)?;
    }
    let mut text = in_words(&study, &results);
    text.extend(run.iter().map(run_in_words));
    text.push_str(&text::failures(&failed));
    let value = serde_json::json!({ "quasi_steady": results, "simulation": run, "failed": failed });
    let answer = out.answer(text, value)?;
    Ok(answer
        .with_outcome_of(&results.verdict)
        .passed_if(failed.is_empty()))
}

fn draw(study: &WindStudy, results: &QuasiSteadyStudy, out: &mut OutputDir) -> Result<()> {
    figures::write("coefficients", out, || coefficients(results))?;
    figures::outdated("equilibrium", out);
    figures::outdated("quasi_steady_modes", out);
    if results.equilibria.points.is_empty() {
        return Ok(());
    }
    let draw = || equilibrium_figure(&study.name, &results.dofs, &results.equilibria);
    figures::write("equilibrium", out, draw)?;
    let onsets: Vec<_> = results.onset.search.onset().cloned().into_iter().collect();
    let curves = std::slice::from_ref(&results.curves);
    let draw = || vf_vg_figure(curves, &onsets, &study.name, Some(&results.verdict));
    figures::write("quasi_steady_modes", out, draw)
}

/// The table as dots and the line that is computed with.
fn coefficients(results: &QuasiSteadyStudy) -> Result<Figure> {
    let plot = |name: &str, row: fn(&CoefficientRow) -> f64, of: fn(&CoefficientsAt) -> f64| {
        let table = results.rows.iter().map(|r| (r.angle_deg, row(r)));
        let spline = results.line.iter().map(|(angle, c)| (*angle, of(c)));
        DerivativePlot {
            name: name.to_owned(),
            measured: vec![PlottedSeries::new("table", table.collect())],
            fitted: vec![PlottedSeries::new("spline", spline.collect())],
            ..DerivativePlot::default()
        }
    };
    let all = [
        plot("Drag C_D", |r| r.drag, |c| c.drag),
        plot("Lift C_L", |r| r.lift, |c| c.lift),
        plot("Moment C_M", |r| r.moment, |c| c.moment),
    ];
    let title = format!("Static coefficients: {}", results.coefficients);
    derivatives_figure(&title, "Angle of attack α (deg)", "", &all)
}

fn in_words(study: &WindStudy, results: &QuasiSteadyStudy) -> String {
    let mut text = headline::text(&study.name, &results.verdict, &[]);
    let _ = writeln!(text, "\nstatic coefficients: {}", results.coefficients);
    if let Some(first) = results.linear.first() {
        let arms = first.arms;
        let arm = |d: &Dof| format!("{} {:+.3}", d.symbol(), arms.arm(*d));
        let arms: Vec<String> = results.dofs.iter().map(arm).collect();
        let _ = writeln!(text, "arms B₁/B, upwind positive: {}", arms.join(", "));
    }
    let _ = write!(text, "\nStatic equilibrium\n{}", equilibria(results));
    let end = results.equilibria.end.iter();
    text.extend(end.map(|end| format!("{}\n", end.explain())));
    text.push('\n');
    match &results.onset.search {
        FlutterSearch::Onset(onset) => {
            text.push_str(&text::onsets(&FlutterStudy {
                onsets: vec![onset.as_ref().clone()],
                ..FlutterStudy::default()
            }));
            let mode = results.onset.mode.iter();
            text.extend(mode.map(|mode| format!("kind: {}\n", mode.kind.name())));
        }
        other => {
            let _ = writeln!(text, "{}", other.explain());
        }
    }
    text
}

/// A line per wind speed, as many as a terminal shows.
fn equilibria(results: &QuasiSteadyStudy) -> String {
    let dofs = &results.dofs;
    let motion = |d: &Dof| format!(">{} {} | ", d.symbol(), shown_in(*d).1);
    let motions: String = dofs.iter().map(motion).collect();
    let mut table = TextTable::new(&format!(">V m/s | {motions}>stiffness left"));
    let points = &results.equilibria.points;
    let every = points.len().div_ceil(TABLE_LINES).max(1);
    for point in points.iter().step_by(every) {
        let motion = dofs.iter().zip(&point.displacement);
        let motion = motion.map(|(dof, value)| format!("{:.5}", shown_in(*dof).0 * value));
        let left = format!("{:.1} %", 100.0 * point.stiffness_left);
        let speed = std::iter::once(format!("{:.2}", point.speed_m_s));
        table.row(speed.chain(motion).chain([left]));
    }
    table.text()
}

fn run_in_words(run: &SimulatedMotion) -> String {
    let rows = counted(run.nonlinear.len(), "row");
    let each = counted(run.substeps, "Runge-Kutta step");
    let mut text = format!(
        "\nNonlinear run at {} m/s: {rows} of {} s, {each} each, halving changes {:.1e}\n",
        run.speed_m_s, run.step_s, run.step_error
    );
    if run.gusts_m_s.iter().any(|gust| *gust != (0.0, 0.0)) {
        text += "  gusts act in full, without the admittance that `buffeting` gives them\n";
    }
    let spread = |rows: &[Vec<f64>], i: usize| {
        let mean = rows.iter().map(|r| r[i]).sum::<f64>() / rows.len() as f64;
        let square = rows.iter().map(|r| (r[i] - mean).powi(2)).sum::<f64>() / rows.len() as f64;
        [mean, square.sqrt()]
    };
    for (i, dof) in run.dofs.iter().enumerate() {
        let (factor, unit) = shown_in(*dof);
        let shown = |rows| spread(rows, i).map(|x| factor * x);
        let ([mean, rms], [of_linear, linear]) = (shown(&run.nonlinear), shown(&run.linear));
        text += &format!("  {}: mean {mean:.5}, RMS {rms:.5} {unit}; ", dof.symbol());
        text += &format!("linear: mean {of_linear:.5}, RMS {linear:.5}\n");
    }
    text
}

fn write_run(study: &WindStudy, run: &SimulatedMotion, out: &mut OutputDir) -> Result<()> {
    out.write(RUN.to_owned() + ".csv", csv(study, run))?;
    let (u, w) = run.gusts_m_s.iter().copied().unzip();
    let gusts = GustSeries::new(run.step_s, u, w)?;
    let path = out.stage(GUSTS)?;
    let mut file = std::fs::File::create(&path).map_err(|e| Error::io(&path, e))?;
    let source = format!("the run of {RUN}.csv at {} m/s", run.speed_m_s);
    write_gusts(&study.name, &source, &gusts, &mut file).map_err(|e| Error::io(&path, e))?;
    let title = format!("{} at {} m/s", study.name, run.speed_m_s);
    let draw = || time_history_figure(&title, &panels(run), "Time t (s)");
    figures::write(RUN, out, draw)
}

fn csv(study: &WindStudy, run: &SimulatedMotion) -> String {
    let mut text = format!(
        "# {}; quasi-steady forces at {} m/s, per unit length of span; y and lift up, theta nose-up, x downwind\n",
        study.name, run.speed_m_s
    );
    let mut columns = vec!["time_s".to_owned(), "u_m_s".into(), "w_m_s".into()];
    for kind in ["nonlinear", "linear"] {
        for (what, linear, angular) in [("", "m", "rad"), ("_rate", "m_s", "rad_s")] {
            let what = format!("{what}_{kind}");
            columns.extend(motion_columns(&run.dofs, &what, linear, angular));
        }
    }
    let _ = writeln!(text, "{}", columns.join(","));
    let rows = run.nonlinear.iter().zip(&run.linear).zip(&run.gusts_m_s);
    for (i, ((nonlinear, linear), (u, w))) in rows.enumerate() {
        let _ = write!(text, "{},{u},{w}", run.step_s * i as f64);
        for value in nonlinear.iter().chain(linear) {
            let _ = write!(text, ",{value}");
        }
        text.push('\n');
    }
    text
}

/// One panel per degree of freedom, then the gusts.
fn panels(run: &SimulatedMotion) -> Vec<TimePanel> {
    let series = |label: &str, values: &mut dyn Iterator<Item = f64>| {
        let points = values.enumerate();
        let points = points.map(|(i, v)| (run.step_s * i as f64, v)).collect();
        PlottedSeries::new(label, points)
    };
    let mut panels = Vec::with_capacity(run.dofs.len() + 1);
    for (i, dof) in run.dofs.iter().enumerate() {
        let (factor, unit) = shown_in(*dof);
        let of = |rows: &[Vec<f64>]| rows.iter().map(|r| factor * r[i]).collect::<Vec<_>>();
        let both = [
            series("nonlinear", &mut of(&run.nonlinear).into_iter()),
            series("linear", &mut of(&run.linear).into_iter()),
        ];
        let label = format!("{} {} ({unit})", dof.name(), dof.symbol());
        panels.push(TimePanel::new(label, both));
    }
    let gusts = [
        series("gust u", &mut run.gusts_m_s.iter().map(|g| g.0)),
        series("gust w", &mut run.gusts_m_s.iter().map(|g| g.1)),
    ];
    panels.push(TimePanel::new("gusts (m/s)", gusts));
    panels
}
