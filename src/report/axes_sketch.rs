//! Sketch of the axes: heave up (this program, PoliMi) beside heave down (classical, Küssner/Starossek).

use super::figure::Figure;
use super::font::FAMILIES;
use super::geometry::Px;
use super::style::{BLACK, COLOURS};
use crate::aerodynamics::derivatives::notation::Axes;
use std::fmt::Write as _;

/// Width and height of one panel, px.
const PANEL: (f64, f64) = (400.0, 330.0);
/// Reference point of the deck in its panel.
const CENTRE: (f64, f64) = (215.0, 165.0);
/// Half the width of the deck, px.
const HALF_WIDTH: f64 = 105.0;
/// Rotation of the ghost that shows nose-up, deg.
const NOSE_UP_DEG: f64 = 9.0;
/// Radius of the arrow of rotation, px, and half its angle, deg.
const TURN: (f64, f64) = (72.0, 33.0);

/// Two panels with the positive directions of motion and force in both axes, wind from the left.
pub(crate) fn axes_sketch() -> Figure {
    let (width, height) = (2.0 * PANEL.0, PANEL.1);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"{FAMILIES}\" font-size=\"13\" role=\"img\" \
         aria-label=\"Positive directions of motion and force\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
    );
    for (i, axes) in Axes::ALL.into_iter().enumerate() {
        let _ = writeln!(svg, "<g transform=\"translate({} 0)\">", i as f64 * PANEL.0);
        panel(&mut svg, axes);
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    Figure::from_svg(svg)
}

fn panel(svg: &mut String, axes: Axes) {
    let (cx, cy) = CENTRE;
    let (title, who, heave, sway, turn, down) = match axes {
        Axes::HeaveUp => (
            "heave_up",
            "Scanlan with ½ (this program), PoliMi",
            "y or z, lift",
            "x, drag",
            "θ, moment, nose-up",
            -1.0,
        ),
        Axes::HeaveDown => (
            "heave_down",
            "classical, Küssner/Starossek",
            "h, lift",
            "p, drag",
            "α, moment, nose-up",
            1.0,
        ),
    };
    text(
        svg,
        Px::new(20.0, 26.0),
        BLACK,
        "font-weight=\"bold\"",
        title,
    );
    text(svg, Px::new(20.0, 45.0), BLACK, "", who);
    let wind = COLOURS[0];
    for dy in [-30.0, 0.0, 30.0] {
        arrow(svg, wind, Px::new(18.0, cy + dy), Px::new(72.0, cy + dy));
    }
    text(svg, Px::new(18.0, cy - 42.0), wind, "", "wind V");
    deck(
        svg,
        0.0,
        "fill=\"#e8e8e8\" stroke=\"#333\" stroke-width=\"1.4\"",
    );
    let ghost = "fill=\"none\" stroke=\"#888\" stroke-width=\"1.1\" stroke-dasharray=\"5 4\"";
    deck(svg, NOSE_UP_DEG, ghost);
    let motion = COLOURS[1];
    arrow(svg, motion, Px::new(cx, cy), Px::new(cx, cy + down * 98.0));
    arrow(svg, motion, Px::new(cx, cy), Px::new(cx + 160.0, cy));
    rotation(svg, motion);
    let _ = writeln!(
        svg,
        "<circle cx=\"{cx}\" cy=\"{cy}\" r=\"3.5\" fill=\"#333\"/>"
    );
    let beside = if down > 0.0 { cy + 96.0 } else { cy - 90.0 };
    text(svg, Px::new(cx + 10.0, beside), motion, "", heave);
    text(svg, Px::new(cx + 118.0, cy - 12.0), motion, "", sway);
    text(svg, Px::new(cx - 148.0, cy - 62.0), motion, "", turn);
    dimension(svg);
}

/// The deck turned nose-up about the reference point: with the wind from the left that is clockwise.
fn deck(svg: &mut String, turn_deg: f64, style: &str) {
    let (cx, cy) = CENTRE;
    let h = HALF_WIDTH;
    let corners = [
        (-h, 0.0),
        (-0.6 * h, -14.0),
        (0.6 * h, -14.0),
        (h, 0.0),
        (0.6 * h, 12.0),
        (-0.6 * h, 12.0),
    ];
    let points: Vec<String> = corners
        .iter()
        .map(|(x, y)| format!("{:.1},{:.1}", cx + x, cy + y))
        .collect();
    let _ = writeln!(
        svg,
        "<polygon points=\"{}\" transform=\"rotate({turn_deg} {cx} {cy})\" {style}/>",
        points.join(" ")
    );
}

/// Arrow that rises on the windward side.
fn rotation(svg: &mut String, colour: &str) {
    let (cx, cy) = CENTRE;
    let (radius, half) = TURN;
    let at = |angle_deg: f64| {
        let a = angle_deg.to_radians();
        Px::new(cx + radius * a.cos(), cy - radius * a.sin())
    };
    let (start, end) = (at(180.0 + half), at(180.0 - half));
    let _ = writeln!(
        svg,
        "<path d=\"M{:.1} {:.1}A{radius} {radius} 0 0 1 {:.1} {:.1}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>",
        start.x, start.y, end.x, end.y
    );
    let tangent = (180.0 - half).to_radians();
    head(svg, colour, end, Px::new(tangent.sin(), tangent.cos()));
}

fn arrow(svg: &mut String, colour: &str, from: Px, to: Px) {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let length = dx.hypot(dy);
    let _ = writeln!(
        svg,
        "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"/>",
        from.x, from.y, to.x, to.y
    );
    head(svg, colour, to, Px::new(dx / length, dy / length));
}

/// Arrow head with its tip a little beyond `at`, in the direction `unit` of the page.
fn head(svg: &mut String, colour: &str, at: Px, unit: Px) {
    let point = |along: f64, aside: f64| {
        format!(
            "{:.1},{:.1}",
            at.x + along * unit.x - aside * unit.y,
            at.y + along * unit.y + aside * unit.x
        )
    };
    let _ = writeln!(
        svg,
        "<polygon points=\"{} {} {}\" fill=\"{colour}\"/>",
        point(6.0, 0.0),
        point(-5.0, 4.5),
        point(-5.0, -4.5)
    );
}

/// Width B and semi-chord b under the deck.
fn dimension(svg: &mut String) {
    let (cx, _) = CENTRE;
    let (left, right) = (cx - HALF_WIDTH, cx + HALF_WIDTH);
    for (level, from, words) in [(285.0, left, "width B"), (310.0, cx, "b = B/2")] {
        for x in [from, right] {
            let _ = writeln!(
                svg,
                "<path d=\"M{x} {}V{}\" stroke=\"#333\" stroke-width=\"1\"/>",
                level - 7.0,
                level + 7.0
            );
        }
        let _ = writeln!(
            svg,
            "<path d=\"M{from} {level}H{right}\" stroke=\"#333\" stroke-width=\"1\"/>"
        );
        text(svg, Px::new(right + 10.0, level + 4.0), "#333", "", words);
    }
}

fn text(svg: &mut String, at: Px, colour: &str, style: &str, words: &str) {
    let _ = writeln!(
        svg,
        "<text x=\"{}\" y=\"{}\" fill=\"{colour}\" {style}>{words}</text>",
        at.x, at.y
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The picture of the page on notations is what `aerodeck derivatives notations --sketch` draws.
    #[test]
    fn the_page_shows_this_sketch() {
        assert_eq!(axes_sketch().svg(), include_str!("../../docs/axes.svg"));
    }
}
