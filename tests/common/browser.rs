//! A page in a headless Chromium, where there is one.

use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// The document that the scripts of a page leave in a window of `width,height`; `None` without a browser.
pub fn document(page: &Path, size: &str) -> Option<String> {
    let Some(browser) = ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok())
    else {
        eprintln!("no Chromium here: the scripts of the page are not run");
        return None;
    };
    let profile = TempDir::new().unwrap();
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
        ])
        .args(["--disable-background-networking"])
        .args(["--virtual-time-budget=20000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("--window-size={size}"))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The page loads nothing, and its scripts draw both charts at the widths of a desk and of a phone.
pub fn stands_alone(page: &Path) {
    let text = std::fs::read_to_string(page).unwrap();
    for outside in ["src=\"", "@import"] {
        assert!(!text.contains(outside), "{outside} in the report");
    }
    let (links, inside) = (text.matches("href=\""), text.matches("href=\"#"));
    assert_eq!(links.count(), inside.count(), "a link to elsewhere");
    let own = text.matches("url(#").count();
    assert_eq!(text.matches("url(").count(), own, "something is loaded");
    for size in ["1280,1000", "390,800"] {
        if let Some(dom) = document(page, size) {
            let dom = without_sliders(&dom);
            assert_eq!(dom.matches("<canvas").count(), 2, "charts at {size}");
        }
    }
}

/// The page without what a program adds that carries the module for the sliders.
pub fn without_sliders(page: &str) -> String {
    let mut parts = page.split("\n<!-- sliders -->");
    let first = parts.next().unwrap().to_owned();
    parts.fold(first, |whole, part| {
        whole + part.split_once("<!-- /sliders -->").unwrap().1
    })
}
