//! Sketch of the axes: heave up (this program, PoliMi) beside heave down (classical, Küssner/Starossek).

use super::vocabulary::{BLACK, COLOURS, Figure, GREY, Ink, Px, Scene};
use crate::aerodynamics::derivatives::notation::Axes;

/// Width and height of one panel, px.
const PANEL: Px = Px::new(400.0, 330.0);
/// Reference point of the deck in its panel.
const CENTRE: Px = Px::new(215.0, 165.0);
/// Half the width of the deck, px.
const HALF_WIDTH: f64 = 105.0;
/// Rotation of the ghost that shows nose-up, deg.
const NOSE_UP_DEG: f64 = 9.0;
/// Radius of the arrow of rotation, px.
const TURN_RADIUS: f64 = 72.0;
/// Half its angle, deg.
const TURN_DEG: i32 = 33;
const SIZE: u32 = 13;

/// Two panels with the positive directions of motion and force in both axes, wind from the left.
pub(crate) fn axes_sketch() -> Figure {
    let mut scene = Scene::new(2.0 * PANEL.x, PANEL.y);
    for (i, axes) in Axes::ALL.into_iter().enumerate() {
        scene.moved(Px::new(i as f64 * PANEL.x, 0.0), |s| panel(s, axes));
    }
    scene.finish()
}

fn panel(scene: &mut Scene, axes: Axes) {
    let (title, who, heave, sway, turn, down) = match axes {
        Axes::HeaveUp => (
            "heave_up",
            "Scanlan with ½ (this program, wawi), PoliMi (Zasso)",
            "y or z, lift",
            "x, drag",
            "θ, moment, nose-up",
            -1.0,
        ),
        Axes::HeaveDown => (
            "heave_down",
            "Simiu–Scanlan, classical, Küssner/Starossek",
            "h, lift",
            "p, drag",
            "α, moment, nose-up",
            1.0,
        ),
    };
    scene.group("font-weight=\"bold\"", |s| {
        s.text(Px::new(20.0, 26.0), title, SIZE, BLACK)
    });
    scene.text(Px::new(20.0, 45.0), who, SIZE, BLACK);
    let (wind, motion) = (COLOURS[0], COLOURS[1]);
    for dy in [-30.0, 0.0, 30.0] {
        let from = Px::new(18.0, CENTRE.y + dy);
        arrow(scene, wind, &[from, from + Px::new(54.0, 0.0)]);
    }
    scene.text(Px::new(18.0, CENTRE.y - 42.0), "wind V", SIZE, wind);
    scene.polygon(&deck(0.0), "#e8e8e8", Ink::solid(BLACK, 1.4));
    let ghost = Ink::stroke(GREY, Some("5 4"), 1.1);
    scene.polygon(&deck(NOSE_UP_DEG), "none", ghost);
    arrow(scene, motion, &[CENTRE, CENTRE + Px::new(0.0, down * 98.0)]);
    arrow(scene, motion, &[CENTRE, CENTRE + Px::new(160.0, 0.0)]);
    // it rises on the windward side
    let around = (-TURN_DEG..=TURN_DEG).step_by(3).map(|angle_deg| {
        let a = f64::from(180 - angle_deg).to_radians();
        CENTRE + Px::new(TURN_RADIUS * a.cos(), -TURN_RADIUS * a.sin())
    });
    arrow(scene, motion, &around.collect::<Vec<_>>());
    scene.circle(CENTRE, 3.5, BLACK, None);
    let beside = if down > 0.0 { 96.0 } else { -90.0 };
    scene.text(CENTRE + Px::new(10.0, beside), heave, SIZE, motion);
    scene.text(CENTRE + Px::new(118.0, -12.0), sway, SIZE, motion);
    scene.text(CENTRE + Px::new(-148.0, -62.0), turn, SIZE, motion);
    dimension(scene);
}

/// The deck turned nose-up about the reference point: with the wind from the left that is clockwise.
fn deck(turn_deg: f64) -> Vec<Px> {
    let h = HALF_WIDTH;
    let corners = [
        Px::new(-h, 0.0),
        Px::new(-0.6 * h, -14.0),
        Px::new(0.6 * h, -14.0),
        Px::new(h, 0.0),
        Px::new(0.6 * h, 12.0),
        Px::new(-0.6 * h, 12.0),
    ];
    let (sin, cos) = turn_deg.to_radians().sin_cos();
    let turned = |c: Px| CENTRE + Px::new(cos * c.x - sin * c.y, sin * c.x + cos * c.y);
    corners.into_iter().map(turned).collect()
}

/// A line with a head at its end, whose tip stands a little beyond.
fn arrow(scene: &mut Scene, colour: &'static str, way: &[Px]) {
    scene.polyline(way, Ink::solid(colour, 2.0));
    let [.., before, end] = way else { return };
    let (dx, dy) = (end.x - before.x, end.y - before.y);
    let length = dx.hypot(dy);
    let (u, v) = (dx / length, dy / length);
    let point =
        |along: f64, aside: f64| *end + Px::new(along * u - aside * v, along * v + aside * u);
    let head = [point(6.0, 0.0), point(-5.0, 4.5), point(-5.0, -4.5)];
    scene.polygon(&head, colour, Ink::solid("none", 0.0));
}

/// Width B and semi-chord b under the deck.
fn dimension(scene: &mut Scene) {
    let (left, right) = (CENTRE.x - HALF_WIDTH, CENTRE.x + HALF_WIDTH);
    let thin = Ink::solid(BLACK, 1.0);
    for (level, from, words) in [(285.0, left, "width B"), (310.0, CENTRE.x, "b = B/2")] {
        for x in [from, right] {
            scene.polyline(&[Px::new(x, level - 7.0), Px::new(x, level + 7.0)], thin);
        }
        scene.polyline(&[Px::new(from, level), Px::new(right, level)], thin);
        scene.text(Px::new(right + 10.0, level + 4.0), words, SIZE, BLACK);
    }
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
