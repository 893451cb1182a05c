//! One pair of axes with curves, markers, shaded regions and labelled points.

use super::axis::{Axis, Scale};
use super::font::text_width;
use super::labels::{Area, Labels};
use super::style::{BLACK, GRID, Ink, SHADE, SHADE_OPACITY, draw_marker};
use super::text::text;
use crate::error::{Error, Result};
use kuva::TickFormat;
use kuva::plot::annotations::{ReferenceLine, ShadedRegion};
use kuva::plot::line::{LinePlot, LineStyle};
use kuva::render::color::Color;
use kuva::render::layout::{ComputedLayout, Layout};
use kuva::render::plots::Plot;
use kuva::render::render::{Primitive, Scene, TextAnchor, render_multiple};
use kuva::render::theme::Theme;

pub(super) const TICK_SIZE: u32 = 11;
pub(super) const LABEL_SIZE: u32 = 12;
const NOTE_SIZE: u32 = 11;
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
#[derive(Debug, Clone, PartialEq)]
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

/// Where the axes of a panel are inside its cell, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) margins: Margins,
}

/// Space around the axes, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Margins {
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
}

impl Panel {
    pub(super) fn new(x: Axis, y: Axis) -> Self {
        Self {
            title: None,
            x,
            y,
            series: Vec::new(),
            notes: Vec::new(),
            shaded: Vec::new(),
            level: None,
            uprights: Vec::new(),
        }
    }

    pub(super) fn add(&mut self, name: impl Into<String>, points: Vec<(f64, f64)>, ink: Ink) {
        self.series.push(Series {
            name: name.into(),
            points,
            ink,
        });
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
                if !(x.is_finite() && y.is_finite()) {
                    return Err(Error::input(
                        place(&series.name),
                        "finite numbers",
                        format!("({x}, {y}) at point {}", i + 1),
                    ));
                }
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
        let label = scale.tick_label();
        scale
            .ticks()
            .into_iter()
            .map(|t| text_width(&label(t), f64::from(TICK_SIZE)))
            .fold(0.0, f64::max)
    }

    /// Draws the panel into a scene of its own, axes labels and title included.
    pub(super) fn draw(&self, frame: Frame) -> Scene {
        let (x, y) = self.scales();
        let layout = layout(frame, x, y);
        let map = ComputedLayout::from_layout(&layout);
        let layout = self.with_regions(layout, x);
        let inner = frame.width - frame.margins.left - frame.margins.right;
        // without any plot the library would leave out the axes
        let axes_only = Plot::Line(LinePlot::new());
        let curves = self.series.iter().filter_map(|s| curve(s, (x, y), inner));
        let plots = std::iter::once(axes_only).chain(curves).collect();
        let mut scene = render_multiple(plots, layout);
        let mut labels = Labels::new(Area {
            left: frame.margins.left,
            top: frame.margins.top,
            right: frame.width - frame.margins.right,
            bottom: frame.height - frame.margins.bottom,
        });
        let px = |p: &(f64, f64)| (map.map_x(x.place(p.0)), map.map_y(y.place(p.1)));
        for series in &self.series {
            let points: Vec<(f64, f64)> = series.points.iter().map(px).collect();
            if let Ink::Dots {
                colour,
                shape,
                radius,
                hollow,
            } = series.ink
            {
                for at in points {
                    draw_marker(&mut scene, at, (colour, shape, radius, hollow));
                    labels.occupy(at, radius + 1.5);
                }
            } else if !self.notes.is_empty() {
                labels.avoid(&points);
            }
        }
        self.keep_rules_free(&mut labels, &map, (x, y));
        for note in &self.notes {
            draw_note(&mut scene, &mut labels, px(&note.at), note);
        }
        self.write_labels(&mut scene, frame);
        scene
    }

    /// Keeps labels off the level and the uprights.
    fn keep_rules_free(&self, labels: &mut Labels, map: &ComputedLayout, (x, y): (Scale, Scale)) {
        if let Some(level) = self.level {
            let at = map.map_y(level);
            labels.avoid(&[(map.map_x(x.min), at), (map.map_x(x.max), at)]);
        }
        for (upright, _) in &self.uprights {
            let at = map.map_x(*upright);
            labels.avoid(&[(at, map.map_y(y.min)), (at, map.map_y(y.max))]);
        }
    }

