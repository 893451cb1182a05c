//! Dynamic time warping against dtaidistance (PyPI, compiled C) in the same run, and the times of all metrics.
//!
//! `cargo bench --bench metrics [-- <samples>]`, 20 000 samples by default. The first run makes a Python
//! environment below `target/`. The baseline's path needs the whole matrix: 3.2 GB at 20 000 samples.

use aerodeck::comparison::{
    BicoherenceParameters, DensityParameters, PhaseParameters, SignalPair, StationarityParameters,
    WarpingParameters, WaveletParameters, bicoherence, magnitude, magnitude_warped, peak, phase,
    probability_density, rms, stationarity, warping_path, wavelet, wavelet_normalised,
};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

const BASELINE: &str = "dtaidistance==2.5.1";
const BASELINE_SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/dtw_baseline.py");
const SAMPLES: usize = 20_000;
const REPETITIONS: usize = 3;
const STEP_S: f64 = 0.005;

/// Agreed limits at 20 000 samples.
const LIMIT_S: f64 = 2.0;
const LIMIT_MIB: f64 = 100.0;

fn main() -> Result<(), Box<dyn Error>> {
    let samples = std::env::args()
        .skip(1)
        .find_map(|argument| argument.parse().ok())
        .unwrap_or(SAMPLES);
    let (x1, x2) = signals(samples);
    let pair = SignalPair::new(&x1, &x2, STEP_S)?;
    compare_warping(&pair)?;
    time_metrics()
}

/// Two forces at 2 Hz and its odd multiples with noise, the second late, weaker and with other noise.
fn signals(samples: usize) -> (Vec<f64>, Vec<f64>) {
    let mut state = 1_u64;
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        0.1 * ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
    };
    let force = |t: f64| (12.6 * t).cos() + 0.2 * (37.7 * t + 0.4).cos();
    (0..samples)
        .map(|k| STEP_S * k as f64)
        .map(|t| (force(t) + noise(), 0.9 * force(t - 0.012) + noise()))
        .unzip()
}

fn compare_warping(pair: &SignalPair<'_>) -> Result<(), Box<dyn Error>> {
    let samples = pair.sample_count();
    println!("dynamic time warping, {samples} x {samples} samples, best of {REPETITIONS}");
    let before = peak_memory_mib();
    let mut own = f64::INFINITY;
    let mut path = None;
    for _ in 0..REPETITIONS {
        let start = Instant::now();
        path = Some(warping_path(pair.compared(), pair.reference(), None)?);
        own = own.min(start.elapsed().as_secs_f64());
    }
    let path = path.ok_or("no repetition")?;
    let added = peak_memory_mib() - before;
    println!("  aerodeck     distance and path  {own:8.3} s, {added:7.1} MiB added to the peak");
    if samples == SAMPLES {
        let verdict = if own <= LIMIT_S && added <= LIMIT_MIB {
            "met"
        } else {
            "NOT met"
        };
        println!("  limits of {LIMIT_S} s and {LIMIT_MIB} MiB {verdict}");
    }
    let baseline = run_baseline(pair)?;
    let best = |key: &str| -> f64 {
        let times = baseline[key].as_array();
        times
            .into_iter()
            .flatten()
            .filter_map(serde_json::Value::as_f64)
            .fold(f64::INFINITY, f64::min)
    };
    let (distance, with_path) = (best("distance_seconds"), best("path_seconds"));
    println!("  {BASELINE}  distance only      {distance:8.3} s",);
    println!(
        "  {BASELINE}  path               {with_path:8.3} s, {} MiB peak of the process",
        baseline["peak_mib"]
    );
    println!(
        "  ratio: {:.2} times as fast as its distance alone, {:.1} times as fast as its path",
        distance / own,
        with_path / own
    );
    let other = baseline["squared_distance"].as_f64().unwrap_or(f64::NAN);
    let difference = (path.distance / other - 1.0).abs();
    println!("  squared distances differ by {difference:.1e}");
    // Its square root is squared again: a few roundings.
    if difference.is_nan() || difference > 1e-12 {
        return Err("the distances differ".into());
    }
    Ok(())
}

