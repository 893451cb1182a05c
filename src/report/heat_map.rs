//! A number over a grid of two parameters, as cells of colour.

use super::axis::ends;
use super::legend::shortened;
use super::vocabulary::{Area, BLACK, Figure, GREY, Ink, Px, Scene};
use crate::error::{Error, Result, ensure};

/// Stops of a colour scale that rises evenly in lightness and is read by colour-blind readers (viridis, CC0).
const SCALE: [[u8; 3]; 6] = [
    [68, 1, 84],
    [65, 68, 135],
    [42, 120, 142],
    [34, 168, 132],
    [122, 209, 81],
    [253, 231, 37],
];
const TITLE: u32 = 14;
const LABEL: u32 = 12;
const SMALL: u32 = 11;
const LEFT: f64 = 58.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 48.0;
/// Room for the colour scale and its numbers.
const RIGHT: f64 = 92.0;
const WIDTH: f64 = 360.0;
const ROW: f64 = 22.0;
/// Labels of the columns at most.
const TICKS: usize = 7;

/// One map.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct HeatMap {
    /// Line above it.
    pub title: String,
    /// Name of the parameter along the abscissa.
    pub x_label: String,
    /// Its values, one per column.
    pub x: Vec<f64>,
    /// Name of the whole number along the ordinate.
    pub y_label: String,
    /// Number of rows, from one upwards.
    pub rows: usize,
    /// Values, all rows of the first column first; `None` for empty cells.
    pub values: Vec<Option<f64>>,
    /// Whether colours follow the logarithm.
    pub logarithmic: bool,
    /// Cells that are crossed out, in the order of the values; may be empty.
    pub refused: Vec<bool>,
    /// Column and row (both from zero) of the cell that is framed.
    pub chosen: Option<(usize, usize)>,
}

/// Maps side by side, `columns` in a row, under one title; dots mark refused cells, a frame the chosen one.
///
/// # Errors
/// [`Error::Input`] for no maps, maps of other sizes than their axes say, and maps without a finite value.
pub(crate) fn heat_map_figure(title: &str, maps: &[HeatMap], columns: usize) -> Result<Figure> {
    const PLACE: &str = "heat map";
    if maps.is_empty() || columns == 0 {
        return Err(Error::input(PLACE, "at least one map", "none"));
    }
    for map in maps {
        let (found, cells) = (map.values.len(), map.x.len() * map.rows);
        let (place, full) = (format!("{PLACE} {}", map.title), found == cells);
        let expected = format_args!("{cells} values");
        ensure(!map.x.is_empty() && full, place, expected, found)?;
    }
    let height = |m: &HeatMap| TOP + ROW * m.rows as f64 + BOTTOM;
    let panel_width = LEFT + WIDTH + RIGHT;
    let row_heights: Vec<f64> = maps
        .chunks(columns)
        .map(|row| row.iter().map(height).fold(0.0, f64::max))
        .collect();
    let wide = columns.min(maps.len()) as f64 * panel_width;
    let foot = 26.0;
    let mut scene = Scene::new(wide, 34.0 + row_heights.iter().sum::<f64>() + foot);
    scene.text(Px::new(LEFT, 22.0), &shortened(title), TITLE, BLACK);
    let mut top = 34.0;
    for (row, tall) in maps.chunks(columns).zip(&row_heights) {
        for (c, map) in row.iter().enumerate() {
            map.draw(&mut scene, Px::new(c as f64 * panel_width, top))?;
        }
        top += tall;
    }
    let key = "dot: refused model · frame: recommended model";
    scene.text(Px::new(LEFT, top + 10.0), key, SMALL, GREY);
    Ok(scene.finish())
}

impl HeatMap {
    fn scaled(&self, value: f64) -> f64 {
        if self.logarithmic { value.ln() } else { value }
    }

    /// Ends of the colour scale.
    fn ends(&self) -> Result<(f64, f64)> {
        let usable = |v: &f64| v.is_finite() && (!self.logarithmic || *v > 0.0);
        // refused models may be anywhere: the scale is for those to choose from
        let kept = |at: usize| self.refused.get(at) != Some(&true);
        let chosen = self.values.iter().enumerate().filter(|(at, _)| kept(*at));
        let (mut low, mut high) = ends(chosen.filter_map(|(_, v)| v.filter(|x| x.is_finite())));
        if low > high {
            (low, high) = ends(self.values.iter().copied().flatten().filter(usable));
        }
        let place = format!("heat map {}", self.title);
        ensure(low <= high, place, "at least one finite value", "none")?;
        Ok((low, high))
    }

