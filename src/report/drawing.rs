//! Panels in a grid with a title above and a legend below, put together into one figure.

use super::axis::ends;
use super::font::text_width;
use super::legend::Entry;
use super::legend::{LegendLayout, lay_out, shortened};
use super::panel::Panel;
use super::panel::{LABEL_SIZE, ROOM_BELOW};
use super::scene::{Area, Figure, Px, Scene};
use super::style::BLACK;
use crate::error::{Error, Result};

const TITLE_SIZE: u32 = 14;
const TITLE_HEIGHT: f64 = 30.0;
const EDGE: f64 = 12.0;
const RIGHT: f64 = 16.0;

/// A whole figure before it is drawn.
#[derive(Debug)]
pub(super) struct Drawing {
    /// Kind of figure, for messages.
    pub(super) name: &'static str,
    /// The line above it; none for an empty one.
    pub(super) title: Option<String>,
    /// Row by row.
    pub(super) panels: Vec<Panel>,
    pub(super) columns: usize,
    /// Size of the axes of one panel, px.
    pub(super) axes: [f64; 2],
    /// Groups of entries; each starts a new row.
    pub(super) legend: Vec<Vec<Entry>>,
}

impl Drawing {
    /// Panels of this height above each other over one abscissa.
    pub(super) fn stacked(
        name: &'static str,
        title: &str,
        panels: Vec<Panel>,
        height: f64,
        legend: Vec<Vec<Entry>>,
    ) -> Result<Figure> {
        let drawing = Self::grid(name, title, panels, 1, [640.0, height], legend);
        drawing.over_one_abscissa().draw()
    }

    /// Panels row by row, each with an abscissa of its own.
    pub(super) fn grid(
        name: &'static str,
        title: &str,
        panels: Vec<Panel>,
        columns: usize,
        axes: [f64; 2],
        legend: Vec<Vec<Entry>>,
    ) -> Self {
        Self {
            name,
            title: Some(shortened(title)).filter(|t| !t.is_empty()),
            panels,
            columns,
            axes,
            legend,
        }
    }

    /// The abscissa of all panels is named under the lowest of each column alone.
    pub(super) fn over_one_abscissa(mut self) -> Self {
        let above = self.panels.len().saturating_sub(self.columns);
        for panel in &mut self.panels[..above] {
            panel.x.label.clear();
        }
        self
    }

    /// Draws everything.
    ///
    /// # Errors
    /// [`Error::Input`] for no panels, for panels without data and for numbers that are not finite.
    pub(super) fn draw(&self) -> Result<Figure> {
        for panel in &self.panels {
            panel.check(self.name)?;
        }
        let stacked = self.with_one_abscissa();
        let (left, width, legend) = self.widths();
        let rows = self.panels.chunks(self.columns);
        let rows: Vec<(Area, f64)> = rows.map(|row| self.row(row, left, width)).collect();
        if rows.is_empty() {
            return Err(Error::input(self.name, "data", "none"));
        }
        let grid_width = self.columns as f64 * width;
        let grid_height: f64 = rows.iter().map(|(_, height)| height).sum();
        let head = self.title.as_ref().map_or(EDGE, |_| TITLE_HEIGHT + EDGE);
        let foot = match legend.height > 0.0 {
            true => legend.height + 2.0 * EDGE,
            false => EDGE,
        };
        let mut scene = Scene::new(grid_width.ceil(), (head + grid_height + foot).ceil());
        if let Some(title) = &self.title {
            scene.text(Px::new(left, EDGE + 16.0), title, TITLE_SIZE, BLACK);
        }
        let mut top = head;
        for (row, (axes, height)) in stacked.chunks(self.columns).zip(rows) {
            for (column, panel) in row.iter().enumerate() {
                let corner = Px::new(column as f64 * width, top);
                scene.moved(corner, |scene| panel.draw(scene, axes));
            }
            top += height;
        }
        legend.draw(&mut scene, Px::new(left, top + EDGE));
        Ok(scene.finish())
    }

    /// The panels; those in one column with abscissae of their data alone get one for all.
    fn with_one_abscissa(&self) -> Vec<Panel> {
        let mut panels = self.panels.clone();
        let own = |p: &Panel| p.x.tight && p.x.range.is_none() && p.x.within.is_none();
        if self.columns == 1 && panels.iter().all(own) {
            let points = self.panels.iter().flat_map(|p| &p.series);
            let range = ends(points.flat_map(|s| &s.points).map(|p| p.0));
            if range.0 < range.1 {
                panels.iter_mut().for_each(|p| p.x.range = Some(range));
            }
        }
        panels
    }

    /// Room at the left of the axes and width of every panel, and the legend. When the legend or the title is wider than the
    /// panels, the panels grow.
    fn widths(&self) -> (f64, f64, LegendLayout<'_>) {
        let line = f64::from(LABEL_SIZE);
        let widest = |p: &[Panel]| p.iter().map(Panel::tick_width).fold(0.0, f64::max);
        let y_label = self.panels.iter().any(|p| !p.y.label.is_empty());
        let left = widest(&self.panels) + line + if y_label { line + 16.0 } else { 4.0 };
        let columns = self.columns as f64;
        let outside = left + EDGE;
        let wanted = columns * (self.axes[0] + left + RIGHT);
        let legend = lay_out(&self.legend, wanted - outside);
        let title = self.title.as_ref();
        let title = title.map_or(0.0, |t| text_width(t, f64::from(TITLE_SIZE)));
        let width = wanted.max(outside + legend.width.max(title)) / columns;
        let legend = lay_out(&self.legend, columns * width - outside);
        (left, width, legend)
    }

    /// Where the axes of a row of panels are in their cells, in line with those of the others, and how tall it is.
    fn row(&self, row: &[Panel], left: f64, width: f64) -> (Area, f64) {
        let titled = row.iter().any(|p| p.title.is_some());
        let named = row.iter().any(|p| !p.x.label.is_empty());
        let top = if titled { 26.0 } else { 8.0 };
        let axes = Area {
            left,
            top,
            right: width - RIGHT,
            bottom: top + self.axes[1],
        };
        (axes, axes.bottom + if named { ROOM_BELOW } else { 28.0 })
    }
}
