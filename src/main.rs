//! The `aerodeck` command.

fn main() -> std::process::ExitCode {
    aerodeck::cli::main()
}
