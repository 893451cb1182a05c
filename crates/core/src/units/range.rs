//! The reduced frequencies in which something was tested, and the gaps between them.

use super::ReducedFrequency;
use crate::error::{Error, Result};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error as _};

/// Ratio of the `K` of tests that are meant to be one.
const ONE_TEST: f64 = 1.05;
/// Neighbouring tested `K` further apart than this ratio leave a gap. Smooth forces read across a gap of this ratio about
/// the onset move it by a per cent at most: `tests/flutter/gaps.rs` measures it.
const WIDEST_STEP: f64 = 2.0;
/// Gaps that are kept apart; of more, neighbours are joined, with the tests between them.
const MOST_GAPS: usize = 8;

/// Two neighbouring tested `K` with nothing between them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ReducedFrequencyGap {
    /// The lower one.
    pub from: ReducedFrequency,
    /// The upper one.
    pub to: ReducedFrequency,
}

impl ReducedFrequencyGap {
    /// The part of the gap in which nothing is known, `K` to `K`, or `None` if it is narrow enough. Interpolation over `ln K` errs in
    /// proportion to the product of the distances to both tests, and may do so as in the middle of the widest step.
    pub fn unknown(self) -> Option<(f64, f64)> {
        let (from, to) = (self.from.full_width(), self.to.full_width());
        let (width, widest) = ((to / from).ln(), WIDEST_STEP.ln());
        let near = 0.5 * (width - (width * width - widest * widest).max(0.0).sqrt());
        (width > widest).then(|| (from * near.exp(), to * (-near).exp()))
    }

    /// `in a gap between K a and b`.
    pub fn explain(self) -> String {
        let (from, to) = (self.from.full_width(), self.to.full_width());
        format!("in a gap between the tested K {from:.3} and {to:.3}")
    }
}

/// A `K` at which a motion whose `K` falls leaves what was tested, and the gap into which it comes there; `None` at the lowest
/// tested `K`.
pub type LowerEnd = (ReducedFrequency, Option<ReducedFrequencyGap>);

/// A closed range of reduced frequencies, e.g. the one in which a model was tested, with the gaps in it.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
///
/// let k = ReducedFrequency::from_full_width;
/// let tested = ReducedFrequencyRange::spanning([0.2, 0.3, 0.45, 1.5].map(k)).expect("tests");
/// assert!(tested.contains(k(0.4)));
/// assert!(!tested.contains(k(0.9))); // no test is near
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ReducedFrequencyRange {
    /// Lowest `K`.
    pub min: ReducedFrequency,
    /// Highest `K`.
    pub max: ReducedFrequency,
    /// Where no test is near, by rising `K`.
    #[serde(
        default,
        skip_serializing_if = "no_gaps",
        serialize_with = "write_gaps",
        deserialize_with = "read_gaps"
    )]
    gaps: Gaps,
}

impl ReducedFrequencyRange {
    /// From one `K` to another, without gaps.
    pub const fn between(min: ReducedFrequency, max: ReducedFrequency) -> Self {
        Self {
            min,
            max,
            gaps: [None; MOST_GAPS],
        }
    }

    /// The smallest range that holds all tested `values`, with the gaps between them; `None` when there are none.
    pub fn spanning(values: impl IntoIterator<Item = ReducedFrequency>) -> Option<Self> {
        Self::covering(values.into_iter().map(|k| Self::between(k, k)))
    }

    /// The smallest range that holds all of `parts`, in each of which everything was tested, with the gaps between them;
    /// `None` when there are none.
    pub fn covering(parts: impl IntoIterator<Item = Self>) -> Option<Self> {
        let mut parts: Vec<Self> = parts.into_iter().collect();
        parts.sort_by(|a, b| a.min.full_width().total_cmp(&b.min.full_width()));
        let mut reached = parts.first()?.max;
        let mut gaps = Vec::new();
        for part in &parts {
            let gap = ReducedFrequencyGap {
                from: reached,
                to: part.min,
            };
            gaps.extend(gap.unknown().map(|_| gap));
            reached.0 = reached.0.max(part.max.0);
        }
        Some(Self {
            min: parts[0].min,
            max: reached,
            gaps: kept(gaps),
        })
    }

