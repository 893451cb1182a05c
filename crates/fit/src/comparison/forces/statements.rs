//! What the thesis says of its comparisons in words and numbers, beside what is found here.

use super::entries::{EntryComparison, in_phase_band};
use super::score::Score;
use crate::section::Dof;
use serde::Serialize;

/// A sentence of the thesis and its counterpart.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Statement {
    /// Section of the thesis.
    pub section: &'static str,
    /// What it says of its own records.
    pub thesis: &'static str,
    /// What is found here.
    pub here: String,
}

/// Whether scores are to be had of records that the models were not trained on; `None` where neither kind has two decks.
fn kind_of_two_decks(scores: &[Score]) -> Option<bool> {
    let several = |held_out: bool| {
        let of_kind = || scores.iter().filter(|s| s.case.held_out == held_out);
        let first = of_kind().next();
        first.is_some_and(|first| of_kind().any(|s| s.case.deck != first.case.deck))
    };
    [false, true].into_iter().find(|kind| several(*kind))
}

/// Section 3.5.4 on the scores of several decks; nothing on those of one, which differ from no other.
pub(super) fn on_decks(scores: &[Score]) -> Vec<Statement> {
    let Some(held_out) = kind_of_two_decks(scores) else {
        return Vec::new();
    };
    let rotating = || {
        let all = scores.iter();
        all.filter(|s| s.case.motion == Dof::Torsion && s.case.held_out == held_out)
    };
    let kind = match held_out {
        true => ", on records that the model was not trained on",
        false => "",
    };
    let spread = |force: Dof, metric: usize| {
        let mut worst: Option<(f64, f64)> = None;
        let of_force = || rotating().filter(|s| s.case.force == force);
        for one in of_force() {
            let near = |s: &&Score| (s.frequency_hz / one.frequency_hz - 1.0).abs() < 0.08;
            let values = || of_force().filter(near).map(|s| s.metrics.values()[metric]);
            let (low, high) = (values().fold(1.0, f64::min), values().fold(0.0, f64::max));
            if worst.is_none_or(|(w, _)| high - low > w) {
                worst = Some((high - low, one.frequency_hz));
            }
        }
        worst.unwrap_or((0.0, 0.0))
    };
    let parts = [(0, "M_phi"), (1, "M_p"), (4, "M_mw")].map(|(m, name)| {
        let ((lift, at_lift), (moment, at_moment)) =
            (spread(Dof::Vertical, m), spread(Dof::Torsion, m));
        format!(
            "{name} differs by up to {lift:.2} in lift (near {at_lift:.2} Hz) and {moment:.2} in moment (near \
             {at_moment:.2} Hz)"
        )
    });
    let lowest = rotating().min_by(|a, b| a.metrics.peak.total_cmp(&b.metrics.peak));
    vec![
        Statement {
            section: "3.5.4",
            thesis: "very similar metrics on the four girders under rotation, with small discrepancies, most of them in the \
                     lift (LN21-6100 at the first and last frequency)",
            here: parts.join("; ") + kind,
        },
        Statement {
            section: "3.5.4",
            thesis: "M_p plunges at 0.5 Hz on LN21-6100 and LN21-5800, an error of the measurement",
            here: lowest.map_or_else(String::new, |s| {
                format!(
                    "no spike in these records: lowest M_p {:.3} ({}, {} force, {:.2} Hz){kind}",
                    s.metrics.peak,
                    s.case.deck,
                    s.case.force.name(),
                    s.frequency_hz
                )
            }),
        },
    ]
}

/// Sections 3.5.2, 3.5.5 and 3.5.6 on the comparison of models; the first model is the thesis's Laguerre model.
pub(super) fn on_models(entries: &[EntryComparison], scores: &[Score]) -> Vec<Statement> {
    let entry = |force, motion| {
        let mut all = entries.iter();
        all.find(move |e| (e.force, e.motion) == (force, motion))
    };
    let (y, t) = (Dof::Vertical, Dof::Torsion);
    let mut statements = Vec::new();
    if let Some(e) = entry(y, y) {
        statements.push(Statement {
            section: "3.5.5",
            thesis: "heave: magnitude of the lift slightly overestimated at high frequency, its phase never more than 5° off",
            here: e.describe(0),
        });
    }
    if let Some(e) = entry(t, y) {
        let beyond = e.points.iter().zip(&e.models[0].points);
        let beyond = beyond.filter(|(_, m)| !in_phase_band(m.1));
        let beyond = beyond.map(|(p, _)| format!("{:.2}", p.frequency_hz));
        let beyond: Vec<String> = beyond.collect();
        let list = match beyond.is_empty() {
            true => "none".into(),
            false => format!("{} Hz", beyond.join(", ")),
        };
        statements.push(Statement {
            section: "3.5.5",
            thesis: "heave: phase of the moment badly reconstructed above 1.4 Hz",
            here: format!("{}; beyond ±5° at {list}", e.describe(0)),
        });
    }
    if let (Some(lift), Some(moment)) = (entry(y, t), entry(t, t)) {
        statements.push(Statement {
            section: "3.5.5",
            thesis: "rotation: magnitudes within ±15 % and phases within ±5° at all tested frequencies",
            here: format!("lift: {}; moment: {}", lift.describe(0), moment.describe(0)),
        });
    }
    statements.extend(on_histories(entries, scores));
    statements.push(better(scores));
    statements
}

