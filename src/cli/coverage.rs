//! `aerodeck coverage`: are the intervals reliable?

use super::vocabulary::{Answer, Progress, Result, TextTable, spelt};
use crate::uncertainty::{
    CoveragePlan, CoverageReport, FamilyPlan, FamilyReport, RangeCount, Truth, coverage,
    family_coverage,
};
use crate::wind_tunnel::TunnelPlan;
use std::fmt::Write as _;

/// Repeat a virtual campaign with known truth and count how often the 95 % intervals hold it
///
/// With --family it makes, tests and judges many synthetic decks instead, each once, and counts what is true of what the program
/// says of them.
///
/// Example: aerodeck coverage --repetitions 500 --noise-correlation 0.1
///
/// Example: aerodeck coverage --family 400
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct CoverageArgs {
    /// Number of repetitions.
    #[arg(long, default_value_t = 500)]
    repetitions: usize,
    /// True force model; `theodorsen` is outside what every fitted model can represent exactly.
    #[arg(long, default_value = "jones", value_parser = spelt::<Truth>(["jones", "theodorsen"]))]
    truth: Truth,
    /// Poles of the fitted filters; by default those of Jones's function, which they span exactly.
    #[arg(long, value_delimiter = ',', default_value = "0.091,0.6")]
    poles: Vec<f64>,
    /// Search the poles, from those given.
    #[arg(long)]
    search: bool,
    /// Noise of the forces as a fraction of their RMS.
    #[arg(long, default_value_t = 0.05)]
    noise: f64,
    /// Correlation time of the noise, s; 0 for white noise.
    #[arg(long, default_value_t = 0.0)]
    noise_correlation: f64,
    /// Mean speeds, m/s.
    #[arg(long, value_delimiter = ',', default_value = "8.17,4")]
    speeds: Vec<f64>,
    /// Standard deviation of every transfer function from one mean speed to the other, relative, in size and in phase.
    #[arg(long, default_value_t = 0.0)]
    speed_scatter: f64,
    /// The same from run to run (one motion at one speed), for all forces of a run together.
    #[arg(long, default_value_t = 0.0)]
    run_scatter: f64,
    /// Judge this number of synthetic decks: five sections, two and three motions, tests around, beside and far from the onset.
    #[arg(long, value_name = "DECKS", conflicts_with_all = ["repetitions", "truth", "poles", "search"])]
    family: Option<usize>,
    /// Decks of the family whose mean speeds agree, where intervals are wider than they need be.
    #[arg(long, requires = "family")]
    no_speed_scatter: bool,
    /// Seed of the first repetition; each has its own.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Runs the command.
pub(crate) fn run(args: &CoverageArgs, progress: &Progress) -> Result<Answer> {
    if let Some(decks) = args.family {
        let plan = FamilyPlan {
            decks,
            seed: args.seed,
            speeds_scatter: !args.no_speed_scatter,
        };
        let report = progress.counting("decks", |on_done| family_coverage(&plan, on_done))?;
        return Answer::new(family(&report), &report);
    }
    let plan = CoveragePlan {
        truth: args.truth,
        poles: args.poles.clone(),
        search_poles: args.search,
        repetitions: args.repetitions,
        speed_scatter: args.speed_scatter,
        run_scatter: args.run_scatter,
        tunnel: TunnelPlan {
            speeds_m_s: args.speeds.clone(),
            noise_fraction: args.noise,
            noise_correlation_s: args.noise_correlation,
            seed: args.seed,
            ..TunnelPlan::default()
        },
        ..CoveragePlan::default()
    };
    let report = progress.counting("repetitions", |on_done| coverage(&plan, on_done))?;
    Answer::new(text(&report), &report)
}

/// The family by where tests lie.
fn family(report: &FamilyReport) -> String {
    let mut table = TextTable::new(
        "tests | >decks | >onsets | >held | >no flutter | >refused | >false none | >unsafe | >met | >half | >error",
    );
    for r in &report.ranges {
        table.row(family_row(r));
    }
    table.text()
        + ("\nheld: stated 95 % intervals that hold the truth; false none: \"no flutter\" above the true onset; unsafe: intervals \
         above it; met: required speeds above it that are called met; half: median half width of the intervals; error: of the \
         stated onsets over their standard errors (root mean square), one where those are right\n")
}

fn family_row(r: &RangeCount) -> [String; 11] {
    let half = r.median_half_width_percent;
    let error = r.error_over_standard_error;
    [
        r.range.title().to_owned(),
        r.decks.to_string(),
        r.held.of.to_string(),
        match r.held.of {
            0 => "–".to_owned(),
            _ => format!("{} ({:5.1} %)", r.held.inside, r.held.percent),
        },
        r.no_flutter.to_string(),
        r.refused.to_string(),
        r.false_no_flutter.to_string(),
        r.unsafe_side.to_string(),
        r.met_against_truth.to_string(),
        half.map_or("–".to_owned(), |h| format!("{h:.1} %")),
        error.map_or("–".to_owned(), |e| format!("{e:.2}")),
    ]
}

fn text(r: &CoverageReport) -> String {
    let mut text = plan(&r.plan);
    let rows = speeds(r).into_iter().chain(shares(r));
    text.extend(rows.map(|(what, value)| format!("{what:<42} {value}\n")));
    if r.without_onset > 0 {
        let _ = writeln!(text, "repetitions without an onset: {}", r.without_onset);
    }
    let warnings = r.warnings.iter();
    text.extend(warnings.map(|warning| format!("warning: {warning}\n")));
    text
}

/// What was repeated.
fn plan(plan: &CoveragePlan) -> String {
    let tunnel = &plan.tunnel;
    let truth = match plan.truth {
        Truth::Jones => "Jones's rational function",
        Truth::Theodorsen => "Theodorsen's function",
    };
    let noise = match tunnel.noise_correlation_s {
        time_s if time_s > 0.0 => format!("correlation time {time_s} s"),
        _ => "white".to_owned(),
    };
    let poles = match plan.search_poles {
        true => "searched",
        false => "given",
    };
    format!(
        "Truth {truth}; filters with poles {:?} ({poles}); noise {} % of each force, {noise}; {} repetitions\n\
         Mean speeds {:?} m/s; truth scatters between speeds by {} %, between runs by {} %\n\n",
        plan.poles,
        100.0 * tunnel.noise_fraction,
        plan.repetitions,
        tunnel.speeds_m_s,
        100.0 * plan.speed_scatter,
        100.0 * plan.run_scatter,
    )
}

/// Errors and standard errors of the onset.
fn speeds(r: &CoverageReport) -> Vec<(&'static str, String)> {
    let speed = |value: f64| format!("{value:>9.4} m/s");
    let number = |value: f64| format!("{value:>9.1}");
    let mean_square = "stated standard error (root mean square)";
    let bias = "bias (fit without noise − truth)";
    let scatter = "scatter from repetition to repetition";
    let freedom = "degrees of freedom (mean)";
    let half = "half width of the intervals (mean)";
    let observed = "  as the scatter of the variances shows";
    vec![
        ("true onset", speed(r.true_onset_m_s)),
        (bias, speed(r.bias_m_s)),
        ("mean error", speed(r.mean_error_m_s)),
        ("  its standard error", speed(r.standard_error_of_mean_m_s)),
        (scatter, speed(r.scatter_m_s)),
        (mean_square, speed(r.stated_standard_error_m_s)),
        (half, speed(r.mean_half_width_m_s)),
        (freedom, number(r.mean_degrees_of_freedom)),
        (observed, number(r.observed_degrees_of_freedom)),
    ]
}

/// How often intervals held the truth.
fn shares(r: &CoverageReport) -> [(&'static str, String); 4] {
    [
        ("intervals of the onset that hold the truth", &r.holds_truth),
        ("  with the bias taken away", &r.holds_fit_without_noise),
        ("intervals of the derivatives", &r.derivatives_hold_truth),
        ("repetitions in which speeds differ", &r.speeds_differ),
    ]
    .map(|(what, s)| {
        let share = format!("{:5.1} % ({} of {})", s.percent, s.inside, s.of);
        (what, share)
    })
}