    /// What was tested in both; a gap of one is a gap of both.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self {
            min: ReducedFrequency(self.min.0.max(other.min.0)),
            max: ReducedFrequency(self.max.0.min(other.max.0)),
            gaps: kept(self.gaps().chain(other.gaps()).collect()),
        }
    }

    /// The same in reduced frequencies that are `factor` times as high.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let scaled = |k: ReducedFrequency| ReducedFrequency(k.0 * factor);
        let gaps = self.gaps().map(|gap| ReducedFrequencyGap {
            from: scaled(gap.from),
            to: scaled(gap.to),
        });
        Self {
            min: scaled(self.min),
            max: scaled(self.max),
            gaps: kept(gaps.collect()),
        }
    }

    /// The `K` that all of `parts` hold, where there are parts. Those of tests of one frequency differ a little: up to 5 % they hold
    /// what lies between.
    ///
    /// # Errors
    /// [`Error::Input`] for parts that have none in common.
    pub fn common(parts: impl IntoIterator<Item = Self>) -> Option<Result<Self>> {
        let common = parts.into_iter().reduce(Self::intersection)?;
        let (from, to) = (common.max, common.min);
        let is_one_test = from < to && to.full_width() <= ONE_TEST * from.full_width();
        Some(match is_one_test {
            true => Ok(Self::between(from, to)),
            false => common.not_empty(),
        })
    }

    /// Itself, unless it holds no `K`, as the intersection of tests that have none in common.
    ///
    /// # Errors
    /// [`Error::Input`] with the ends of those tests.
    pub fn not_empty(self) -> Result<Self> {
        if self.min <= self.max {
            return Ok(self);
        }
        let (low, high) = (self.min.full_width(), self.max.full_width());
        let found = format!("none: some were tested from K {low:.4} on, others up to K {high:.4}");
        let expected = "a reduced frequency at which all forces were tested";
        Err(Error::input("tests", expected, found))
    }

    /// Whether `k` was tested: it lies inside, ends included, and tests are near enough.
    pub fn contains(&self, k: ReducedFrequency) -> bool {
        self.spans(k) && self.gap_at(k).is_none()
    }

    /// Whether `k` lies between the lowest and the highest tested, in a gap or not.
    pub fn spans(&self, k: ReducedFrequency) -> bool {
        self.min <= k && k <= self.max
    }

    /// The gap in which `k` is too far from the nearest tests.
    pub fn gap_at(&self, k: ReducedFrequency) -> Option<ReducedFrequencyGap> {
        let inside = |(from, to): (f64, f64)| (from < k.full_width()) && (k.full_width() < to);
        self.gaps().find(|gap| gap.unknown().is_some_and(inside))
    }

    /// The gaps, by rising `K`.
    pub fn gaps(&self) -> impl Iterator<Item = ReducedFrequencyGap> {
        self.gaps.into_iter().flatten()
    }

    /// Where a motion whose `K` falls leaves what was tested.
    pub fn lower_ends(&self) -> impl Iterator<Item = LowerEnd> {
        let of_gap = |gap: ReducedFrequencyGap| {
            let (_, to) = gap.unknown()?;
            Some((ReducedFrequency::from_full_width(to), Some(gap)))
        };
        let of_gaps = self.gaps().filter_map(of_gap);
        of_gaps.chain([(self.min, None)])
    }
}

/// A few gaps in place, so that a range is a value that can be copied.
type Gaps = [Option<ReducedFrequencyGap>; MOST_GAPS];

fn no_gaps(gaps: &Gaps) -> bool {
    gaps[0].is_none()
}

/// All of them, those left out that say nothing besides the others.
fn kept(mut gaps: Vec<ReducedFrequencyGap>) -> Gaps {
    gaps.sort_by(|a, b| a.from.0.total_cmp(&b.from.0));
    let within = |a: &ReducedFrequencyGap, b: &ReducedFrequencyGap| match (a.unknown(), b.unknown())
    {
        (Some(a), Some(b)) => b.0 <= a.0 && a.1 <= b.1,
        (None, _) => true,
        (Some(_), None) => false,
    };
    let mut kept: Vec<ReducedFrequencyGap> = Vec::new();
    for gap in gaps {
        if !kept.iter().any(|other| within(&gap, other)) {
            kept.retain(|other| !within(other, &gap));
            kept.push(gap);
        }
    }
    while kept.len() > MOST_GAPS {
        join_nearest(&mut kept);
    }
    std::array::from_fn(|i| kept.get(i).copied())
}

/// Joins the two neighbours that make the narrowest gap together.
fn join_nearest(gaps: &mut Vec<ReducedFrequencyGap>) {
    let joined = |i: usize| ReducedFrequencyGap {
        from: gaps[i].from,
        to: ReducedFrequency(gaps[i].to.0.max(gaps[i + 1].to.0)),
    };
    let ratio = |i: usize| joined(i).to.full_width() / joined(i).from.full_width();
    let nearest = (0..gaps.len() - 1).min_by(|a, b| ratio(*a).total_cmp(&ratio(*b)));
    if let Some(i) = nearest {
        let gap = joined(i);
        gaps.splice(i..i + 2, [gap]);
    }
}

fn write_gaps<S: Serializer>(gaps: &Gaps, s: S) -> std::result::Result<S::Ok, S::Error> {
    s.collect_seq(gaps.iter().flatten())
}

