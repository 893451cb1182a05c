//! The command line: one file per subcommand. Commands compute an [`Answer`]; it is printed here and nowhere else.

mod answer;
mod bridge;
mod buffeting;
mod campaign;
mod command;
mod common;
mod compare;
mod coverage;
mod demo;
mod derivatives;
mod figures;
mod flutter;
mod fmu;
mod groups;
mod headline;
mod interrupt;
mod laboratory;
mod lock;
mod measured_forces;
mod monte_carlo;
mod new;
mod output;
mod panic_message;
mod plot;
mod process;
mod progress;
mod quasi_steady;
mod report;
mod result_files;
mod routes;
mod schemas;
mod select;
mod simulate;
mod ssp;
mod stages;
mod study;
mod study_run;
mod summary;
mod text;
mod text_table;
mod thesis;
mod train;
mod tunnel;
mod validate;
mod vocabulary;
mod wind;
mod wrapping;

pub use answer::Answer;

use crate::error::{Error, Result};
use answer::{FAILED, NOT_MET};
use clap::{ArgMatches, CommandFactory as _, FromArgMatches as _, Parser};
use clap_complete::Shell;
use command::Command;
use common::in_input;
use interrupt::uninterrupted;
use progress::Progress;
use std::ffi::OsString;
use std::io::{ErrorKind, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

/// Exit code for wrong input, as clap uses it for wrong arguments.
const WRONG_INPUT: u8 = 2;

/// Above the options that every command has.
const OF_ALL: &str = "Options of all commands";

/// What each exit code means.
const EXIT_CODES: [(u8, &str); 5] = [
    (0, "done; where a wind speed is required, it is met"),
    (
        FAILED,
        "a computation failed or a check did not pass, or there is no room on the disk; what was finished is written",
    ),
    (WRONG_INPUT, "wrong input: arguments, a file, a number"),
    (
        NOT_MET,
        "a wind speed is required, and it is not known to be met: see [the verdict](verdict.md)",
    ),
    (panic_message::OWN_FAULT, "a fault of the program itself"),
];

/// Bridge aeroelasticity from wind-tunnel data to an FMU (FMI 2.0 or 3.0).
#[derive(Parser)]
#[command(name = "aerodeck", version, about, propagate_version = true)]
struct Cli {
    /// Print the result as JSON on standard output, for machines.
    #[arg(long, global = true, help_heading = OF_ALL)]
    json: bool,
    /// Print the JSON Schema of what `--json` prints, and do nothing else.
    #[arg(long, global = true, help_heading = OF_ALL)]
    json_schema: bool,
    /// No progress bars.
    #[arg(long, short, global = true, help_heading = OF_ALL)]
    quiet: bool,
    /// The whole account of `study`, `demo` and `bridge flutter`; the report has all of it in any case.
    #[arg(long, short, global = true, help_heading = OF_ALL)]
    verbose: bool,
    /// Neither draw nor write figures.
    #[arg(long, global = true, help_heading = OF_ALL)]
    no_figures: bool,
    /// Figures as PNG images too (in programs built with `--features png`).
    #[arg(long, global = true, help_heading = OF_ALL)]
    png: bool,
    #[command(subcommand)]
    command: Command,
    /// What the answer is: the names of the command, as its schema has them.
    #[arg(skip)]
    kind: String,
    /// The study or the bridge that the command works on.
    #[arg(skip)]
    input: Option<PathBuf>,
    /// What is set in it.
    #[arg(skip)]
    set: Vec<String>,
}

/// Every command with what it does, the options of all and the exit codes, in Markdown: `docs/commands.md`.
pub fn commands_page() -> String {
    groups::page(&Cli::command(), &EXIT_CODES)
}

/// Runs the command line of this process.
pub fn main() -> ExitCode {
    common::is_program();
    panic_message::install();
    interrupt::install();
    let _temporary = interrupt::own_temporary_folder();
    let code = panic_message::guarded(|| {
        if let Err(error) = readable_arguments() {
            return report(&error, std::env::args_os().any(|a| a == "--json"));
        }
        let arguments: Vec<String> = std::env::args().skip(1).collect();
        match schemas::asked(&arguments) {
            Ok(None) => (),
            Ok(Some(schema)) => return print(&schema, false),
            Err(error) => return report(&error, false),
        }
        let command = groups::in_groups(Cli::command());
        let cli = match Cli::read(command, std::env::args_os()) {
            Ok(cli) => cli,
            Err(error) => return usage(&error),
        };
        let result = cli.answer();
        // a signal that is being obeyed ends the program with a code of its own
        let _busy = uninterrupted();
        match result {
            Ok(answer) => print(&answer, cli.json),
            Err(error) => report(&error, cli.json),
        }
    });
    ExitCode::from(code)
}

/// What a command line, without the name of the program, answers to another program: the JSON that `--json` prints and the exit
/// code. Nothing is printed but progress, where standard error is a terminal, unless `--quiet` is said.
///
/// # Errors
/// [`Error::Input`] with what is said of a wrong command line; those of the command.
pub fn answer(arguments: &[String]) -> Result<(serde_json::Value, u8)> {
    let name = std::iter::once("aerodeck");
    let line = name.chain(arguments.iter().map(String::as_str));
    let cli = Cli::read(Cli::command(), line).map_err(|e| {
        let said = e.to_string();
        Error::input("arguments", "a command line of the program", said.trim())
    })?;
    let answer = cli.answer()?;
    Ok((answer.value(), answer.exit_code()))
}

impl Cli {
    fn read(
        command: clap::Command,
        line: impl IntoIterator<Item = impl Into<OsString> + Clone>,
    ) -> std::result::Result<Self, clap::Error> {
        let matches = command.try_get_matches_from(line)?;
        let mut cli = Self::from_arg_matches(&matches)?;
        cli.kind = kind(&matches);
        let line = innermost(&matches);
        let named = |id| line.try_get_one::<PathBuf>(id).ok().flatten();
        cli.input = named("study").or_else(|| named("bridge")).cloned();
        let set = line.try_get_many::<String>("set").ok().flatten();
        cli.set = set.into_iter().flatten().cloned().collect();
        Ok(cli)
    }

    fn answer(&self) -> Result<Answer> {
        figures::want(!self.no_figures, self.png)?;
        let progress = Progress::new(!self.quiet && !self.json, self.verbose);
        let answer = run(&self.command, &progress).map_err(|e| match &self.input {
            Some(file) => in_input(file, &self.set, e),
            None => e,
        })?;
        Ok(answer.of_kind(&self.kind))
    }
}

/// The arguments of the command itself.
fn innermost(line: &ArgMatches) -> &ArgMatches {
    line.subcommand()
        .map_or(line, |(_, inner)| innermost(inner))
}

/// What the command of a line answers.
fn kind(line: &ArgMatches) -> String {
    match line.subcommand() {
        Some(("demo", demo)) if demo.get_flag("bridge") => "bridge-flutter".to_owned(),
        Some(("demo", _)) => "study".to_owned(),
        Some((name, inner)) => format!("{name}-{}", kind(inner))
            .trim_end_matches('-')
            .to_owned(),
        None => String::new(),
    }
}

/// Names that are no UTF-8 cannot be said in results, which are text.
fn readable_arguments() -> Result<()> {
    match std::env::args_os().find(|a| a.to_str().is_none()) {
        None => Ok(()),
        Some(argument) => {
            let found = argument.to_string_lossy();
            Err(Error::input("arguments", "names and paths in UTF-8", found))
        }
    }
}

/// Help, the version, or a wrong command line, which is said as JSON where JSON was asked for.
fn usage(error: &clap::Error) -> u8 {
    if error.use_stderr() && std::env::args_os().any(|a| a == "--json") {
        let text = error.render().to_string();
        let value = serde_json::json!({ "error": text.trim().trim_start_matches("error: ") });
        let _ = say(&format!("{value}\n"));
    }
    // standard output may be closed
    let _ = error.print();
    u8::try_from(error.exit_code()).unwrap_or(WRONG_INPUT)
}

fn print(answer: &Answer, json: bool) -> u8 {
    let text = match json {
        true => answer.json() + "\n",
        false => answer.shown(),
    };
    match say(&text) {
        Err(error) => {
            complain(&error);
            FAILED
        }
        Ok(()) => answer.exit_code(),
    }
}

/// Writes to standard output. Who closes it has read enough; a full disk is an error.
fn say(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::io("standard output", e)),
        _ => Ok(()),
    }
}

