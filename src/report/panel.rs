//! One pair of axes with curves, markers, shaded regions and labelled points.

use super::axis::Axis;
use super::axis::Scale;
use super::font::text_width;
use super::labels::Labels;
use super::legend::{PlottedSeries, index_of};
use super::scene::{Area, Px, Scene};
use super::style::{BLACK, Ink};
use super::style::{GRID, SHADE, SHADE_OPACITY};
use crate::error::{Error, Result, ensure};

pub(super) const TICK_SIZE: u32 = 11;
pub(super) const LABEL_SIZE: u32 = 12;
/// Room below the axes for the ticks and the name of the abscissa, px.
pub(super) const ROOM_BELOW: f64 = 46.0;
const NOTE_SIZE: u32 = 11;
const TICK_LENGTH: f64 = 4.0;
/// Axes and rules.
const THIN: Ink = Ink::solid(BLACK, 0.9);
/// Curves are drawn with at most this many points per px of the panel's width.
const POINTS_PER_PX: usize = 4;
/// Distance of a label from its point from which on a line leads to it, px.
const LEADERLESS: f64 = 12.0;
/// An outline of its own below the text: not every renderer knows `paint-order`, and those would hide the text.
const RIM: &str = r##"stroke="#ffffff" stroke-width="3" stroke-linejoin="round""##;
const RIM_COLOUR: &str = "#ffffff";

/// Points drawn with one ink.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Series {
    /// For messages.
    pub(super) name: String,
    pub(super) points: Vec<(f64, f64)>,
    pub(super) ink: Ink,
}

/// A text that belongs to a point.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Note {
    pub(super) at: (f64, f64),
    pub(super) text: String,
    pub(super) colour: &'static str,
}

/// Content of one pair of axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Panel {
    pub(super) title: Option<String>,
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) series: Vec<Series>,
    pub(super) notes: Vec<Note>,
    /// Bands of x.
    pub(super) shaded: Vec<(f64, f64)>,
    /// Values of y with a thin black line.
    pub(super) level: Option<f64>,
    /// Values of x with a thin line and its colour.
    pub(super) uprights: Vec<(f64, &'static str)>,
}

impl Panel {
    pub(super) fn new(x: Axis, y: Axis) -> Self {
        Self {
            x,
            y,
            ..Self::default()
        }
    }

    pub(super) fn add(&mut self, name: impl Into<String>, points: Vec<(f64, f64)>, ink: Ink) {
        self.series.push(Series {
            name: name.into(),
            points,
            ink,
        });
    }

    /// Adds every series with the ink of its label, by the place of that among `labels`.
    pub(super) fn add_labelled(
        &mut self,
        all: &[PlottedSeries],
        labels: &[String],
        ink: impl Fn(usize) -> Result<Ink>,
    ) -> Result<()> {
        for series in all {
            let ink = ink(index_of(labels, &series.label))?;
            self.add(&series.label, series.points.clone(), ink);
        }
        Ok(())
    }

    /// Refuses what cannot be drawn.
    pub(super) fn check(&self, figure: &str) -> Result<()> {
        let place = |what: &str| format!("{figure}, {what}");
        if self.series.is_empty() {
            return Err(Error::input(place(&self.y.label), "data", "none"));
        }
        for series in &self.series {
            if series.points.is_empty() {
                return Err(Error::input(place(&series.name), "points", "none"));
            }
            for (i, (x, y)) in series.points.iter().enumerate() {
                let finite = x.is_finite() && y.is_finite();
                let found = format_args!("({x}, {y}) at point {}", i + 1);
                ensure(finite, place(&series.name), "finite numbers", found)?;
            }
        }
        Ok(())
    }

    fn scales(&self) -> (Scale, Scale) {
        let points = || self.series.iter().flat_map(|s| &s.points);
        let level = self.level.filter(|_| self.y.range.is_none());
        (
            self.x.scale(points().map(|p| p.0), 6),
            self.y.scale(points().map(|p| p.1).chain(level), 5),
        )
    }

