//! The commands by what they are for: their help, and the page of the manual that lists them.

use super::{command::GROUPS, wrapping};
use clap::Command;
use std::fmt::Write as _;

const TEMPLATE: &str = "{about-with-newline}\n{usage-heading} {usage}\n\n";

/// The command line with its commands in groups.
pub(super) fn in_groups(cli: Command) -> Command {
    let listed = listed(&cli);
    cli.help_template(format!(
        "{TEMPLATE}Commands:\n{listed}\nOptions:\n{{options}}"
    ))
}

fn listed(cli: &Command) -> String {
    let widest = cli.get_subcommands().map(|c| c.get_name().len()).max();
    let width = widest.unwrap_or_default();
    let mut text = String::new();
    for (group, names) in GROUPS {
        let _ = writeln!(text, " {group}");
        for command in commands(cli, names) {
            let head = format!("  {:<width$} ", command.get_name());
            text.push_str(&wrapping::beside(&head, &purpose(command)));
        }
    }
    text
}

/// The commands of a group, by their names.
fn commands<'a>(cli: &'a Command, names: &'a str) -> impl Iterator<Item = &'a Command> {
    names
        .split(' ')
        .filter_map(|name| cli.find_subcommand(name))
}

/// The first sentence of a command's help.
fn purpose(command: &Command) -> String {
    let about = command.get_about().map(ToString::to_string);
    about.unwrap_or_default()
}

/// Every command with what it does, by groups, the options of all and the exit codes, in Markdown.
pub(super) fn page(cli: &Command, exit_codes: &[(u8, &str)]) -> String {
    let mut text = String::new();
    for (group, names) in GROUPS {
        let _ = writeln!(text, "## {group}\n\n| command | what it does |\n|---|---|");
        for command in commands(cli, names) {
            rows(&mut text, command, "aerodeck");
        }
        text.push('\n');
    }
    text.push_str("## Options of all commands\n\n| option | what it does |\n|---|---|\n");
    for option in cli.get_arguments().filter(|a| a.is_global_set()) {
        let short = option.get_short().map(|c| format!("-{c}, "));
        let short = short.unwrap_or_default();
        let long = option.get_long().unwrap_or_default();
        let help = option.get_help().map(ToString::to_string);
        let _ = writeln!(text, "| `{short}--{long}` | {} |", help.unwrap_or_default());
    }
    text.push_str("\n## Exit codes\n\n| code | meaning |\n|---|---|\n");
    for (code, meaning) in exit_codes {
        let _ = writeln!(text, "| {code} | {meaning} |");
    }
    text.push_str("| 128 + n | ended by signal n |\n");
    text
}

fn rows(text: &mut String, command: &Command, path: &str) {
    let path = format!("{path} {}", command.get_name());
    if !command.has_subcommands() {
        let _ = writeln!(text, "| `{path}` | {} |", purpose(command));
    }
    for below in command.get_subcommands() {
        rows(text, below, &path);
    }
}
