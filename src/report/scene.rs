//! What a figure is drawn on: places and rectangles, in px from the upper left corner, elements of SVG, and the finished figure.

use super::font::FAMILIES;
use super::style::{BLACK, Ink, Shape};
use crate::error::{Error, Result};
use quick_xml::escape::escape;
use std::fmt::{Display, Write as _};
use std::ops::Add;
use std::path::{Path, PathBuf};
use uuid::Uuid;

/// Beginning of the names of clip paths before the figure has a name of its own.
const CLIP: &str = "clip-of-the-figure-";
const WHITE: &str = "#ffffff";

/// A place, or the way between two, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Px {
    pub(super) x: f64,
    pub(super) y: f64,
}

impl Px {
    pub(super) const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }
}

impl Add for Px {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

/// A rectangle of the panel, px, y down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Area {
    pub(super) fn overlap(&self, other: &Self) -> f64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }
    pub(super) fn size(&self) -> f64 {
        (self.right - self.left) * (self.bottom - self.top)
    }
    pub(super) fn middle(&self) -> Px {
        Px::new(
            0.5 * (self.left + self.right),
            0.5 * (self.top + self.bottom),
        )
    }
    /// The same with a margin on every side.
    pub(super) fn grown(&self, margin: f64) -> Self {
        Self {
            left: self.left - margin,
            top: self.top - margin,
            right: self.right + margin,
            bottom: self.bottom + margin,
        }
    }
    /// The point of the area that is nearest to another.
    pub(super) fn nearest(&self, at: Px) -> Px {
        Px::new(
            at.x.clamp(self.left, self.right),
            at.y.clamp(self.top, self.bottom),
        )
    }
    pub(super) fn contains(&self, at: Px) -> bool {
        self.left <= at.x && at.x <= self.right && self.top <= at.y && at.y <= self.bottom
    }
}

/// A drawing as SVG text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    svg: String,
}

impl Figure {
    /// That of a file, without what only a file of its own needs; none where there is no drawing in it.
    pub(crate) fn of_file(text: &str) -> Option<Self> {
        let svg = text[text.find("<svg")?..].to_owned();
        Some(Self { svg })
    }

    /// The SVG text: one `svg` element with a `viewBox`, ready to stand in a page; its identifiers are its own, so that
    /// several figures in one page do not disturb each other.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// Writes `stem.svg` into the existing directory `dir`; returns its path.
    ///
    /// # Errors
    /// [`Error::Io`] naming the file.
    pub fn write(&self, dir: impl AsRef<Path>, stem: &str) -> Result<PathBuf> {
        let path = dir.as_ref().join(format!("{stem}.svg"));
        std::fs::write(&path, &self.svg).map_err(|e| Error::io(&path, e))?;
        Ok(path)
    }
}

/// Elements in the order in which they are drawn.
#[derive(Debug)]
pub(super) struct Scene {
    width: f64,
    height: f64,
    body: String,
    clips: usize,
}

impl Scene {
    pub(super) fn new(width: f64, height: f64) -> Self {
        Self {
            width,
            height,
            body: String::new(),
            clips: 0,
        }
    }

    fn add(&mut self, element: std::fmt::Arguments<'_>) {
        // a string takes everything
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }

    /// A line through all points.
    pub(super) fn polyline(&mut self, points: &[Px], stroke: Ink) {
        let way = path(points);
        self.add(format_args!("<path d=\"{way}\" fill=\"none\"{stroke}/>"));
    }

    /// An area within corners.
    pub(super) fn polygon(&mut self, corners: &[Px], fill: &str, rim: Ink) {
        let way = path(corners);
        self.add(format_args!("<path d=\"{way}Z\" fill=\"{fill}\"{rim}/>"));
    }