    /// Width of the widest tick label of the y axis, px.
    pub(super) fn tick_width(&self) -> f64 {
        let scale = self.scales().1;
        let width = |tick: &f64| text_width(&scale.tick_label(*tick), f64::from(TICK_SIZE));
        scale.ticks().iter().map(width).fold(0.0, f64::max)
    }

    /// Draws the panel with its axes around `area`, their labels and the title included.
    pub(super) fn draw(&self, scene: &mut Scene, area: Area) {
        let (x, y) = self.scales();
        let map = Map { area, x, y };
        map.draw_axes(scene);
        let rules = self.rules(&map);
        scene.clipped(area, |scene| {
            for (low, high) in &self.shaded {
                let band = map.band(*low, *high);
                if band.left < band.right {
                    scene.filled(band, SHADE, SHADE_OPACITY);
                }
            }
            for (rule, stroke) in &rules {
                scene.polyline(rule, *stroke);
            }
            for series in &self.series {
                if series.ink.shape.is_none() {
                    let points = thinned(&series.points, (area.right - area.left) as usize);
                    scene.polyline(&map.all(&points), series.ink);
                }
            }
        });
        let mut labels = Labels::new(area);
        for series in &self.series {
            let points = map.all(&series.points);
            if series.ink.shape.is_some() {
                for at in points {
                    scene.marker(at, series.ink);
                    labels.occupy(at, series.ink.size + 1.5);
                }
            } else if !self.notes.is_empty() {
                labels.avoid(&points);
            }
        }
        rules.iter().for_each(|(rule, _)| labels.avoid(rule));
        for note in &self.notes {
            draw_note(scene, &mut labels, map.px(note.at.0, note.at.1), note);
        }
        self.write_labels(scene, area);
    }

    /// The level and the uprights.
    fn rules(&self, map: &Map) -> Vec<([Px; 2], Ink)> {
        let Area {
            left,
            top,
            right,
            bottom,
        } = map.area;
        let level = self.level.map(|level| {
            let y = map.y_px(level);
            ([Px::new(left, y), Px::new(right, y)], THIN)
        });
        let upright = |(at, colour): &(f64, &'static str)| {
            let x = map.x_px(*at);
            let dashed = Ink::stroke(colour, Some("3 3"), 0.9);
            ([Px::new(x, top), Px::new(x, bottom)], dashed)
        };
        let uprights = self.uprights.iter().map(upright);
        level.into_iter().chain(uprights).collect()
    }

    fn write_labels(&self, scene: &mut Scene, area: Area) {
        let middle = area.middle();
        if !self.x.label.is_empty() {
            let at = Px::new(middle.x, area.bottom + ROOM_BELOW - 8.0);
            scene.label(at, &self.x.label, LABEL_SIZE, "middle");
        }
        if !self.y.label.is_empty() {
            scene.upright_label(Px::new(20.0, middle.y), &self.y.label, LABEL_SIZE);
        }
        if let Some(title) = &self.title {
            let at = Px::new(middle.x, area.top - 8.0);
            scene.label(at, title, LABEL_SIZE, "middle");
        }
    }
}

/// Where numbers stand in the rectangle within the axes.
struct Map {
    area: Area,
    x: Scale,
    y: Scale,
}

impl Map {
    fn x_px(&self, value: f64) -> f64 {
        self.x_px_of_place(self.x.place(value))
    }

    fn y_px(&self, value: f64) -> f64 {
        self.y_px_of_place(self.y.place(value))
    }

    /// Of what stands on the axis: the number itself or its decimal logarithm.
    fn x_px_of_place(&self, place: f64) -> f64 {
        let part = (place - self.x.min) / (self.x.max - self.x.min);
        self.area.left + part * (self.area.right - self.area.left)
    }

    fn y_px_of_place(&self, place: f64) -> f64 {
        let part = (place - self.y.min) / (self.y.max - self.y.min);
        self.area.bottom - part * (self.area.bottom - self.area.top)
    }

    fn px(&self, x: f64, y: f64) -> Px {
        Px::new(self.x_px(x), self.y_px(y))
    }

    fn all(&self, points: &[(f64, f64)]) -> Vec<Px> {
        points.iter().map(|p| self.px(p.0, p.1)).collect()
    }

