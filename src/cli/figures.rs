//! Figures of results: an SVG each, a PNG beside it with `--png`, nothing with `--no-figures`.

use super::vocabulary::{Figure, OutputDir, Result, ensure};
use std::sync::atomic::{AtomicBool, Ordering};

/// Said at the start of a command.
static WANTED: AtomicBool = AtomicBool::new(true);
static IMAGES: AtomicBool = AtomicBool::new(false);

/// Whether figures are written, and whether each as a PNG image too.
///
/// # Errors
/// [`Error::Input`] for images where the program was built without the renderer.
pub(super) fn want(figures: bool, images: bool) -> Result<()> {
    ensure(
        !images || cfg!(feature = "png"),
        "--png",
        "a program built with `--features png` (figures are written as SVG, which browsers and word processors show)",
        "one without",
    )?;
    WANTED.store(figures, Ordering::Relaxed);
    IMAGES.store(images, Ordering::Relaxed);
    Ok(())
}

/// Whether figures are drawn: what only they show need not be computed otherwise.
pub(super) fn wanted() -> bool {
    WANTED.load(Ordering::Relaxed)
}

/// What an earlier run left of a figure is not of this one.
pub(super) fn outdated(stem: &str, out: &mut OutputDir) {
    for ending in ["svg", "png"] {
        out.outdated(format!("{stem}.{ending}"));
    }
}

/// Draws and writes `stem.svg`, and `stem.png` where images are wanted.
pub(super) fn write(
    stem: &str,
    out: &mut OutputDir,
    draw: impl FnOnce() -> Result<Figure>,
) -> Result<()> {
    outdated(stem, out);
    if !wanted() {
        return Ok(());
    }
    let figure = draw()?;
    out.write(format!("{stem}.svg"), figure.svg())?;
    #[cfg(feature = "png")]
    if IMAGES.load(Ordering::Relaxed) {
        let image = figure.png(crate::report::PNG_SCALE)?;
        out.write(format!("{stem}.png"), image)?;
    }
    Ok(())
}