/// Writes to standard error, which may be closed: then nobody can be told.
fn complain(error: &Error) {
    let _ = writeln!(std::io::stderr(), "error: {error}");
}

fn run(command: &Command, progress: &Progress) -> Result<Answer> {
    match command {
        Command::Demo { out, bridge, force } => demo::run(out, *bridge, *force, progress),
        Command::New(args) => new::run(args),
        Command::Study {
            study,
            allow_unstable,
            force,
        } => study::run(study, *allow_unstable, *force, progress),
        Command::Report { folder, pdf } => report::run(folder, *pdf),
        Command::Plot { file, x, y, out } => plot::run(file, x.as_deref(), y, out.as_deref()),
        Command::Tunnel(args) => tunnel::run(args, progress),
        Command::Campaign(command) => campaign::run(command, progress),
        Command::Process(args) => process::run(args, progress),
        Command::Train(args) => train::run(args, progress),
        Command::Flutter { study, all } => flutter::run(study, *all, progress),
        Command::MonteCarlo(args) => monte_carlo::run(args, progress),
        Command::Simulate(args) => simulate::run(args),
        Command::QuasiSteady(args) => quasi_steady::run(args, progress),
        Command::Buffeting(args) => buffeting::run(args, progress),
        Command::Bridge(command) => bridge::run(command, progress),
        Command::Fmu(command) => fmu::run(command, progress),
        Command::Ssp(command) => ssp::run(command, progress),
        Command::Derivatives(command) => derivatives::run(command),
        Command::Validate {
            name,
            files,
            markdown,
        } => validate::run(name.as_deref(), files, *markdown, progress),
        Command::Thesis { out } => thesis::run(out.as_deref(), progress),
        Command::Select(args) => select::run(args, progress),
        Command::Coverage(args) => coverage::run(args, progress),
        Command::Compare(command) => compare::run(command, progress),
        Command::Completions { shell } => completions(*shell),
    }
}

