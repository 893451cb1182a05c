//! `aerodeck monte-carlo`: the distribution of the onset when section and forces are random.

use super::vocabulary::{
    Answer, Finding, OutputDir, Progress, Result, TrainedModel, Verdict, counted, ensure,
    folder_of, read_text,
};
use super::{figures, stages};
use crate::report::onset_distribution_figure;
use crate::study::{FlutterBlock, saved_evidence};
use crate::uncertainty::monte_carlo::{
    MAX_SAMPLES, MonteCarloPlan, MonteCarloResult, Quantile, monte_carlo,
};
use crate::verdict::RequiredSpeed;
use std::path::{Path, PathBuf};

/// Distribution of the flutter onset when section and forces are random, and its probability below a design speed
///
/// Example: aerodeck monte-carlo scatter.toml --samples 100000
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct MonteCarloArgs {
    /// What is random (`.toml`); names the trained model.
    plan: PathBuf,
    /// Number of samples instead of that of the file.
    #[arg(long)]
    samples: Option<usize>,
    /// Seed instead of that of the file.
    #[arg(long)]
    seed: Option<u64>,
    /// Folder of the results; by default the folder of the file.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Runs the command.
pub(crate) fn run(args: &MonteCarloArgs, progress: &Progress) -> Result<Answer> {
    if let Some(samples) = args.samples {
        let expected = format_args!("a number from 1 to {MAX_SAMPLES:e}");
        let within = (1..=MAX_SAMPLES).contains(&samples);
        ensure(within, "--samples", expected, samples)?;
    }
    let plan_text = read_text(&args.plan)?;
    let folder = args.plan.parent().unwrap_or(Path::new(""));
    let mut plan = MonteCarloPlan::from_toml(&plan_text, folder.to_path_buf())
        .map_err(|e| e.in_file(&args.plan))?;
    plan.samples = args.samples.unwrap_or(plan.samples);
    plan.seed = args.seed.unwrap_or(plan.seed);
    let model = stages::read_model(&plan.directory.join(&plan.model))?;
    let result = progress.counting("samples", |on_done| monte_carlo(&plan, &model, on_done));
    let mut result =
        result.map_err(|e| MonteCarloPlan::locate(&plan_text, e).in_file(&args.plan))?;
    result.verdict = verdict(&plan, &model, &result.findings)?;
    let mut out = OutputDir::new(args.out.as_deref().unwrap_or(folder_of(&args.plan)))?;
    figures::outdated("monte_carlo", &mut out);
    if result.onsets > 1 {
        let draw = || onset_distribution_figure(&result);
        figures::write("monte_carlo", &mut out, draw)?;
    }
    out.write_json("monte_carlo.json", "monte-carlo-results", &result)?;
    let refused = result.verdict.iter().filter(|v| v.refuses());
    let of_model = refused.map(|v| format!("warning: of the model itself: {}", v.explanation));
    let odd = result.findings.iter().map(|f| format!("warning: {f}"));
    let parts = [
        odd.collect(),
        onsets(&result),
        design(&result),
        of_model.collect(),
        warnings(&result),
        failures(&result),
    ];
    let text = parts.concat().iter().map(|l| format!("{l}\n")).collect();
    let verdict = &result.verdict;
    let value = serde_json::json!({ "result": result, "verdict": verdict });
    out.answer(text, value)
}

/// What the model itself, of which the samples are made, can say of the design speed, with what is odd about their means.
fn verdict(
    plan: &MonteCarloPlan,
    model: &TrainedModel,
    of_means: &[Finding],
) -> Result<Option<Verdict>> {
    let file = plan.directory.join(&plan.model);
    let judge = |speed_m_s: f64| {
        let block = FlutterBlock {
            required_speed_m_s: Some(speed_m_s),
            ..FlutterBlock::default()
        };
        // as `flutter` and Python search: the speeds of a search are in the last digits of what was judged
        let search = block.range(&model.section).search();
        let mut evidence = saved_evidence(&file, model, &model.section, &search)?;
        evidence.required = Some(RequiredSpeed { speed_m_s });
        evidence.implausible.extend_from_slice(of_means);
        Ok(Verdict::judge(&evidence))
    };
    plan.design_speed_m_s.map(judge).transpose()
}

/// How many samples have an onset, where it lies, and how it scatters.
fn onsets(r: &MonteCarloResult) -> Vec<String> {
    let (samples, counts) = (counted(r.samples, "sample"), r.counts_in_words());
    let mut lines = vec![format!("{}: {samples}, seed {}: {counts}", r.model, r.seed)];
    if let Some(speed) = r.unstable_up_to_m_s {
        lines.push(format!(
            "warning: {} samples are unstable at and below the lowest speed that could be judged (up to {speed:.3} m/s): \
             they count as flutter, not as safe",
            r.unstable_at_or_below
        ));
    }
    if let Some(forces) = &r.drawn_forces {
        lines.push(format!("Forces    {}", forces.in_words()));
        let left_out = forces.left_out();
        lines.extend(left_out.map(|what| format!("warning: left out: {what}")));
    }
    lines.push(nominal(r));
    if let (Some(mean), Some(deviation)) = (r.mean_m_s, r.standard_deviation_m_s) {
        let of = r.averaged_in_words().map(|of| format!(" ({of})"));
        lines.push(format!(
            "          mean {mean:.3} m/s, standard deviation {deviation:.3} m/s{}",
            of.unwrap_or_default()
        ));
    }
    lines.extend(r.quantiles.iter().map(|q| quantile(r, q)));
    lines
}

/// The onset of the model itself.
fn nominal(r: &MonteCarloResult) -> String {
    let or_below = match r.nominal_or_below {
        true => "at or below ",
        false => "",
    };
    let speed = match r.nominal_m_s {
        Some(v) => format!("{v:.3} m/s"),
        None => format!("above {:.3} m/s", r.speed_max_m_s),
    };
    format!("Onset     of the model itself {or_below}{speed}")
}

/// The speed of a quantile, or why there is none.
fn quantile(r: &MonteCarloResult, q: &Quantile) -> String {
    let percent = 100.0 * q.probability;
    if q.too_few_samples {
        let samples = counted(r.samples, "sample");
        let tell = if r.samples == 1 { "does" } else { "do" };
        return format!("          {percent:>6} %: {samples} {tell} not tell");
    }
    let speed = match (q.speed_m_s, q.ends_m_s) {
        (Some(v), _) => format!("{v:.3} m/s"),
        // by what becomes of samples that failed or are not judged so far
        (None, [Some(low), Some(high)]) => format!("a speed from {low:.3} to {high:.3} m/s"),
        (None, [low, _]) => format!("a speed above {:.3} m/s", low.unwrap_or(r.speed_max_m_s)),
    };
    format!("          {percent:>6} % of all sections flutter at or below {speed}")
}

/// The probability of an onset below the design speed, where one is stated.
fn design(r: &MonteCarloResult) -> Vec<String> {
    let Some(d) = &r.design else {
        return Vec::new();
    };
    let mut lines = vec![format!(
        "Design    onset below {:.3} m/s: probability {:.3e}, {} % confidence {:.3e} to {:.3e} ({})",
        d.speed_m_s,
        d.probability,
        100.0 * d.confidence,
        d.lower,
        d.upper,
        counted(d.below as usize, "sample")
    )];
    if d.undecided > 0 {
        lines.push(format!(
            "          {} more failed or cannot be judged at {:.3} m/s, which the tests do not reach or reach only above: they count in the probability and in its upper limit",
            d.undecided, d.speed_m_s
        ));
    }
    lines
}

fn warnings(r: &MonteCarloResult) -> Vec<String> {
    let mut lines = Vec::new();
    if r.outside_tested_range > 0 {
        lines.push(format!(
            "warning: outside the tested range of the model: {}",
            counted(r.outside_tested_range, "onset")
        ));
    }
    if let Some(lowest) = r.judged_up_to_m_s {
        lines.push(format!(
            "warning: no flutter, but judged only up to {lowest:.3} m/s or somewhat more, where a mode leaves the tested range of the model: {}",
            counted(r.not_judged, "sample")
        ));
    }
    if r.with_spurious_crossings > 0 {
        lines.push(format!(
            "warning: {} samples lose damping below the onset, outside the tested range: probably spurious",
            r.with_spurious_crossings
        ));
    }
    lines
}

/// The samples that failed, as far as they are named, and how many more.
fn failures(r: &MonteCarloResult) -> Vec<String> {
    let failed = r.failures.iter();
    let failed = failed.map(|f| format!("failed: sample {}: {}", f.sample, f.reason));
    let mut lines: Vec<String> = failed.collect();
    if r.failed > lines.len() {
        lines.push(format!("failed: {} more", r.failed - lines.len()));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn result(changed: serde_json::Value) -> MonteCarloResult {
        let mut all = serde_json::json!({
            "model": "m", "seed": 1, "samples": 20, "onsets": 15, "unstable_at_or_below": 0, "unstable_up_to_m_s": null,
            "stable": 5, "not_judged": 0, "judged_up_to_m_s": null, "failed": 0, "failures": [], "outside_tested_range": 0,
            "with_spurious_crossings": 0, "searched_in_full": 0, "speed_max_m_s": 60.0, "nominal_m_s": 36.0,
            "nominal_or_below": false, "mean_m_s": 36.0, "standard_deviation_m_s": 1.0, "quantiles": [],
            "histogram": { "from_m_s": 30.0, "width_m_s": 1.0, "counts": [15] }, "design": null, "verdict": null
        });
        let changed = changed.as_object().cloned().unwrap_or_default();
        all.as_object_mut().unwrap().extend(changed);
        serde_json::from_value(all).unwrap()
    }

    /// What mean and quantiles are of stands beside them.
    #[test]
    fn figures_say_what_they_are_of() {
        let some = onsets(&result(serde_json::json!({}))).concat();
        let of = "deviation 1.000 m/s (of the 15 of 20 samples with an onset up to 60.000 m/s; the other 5 are in neither)";
        assert!(some.contains(of), "{some}");
        let all = onsets(&result(serde_json::json!({ "onsets": 20, "stable": 0 }))).concat();
        assert!(
            all.contains("deviation 1.000 m/s") && !all.contains("neither"),
            "{all}"
        );
        let none = serde_json::json!({ "probability": 0.01, "speed_m_s": null, "ends_m_s": [null, null], "or_below": false,
                                       "too_few_samples": true });
        let few = onsets(&result(serde_json::json!({ "quantiles": [none] }))).concat();
        assert!(few.contains("1 %: 20 samples do not tell"), "{few}");
        assert!(!few.contains("flutter at or below"), "{few}");
    }
}