fn read_gaps<'de, D: Deserializer<'de>>(d: D) -> std::result::Result<Gaps, D::Error> {
    let gaps = Vec::<ReducedFrequencyGap>::deserialize(d)?;
    for gap in &gaps {
        let (from, to) = (gap.from.0, gap.to.0);
        if !(from > 0.0 && from < to && to.is_finite()) {
            let why = format!("gaps: expected 0 < from < to, found {from} to {to}");
            return Err(D::Error::custom(why));
        }
    }
    Ok(kept(gaps))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn k(value: f64) -> ReducedFrequency {
        ReducedFrequency::from_full_width(value)
    }

    fn spanning(values: &[f64]) -> ReducedFrequencyRange {
        ReducedFrequencyRange::spanning(values.iter().map(|x| k(*x))).unwrap()
    }

    #[test]
    fn close_tests_leave_no_gap_and_distant_ones_do() {
        let close = spanning(&[0.9, 0.1, 0.19, 0.35, 0.6]);
        assert_eq!(close.gaps().count(), 0);
        assert_eq!(close, ReducedFrequencyRange::between(k(0.1), k(0.9)));
        let wide = spanning(&[1.2, 0.15, 0.23, 0.69]);
        assert!(wide.spans(k(0.36)) && !wide.contains(k(0.36)));
        let gap = wide.gap_at(k(0.36)).unwrap();
        assert_eq!((gap.from, gap.to), (k(0.23), k(0.69)));
        assert_eq!(
            gap.explain(),
            "in a gap between the tested K 0.230 and 0.690"
        );
        // beside a test something is known, the more the narrower the gap; outside nothing
        for inside in [0.15, 0.23, 0.235, 0.67, 0.69, 1.2] {
            assert!(wide.contains(k(inside)), "{inside}");
        }
        for outside in [0.149, 0.28, 0.57, 1.21] {
            assert!(!wide.contains(k(outside)), "{outside}");
        }
        let ends: Vec<_> = wide.lower_ends().collect();
        assert_eq!(ends.len(), 2);
        assert!(!wide.contains(k(0.999 * ends[0].0.full_width())));
        assert!(wide.contains(ends[0].0) && ends[1] == (k(0.15), None));
    }

    /// A band is tested everywhere; a gap of one derivative is a gap of all.
    #[test]
    fn bands_have_no_gaps_and_gaps_are_shared() {
        let band = ReducedFrequencyRange::between(k(0.1), k(0.8));
        let tones = [k(0.05), k(2.0)].map(|k| ReducedFrequencyRange::between(k, k));
        let all = ReducedFrequencyRange::covering(tones.into_iter().chain([band])).unwrap();
        assert_eq!((all.min, all.max), (k(0.05), k(2.0)));
        let gaps: Vec<_> = all.gaps().map(|g| (g.from, g.to)).collect();
        assert_eq!(gaps, [(k(0.8), k(2.0))]);
        let other = spanning(&[0.06, 0.2, 0.3, 0.5, 0.8, 1.4]);
        let common = all.intersection(other);
        assert_eq!((common.min, common.max), (k(0.06), k(1.4)));
        assert!(!common.contains(k(0.11)) && !common.contains(k(1.2)) && common.contains(k(0.4)));
        let apart = band.intersection(ReducedFrequencyRange::between(k(0.9), k(2.0)));
        assert!(common.not_empty().is_ok() && apart.not_empty().is_err());
        let tests = |values: &[f64]| -> Vec<_> {
            let ks = values.iter().map(|x| k(*x));
            ks.map(|k| ReducedFrequencyRange::between(k, k)).collect()
        };
        let of = |values: &[f64]| ReducedFrequencyRange::common(tests(values)).unwrap();
        assert_eq!(
            of(&[0.4, 0.41]).unwrap(),
            ReducedFrequencyRange::between(k(0.4), k(0.41))
        );
        assert!(of(&[0.4, 0.43]).is_err() && ReducedFrequencyRange::common(tests(&[])).is_none());
        let twice = common.scaled(2.0);
        assert!(!twice.contains(k(0.22)) && twice.contains(k(0.8)));
    }

    /// With more gaps than can be kept, what was a gap stays one.
    #[test]
    fn too_many_gaps_are_joined() {
        let tests: Vec<f64> = (0..14).map(|i| 0.001 * 2.5f64.powi(i)).collect();
        let range = spanning(&tests);
        assert_eq!(range.gaps().count(), MOST_GAPS);
        for pair in tests.windows(2) {
            assert!(!range.contains(k((pair[0] * pair[1]).sqrt())), "{pair:?}");
        }
    }

    #[test]
    fn files_without_gaps_are_read_and_those_with_gaps_are_kept() {
        let old = r#"{"min":0.1,"max":0.9}"#;
        let read: ReducedFrequencyRange = serde_json::from_str(old).unwrap();
        assert_eq!(serde_json::to_string(&read).unwrap(), old);
        let wide = spanning(&[0.15, 0.23, 0.69, 1.2]);
        let text = serde_json::to_string(&wide).unwrap();
        assert!(
            text.contains(r#""gaps":[{"from":0.23,"to":0.69}]"#),
            "{text}"
        );
        let back: ReducedFrequencyRange = serde_json::from_str(&text).unwrap();
        assert_eq!(back, wide);
        let bad = r#"{"min":0.1,"max":0.9,"gaps":[{"from":0.5,"to":0.2}]}"#;
        assert!(serde_json::from_str::<ReducedFrequencyRange>(bad).is_err());
    }
}
