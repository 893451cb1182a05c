//! Figures of cases with known answers: well-formed, complete, the same bytes every time.

use aerodeck::aerodynamics::derivatives::Derivative;
use aerodeck::aerodynamics::derivatives::Part;
use aerodeck::aerodynamics::{FlatPlate, RationalModel, Realizable, Transfer};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::derivatives::embedded;
use aerodeck::flutter::{
    FlutterCurves, Onset, OnsetSearch, determinant_onset, find_onset, trace_modes,
};
use aerodeck::report::{
    DerivativePlot, Figure, PlottedSeries, TimePanel, derivatives_figure, time_history_figure,
    vf_vg_figure,
};
use aerodeck::response::{Inputs, Outputs, Stepper};
use aerodeck::section::{Dof, SectionModel};
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
use aerodeck::verdict::{Divergence, Evidence, RequiredSpeed, Verdict};
use quick_xml::events::Event;
use std::f64::consts::TAU;
use std::path::Path;

/// A verdict against a required speed, which divergence below it does not meet.
fn required(speed_m_s: f64) -> Verdict {
    let below = Divergence::at("the model", Some(0.9 * speed_m_s));
    Verdict::judge(&Evidence {
        required: Some(RequiredSpeed { speed_m_s }),
        divergence: vec![below],
        ..Evidence::default()
    })
}

fn jones(section: &SectionModel) -> CoupledSection {
    let model = RationalModel::jones_flat_plate().realize();
    CoupledSection::new(section.structure().unwrap(), model).unwrap()
}

fn jones_curves(name: &str, section: &SectionModel, speed_max_m_s: f64) -> FlutterCurves {
    let speeds: Vec<f64> = (0..=120)
        .map(|i| speed_max_m_s * f64::from(i) / 120.0)
        .collect();
    trace_modes(name, &jones(section), &speeds).unwrap()
}

fn jones_onset(name: &str, section: &SectionModel, speed_max_m_s: f64) -> Onset {
    let search = OnsetSearch {
        speed_max_m_s,
        speeds: 60,
    };
    let found = find_onset(name, &jones(section), &search, None).unwrap();
    found.onset().unwrap().clone()
}

fn plate_onset(section: &SectionModel) -> Onset {
    let range = ReducedFrequencyRange::between(
        ReducedFrequency::from_full_width(0.02),
        ReducedFrequency::from_full_width(10.0),
    );
    let plate = FlatPlate {
        rotary_inertia: false,
    };
    let structure = section.structure().unwrap();
    let found = determinant_onset("flat plate (Theodorsen)", &structure, &plate, range, 200.0);
    found.unwrap().onset().unwrap().clone()
}

/// All texts of a figure, which must be well-formed XML; collects identifiers on the way.
fn texts(figure: &Figure) -> (Vec<String>, Vec<String>) {
    let mut reader = quick_xml::Reader::from_str(figure.svg());
    let (mut texts, mut ids) = (Vec::new(), Vec::new());
    let mut text = String::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Start(tag) | Event::Empty(tag) => {
                for attribute in tag.attributes() {
                    let attribute = attribute.unwrap();
                    if attribute.key.as_ref() == "id" {
                        ids.push(attribute.value.to_string());
                    }
                }
                text.clear();
            }
            Event::Text(part) => text.push_str(&part),
            Event::GeneralRef(name) => text.push(match &*name {
                "amp" => '&',
                "lt" => '<',
                "gt" => '>',
                "quot" => '"',
                "apos" => '\'',
                other => panic!("entity {other}"),
            }),
            Event::End(tag) if tag.name().as_ref() == "text" => texts.push(text.clone()),
            Event::Eof => return (texts, ids),
            _ => {}
        }
    }
}

/// Checks what every figure must fulfil, and leaves it in the directory of test files for looking at.
#[track_caller]
fn check(figure: &Figure, again: &Figure, stem: &str, labels: &[&str]) {
    assert_eq!(figure.svg(), again.svg(), "two drawings differ");
    let (found, ids) = texts(figure);
    for label in labels {
        assert!(
            found.iter().any(|t| t == label),
            "{label:?} not in {found:?}"
        );
    }
    let mut unique = ids.clone();
    unique.sort();
    unique.dedup();
    assert_eq!(unique.len(), ids.len(), "identifiers are used twice");

    let path = figure
        .write(Path::new(env!("CARGO_TARGET_TMPDIR")), stem)
        .unwrap();
    assert_eq!(std::fs::read_to_string(path).unwrap(), figure.svg());
    #[cfg(feature = "png")]
    check_image(figure, again);
}

