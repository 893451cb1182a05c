//! The first-order example of section 2.5 of the thesis: trains discrete Laguerre filters on six sines, predicts a seventh,
//! varies `α` and `L`, and writes Figures 2.6 to 2.11 as SVG.
//!
//! `cargo run --release --example first_order -- OUT_FOLDER`

use aerodeck::reference::first_order_example;
use aerodeck::report::first_order_figures;
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let folder: PathBuf = std::env::args()
        .nth(1)
        .ok_or("usage: first_order OUT_FOLDER")?
        .into();
    std::fs::create_dir_all(&folder)?;
    let results = first_order_example()?;
    for (number, figure) in first_order_figures(&results)? {
        let stem = format!("figure_{}", number.replace('.', "_"));
        let svg = figure.write(&folder, &stem)?;
        println!("{}", svg.display());
    }
    let (lower, upper) = results.alpha_bounds;
    println!(
        "bounds of α: {lower:.4} by (2.36), {upper:.4} by (2.37); the thesis prints 0.8283 and 0.889"
    );
    println!(
        "|g_3| at the end of the memory: {:.4}; the thesis prints 0.0096",
        results.last_value
    );
    println!(
        "{}: output off by {:.1} %, transfer function by at most {:.1} % in the trained band",
        results.model.model,
        100.0 * results.validation_error,
        100.0 * results.worst_in_band(&results.model),
    );
    for trial in results.by_alpha.iter().chain(&results.by_order) {
        println!(
            "  {:<12} at most {:5.1} %",
            trial.model,
            100.0 * results.worst_in_band(trial)
        );
    }
    Ok(())
}
