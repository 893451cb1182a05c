//! Panels in a grid with a title above and a legend below, put together into one figure.

use super::figure::Figure;
use super::font::{FAMILIES, text_width};
use super::legend::{Entry, LegendLayout, lay_out};
use super::panel::{Frame, LABEL_SIZE, Margins, Panel};
use super::style::BLACK;
use super::text::text;
use crate::error::{Error, Result};
use kuva::backend::svg::SvgBackend;
use kuva::render::render::{Primitive, Scene};
use uuid::Uuid;

const TITLE_SIZE: u32 = 14;
const TITLE_HEIGHT: f64 = 30.0;
const EDGE: f64 = 12.0;
const RIGHT: f64 = 16.0;

/// The line above a figure; none for an empty one.
pub(super) fn titled(title: &str) -> Option<String> {
    Some(title.to_owned()).filter(|t| !t.is_empty())
}

/// A whole figure before it is drawn.
#[derive(Debug)]
pub(super) struct Drawing {
    /// Kind of figure, for messages.
    pub(super) name: &'static str,
    pub(super) title: Option<String>,
    /// Row by row.
    pub(super) panels: Vec<Panel>,
    pub(super) columns: usize,
    /// Size of the axes of one panel, px.
    pub(super) axes: (f64, f64),
    /// Groups of entries; each starts a new row.
    pub(super) legend: Vec<Vec<Entry>>,
}

impl Drawing {
    /// Draws everything.
    ///
    /// # Errors
    /// [`Error::Input`] for no panels, for panels without data and for numbers that are not finite.
    pub(super) fn draw(&self) -> Result<Figure> {
        for panel in &self.panels {
            panel.check(self.name)?;
        }
        let stacked = self.with_one_abscissa();
        let (frames, legend) = self.frames();
        let Some(Frame { width, margins, .. }) = frames.first() else {
            return Err(Error::input(self.name, "data", "none"));
        };
        let grid_width = self.columns as f64 * width;
        let grid_height: f64 = frames.iter().map(|f| f.height).sum();
        let left = margins.left;
        let head = self.title.as_ref().map_or(EDGE, |_| TITLE_HEIGHT + EDGE);
        let foot = if legend.height > 0.0 {
            legend.height + 2.0 * EDGE
        } else {
            EDGE
        };
        let mut scene = Scene::new(grid_width.ceil(), (head + grid_height + foot).ceil());
        scene.font_family = Some(FAMILIES.to_owned());
        scene.text_color = Some(BLACK.to_owned());
        if let Some(title) = &self.title {
            scene.add(text((left, EDGE + 16.0), title, TITLE_SIZE, BLACK));
        }
        let mut top = head;
        for (row, frame) in stacked.chunks(self.columns).zip(&frames) {
            for (column, panel) in row.iter().enumerate() {
                let corner = (column as f64 * frame.width, top);
                insert(&mut scene, panel.draw(*frame), corner);
            }
            top += frame.height;
        }
        legend.draw(&mut scene, (left, top + EDGE));
        Ok(Figure::from_svg(finished(&scene)))
    }

    /// The panels; those in one column with abscissae of their data alone get one for all.
    fn with_one_abscissa(&self) -> Vec<Panel> {
        let mut panels = self.panels.clone();
        let own = |p: &Panel| p.x.tight && p.x.range.is_none() && p.x.within.is_none();
        if self.columns == 1 && panels.iter().all(own) {
            let points = self.panels.iter().flat_map(|p| &p.series);
            let ends = points.flat_map(|s| &s.points).map(|p| p.0);
            let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                (low.min(x), high.max(x))
            });
            if low < high {
                panels
                    .iter_mut()
                    .for_each(|p| p.x.range = Some((low, high)));
            }
        }
        panels
    }

    /// A frame for each row, of one width and with axes in line, and the legend. When the legend or the title is wider
    /// than the panels, the panels grow.
    fn frames(&self) -> (Vec<Frame>, LegendLayout<'_>) {
        let line = f64::from(LABEL_SIZE);
        let widest = |p: &[Panel]| p.iter().map(Panel::tick_width).fold(0.0, f64::max);
        let any = |row: &[Panel], has: fn(&Panel) -> bool| row.iter().any(has);
        let y_label = any(&self.panels, |p| !p.y.label.is_empty());
        let left = widest(&self.panels) + line + if y_label { line + 16.0 } else { 4.0 };
        let columns = self.columns as f64;
        let outside = left + EDGE;
        let wanted = columns * (self.axes.0 + left + RIGHT);
        let legend = lay_out(&self.legend, wanted - outside);
        let title = self
            .title
            .as_ref()
            .map_or(0.0, |t| text_width(t, f64::from(TITLE_SIZE)));
        let width = wanted.max(outside + legend.width.max(title)) / columns;
        let legend = lay_out(&self.legend, columns * width - outside);
        let frame = |row: &[Panel]| {
            let titled = any(row, |p| p.title.is_some());
            let named = any(row, |p| !p.x.label.is_empty());
            let margins = Margins {
                left,
                right: RIGHT,
                top: if titled { 26.0 } else { 8.0 },
                bottom: if named { 46.0 } else { 28.0 },
            };
            Frame {
                width,
                height: self.axes.1 + margins.top + margins.bottom,
                margins,
            }
        };
        (
            self.panels.chunks(self.columns).map(frame).collect(),
            legend,
        )
    }
}