    pub(super) fn circle(&mut self, centre: Px, radius: f64, fill: &str, rim: Option<Ink>) {
        let rim = rim.map(|r| r.to_string()).unwrap_or_default();
        let (x, y, r) = (rounded(centre.x), rounded(centre.y), rounded(radius));
        self.add(format_args!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"{fill}\"{rim}/>"
        ));
    }

    /// A filled rectangle; `opacity` from 0 to 1.
    pub(super) fn filled(&mut self, area: Area, fill: &str, opacity: f64) {
        let sides = sides(area);
        let opacity = match opacity {
            1.0 => String::new(),
            other => format!(" fill-opacity=\"{other}\""),
        };
        self.add(format_args!("<rect{sides} fill=\"{fill}\"{opacity}/>"));
    }

    /// The sides of a rectangle.
    pub(super) fn outline(&mut self, area: Area, stroke: Ink) {
        let sides = sides(area);
        self.add(format_args!("<rect{sides} fill=\"none\"{stroke}/>"));
    }

    /// A text that starts at a point.
    pub(super) fn text(&mut self, at: Px, content: &str, size: u32, colour: &str) {
        self.write(at, content, size, &format!(" fill=\"{colour}\""));
    }

    /// A black text of which the `middle` or the `end` stands on a point.
    pub(super) fn label(&mut self, at: Px, content: &str, size: u32, anchor: &str) {
        let anchor = format!(" text-anchor=\"{anchor}\"");
        self.write(at, content, size, &anchor);
    }

    /// A black text around a point, read from below upwards.
    pub(super) fn upright_label(&mut self, at: Px, content: &str, size: u32) {
        let turn = format!(" text-anchor=\"middle\" transform=\"rotate(-90 {at})\"");
        self.write(at, content, size, &turn);
    }

    fn write(&mut self, at: Px, content: &str, size: u32, attributes: &str) {
        // what XML cannot hold becomes a space
        let shown = |c: char| if c.is_control() { ' ' } else { c };
        let plain: String = content.chars().map(shown).collect();
        let content = subscripted(&escape(&plain));
        let (x, y) = (rounded(at.x), rounded(at.y));
        self.add(format_args!(
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{attributes}>{content}</text>"
        ));
    }

    /// A marker; filled ones get a white rim that keeps neighbours apart.
    pub(super) fn marker(&mut self, at: Px, marker: Ink) {
        let r = marker.size;
        let (fill, rim) = match marker.hollow {
            true => (WHITE, Ink::solid(marker.colour, 1.6)),
            false => (marker.colour, Ink::solid(WHITE, 0.8)),
        };
        let around = |corners: &[[f64; 2]]| -> Vec<Px> {
            let corner = |c: &[f64; 2]| at + Px::new(c[0] * r, c[1] * r);
            corners.iter().map(corner).collect()
        };
        match marker.shape.unwrap_or(Shape::Circle) {
            Shape::Circle => self.circle(at, r, fill, Some(rim)),
            Shape::Square => {
                let corners = around(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]);
                self.polygon(&corners, fill, rim);
            }
            Shape::Diamond => {
                let corners = around(&[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]]);
                self.polygon(&corners, fill, rim);
            }
            Shape::Cross => {
                let ink = Ink::solid(marker.colour, 1.8);
                self.polyline(&around(&[[-1.0, -1.0], [1.0, 1.0]]), ink);
                self.polyline(&around(&[[-1.0, 1.0], [1.0, -1.0]]), ink);
            }
        }
    }

    /// Draws with the upper left corner moved.
    pub(super) fn moved(&mut self, by: Px, draw: impl FnOnce(&mut Self)) {
        self.group(&format!("transform=\"translate({by})\""), draw);
    }

    /// Draws what is seen of an area alone.
    pub(super) fn clipped(&mut self, area: Area, draw: impl FnOnce(&mut Self)) {
        let id = format!("{CLIP}{}", self.clips);
        self.clips += 1;
        let sides = sides(area);
        self.add(format_args!(
            "<clipPath id=\"{id}\"><rect{sides}/></clipPath>"
        ));
        self.group(&format!("clip-path=\"url(#{id})\""), draw);
    }

    /// Draws with attributes that all elements take over.
    pub(super) fn group(&mut self, attributes: &str, draw: impl FnOnce(&mut Self)) {
        self.add(format_args!("<g {attributes}>"));
        draw(self);
        self.add(format_args!("</g>"));
    }

    /// The figure, with a `viewBox`, so that pages can scale it, and with identifiers made from the content, so that several
    /// figures in one page do not share any.
    pub(super) fn finish(self) -> Figure {
        let own = Uuid::new_v5(&Uuid::NAMESPACE_OID, self.body.as_bytes()).simple();
        let body = self.body.replace(CLIP, &format!("fig-{own}-"));
        let (width, height) = (self.width, self.height);
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             role=\"img\" font-family=\"{FAMILIES}\" fill=\"{BLACK}\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{body}</svg>\n"
        );
        Figure { svg }
    }
}