/// The image is the drawing, pixel by pixel of its `viewBox`, and the same every time.
#[cfg(feature = "png")]
fn check_image(figure: &Figure, again: &Figure) {
    use resvg::tiny_skia::Pixmap;
    let drawn = |figure: &Figure, scale: f64| figure.png(scale).unwrap();
    assert_eq!(drawn(figure, 2.0), drawn(again, 2.0), "two images differ");
    let size = |image: Pixmap| (image.width(), image.height());
    let of_scale = |scale: f64| size(Pixmap::decode_png(&drawn(figure, scale)).unwrap());
    let (width, height) = of_scale(1.0);
    assert_eq!(of_scale(2.0), (2 * width, 2 * height));
    let view_box = format!("viewBox=\"0 0 {width} {height}\"");
    assert!(figure.svg().contains(&view_box));
}

#[test]
fn vf_vg_of_the_iabse_deck() {
    let section = SectionModel::iabse_1_1a();
    let mut heavier = section.clone();
    heavier.torsion.inertia_kg_m2_m *= 1.2;
    let names = ["flat plate, Jones", "Jones, inertia & frequency < plan"];
    let curves = [
        jones_curves(names[0], &section, 100.0),
        jones_curves(names[1], &heavier, 100.0),
    ];
    let mut outside = jones_onset(names[1], &heavier, 120.0);
    outside.in_tested_range = Some(false);
    outside.spurious_speeds_m_s = vec![12.0];
    let onsets = [
        jones_onset(names[0], &section, 120.0),
        plate_onset(&section),
        outside,
    ];
    let title = "IABSE TG 3.1, step 1.1a";
    let draw = || vf_vg_figure(&curves, &onsets, title, Some(&required(80.0))).unwrap();
    check(
        &draw(),
        &draw(),
        "vf_vg_iabse",
        &[
            "IABSE TG 3.1, step 1.1a",
            "Wind speed V (m/s)",
            "Frequency f (Hz)",
            "Damping ratio ζ (%)",
            names[0],
            names[1],
            "vertical mode",
            "torsion mode",
            "required 80.00 m/s: NOT MET",
            "onset outside the tested range",
            "probably spurious crossing",
            "77.48 m/s",
            "Onset V = 77.48 m/s, f = 0.1940 Hz, V/(fB) = 12.88: flat plate (Theodorsen), torsion mode (determinant)",
        ],
    );
}

#[test]
fn vf_vg_of_table_4_1() {
    let section = SectionModel::table_4_1();
    let curves = [jones_curves("flat plate, Jones", &section, 45.0)];
    let onsets = [jones_onset("flat plate, Jones", &section, 60.0)];
    let draw = || vf_vg_figure(&curves, &onsets, "", None).unwrap();
    check(
        &draw(),
        &draw(),
        "vf_vg_table_4_1",
        &["flat plate, Jones", "vertical mode", "torsion mode"],
    );
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let none = vf_vg_figure(&[], &[], "", None).unwrap_err();
    assert_eq!(
        none.to_string(),
        "flutter curves: expected at least one mode, found none"
    );
    let mut curves = [jones_curves("Jones", &SectionModel::table_4_1(), 30.0)];
    curves[0].branches[1].points[2].damping_ratio = f64::NAN;
    let message = vf_vg_figure(&curves, &[], "", None)
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "V-f and V-g diagram, Jones, torsion mode: expected finite numbers, found (0.5, NaN) at point 3"
    );
    curves[0].branches[1].points.clear();
    let message = vf_vg_figure(&curves, &[], "", None)
        .unwrap_err()
        .to_string();
    assert!(message.ends_with("torsion mode: expected points, found none"));
    let figure = vf_vg_figure(
        &[jones_curves("Jones", &SectionModel::table_4_1(), 30.0)],
        &[],
        "",
        None,
    )
    .unwrap();
    #[cfg(feature = "png")]
    for scale in [0.0, -1.0, f64::NAN, 1e6] {
        assert!(figure.png(scale).is_err());
    }
    assert!(figure.write("no/such/directory", "x").is_err());
}

/// A derivative of a two-degree-of-freedom model over V* = V/(fB): G/K².
fn line(label: &str, model: &dyn Transfer, derivative: Derivative, v_max: f64) -> PlottedSeries {
    let index = |dof: Dof| usize::from(dof == Dof::Torsion);
    let points = (1..=60).map(|i| {
        let v_star = v_max * f64::from(i) / 60.0;
        let k = TAU / v_star;
        let g = model
            .transfer(ReducedFrequency::from_full_width(k))
            .unwrap();
        let entry = g[(index(derivative.force()), index(derivative.motion()))];
        let value = match derivative.part() {
            Part::Real => entry.re,
            Part::Imaginary => entry.im,
        };
        (v_star, value / (k * k))
    });
    PlottedSeries::new(label, points.collect())
}

