//! Where the labels of points go, so that they cover neither each other nor the curves.

use super::font::text_width;
use super::scene::{Area, Px};

/// Places for one label after the other.
#[derive(Debug)]
pub(super) struct Labels {
    frame: Area,
    /// Points to keep free: curves, sampled every few px.
    drawn: Vec<Px>,
    /// Markers and the labels so far.
    taken: Vec<Area>,
}

impl Labels {
    pub(super) fn new(frame: Area) -> Self {
        Self {
            frame,
            drawn: Vec::new(),
            taken: Vec::new(),
        }
    }

    /// Keeps a marker free of labels.
    pub(super) fn occupy(&mut self, at: Px, radius: f64) {
        self.taken.push(Area {
            left: at.x - radius,
            top: at.y - radius,
            right: at.x + radius,
            bottom: at.y + radius,
        });
    }

    /// Keeps a polyline (px) free of labels.
    pub(super) fn avoid(&mut self, points: &[Px]) {
        // far outside the frame nothing can be covered
        let reach = (self.frame.right - self.frame.left) + (self.frame.bottom - self.frame.top);
        self.drawn.extend(points.first());
        for pair in points.windows(2) {
            self.drawn.extend(sampled(pair[0], pair[1], reach));
        }
    }

    /// The best area for `text` of `size` px near the point, now taken.
    pub(super) fn place(&mut self, at: Px, text: &str, size: f64) -> Area {
        let (width, height) = (text_width(text, size) + 6.0, 1.35 * size);
        let mut best: Option<(f64, Area)> = None;
        for (ring, gap) in [7.0, 16.0, 28.0, 44.0, 64.0].into_iter().enumerate() {
            for (i, (dx, dy)) in DIRECTIONS.into_iter().enumerate() {
                let left = at.x + dx * gap + 0.5 * (dx.signum() * dx.abs().ceil() - 1.0) * width;
                let top = at.y + dy * gap + 0.5 * (dy.signum() * dy.abs().ceil() - 1.0) * height;
                let area = Area {
                    left,
                    top,
                    right: left + width,
                    bottom: top + height,
                };
                let cost =
                    self.cost(&area) + self.leader_cost(at, &area) + ring as f64 + 0.01 * i as f64;
                if best.is_none_or(|(lowest, _)| cost < lowest) {
                    best = Some((cost, area));
                }
            }
        }
        let area = best.map_or(self.frame, |(_, area)| area);
        self.avoid(&[at, area.nearest(at)]);
        self.taken.push(area);
        area
    }

    /// A line from the point to the area must not cross labels and markers other than its own, which holds the point.
    fn leader_cost(&self, at: Px, area: &Area) -> f64 {
        let crossed = |p: Px| {
            let foreign = |t: &&Area| t.contains(p) && !t.contains(at);
            self.taken.iter().filter(foreign).count()
        };
        sampled(at, area.nearest(at), f64::MAX)
            .map(|p| 0.5 * crossed(p) as f64)
            .sum()
    }

    fn cost(&self, area: &Area) -> f64 {
        let outside = 1.0 - area.overlap(&self.frame) / area.size();
        let covered: f64 = self.taken.iter().map(|t| area.overlap(t)).sum();
        let hidden = self.drawn.iter().filter(|p| area.contains(**p)).count();
        100.0 * outside + 50.0 * covered / area.size() + 0.5 * hidden as f64
    }
}

/// Points every 3 px from one end to the other, the first left out; at most as many as `reach` px hold.
fn sampled(from: Px, to: Px, reach: f64) -> impl Iterator<Item = Px> {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let steps = (dx.hypot(dy).min(reach) / 3.0).ceil().max(1.0);
    (1..=steps as usize).map(move |i| {
        let t = i as f64 / steps;
        from + Px::new(t * dx, t * dy)
    })
}

/// Right above first, then the other sides; a zero centres the label.
const DIRECTIONS: [(f64, f64); 8] = [
    (0.8, -0.8),
    (-0.8, -0.8),
    (0.8, 0.8),
    (-0.8, 0.8),
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, -1.0),
    (0.0, 1.0),
];

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Area = Area {
        left: 0.0,
        top: 0.0,
        right: 400.0,
        bottom: 200.0,
    };

    #[test]
    fn labels_of_one_point_do_not_overlap_and_stay_inside() {
        let mut labels = Labels::new(FRAME);
        labels.avoid(&[Px::new(0.0, 100.0), Px::new(400.0, 100.0)]);
        let areas: Vec<Area> = (0..4)
            .map(|_| labels.place(Px::new(395.0, 100.0), "76.92 m/s", 11.0))
            .collect();
        for (i, a) in areas.iter().enumerate() {
            assert!((a.overlap(&FRAME) - a.size()).abs() < 1e-9);
            assert!(a.bottom <= 100.0 || a.top >= 100.0, "the line is covered");
            for b in &areas[..i] {
                assert_eq!(a.overlap(b), 0.0);
            }
        }
    }
}
