//! `aerodeck coverage`: do the intervals keep their word?

use super::answer::Answer;
use super::progress::Progress;
use crate::error::Result;
use crate::uncertainty::{CoveragePlan, CoverageReport, Share, Truth, coverage};
use crate::wind_tunnel::TunnelPlan;
use std::fmt::Write as _;

/// Repeat a virtual campaign with known truth and count how often the 95 % intervals hold it
///
/// Example: aerodeck coverage --repetitions 500 --noise-correlation 0.1
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// Number of repetitions.
    #[arg(long, default_value_t = 500)]
    repetitions: usize,
    /// What the forces follow; `theodorsen` lies outside every fitted class.
    #[arg(long, value_enum, default_value_t = TruthArg::Jones)]
    truth: TruthArg,
    /// Poles of the fitted filters; by default those of Jones's function, which they span exactly.
    #[arg(long, value_delimiter = ',', default_values_t = [0.091, 0.6])]
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
    #[arg(long, value_delimiter = ',', default_values_t = [8.17, 4.0])]
    speeds: Vec<f64>,
    /// Standard deviation of every transfer function from one mean speed to the other, relative, in size and in phase.
    #[arg(long, default_value_t = 0.0)]
    speed_scatter: f64,
    /// The same from run to run (one motion at one speed), for all forces of a run together.
    #[arg(long, default_value_t = 0.0)]
    run_scatter: f64,
    /// Seed of the first repetition; each has its own.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum TruthArg {
    Jones,
    Theodorsen,
}

/// Runs the command.
pub(crate) fn run(args: &Args, progress: &Progress) -> Result<Answer> {
    let plan = CoveragePlan {
        truth: match args.truth {
            TruthArg::Jones => Truth::Jones,
            TruthArg::Theodorsen => Truth::Theodorsen,
        },
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
    let stage = progress.steps("repetitions");
    let report = coverage(&plan, &|done| {
        stage.at(done as u64, args.repetitions as u64)
    })?;
    drop(stage);
    Answer::new(account(&report), &report)
}

fn account(r: &CoverageReport) -> String {
    let share = |s: &Share| format!("{:5.1} % ({} of {})", s.percent, s.inside, s.of);
    let truth = match r.plan.truth {
        Truth::Jones => "Jones's rational function",
        Truth::Theodorsen => "Theodorsen's function",
    };
    let noise = if r.plan.tunnel.noise_correlation_s > 0.0 {
        format!("correlation time {} s", r.plan.tunnel.noise_correlation_s)
    } else {
        "white".to_owned()
    };
    let mut text = format!(
        "Truth {truth}; filters with poles {:?} ({}); noise {} % of each force, {noise}; {} repetitions\n\
         Mean speeds {:?} m/s; truth scatters between speeds by {} %, between runs by {} %\n\n",
        r.plan.poles,
        if r.plan.search_poles {
            "searched"
        } else {
            "given"
        },
        100.0 * r.plan.tunnel.noise_fraction,
        r.plan.repetitions,
        r.plan.tunnel.speeds_m_s,
        100.0 * r.plan.speed_scatter,
        100.0 * r.plan.run_scatter,
    );
    for (what, value) in [
        ("true onset", r.true_onset_m_s),
        ("bias (fit without noise − truth)", r.bias_m_s),
        ("mean error", r.mean_error_m_s),
        ("  its standard error", r.standard_error_of_mean_m_s),
        ("scatter from repetition to repetition", r.scatter_m_s),
        (
            "stated standard error (root mean square)",
            r.stated_standard_error_m_s,
        ),
        ("half width of the intervals (mean)", r.mean_half_width_m_s),
    ] {
        let _ = writeln!(text, "{what:<42} {value:>9.4} m/s");
    }
    for (what, value) in [
        ("degrees of freedom (mean)", r.mean_degrees_of_freedom),
        (
            "  as the scatter of the variances shows",
            r.observed_degrees_of_freedom,
        ),
    ] {
        let _ = writeln!(text, "{what:<42} {value:>9.1}");
    }
    for (what, value) in [
        ("intervals of the onset that hold the truth", &r.holds_truth),
        ("  with the bias taken away", &r.holds_fit_without_noise),
        ("intervals of the derivatives", &r.derivatives_hold_truth),
        ("repetitions in which speeds differ", &r.speeds_differ),
    ] {
        let _ = writeln!(text, "{what:<42} {}", share(value));
    }
    if r.without_onset > 0 {
        let _ = writeln!(text, "repetitions without an onset: {}", r.without_onset);
    }
    for warning in &r.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    text
}