fn completions(shell: Shell) -> Result<Answer> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "aerodeck", &mut script);
    let script = String::from_utf8_lossy(&script).into_owned();
    let value = serde_json::json!({ "shell": shell.to_string(), "script": script });
    Ok(Answer::new(script, &value)?.verbatim())
}

fn report(error: &Error, json: bool) -> u8 {
    if json {
        let value = serde_json::json!({ "error": error.to_string() });
        // the same is said below
        let _ = say(&format!("{value}\n"));
    }
    complain(error);
    code(error)
}

fn code(error: &Error) -> u8 {
    match error {
        Error::Io { source, .. } if no_room(source.kind()) => FAILED,
        Error::Input(_) | Error::Io { .. } => WRONG_INPUT,
        Error::Numerical(_) | Error::NotDistinct(_) | Error::Unstable(_) => FAILED,
        Error::Several(errors) => errors.iter().map(code).max().unwrap_or(FAILED),
    }
}

fn no_room(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::WriteZero
    )
}

#[cfg(test)]
mod tests {
    use super::{Cli, command};
    use clap::CommandFactory as _;

    #[test]
    fn every_command_stands_in_one_group() {
        let mut grouped: Vec<&str> = command::GROUPS
            .iter()
            .flat_map(|(_, names)| names.split(' '))
            .collect();
        let cli = Cli::command();
        let mut all: Vec<&str> = cli.get_subcommands().map(clap::Command::get_name).collect();
        grouped.sort_unstable();
        all.sort_unstable();
        assert_eq!(grouped, all);
    }
}
