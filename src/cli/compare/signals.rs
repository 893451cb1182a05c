//! `aerodeck compare signals`: all metrics of two time histories of any laboratory file.

use crate::cli::vocabulary::{Answer, Error, Progress, Result, ensure};
use crate::comparison::{
    BicoherenceParameters, Metric, PhaseParameters, SignalPair, StationarityParameters,
    WaveletParameters, bicoherence, magnitude, magnitude_warped, peak, phase, probability_density,
    rms, stationarity, wavelet, wavelet_normalised,
};
use crate::error::positive;
use crate::files::lab::ChannelSet;
use crate::wind_tunnel::campaign::{SAME_RATE, sampling_by_time};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;

/// How alike two time histories are, by all metrics: phase, peak, RMS, magnitude, wavelets, distribution, stationarity, bicoherence
///
/// Example: aerodeck compare signals forces.csv --reference measured --compared predicted --sampling-hz 200
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct CompareSignalsArgs {
    /// CSV, MATLAB, HDF5 or TDMS file with both signals.
    file: PathBuf,
    /// Channel of the reference signal.
    #[arg(long)]
    reference: String,
    /// Channel of the signal that is compared with it.
    #[arg(long)]
    compared: String,
    /// Group (HDF5, TDMS) or struct (MATLAB) of the file to read.
    #[arg(long)]
    group: Option<String>,
    /// Samples per second; by default the rate that the file states or its time column shows.
    #[arg(long)]
    sampling_hz: Option<f64>,
    /// Lowest frequency of wavelets, Hz.
    #[arg(long, default_value_t = 0.2)]
    from_hz: f64,
    /// Highest frequency of wavelets, Hz.
    #[arg(long, default_value_t = 12.0)]
    to_hz: f64,
    /// Frequencies between them.
    #[arg(long, default_value_t = 120)]
    levels: usize,
    /// Delay that brings the phase metric to 1/e, s.
    #[arg(long, default_value_t = 1.0)]
    significant_delay: f64,
    /// Seed of the surrogates.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl CompareSignalsArgs {
    fn check(&self) -> Result<()> {
        positive("--levels", self.levels as f64)?;
        positive("--significant-delay", self.significant_delay)?;
        let from = positive("--from-hz", self.from_hz)?;
        let expected = format_args!("a number from the {from} of --from-hz on");
        ensure(self.to_hz >= from, "--to-hz", expected, self.to_hz)
    }
}

/// One metric, or why there is none.
#[derive(Serialize)]
struct Line {
    symbol: &'static str,
    sees: &'static str,
    value: Option<f64>,
    details: serde_json::Value,
    problem: Option<String>,
}

impl Line {
    fn new<D: Serialize>(
        symbol: &'static str,
        sees: &'static str,
        metric: Result<Metric<D>>,
    ) -> Result<Self> {
        let problem = metric.as_ref().err().map(ToString::to_string);
        let (value, details) = metric.ok().map(|m| (m.value, m.details)).unzip();
        let details = serde_json::to_value(details).map_err(|e| Error::Numerical(e.to_string()))?;
        Ok(Self {
            symbol,
            sees,
            value,
            details,
            problem,
        })
    }
}

/// Runs the command.
pub(crate) fn run(args: &CompareSignalsArgs, progress: &Progress) -> Result<Answer> {
    args.check()?;
    let set = ChannelSet::read(&args.file, args.group.as_deref())?;
    let channel = |name: &str| {
        let found = set.only_channel("channel", name);
        found.map_err(|e| e.in_file(&args.file))
    };
    let (reference, compared) = (channel(&args.reference)?, channel(&args.compared)?);
    if let (Some(one), Some(other)) = (&reference.unit, &compared.unit) {
        let expected = format!("a channel in {one}, as `{}`", args.reference);
        let found = format!("`{}` in {other}", args.compared);
        ensure(one == other, "--compared", expected, found).map_err(|e| e.in_file(&args.file))?;
    }
    let sampling_hz = sampling(args, &set).map_err(|e| e.in_file(&args.file))?;
    let pair = SignalPair::new(&reference.samples, &compared.samples, 1.0 / sampling_hz)
        .map_err(|e| e.in_file(&args.file))?;
    let lines = progress.during("metrics", || metrics(&pair, args))?;
    let missing = lines.iter().any(|l| l.problem.is_some());
    let value = serde_json::json!({ "metrics": lines });
    Ok(Answer::new(text(args, &pair, &lines), &value)?.passed_if(!missing))
}