/// Figures of time histories: motion, frequency in Hz, what the thesis says of them.
const HISTORIES: [(&str, Dof, f64, &str); 4] = [
    (
        "3.5.2, Figure 3.14",
        Dof::Vertical,
        2.0,
        "heave at 2.0 Hz: the moment is 0.015 s late, 10°, so that its M_phi is low and M_mw high; M_phi of the lift is almost 1",
    ),
    (
        "3.5.2, Figure 3.15",
        Dof::Torsion,
        2.0,
        "rotation at 2.0 Hz: good M_phi (caption); that of the moment is quite low (text)",
    ),
    (
        "3.5.2, Figure 3.16",
        Dof::Torsion,
        0.5,
        "rotation at 0.5 Hz: almost perfectly reconstructed, metrics of the moment almost 1 but for M_p, which a spike in the \
         measured force lowers",
    ),
    (
        "3.5.2, Figure 3.17",
        Dof::Vertical,
        0.5,
        "heave at 0.5 Hz: the force is underestimated amid noise of low frequency, which lowers M_mw, most in the lift",
    ),
];

/// Section 3.5.2: the thesis's Laguerre model, which comes first, over a few periods.
fn on_histories<'a>(
    entries: &'a [EntryComparison],
    scores: &'a [Score],
) -> impl Iterator<Item = Statement> + 'a {
    HISTORIES.iter().map(move |&(section, motion, hz, thesis)| {
        let near = move |f: f64| (f / hz - 1.0).abs() < 0.05;
        let of = |(force, name): (Dof, &str)| {
            let same = |s: &&Score| (s.case.motion, s.case.force) == (motion, force);
            let m = scores.iter().find(|s| same(s) && near(s.frequency_hz))?.metrics;
            let entry = entries.iter().find(|e| (e.force, e.motion) == (force, motion))?;
            let at = entry.points.iter().position(|p| near(p.frequency_hz))?;
            Some(format!(
                "{name} {:+.1} % in magnitude, {:+.4} s late ({:+.1}°), M_phi {:.3}, M_p {:.3}, M_mw {:.3}",
                entry.models[0].points[at].0,
                m.lag_deg / 360.0 / hz,
                m.lag_deg,
                m.phase,
                m.peak,
                m.magnitude_warped
            ))
        };
        let both = [(Dof::Vertical, "lift"), (Dof::Torsion, "moment")];
        let here: Vec<String> = both.into_iter().filter_map(of).collect();
        Statement {
            section,
            thesis,
            here: here.join("; "),
        }
    })
}

/// How often each model is ahead in each of the thesis's three metrics.
fn better(scores: &[Score]) -> Statement {
    let mut models: Vec<&str> = scores.iter().map(|s| s.case.model.as_str()).collect();
    models.dedup();
    models.sort_unstable();
    models.dedup();
    let means = models.iter().map(|model| {
        let own: Vec<&Score> = scores.iter().filter(|s| s.case.model == *model).collect();
        let sum = |m: usize| own.iter().map(|s| s.metrics.values()[m]).sum::<f64>();
        let [phase, peak, warped] = [0, 1, 4].map(|m| sum(m) / own.len().max(1) as f64);
        format!("{model}: M_phi {phase:.3}, M_p {peak:.3}, M_mw {warped:.3}")
    });
    let means: Vec<String> = means.collect();
    Statement {
        section: "3.5.6",
        thesis: "both models have really similar capability in the time domain, with three coefficients a transfer function",
        here: format!(
            "means over motions, forces and frequencies: {}",
            means.join("; ")
        ),
    }
}
