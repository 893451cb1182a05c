//! `aerodeck derivatives`: tables of derivatives, shown and converted between notations.

mod convert;
mod notations;
mod show;

use super::answer::Answer;
use crate::aerodynamics::derivatives::DerivativeTable;
use crate::aerodynamics::derivatives::Missing;
use crate::aerodynamics::derivatives::notation::{
    Argument, Axes, Convention, Notation, StatedConvention,
};
use crate::error::Result;
use crate::files::derivatives::ReadOptions;
use crate::files::derivatives::embedded;
use crate::files::derivatives::is_table_file;
use crate::files::derivatives::read_table_with;
use clap::Subcommand;

/// Show tables of aerodynamic derivatives and convert them between notations
#[derive(Subcommand)]
pub(crate) enum Derivatives {
    Convert(convert::Args),
    Show(show::Args),
    Notations(notations::Args),
}

/// Runs the command.
pub fn run(command: &Derivatives) -> Result<Answer> {
    match command {
        Derivatives::Convert(args) => convert::run(args),
        Derivatives::Show(args) => show::run(args),
        Derivatives::Notations(args) => notations::run(args),
    }
}

/// A table and its conventions.
#[derive(clap::Args)]
struct TableArgs {
    /// Table of derivatives (.csv, .xlsx), or the name of an embedded deck.
    table: String,
    /// Notation of the file: scanlan, classical, polimi, starossek. A CSV file states it itself; what is stated here must
    /// not contradict it.
    #[arg(long, value_name = "NOTATION")]
    from: Option<Notation>,
    /// What the file is tabulated over: v_hat = V/(omega B), v_star = V/(f B), k_full = omega B/V, k_semi = omega b/V.
    #[arg(long, value_name = "ARGUMENT")]
    from_argument: Option<Argument>,
    /// Direction of heave and lift in the file: heave_up, heave_down.
    #[arg(long, value_name = "AXES")]
    from_axes: Option<Axes>,
    /// Notation of the result; by default scanlan.
    #[arg(long, value_name = "NOTATION")]
    to: Option<Notation>,
    /// What the result is tabulated over; by default what is usual for the notation.
    #[arg(long, value_name = "ARGUMENT")]
    to_argument: Option<Argument>,
    /// Direction of heave and lift in the result; by default what is usual for the notation.
    #[arg(long, value_name = "AXES")]
    to_axes: Option<Axes>,
    /// Width of the section model, m; by default what the file states, and for a workbook what follows from the frequencies.
    #[arg(long)]
    width_m: Option<f64>,
    /// What stands for H4*, A4* in a table without them: zero (as when nothing is stated), quasi_steady (K H2*, K A2*).
    #[arg(long, value_name = "HOW")]
    missing: Option<Missing>,
    /// Frequencies of motion of a workbook in test order, Hz, with commas between them; by default those of the NTNU
    /// tests.
    #[arg(long, value_delimiter = ',')]
    frequencies_hz: Vec<f64>,
}

impl TableArgs {
    /// The convention of the result.
    fn target(&self) -> Convention {
        let stated = StatedConvention {
            notation: self.to,
            argument: self.to_argument,
            axes: self.to_axes,
        };
        stated.or_usual()
    }

    /// The table and the convention it was in.
    fn read(&self) -> Result<(DerivativeTable, Convention)> {
        let stated = StatedConvention {
            notation: self.from,
            argument: self.from_argument,
            axes: self.from_axes,
        };
        if is_table_file(&self.table) {
            let options = ReadOptions {
                convention: stated,
                width_m: self.width_m,
                missing: self.missing,
                frequencies_hz: (!self.frequencies_hz.is_empty())
                    .then(|| self.frequencies_hz.clone()),
            };
            return read_table_with(&self.table, &options);
        }
        let table = embedded::deck(&self.table)?;
        let convention = stated.with_file(Convention::default().into())?;
        Ok((table, convention))
    }
}
