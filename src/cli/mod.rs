//! The command line: one file a subcommand. Commands compute an [`Answer`]; it is printed here and nowhere else.

mod account;
mod answer;
mod buffeting;
mod campaign;
mod common;
mod compare;
mod coverage;
mod demo;
mod derivatives;
mod flutter;
mod fmu;
mod monte_carlo;
mod output;
mod process;
mod progress;
mod quasi_steady;
mod routes;
mod select;
mod simulate;
mod stages;
mod study;
mod thesis;
mod train;
mod tunnel;
mod validate;
mod wind;

pub use answer::Answer;

use crate::error::{Error, Result};
use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Exit code for wrong input, as clap uses it for wrong arguments.
const WRONG_INPUT: u8 = 2;
/// Exit code when a computation failed or a check did not pass.
const FAILED: u8 = 1;

/// Bridge aeroelasticity from wind-tunnel data to an FMI 2.0 co-simulation FMU.
#[derive(Parser)]
#[command(name = "aerodeck", version, about, propagate_version = true)]
struct Cli {
    /// Print the result as JSON on standard output, for machines.
    #[arg(long, global = true)]
    json: bool,
    /// No progress bars.
    #[arg(long, short, global = true)]
    quiet: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Demo(demo::Args),
    Study(study::Args),
    Tunnel(tunnel::Args),
    #[command(subcommand)]
    Campaign(campaign::Campaign),
    Process(process::Args),
    Train(train::Args),
    Flutter(flutter::Args),
    MonteCarlo(monte_carlo::Args),
    Simulate(simulate::Args),
    QuasiSteady(quasi_steady::Args),
    Buffeting(buffeting::Args),
    #[command(subcommand)]
    Fmu(fmu::Fmu),
    #[command(subcommand)]
    Derivatives(derivatives::Derivatives),
    Validate(validate::Args),
    Thesis(thesis::Args),
    Select(select::Args),
    Coverage(coverage::Args),
    #[command(subcommand)]
    Compare(compare::Compare),
}

/// Runs the command line of this process.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    let progress = progress::Progress::new(!cli.quiet && !cli.json);
    match run(&cli.command, &progress) {
        Ok(answer) => {
            if cli.json {
                println!("{}", answer.json());
            } else {
                print!("{}", answer.text());
            }
            if answer.passed() {
                ExitCode::SUCCESS
            } else {
                ExitCode::from(FAILED)
            }
        }
        Err(error) => report(&error, cli.json),
    }
}

fn run(command: &Command, progress: &progress::Progress) -> Result<Answer> {
    match command {
        Command::Demo(args) => demo::run(args, progress),
        Command::Study(args) => study::run(args, progress),
        Command::Tunnel(args) => tunnel::run(args, progress),
        Command::Campaign(command) => campaign::run(command, progress),
        Command::Process(args) => process::run(args, progress),
        Command::Train(args) => train::run(args, progress),
        Command::Flutter(args) => flutter::run(args, progress),
        Command::MonteCarlo(args) => monte_carlo::run(args, progress),
        Command::Simulate(args) => simulate::run(args),
        Command::QuasiSteady(args) => quasi_steady::run(args, progress),
        Command::Buffeting(args) => buffeting::run(args, progress),
        Command::Fmu(command) => fmu::run(command, progress),
        Command::Derivatives(command) => derivatives::run(command),
        Command::Validate(args) => validate::run(args, progress),
        Command::Thesis(args) => thesis::run(args, progress),
        Command::Select(args) => select::run(args, progress),
        Command::Coverage(args) => coverage::run(args, progress),
        Command::Compare(command) => compare::run(command, progress),
    }
}

fn report(error: &Error, json: bool) -> ExitCode {
    if json {
        println!("{}", serde_json::json!({ "error": error.to_string() }));
    }
    eprintln!("error: {error}");
    ExitCode::from(match error {
        Error::Input(_) | Error::Io { .. } => WRONG_INPUT,
        Error::Numerical(_) => FAILED,
    })
}