    /// Shaded regions, the level and the uprights.
    fn with_regions(&self, mut layout: Layout, x: Scale) -> Layout {
        for (low, high) in &self.shaded {
            let (low, high) = (low.max(x.min), high.min(x.max));
            if low < high {
                layout = layout.with_shaded_region(
                    ShadedRegion::vertical(low, high)
                        .with_color(SHADE)
                        .with_opacity(SHADE_OPACITY),
                );
            }
        }
        if let Some(level) = self.level {
            layout = layout.with_reference_line(
                ReferenceLine::horizontal(level)
                    .with_color(BLACK)
                    .with_stroke_width(0.9)
                    .with_dasharray("none"),
            );
        }
        for (at, colour) in &self.uprights {
            layout = layout.with_reference_line(
                ReferenceLine::vertical(*at)
                    .with_color(*colour)
                    .with_stroke_width(0.9)
                    .with_dasharray("3 3"),
            );
        }
        layout
    }

    fn write_labels(&self, scene: &mut Scene, frame: Frame) {
        let m = frame.margins;
        let middle_x = 0.5 * (m.left + frame.width - m.right);
        let middle_y = 0.5 * (m.top + frame.height - m.bottom);
        let mut put = |at, label: &str, rotate: Option<f64>| {
            let mut label = text(at, label, LABEL_SIZE, BLACK);
            if let Primitive::Text {
                anchor, rotate: r, ..
            } = &mut label
            {
                (*anchor, *r) = (TextAnchor::Middle, rotate);
            }
            scene.add(label);
        };
        if !self.x.label.is_empty() {
            put((middle_x, frame.height - 8.0), &self.x.label, None);
        }
        if !self.y.label.is_empty() {
            put((20.0, middle_y), &self.y.label, Some(-90.0));
        }
        if let Some(title) = &self.title {
            put((middle_x, m.top - 8.0), title, None);
        }
    }
}

/// Axes, grid and ticks.
fn layout(frame: Frame, x: Scale, y: Scale) -> Layout {
    let theme = Theme {
        grid_color: GRID.into(),
        axis_color: BLACK.into(),
        tick_color: BLACK.into(),
        text_color: BLACK.into(),
        ..Theme::light()
    };
    let m = frame.margins;
    let mut layout = Layout::new((x.min, x.max), (y.min, y.max))
        .with_width(frame.width)
        .with_height(frame.height)
        .with_theme(theme)
        .with_box_axes()
        .with_tick_size(TICK_SIZE)
        .with_axis_line_width(0.9)
        .with_tick_length(4.0)
        .with_x_axis_min(x.min)
        .with_x_axis_max(x.max)
        .with_y_axis_min(y.min)
        .with_y_axis_max(y.max)
        .with_x_tick_step(x.step)
        .with_y_tick_step(y.step)
        .with_x_tick_format(TickFormat::Custom(x.tick_label()))
        .with_y_tick_format(TickFormat::Custom(y.tick_label()))
        .with_force_margins(m.left, m.right)
        .with_force_margins_y(m.top, m.bottom);
    layout.show_legend = false;
    layout
}

/// The line of a series; `None` for markers, which are drawn on top later.
fn curve(series: &Series, (x, y): (Scale, Scale), width_px: f64) -> Option<Plot> {
    let Ink::Line {
        colour,
        dash,
        width,
    } = series.ink
    else {
        return None;
    };
    let points = thinned(&series.points, width_px as usize);
    let mut line = LinePlot::new()
        .with_data(points.into_iter().map(|p| (x.place(p.0), y.place(p.1))))
        .with_color(colour)
        .with_stroke_width(width);
    if let Some(dash) = dash {
        line = line.with_line_style(LineStyle::Custom(dash.to_owned()));
    }
    Some(Plot::Line(line))
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
fn draw_note(scene: &mut Scene, labels: &mut Labels, at: (f64, f64), note: &Note) {
    let area = labels.place(at, &note.text, f64::from(NOTE_SIZE));
    let end = area.nearest(at);
    let distance = (end.0 - at.0).hypot(end.1 - at.1);
    if distance > LEADERLESS {
        let outside = 0.5 * LEADERLESS / distance;
        scene.add(Primitive::Line {
            x1: at.0 + outside * (end.0 - at.0),
            y1: at.1 + outside * (end.1 - at.1),
            x2: end.0,
            y2: end.1,
            stroke: Color::from(note.colour),
            stroke_width: 0.7,
            stroke_dasharray: None,
        });
    }
    let baseline = area.bottom - 0.34 * f64::from(NOTE_SIZE);
    scene.add(Primitive::GroupStart {
        transform: None,
        title: None,
        extra_attrs: Some(RIM.to_owned()),
    });
    let at = (area.left + 3.0, baseline);
    scene.add(text(at, &note.text, NOTE_SIZE, RIM_COLOUR));
    scene.add(Primitive::GroupEnd);
    scene.add(text(at, &note.text, NOTE_SIZE, note.colour));
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
