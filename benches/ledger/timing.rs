//! Interleaved rounds of ours and of the baseline.

use crate::baseline::Running;
use crate::entry::{Baseline, BenchEntry, Job, Threads};
use serde::{Deserialize, Serialize};
use std::time::Instant;

const ROUNDS: usize = 5;
/// Rounds of what takes longer than [`LONG_S`].
const FEW_ROUNDS: usize = 3;
const LONG_S: f64 = 2.0;

/// Seconds of all rounds, a unit each.
#[derive(Serialize, Deserialize, Clone, Copy)]
pub(crate) struct Seconds {
    pub(crate) median: f64,
    pub(crate) least: f64,
    pub(crate) most: f64,
}

impl Seconds {
    fn new(mut rounds: Vec<f64>) -> Self {
        rounds.sort_by(f64::total_cmp);
        Self {
            median: rounds[rounds.len() / 2],
            least: rounds[0],
            most: rounds[rounds.len() - 1],
        }
    }
}

/// What the process of one entry finds.
#[derive(Serialize, Deserialize)]
pub(crate) struct Timed {
    pub(crate) ours: Seconds,
    pub(crate) baseline: Option<Rival>,
}

#[derive(Serialize, Deserialize)]
pub(crate) struct Rival {
    pub(crate) name: String,
    pub(crate) seconds: Seconds,
    /// Of its own process, where it has one.
    pub(crate) peak_mib: Option<f64>,
}

/// The entry in a process of its own.
pub(crate) fn timed(entry: &BenchEntry) -> Result<Timed, String> {
    let mut command = entry.process("--time")?;
    if entry.threads == Threads::One {
        command.env("RAYON_NUM_THREADS", "1");
    }
    let output = command
        .stderr(std::process::Stdio::inherit())
        .output()
        .map_err(|e| e.to_string())?;
    serde_json::from_slice(&output.stdout)
        .map_err(|e| format!("{}: {} ({e})", entry.name, output.status))
}

/// Times the entry and prints what it finds, for [`timed`].
pub(crate) fn print(entry: &BenchEntry) -> Result<(), String> {
    let mut job = (entry.job)();
    let mut rival = Opponent::new(entry)?;
    let (mut ours, mut theirs) = (vec![], vec![]);
    job.run(1);
    loop {
        let begin = Instant::now();
        let each = seconds(&mut job, entry.times, entry.units);
        ours.push(each);
        theirs.extend(rival.round()?);
        let rounds = match begin.elapsed().as_secs_f64() {
            s if s > LONG_S => FEW_ROUNDS,
            _ => ROUNDS,
        };
        if ours.len() >= rounds {
            break;
        }
    }
    rival.agrees(&job)?;
    let found = Timed {
        ours: Seconds::new(ours),
        baseline: rival.named(theirs),
    };
    println!("{}", serde_json::json!(found));
    Ok(())
}

fn seconds(job: &mut Job, times: u32, units: u32) -> f64 {
    let begin = Instant::now();
    job.run(times);
    begin.elapsed().as_secs_f64() / f64::from(times) / f64::from(units)
}

/// The baseline as it runs.
enum Opponent {
    Here {
        name: String,
        job: Job,
        units: u32,
        times: u32,
    },
    Python(Box<Running>),
    None,
}

impl Opponent {
    fn new(entry: &BenchEntry) -> Result<Self, String> {
        Ok(match &entry.baseline {
            Baseline::Here {
                name,
                package,
                job,
                units,
                times,
            } => {
                let mut job = job();
                job.run(1);
                let version = package.map(|p| format!(" {}", version_of(p)));
                let name = format!("{name}{}", version.unwrap_or_default());
                Self::Here {
                    name,
                    job,
                    units: *units,
                    times: *times,
                }
            }
            Baseline::Python(script) => {
                Self::Python(Box::new(Running::start(script, entry.threads)?))
            }
            Baseline::None(_) => Self::None,
        })
    }

    fn round(&mut self) -> Result<Option<f64>, String> {
        Ok(match self {
            Self::Here {
                job, units, times, ..
            } => Some(seconds(job, *times, *units)),
            Self::Python(running) => Some(running.round()?),
            Self::None => None,
        })
    }

    fn agrees(&self, job: &Job) -> Result<(), String> {
        match self {
            Self::Python(running) => running.agrees(&job.answer()),
            _ => Ok(()),
        }
    }

    fn named(self, rounds: Vec<f64>) -> Option<Rival> {
        let (name, peak_mib) = match self {
            Self::Here { name, .. } => (name, None),
            Self::Python(running) => (running.name.clone(), Some(running.peak_mib)),
            Self::None => return None,
        };
        let seconds = Seconds::new(rounds);
        Some(Rival {
            name,
            seconds,
            peak_mib,
        })
    }
}

/// Version of a crate in the lock file of this build.
fn version_of(package: &str) -> &'static str {
    let lock = include_str!("../../Cargo.lock");
    let after = lock.split_once(&format!("name = \"{package}\"\nversion = \""));
    after
        .and_then(|(_, rest)| rest.split('"').next())
        .unwrap_or("of this build")
}
