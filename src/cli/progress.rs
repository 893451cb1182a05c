//! Progress on standard error, only where somebody watches.

use crate::numbered::OnDone;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::Duration;

/// Shows what is being done.
pub(super) struct Progress {
    shown: bool,
    /// Whether details were asked for.
    pub(super) verbose: bool,
}

impl Progress {
    /// Progress that is shown or not (and never when standard error is not a terminal).
    pub(crate) fn new(shown: bool, verbose: bool) -> Self {
        Self { shown, verbose }
    }

    /// A stage of unknown length; ends, and is cleared, when the returned bar is dropped.
    pub(crate) fn stage(&self, what: &str) -> ProgressBar {
        let bar = self.bar(ProgressBar::new_spinner(), "{spinner} {msg} {elapsed}");
        bar.set_message(what.to_owned());
        bar.enable_steady_tick(Duration::from_millis(100));
        bar
    }

    /// What `work` comes to, with this stage shown as long as it lasts.
    pub(crate) fn during<T>(&self, what: &str, work: impl FnOnce() -> T) -> T {
        let _stage = self.stage(what);
        work()
    }

    /// The same of work that says how many of how many steps are done.
    pub(crate) fn counting<T>(&self, what: &str, work: impl FnOnce(OnDone<'_>) -> T) -> T {
        let bar = self.bar(ProgressBar::new(1), "{msg} [{bar:30}] {pos}/{len} {eta}");
        bar.set_message(what.to_owned());
        work(&|done, total| {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        })
    }

    fn bar(&self, bar: ProgressBar, template: &str) -> ProgressBar {
        if !self.shown {
            return ProgressBar::hidden();
        }
        match ProgressStyle::with_template(template) {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        }
    }
}