    /// The rectangle between two values of x, as far as it lies within the axes.
    fn band(&self, low: f64, high: f64) -> Area {
        Area {
            left: self.x_px(low).max(self.area.left),
            right: self.x_px(high).min(self.area.right),
            ..self.area
        }
    }

    /// Grid, box, ticks and their labels.
    fn draw_axes(&self, scene: &mut Scene) {
        let Area {
            left,
            top,
            right,
            bottom,
        } = self.area;
        let (grid, tick) = (Ink::solid(GRID, 1.0), Ink::solid(BLACK, 1.0));
        let size = f64::from(TICK_SIZE);
        for value in self.x.ticks() {
            let x = self.x_px_of_place(value);
            scene.polyline(&[Px::new(x, top), Px::new(x, bottom)], grid);
            let end = bottom + TICK_LENGTH;
            scene.polyline(&[Px::new(x, bottom), Px::new(x, end)], tick);
            let label = Px::new(x, end + 0.93 * size);
            scene.label(label, &self.x.tick_label(value), TICK_SIZE, "middle");
        }
        for value in self.y.ticks() {
            let y = self.y_px_of_place(value);
            scene.polyline(&[Px::new(left, y), Px::new(right, y)], grid);
            let end = left - TICK_LENGTH;
            scene.polyline(&[Px::new(end, y), Px::new(left, y)], tick);
            let label = Px::new(end - 3.0, y + 0.36 * size);
            scene.label(label, &self.y.tick_label(value), TICK_SIZE, "end");
        }
        scene.outline(self.area, THIN);
    }
}

/// A long history as the eye sees it: first, lowest, highest and last point of every px column.
fn thinned(points: &[(f64, f64)], width_px: usize) -> Vec<(f64, f64)> {
    let columns = width_px.max(1);
    let ordered = points.windows(2).all(|p| p[0].0 <= p[1].0);
    if !ordered || points.len() <= POINTS_PER_PX * columns {
        return points.to_vec();
    }
    let mut kept = Vec::with_capacity(POINTS_PER_PX * columns);
    for column in points.chunks(points.len().div_ceil(columns)) {
        let by_y = |a: &usize, b: &usize| column[*a].1.total_cmp(&column[*b].1);
        let indices = || 0..column.len();
        let mut keep = vec![0, column.len() - 1];
        keep.extend(indices().min_by(by_y));
        keep.extend(indices().max_by(by_y));
        keep.sort_unstable();
        keep.dedup();
        kept.extend(keep.into_iter().map(|i| column[i]));
    }
    kept
}

/// A label with a white rim, so that it stays readable on grid lines and curves; far from its point a thin line leads
/// to it.
fn draw_note(scene: &mut Scene, labels: &mut Labels, at: Px, note: &Note) {
    let area = labels.place(at, &note.text, f64::from(NOTE_SIZE));
    let end = area.nearest(at);
    let (dx, dy) = (end.x - at.x, end.y - at.y);
    let distance = dx.hypot(dy);
    if distance > LEADERLESS {
        let outside = 0.5 * LEADERLESS / distance;
        let start = at + Px::new(outside * dx, outside * dy);
        scene.polyline(&[start, end], Ink::solid(note.colour, 0.7));
    }
    let baseline = area.bottom - 0.34 * f64::from(NOTE_SIZE);
    let at = Px::new(area.left + 3.0, baseline);
    scene.group(RIM, |scene| {
        scene.text(at, &note.text, NOTE_SIZE, RIM_COLOUR);
    });
    scene.text(at, &note.text, NOTE_SIZE, note.colour);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_every_peak() {
        let mut points: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i), 0.0)).collect();
        points[12_345].1 = 7.0;
        points[54_321].1 = -3.0;
        let kept = thinned(&points, 500);
        assert!(kept.len() <= 2000);
        assert!(kept.contains(&(12_345.0, 7.0)) && kept.contains(&(54_321.0, -3.0)));
        assert_eq!(kept.first(), points.first());
        assert_eq!(kept.last(), points.last());
        let short = &points[..1000];
        assert_eq!(thinned(short, 500), short);
    }
}