/// The one sampling frequency that the file states, its time column shows and the arguments say, Hz.
fn sampling(args: &CompareSignalsArgs, set: &ChannelSet) -> Result<f64> {
    let asked = args.sampling_hz.map(|hz| positive("--sampling-hz", hz));
    let asked = asked.transpose()?;
    let by_time = sampling_by_time(set, asked.or(set.sampling_hz)).transpose()?;
    let known = [
        (asked, "--sampling-hz"),
        (set.sampling_hz, "the file"),
        (by_time, "its time column"),
    ];
    let mut known = known.into_iter().filter_map(|(hz, who)| Some((hz?, who)));
    let Some((hz, who)) = known.next() else {
        let expected = "a file that states it or has a time column, or --sampling-hz";
        return Err(Error::input("sampling frequency", expected, "none"));
    };
    match known.find(|(other, _)| (other / hz - 1.0).abs() > SAME_RATE) {
        None => Ok(hz),
        Some((other, says)) => Err(Error::input(
            "sampling frequency",
            format!("the {hz} Hz of {who}"),
            format!("{other:.4} Hz by {says}"),
        )),
    }
}

fn metrics(pair: &SignalPair<'_>, args: &CompareSignalsArgs) -> Result<Vec<Line>> {
    let levels = WaveletParameters {
        level_count: args.levels,
        frequency_min_hz: args.from_hz,
        frequency_max_hz: args.to_hz,
        ..WaveletParameters::default()
    };
    let delay = PhaseParameters {
        significant_delay_s: args.significant_delay,
        ..PhaseParameters::default()
    };
    let surrogates = StationarityParameters {
        wavelet: levels,
        seed: args.seed,
        ..StationarityParameters::default()
    };
    let coupling = BicoherenceParameters {
        wavelet: levels,
        seed: args.seed,
        ..BicoherenceParameters::default()
    };
    let warping = magnitude_warped(pair, None);
    let (levelled, normalised) = (wavelet(pair, &levels), wavelet_normalised(pair, &levels));
    let density = probability_density(pair, true);
    let steady = stationarity(pair, &surrogates);
    let coupled = bicoherence(pair, &coupling);
    Ok(vec![
        Line::new("M_phi", "mean delay", phase(pair, &delay))?,
        Line::new("M_p", "largest absolute value", peak(pair))?,
        Line::new("M_rms", "mean power", rms(pair))?,
        Line::new("M_muw", "sample by sample difference", magnitude(pair))?,
        Line::new("M_m", "the same after time warping", warping)?,
        Line::new("M_w", "amplitude over time and frequency", levelled)?,
        Line::new("M_wf", "the same, each time normalised", normalised)?,
        Line::new("M_pdf", "distribution of values", density)?,
        Line::new("M_s", "non-stationary content", steady)?,
        Line::new("M_b", "quadratic coupling", coupled)?,
    ])
}

fn text(args: &CompareSignalsArgs, pair: &SignalPair<'_>, lines: &[Line]) -> String {
    let (compared, reference) = (&args.compared, &args.reference);
    let samples = format!(
        "{} samples of {} s",
        pair.sample_count(),
        pair.time_step_s()
    );
    let mut text = format!("{compared} against {reference}: {samples}; 1 for equal signals\n");
    for line in lines {
        let found = match (&line.problem, line.value) {
            (None, Some(value)) => format!("{value:>8.4}"),
            (problem, _) => format!("    none: {}", problem.as_deref().unwrap_or("")),
        };
        let _ = writeln!(text, "{:<6} {:<35} {found}", line.symbol, line.sees);
    }
    text
}
