//! Turns an NTNU workbook of aerodynamic derivatives into this project's CSV, at full precision.
//!
//! `cargo run --example import_workbook -- WORKBOOK.xlsx OUT.csv SOURCE LICENCE [MODEL_LENGTH_M]`
//!
//! The tables in `data/decks` were made with it. An existing file is not overwritten.

use aerodeck::aerodynamics::derivatives::TableHeader;
use aerodeck::files::derivatives::ReadOptions;
use aerodeck::files::derivatives::read_table_with;
use aerodeck::files::derivatives::write_csv;
use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [workbook, out, source, licence, length @ ..] = arguments.as_slice() else {
        return Err(
            "usage: import_workbook WORKBOOK.xlsx OUT.csv SOURCE LICENCE [MODEL_LENGTH_M]".into(),
        );
    };
    let header = TableHeader {
        source: source.clone(),
        licence: licence.clone(),
        generator: "examples/import_workbook.rs of aerodeck".to_owned(),
        model_length_m: length.first().map(|text| text.parse()).transpose()?,
        ..TableHeader::default()
    };
    let options = ReadOptions {
        header,
        ..ReadOptions::default()
    };
    let (table, _) = read_table_with(workbook, &options)?;
    let mut file = BufWriter::new(File::create_new(out)?);
    write_csv(&table, &mut file)?;
    file.flush()?;
    Ok(())
}