/// Puts the scene of a panel into that of the drawing. Clip paths are numbered anew: the library counts them over the
/// life of the process, which would make every drawing differ.
fn insert(scene: &mut Scene, panel: Scene, (x, y): (f64, f64)) {
    let name = format!("{CLIP}{}", scene.defs.len());
    let mut old = None;
    scene.add(Primitive::GroupStart {
        transform: Some(format!("translate({x:.2},{y:.2})")),
        title: None,
        extra_attrs: None,
    });
    for mut element in panel.elements {
        if let Primitive::ClipStart { id, .. } = &mut element {
            old = Some(std::mem::replace(id, name.clone()));
        }
        scene.add(element);
    }
    scene.add(Primitive::GroupEnd);
    for definition in panel.defs {
        scene.defs.push(match &old {
            Some(old) => definition.replace(&format!("\"{old}\""), &format!("\"{name}\"")),
            None => definition,
        });
    }
}

/// Name of a clip path before the figure has a name of its own.
const CLIP: &str = "panel-clip-";

/// The SVG text with a `viewBox`, so that pages can scale it, and with identifiers made from the content, so that
/// several figures in one page do not share any.
pub(super) fn finished(scene: &Scene) -> String {
    let svg = SvgBackend::new().with_pretty(true).render_scene(scene);
    let own = Uuid::new_v5(&Uuid::NAMESPACE_OID, svg.as_bytes()).simple();
    let head = format!(
        "<svg viewBox=\"0 0 {} {}\" role=\"img\" ",
        scene.width, scene.height
    );
    let mark = format!("fig-{own}-");
    with_subscripts(&svg.replacen("<svg ", &head, 1).replace(CLIP, &mark))
}

/// Every text with its subscripts.
fn with_subscripts(svg: &str) -> String {
    let parts = svg
        .split_inclusive('>')
        .map(|part| match part.split_once('<') {
            Some((content, tag)) if content.contains('_') => {
                format!("{}<{tag}", subscripted(content))
            }
            _ => part.to_owned(),
        });
    parts.collect()
}

/// `F_y` as a symbol with a subscript: a single letter, an underscore and one or two letters that end the word.
fn subscripted(content: &str) -> String {
    let mut text = String::new();
    let mut rest = content;
    while let Some((before, after)) = rest.split_once('_') {
        let length = after
            .find(|c: char| !(c.is_alphanumeric() || c == '_'))
            .unwrap_or(after.len());
        let (word, remaining) = after.split_at(length);
        let mut backwards = before.chars().rev();
        let symbol = backwards.next().is_some_and(char::is_alphabetic)
            && backwards.next().is_none_or(|c| !c.is_alphanumeric());
        text.push_str(before);
        if symbol
            && (1..=2).contains(&word.chars().count())
            && word.chars().all(char::is_alphabetic)
        {
            text.push_str(&format!("<tspan dy=\"3\" font-size=\"9\">{word}</tspan>"));
            let end = remaining.find('_').unwrap_or(remaining.len());
            // what follows goes back to the line
            if end > 0 {
                text.push_str(&format!("<tspan dy=\"-3\">{}</tspan>", &remaining[..end]));
            }
            rest = &remaining[end..];
        } else {
            text.push('_');
            text.push_str(word);
            rest = remaining;
        }
    }
    text + rest
}

#[cfg(test)]
mod tests {
    use super::{subscripted, with_subscripts};

    #[test]
    fn symbols_get_subscripts_and_names_keep_their_underscores() {
        let low = "<tspan dy=\"3\" font-size=\"9\">y</tspan>";
        assert_eq!(subscripted("F_y"), format!("F{low}"));
        let back = "<tspan dy=\"-3\"> (N/m)</tspan>";
        assert_eq!(subscripted("f S_y (N/m)"), format!("f S{low}{back}"));
        for name in ["wind_speed", "k_full", "run_1", "_x", "F_y2"] {
            assert_eq!(subscripted(name), name);
        }
        let tag = "<a id=\"F_y\">plain</a>";
        assert_eq!(with_subscripts(tag), tag);
    }
}
