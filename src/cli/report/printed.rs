//! The page as a browser prints it.

use crate::cli::vocabulary::{Error, Result};
use std::path::Path;
use std::process::Command;

/// Programs that print a page without showing it.
const BROWSERS: [&str; 8] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
    "msedge",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "C:\\Program Files (x86)\\Microsoft\\Edge\\Application\\msedge.exe",
];
/// Environment variable that names another one.
const BROWSER: &str = "AERODECK_BROWSER";

/// Prints `page` to `pdf`.
///
/// # Errors
/// [`Error::Input`] where no browser is installed, with another way; [`Error::Numerical`] with what one said that printed nothing.
pub(super) fn print(page: &Path, pdf: &Path) -> Result<()> {
    let named = std::env::var(BROWSER).ok();
    let mut names = named.iter().map(String::as_str).chain(BROWSERS);
    let runs = |name: &&str| Command::new(name).arg("--version").output().is_ok();
    let Some(browser) = names.find(runs) else {
        let expected = format!(
            "an installed browser of the Chromium family ({BROWSER} names one that is not found); without, open report.html in any browser \
             and print it to PDF"
        );
        return Err(Error::input("--pdf", expected, "none"));
    };
    let page = page.canonicalize().map_err(|e| Error::io(page, e))?;
    let profile = tempfile::tempdir().map_err(|e| Error::io(pdf, e))?;
    let mut said = String::new();
    // a sandbox is not to be had everywhere, and the page loads nothing
    for sandbox in [&[][..], &["--no-sandbox"]] {
        let output = Command::new(browser)
            .args(["--headless", "--disable-gpu", "--no-first-run"])
            .args(["--no-pdf-header-footer", "--virtual-time-budget=20000"])
            .args(sandbox)
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg(format!("--print-to-pdf={}", pdf.display()))
            .arg(format!("file://{}", page.display()))
            .output()
            .map_err(|e| Error::io(browser, e))?;
        if pdf.is_file() {
            return Ok(());
        }
        said = String::from_utf8_lossy(&output.stderr).into_owned();
    }
    let last = said.lines().last().unwrap_or_default();
    Err(Error::Numerical(format!(
        "{browser} printed nothing: {last}"
    )))
}
