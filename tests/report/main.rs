//! Figures and the page of a study.

#[path = "../common/browser.rs"]
#[allow(dead_code)] // each room needs a part of it
mod browser;
#[path = "../common/command.rs"]
#[allow(dead_code)]
mod command;

mod figures;
mod images;
mod live;