impl Display for Ink {
    /// The attributes of an element.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { colour, size, .. } = self;
        write!(f, " stroke=\"{colour}\" stroke-width=\"{size}\"")?;
        self.dash
            .map_or(Ok(()), |d| write!(f, " stroke-dasharray=\"{d}\""))
    }
}

impl Display for Px {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", rounded(self.x), rounded(self.y))
    }
}

/// To a hundredth of a px.
fn rounded(length: f64) -> f64 {
    let hundredths = (length * 100.0).round() / 100.0;
    // no minus before zero
    hundredths + 0.0
}

fn path(points: &[Px]) -> String {
    let mut way = String::new();
    for (i, point) in points.iter().enumerate() {
        let _ = write!(way, "{}{point}", if i == 0 { 'M' } else { 'L' });
    }
    way
}

fn sides(area: Area) -> String {
    let (width, height) = (area.right - area.left, area.bottom - area.top);
    let [x, y, width, height] = [area.left, area.top, width, height].map(rounded);
    format!(" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}

/// `F_y` as a symbol with a subscript: a single letter, an underscore and one or two letters that end the word.
fn subscripted(content: &str) -> String {
    let mut text = String::new();
    let mut rest = content;
    while let Some((before, after)) = rest.split_once('_') {
        let length = after.find(|c: char| !(c.is_alphanumeric() || c == '_'));
        let length = length.unwrap_or(after.len());
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
    use super::*;

    #[test]
    fn symbols_get_subscripts_and_names_keep_their_underscores() {
        let low = "<tspan dy=\"3\" font-size=\"9\">y</tspan>";
        assert_eq!(subscripted("F_y"), format!("F{low}"));
        let back = "<tspan dy=\"-3\"> (N/m)</tspan>";
        assert_eq!(subscripted("f S_y (N/m)"), format!("f S{low}{back}"));
        for name in ["wind_speed", "k_full", "run_1", "_x", "F_y2"] {
            assert_eq!(subscripted(name), name);
        }
    }

    #[test]
    fn texts_of_users_stay_texts_and_clips_have_names_of_their_own() {
        let drawn = |word: &str| {
            let mut scene = Scene::new(10.0, 10.0);
            let area = Area {
                left: 0.0,
                top: 0.1 + 0.2,
                right: 5.0,
                bottom: 5.0,
            };
            scene.clipped(area, |s| s.text(Px::new(-1e-9, 2.0), word, 11, BLACK));
            scene.finish().svg().to_owned()
        };
        let svg = drawn("a<b & \u{1}\"c\"");
        assert!(svg.contains(">a&lt;b &amp;  &quot;c&quot;</text>"), "{svg}");
        assert!(svg.contains("x=\"0\" y=\"0.3\""), "{svg}");
        assert!(!svg.contains(CLIP));
        let name = |svg: &str| svg.split("id=\"").nth(1).map(str::to_owned);
        assert_ne!(name(&svg), name(&drawn("other")));
    }
}