#[test]
fn derivatives_of_two_and_three_degrees_of_freedom() {
    let table = embedded::deck("LN21-5200").unwrap();
    let measured = |d: Derivative| {
        let points = table.points(d).iter();
        PlottedSeries::new(
            "wind tunnel, LN21-5200",
            points.map(|p| (TAU * p.v_hat, p.value)).collect(),
        )
    };
    let plate = FlatPlate {
        rotary_inertia: false,
    };
    let jones = RationalModel::jones_flat_plate();
    let two = |d: &Derivative| d.force() != Dof::Lateral && d.motion() != Dof::Lateral;
    let figure = |all: &[DerivativePlot]| {
        let title = "Aerodynamic derivatives of the Langenuen deck & flat plate";
        derivatives_figure(title, "V* = V/(fB)", "95 % interval", all)
    };
    let plot = |derivatives: Vec<Derivative>, lines: bool| -> Vec<DerivativePlot> {
        derivatives
            .into_iter()
            .map(|d| DerivativePlot {
                name: d.name().to_owned(),
                measured: vec![measured(d)],
                bars: if lines {
                    vec![(10.0, -1.0, 1.0)]
                } else {
                    Vec::new()
                },
                fitted: if lines {
                    vec![line("Jones, rational function", &jones, d, 25.0)]
                } else {
                    Vec::new()
                },
                reference: if lines {
                    vec![line("flat plate (Theodorsen)", &plate, d, 25.0)]
                } else {
                    Vec::new()
                },
            })
            .collect()
    };
    let eight = plot(table.derivatives().filter(two).collect(), true);
    assert_eq!(eight.len(), 8);
    let draw = || figure(&eight).unwrap();
    let labels = [
        "Aerodynamic derivatives of the Langenuen deck & flat plate",
        "V* = V/(fB)",
        "wind tunnel, LN21-5200",
        "Jones, rational function",
        "flat plate (Theodorsen)",
        "H₁*",
        "A₄*",
    ];
    check(&draw(), &draw(), "derivatives_8", &labels);
    let eighteen = plot(table.derivatives().collect(), false);
    assert_eq!(eighteen.len(), 18);
    let draw = || figure(&eighteen).unwrap();
    check(&draw(), &draw(), "derivatives_18", &["P₁*", "H₆*", "A₆*"]);

    let mut broken = eight.clone();
    broken[3].measured.clear();
    broken[3].fitted.clear();
    broken[3].reference.clear();
    broken[3].bars.clear();
    assert!(figure(&broken).is_err());
    broken.clear();
    assert!(figure(&broken).is_err());
    let mut broken = eight;
    broken[7].measured[0].points[1].1 = f64::INFINITY;
    assert!(figure(&broken).is_err());
}

#[test]
fn time_history_of_table_4_1() {
    let mut stepper = Stepper::new(jones(&SectionModel::table_4_1()));
    let mut panels = [("Heave y (m)", 0), ("Rotation θ (rad)", 1)].map(|(label, dof)| {
        let panel = TimePanel {
            y_label: label.into(),
            series: Vec::new(),
        };
        (panel, dof)
    });
    for (label, speed) in [("30 m/s", 30.0), ("40 m/s", 40.0)] {
        let inputs = Inputs::steady(speed, 2);
        let mut state = stepper.released(&[0.02, 0.05], &[0.0, 0.0]).unwrap();
        let mut histories = [Vec::new(), Vec::new()];
        for i in 0..=6000 {
            let mut out = Outputs::default();
            stepper.outputs(&state, &inputs, &mut out).unwrap();
            for (history, y) in histories.iter_mut().zip(&out.displacement) {
                history.push((0.001 * f64::from(i), *y));
            }
            stepper.advance(&mut state, &inputs, 0.001).unwrap();
        }
        for (panel, dof) in &mut panels {
            let points = std::mem::take(&mut histories[*dof]);
            panel.series.push(PlottedSeries::new(label, points));
        }
    }
    let panels = panels.map(|(panel, _)| panel);
    let draw = || time_history_figure("Release from 20 mm and 0.05 rad", &panels, "Time t (s)");
    let labels = ["Heave y (m)", "Rotation θ (rad)", "Time t (s)", "30 m/s"];
    check(&draw().unwrap(), &draw().unwrap(), "time_history", &labels);
    assert!(time_history_figure("", &[], "t").is_err());
    let mut broken = panels;
    broken[0].series[1].points[100].0 = f64::NAN;
    assert!(time_history_figure("", &broken, "t").is_err());
}
