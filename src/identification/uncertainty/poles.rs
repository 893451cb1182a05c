//! Which poles are parameters: those that a search found inside its bounds.

use super::coefficients::SearchedPole;
use crate::identification::options::{Form, PoleSearch};
use crate::identification::report::FitReport;
use crate::section::Dof;

/// Poles closer than this to a bound, relatively, are held by it.
const AT_BOUND: f64 = 0.01;

/// How the assumption of a covariance says that searched poles are in it.
pub const SEARCHED_POLES: &str = "searched poles are parameters through their Jacobian columns";

/// Name of a pole and its transfer function (force, motion); none when all share it.
pub(super) type PoleName = (String, Option<(Dof, Dof)>);

/// Poles among the parameters.
pub(super) struct FreePoles {
    pub searched: Vec<SearchedPole>,
    /// Name, transfer function and value of each.
    pub values: Vec<(PoleName, f64)>,
    /// Poles that the bounds or the least ratio of the search hold.
    pub held: usize,
}

/// The poles that a search left free to follow the data.
pub(super) fn free_poles(form: &Form, options: &PoleSearch, report: &FitReport) -> FreePoles {
    let mut poles = FreePoles {
        searched: Vec::new(),
        values: Vec::new(),
        held: 0,
    };
    let mut dofs: Vec<Dof> = report.entries.iter().map(|e| e.motion).collect();
    dofs.sort();
    dofs.dedup();
    let place = |dof: Dof| dofs.iter().position(|d| *d == dof).unwrap_or(0);
    for search in &report.search {
        // the poles in use: a search may end between the points it evaluated
        let used = report
            .entries
            .iter()
            .find(|e| {
                search
                    .entry
                    .is_none_or(|entry| entry == (e.force, e.motion))
            })
            .map(|e| form.collapse(&e.poles))
            .unwrap_or_default();
        for (index, pole) in used.iter().enumerate() {
            let near = |bound: f64| (pole / bound).ln().abs() < AT_BOUND;
            let pressed =
                index > 0 && pole / used[index - 1] < (1.0 + AT_BOUND) * options.min_ratio;
            if near(search.min) || near(search.max) || pressed {
                poles.held += 1;
                continue;
            }
            poles.searched.push(SearchedPole {
                entry: search.entry.map(|(f, m)| (place(f), place(m))),
                index,
            });
            poles
                .values
                .push(((format!("pole {index}"), search.entry), *pole));
        }
    }
    poles
}

impl FreePoles {
    /// How poles enter, in words.
    pub fn sentence(&self) -> String {
        let mut text = if self.searched.is_empty() {
            "poles count as known".to_owned()
        } else {
            SEARCHED_POLES.to_owned()
        };
        if self.held > 0 {
            text.push_str(&format!(
                "; {} pole(s) held by a bound of the search count as known",
                self.held
            ));
        }
        text
    }
}
