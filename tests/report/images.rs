//! Images beside figures.

use crate::command::{listing, refused, succeeds};
use std::fs;
use tempfile::TempDir;

/// Images are asked for; a program without the renderer says so before it computes anything.
#[test]
fn images_are_written_on_request() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("a.csv"), "time_s,heave_m\n0,1\n1,2\n").unwrap();
    let arguments = ["plot", "a.csv", "--png"];
    if cfg!(feature = "png") {
        succeeds(at, &arguments);
        assert!(at.join("a.svg").is_file() && at.join("a.png").is_file());
    } else {
        refused(at, &arguments, &["--png", "--features png", "SVG"]);
        assert_eq!(listing(at), ["a.csv"]);
    }
}