fn run_baseline(pair: &SignalPair<'_>) -> Result<serde_json::Value, Box<dyn Error>> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let python = baseline_python(folder)?;
    let file = folder.join("dtw_signals.f64");
    let bytes: Vec<u8> = pair
        .reference()
        .iter()
        .chain(pair.compared())
        .flat_map(|x| x.to_ne_bytes())
        .collect();
    std::fs::write(&file, bytes)?;
    let output = Command::new(python)
        .arg(BASELINE_SCRIPT)
        .arg(&file)
        .arg(REPETITIONS.to_string())
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

/// Interpreter of an environment with the baseline, made on first use.
fn baseline_python(folder: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let environment = folder.join("dtw-baseline");
    let python = environment.join("bin/python");
    let has_baseline = Command::new(&python)
        .args(["-c", "import dtaidistance, numpy"])
        .output()
        .is_ok_and(|output| output.status.success());
    if !has_baseline {
        run(Command::new("python3")
            .args(["-m", "venv"])
            .arg(&environment))?;
        run(Command::new(&python).args(["-m", "pip", "install", "--quiet", BASELINE, "numpy"]))?;
    }
    Ok(python)
}

fn run(command: &mut Command) -> Result<(), Box<dyn Error>> {
    let status = command.status()?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("{command:?} ended with {status}").into())
    }
}

/// Largest resident memory of this process so far; 0 where the system does not say.
fn peak_memory_mib() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))
        .and_then(|rest| rest.trim().trim_end_matches(" kB").parse::<f64>().ok())
        .map_or(0.0, |kib| kib / 1024.0)
}

/// Each metric once on 4000 samples, 20 s at 200 Hz; the two with surrogates at 120 levels.
fn time_metrics() -> Result<(), Box<dyn Error>> {
    let (x1, x2) = signals(4000);
    let pair = SignalPair::new(&x1, &x2, STEP_S)?;
    let levels = WaveletParameters::default();
    let few = WaveletParameters {
        level_count: 120,
        ..levels
    };
    println!("metrics of 4000 samples, ms");
    let line = |name: &str, metric: &dyn Fn() -> aerodeck::Result<f64>| -> aerodeck::Result<()> {
        let start = Instant::now();
        let value = metric()?;
        let elapsed_ms = 1e3 * start.elapsed().as_secs_f64();
        println!("  {name:<32} {elapsed_ms:10.2}   value {value:.4}");
        Ok(())
    };
    line("phase", &|| {
        Ok(phase(&pair, &PhaseParameters::default())?.value)
    })?;
    line("peak", &|| Ok(peak(&pair)?.value))?;
    line("RMS", &|| Ok(rms(&pair)?.value))?;
    line("magnitude", &|| Ok(magnitude(&pair)?.value))?;
    line("magnitude warped", &|| {
        Ok(magnitude_warped(&pair, &WarpingParameters::default())?.value)
    })?;
    line("wavelet, 1200 levels", &|| {
        Ok(wavelet(&pair, &levels)?.value)
    })?;
    line("wavelet normalised, 1200 levels", &|| {
        Ok(wavelet_normalised(&pair, &levels)?.value)
    })?;
    line("probability density", &|| {
        Ok(probability_density(&pair, &DensityParameters::default())?.value)
    })?;
    line("stationarity, 120 levels", &|| {
        let parameters = StationarityParameters {
            wavelet: few,
            ..StationarityParameters::default()
        };
        Ok(stationarity(&pair, &parameters)?.value)
    })?;
    line("bicoherence, 120 levels", &|| {
        Ok(bicoherence(&pair, &BicoherenceParameters::default())?.value)
    })?;
    Ok(())
}
