//! All critical speeds at once against eigenvalues at many speeds.

use aerodeck::aerodynamics::{Lags, RationalModel};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::derivatives::embedded;
use aerodeck::flutter::{GrowthBand, OnsetSearch, growth_scan, unwanted_growth};
use aerodeck::identification::{Constraints, Fitted, FrequencyFit, fit_table};
use aerodeck::section::{Dof, SectionModel, Translation};

const SPEED_MAX: f64 = 60.0;

/// A stream of numbers from −1 to 1.
struct NoiseStream(u64);

impl NoiseStream {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A section about that of Table 4.1, every third with sway, with forces about those of a plate that are far enough from it to
/// grow in bands, to recover, and to be unstable from still air on.
fn section(noise: &mut NoiseStream) -> CoupledSection {
    let mut section = SectionModel::table_4_1();
    let mut around = |x: f64, part: f64| x * (1.0 + part * noise.next());
    section.vertical.frequency_hz = Some(around(2.0, 0.4));
    section.torsion.frequency_hz = Some(around(3.5, 0.4));
    section.vertical.damping_ratio = around(0.003, 0.9);
    section.torsion.damping_ratio = around(0.003, 0.9);
    let mut model = RationalModel::jones_flat_plate();
    model.a1.apply(|x| *x = around(*x, 0.8));
    model.a2.apply(|x| *x = around(*x, 1.2));
    let mut lags = vec![around(0.091, 0.5), around(0.6, 0.5)];
    for lag in &mut model.lag_terms {
        lag.apply(|x| *x = around(*x, 1.5));
    }
    let more = model.lag_terms[0].map(|x| around(x, 2.0));
    model.lag_terms.push(more);
    lags.push(around(1.5, 0.7));
    if around(1.0, 1.0) < 0.67 {
        section.lateral = Some(Translation {
            frequency_hz: Some(around(1.5, 0.6)),
            ..section.vertical.clone()
        });
        let wider = |m: &nalgebra::DMatrix<f64>, around: &mut dyn FnMut(f64, f64) -> f64| {
            nalgebra::DMatrix::from_fn(3, 3, |i, j| match (i, j) {
                (1, 1) => around(-0.5, 1.0),
                (1, _) | (_, 1) => around(0.1, 8.0),
                _ => m[(i / 2, j / 2)],
            })
        };
        model.a1 = wider(&model.a1, &mut around);
        model.a2 = wider(&model.a2, &mut around);
        model.a3 = nalgebra::DMatrix::from_fn(3, 3, |i, j| match (i, j) {
            (1, _) | (_, 1) => 0.0,
            _ => model.a3[(i / 2, j / 2)],
        });
        model.lag_terms = model
            .lag_terms
            .iter()
            .map(|m| wider(m, &mut around))
            .collect();
        model.dofs = Dof::THREE.to_vec();
    }
    model.lags = Lags::Shared(lags);
    CoupledSection::with_model(&section.structure().unwrap(), &model).unwrap()
}

/// Growth of an oscillation above rounding, or well below; `None` between.
fn grows(section: &CoupledSection, speed: f64) -> Option<bool> {
    let all = section.at(speed).unwrap().eigenvalues().unwrap();
    let oscillating = all.iter().filter(|z| z.im > 1e-6 * z.norm());
    let fastest = oscillating
        .map(|z| z.re / z.norm())
        .fold(f64::MIN, f64::max);
    (fastest.abs() > 1e-8).then_some(fastest > 0.0)
}

/// Speeds of `count` at which the bands say another thing than the eigenvalues.
fn contradictions(
    section: &CoupledSection,
    bands: &[GrowthBand],
    count: usize,
    noise: &mut NoiseStream,
) -> usize {
    let inside = |v: f64| bands.iter().any(|b| b.from_m_s <= v && v <= b.to_m_s);
    let speeds = (0..count).map(|i| {
        let part = (i as f64 + 0.5 + 0.5 * noise.next()) / count as f64;
        // half of them in slow wind
        if i % 2 == 0 {
            SPEED_MAX * part
        } else {
            0.1 * (SPEED_MAX / 0.1).powf(part)
        }
    });
    speeds
        .filter(|v| grows(section, *v).is_some_and(|g| g != inside(*v)))
        .count()
}

/// Sections, bands found, and speeds that contradict them.
fn compare(sections: usize, speeds: usize) -> (usize, usize) {
    let mut noise = NoiseStream(0x9E37_79B9_7F4A_7C15);
    let (mut bands, mut wrong) = (0, 0);
    for i in 0..sections {
        let section = section(&mut noise);
        let found = growth_scan(&section, SPEED_MAX, None).unwrap();
        let against = contradictions(&section, &found, speeds, &mut noise);
        if against > 0 {
            println!("section {i}: {against} of {speeds} speeds contradict {found:?}");
        }
        bands += found.len();
        wrong += usize::from(against > 0);
    }
    (bands, wrong)
}

/// A few hundred sections; `AERODECK_LONG=1` takes a hundred thousand.
#[test]
fn no_growth_is_missed() {
    let long = std::env::var_os("AERODECK_LONG").is_some();
    let sections = if long { 100_000 } else { 400 };
    let begin = std::time::Instant::now();
    let (bands, wrong) = compare(sections, 60);
    println!(
        "{sections} sections, {bands} bands, {wrong} contradicted, {:?}",
        begin.elapsed()
    );
    assert!(bands > sections / 2, "{bands}");
    assert_eq!(wrong, 0);
}

/// Bands of unconstrained fits, by a prototype in another language and its sweeps of 6000 speeds: begin and end of growth in slow
/// wind, and the flutter.
#[test]
fn bands_of_measured_decks() {
    for (deck, section, expected) in [
        (
            "LN20-5500",
            SectionModel::iabse_1_1a(),
            [6.2214, 17.9783, 69.4835],
        ),
        (
            "LN21-5500",
            SectionModel::table_4_1(),
            [1.1282, 2.1759, 37.7626],
        ),
    ] {
        let table = embedded::deck(deck).unwrap();
        let fit = FrequencyFit {
            constraints: Constraints::None,
            ..FrequencyFit::default()
        };
        let Fitted { model, .. } = fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &fit).unwrap();
        let coupled = CoupledSection::with_model(&section.structure().unwrap(), &model).unwrap();
        let bands = growth_scan(&coupled, 90.0, None).unwrap();
        let [slow, flutter] = &bands[..] else {
            panic!("{deck}: {bands:?}")
        };
        let found = [slow.from_m_s, slow.to_m_s, flutter.from_m_s];
        for (found, expected) in found.iter().zip(expected) {
            // four printed decimals
            assert!(
                (found - expected).abs() < 6e-5,
                "{deck}: {found} {expected}"
            );
        }
    }
}

/// A scan of a section is a statement about all speeds and says so; that of a sampled model is not.
#[test]
fn what_is_proved_is_said_to_be() {
    let structure = SectionModel::table_4_1().structure().unwrap();
    let plate = RationalModel::jones_flat_plate();
    let coupled = CoupledSection::with_model(&structure, &plate).unwrap();
    let search = OnsetSearch {
        speed_max_m_s: 60.0,
        speeds: 120,
    };
    let growth = unwanted_growth(&coupled, &search, None).unwrap();
    assert!(growth.proved && growth.explain().ends_with("proved for the model"));
}
