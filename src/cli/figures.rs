//! Figures of results, unless `--no-figures` was said: an SVG for pages and a PNG for everything else.

use super::output::OutputDir;
use crate::error::Result;
use crate::report::{Figure, PNG_SCALE};
use std::sync::atomic::{AtomicBool, Ordering};

/// Said once, at the start of the program.
static WANTED: AtomicBool = AtomicBool::new(true);

/// Leaves out all figures.
pub(super) fn leave_out() {
    WANTED.store(false, Ordering::Relaxed);
}

/// Draws and writes `stem.svg` and `stem.png`.
pub(super) fn write(
    stem: &str,
    out: &mut OutputDir,
    draw: impl FnOnce() -> Result<Figure>,
) -> Result<()> {
    if !WANTED.load(Ordering::Relaxed) {
        return Ok(());
    }
    let figure = draw()?;
    let png = figure.png(PNG_SCALE)?;
    out.write(format!("{stem}.svg"), figure.svg())?;
    out.write(format!("{stem}.png"), png)
}