    fn draw(&self, scene: &mut Scene, corner: Px) -> Result<()> {
        let (low, high) = self.ends()?;
        let corner = corner + Px::new(LEFT, TOP);
        let part = |v: f64| {
            let (a, b) = (self.scaled(low), self.scaled(high));
            match b > a {
                true => (self.scaled(v) - a) / (b - a),
                false => 0.5,
            }
        };
        let title = corner + Px::new(0.0, -8.0);
        scene.text(title, &self.title, LABEL, BLACK);
        for (at, value) in self.values.iter().enumerate() {
            let cell = self.cell(corner, at / self.rows, at % self.rows);
            let known = value.filter(|v| v.is_finite() && (!self.logarithmic || *v > 0.0));
            let fill = known.map_or_else(|| "#ffffff".to_owned(), |v| shade(part(v)));
            scene.filled(cell, &fill, 1.0);
            if self.refused.get(at) == Some(&true) {
                let light = known.is_some_and(|v| part(v) < 0.6);
                let radius = (0.18 * (cell.right - cell.left)).clamp(1.0, 2.5);
                let fill = if light { "#ffffff" } else { BLACK };
                scene.circle(cell.middle(), radius, fill, None);
            }
        }
        if let Some((column, row)) = self.chosen {
            let frame = self.cell(corner, column, row).grown(1.5);
            scene.outline(frame, Ink::solid("#ffffff", 4.0));
            scene.outline(frame, Ink::solid("#d55e00", 2.2));
        }
        self.axes(scene, corner);
        let bar = corner + Px::new(WIDTH + 16.0, 0.0);
        let value = |part: f64| match self.logarithmic {
            true => low * (high / low).powf(part),
            false => low + part * (high - low),
        };
        colour_bar(scene, bar, self.tall(), &value);
        Ok(())
    }

    /// Height of all rows, px.
    fn tall(&self) -> f64 {
        ROW * self.rows as f64
    }

    /// A cell of the map with its upper left corner at `corner`; rows count from below.
    fn cell(&self, corner: Px, column: usize, row: usize) -> Area {
        let width = WIDTH / self.x.len() as f64;
        let left = corner.x + column as f64 * width;
        let bottom = corner.y + self.tall() - row as f64 * ROW;
        Area {
            left,
            top: bottom - ROW,
            right: left + width,
            bottom,
        }
    }

    fn axes(&self, scene: &mut Scene, corner: Px) {
        let tall = self.tall();
        let every = self.x.len().div_ceil(TICKS);
        for (column, x) in self.x.iter().enumerate().step_by(every) {
            let middle = self.cell(corner, column, 0).middle().x;
            let at = Px::new(middle, corner.y + tall + 15.0);
            scene.label(at, &format!("{x:.2}"), SMALL, "middle");
        }
        let below = corner + Px::new(0.5 * WIDTH, tall + 34.0);
        scene.label(below, &self.x_label, LABEL, "middle");
        for row in 0..self.rows {
            let middle = self.cell(corner, 0, row).middle().y;
            let at = Px::new(corner.x - 14.0, middle + 4.0);
            scene.label(at, &(row + 1).to_string(), SMALL, "middle");
        }
        let beside = corner + Px::new(-36.0, 0.5 * tall);
        scene.upright_label(beside, &self.y_label, LABEL);
    }
}

fn colour_bar(scene: &mut Scene, corner: Px, tall: f64, value: &dyn Fn(f64) -> f64) {
    const STEPS: usize = 48;
    let step = tall / STEPS as f64;
    for i in 0..STEPS {
        let top = corner.y + tall - (i + 1) as f64 * step;
        let bar = Area {
            left: corner.x,
            top,
            right: corner.x + 12.0,
            bottom: top + step + 0.4,
        };
        scene.filled(bar, &shade((i as f64 + 0.5) / STEPS as f64), 1.0);
    }
    for part in [0.0, 0.5, 1.0] {
        let at = corner + Px::new(17.0, tall * (1.0 - part) + 4.0);
        scene.text(at, &number(value(part)), SMALL, BLACK);
    }
}

fn number(x: f64) -> String {
    match x.abs() {
        a if a >= 100.0 => format!("{x:.0}"),
        a if a >= 10.0 => format!("{x:.1}"),
        a if a >= 0.1 => format!("{x:.3}"),
        _ => format!("{x:.4}"),
    }
}

fn shade(part: f64) -> String {
    let at = part.clamp(0.0, 1.0) * (SCALE.len() - 1) as f64;
    let low = (at.floor() as usize).min(SCALE.len() - 2);
    let rest = at - low as f64;
    let mix = |c: usize| {
        let (a, b) = (f64::from(SCALE[low][c]), f64::from(SCALE[low + 1][c]));
        (a + rest * (b - a)).round() as u8
    };
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> HeatMap {
        HeatMap {
            title: "error".into(),
            x_label: "p".into(),
            x: vec![0.1, 0.2, 0.4],
            y_label: "L".into(),
            rows: 2,
            values: vec![
                Some(1.0),
                Some(2.0),
                None,
                Some(4.0),
                Some(f64::NAN),
                Some(8.0),
            ],
            logarithmic: true,
            refused: vec![false, true, false, false, false, false],
            chosen: Some((1, 1)),
        }
    }

    #[test]
    fn lowest_and_highest_have_the_ends_of_the_scale() {
        let figure = heat_map_figure(&"two ".repeat(40), &[map(), map()], 2).unwrap();
        assert!(figure.svg().contains('…'));
        for colour in ["#440154", "#fde725"] {
            assert!(figure.svg().contains(colour), "{colour}");
        }
        // half way in the logarithm between 1 and 8
        assert!(figure.svg().contains("2.828"));
    }

    #[test]
    fn maps_that_do_not_fit_are_refused() {
        assert!(heat_map_figure("", &[], 1).is_err());
        let mut short = map();
        short.values.pop();
        assert!(heat_map_figure("", &[short], 1).is_err());
        let mut empty = map();
        empty.values = vec![None; 6];
        assert!(heat_map_figure("", &[empty], 1).is_err());
    }
}
