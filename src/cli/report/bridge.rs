//! The page of a whole bridge, from the folder that `bridge flutter` or `demo --bridge` left.

use super::folder::{SUMMARY, digest, parsed};
use super::parts::{card, curves_of, first_derivatives, known, of_svg, round, row, sentence_row};
use super::variables::variables_of;
use crate::cli::bridge::files::{
    BRIDGE_FMU, BUFFETING_PAGE, CURVES, DERIVATIVES_FIGURE, FLUTTER_FIGURE, MOTION_FIGURE,
    RESPONSE_FIGURE, ROOTS_FIGURE,
};
use crate::cli::bridge::summary::{BridgeSummary, ModeFacts, SectionFacts};
use crate::cli::vocabulary::{PageSection, Result, rendered};
use crate::files::bridge::{BridgeFile, DampingRatios};
use crate::fmu::importer::Fmu;
use crate::report::{PageCurve, PageFigure, StudyPage, sections_of, summary_figure};
use crate::study::bridge::ModeShare;
use crate::study::bridge::{LeftOut, NAMED_SHARE};
use std::path::Path;

/// The page of the results in `folder`, whose summary is `text`.
pub(super) fn page(folder: &Path, text: &str, in_the_archive: bool) -> Result<String> {
    let facts: BridgeSummary = parsed(&folder.join(SUMMARY), text)?;
    let file = BridgeFile::from_toml(&facts.bridge_file, folder.to_path_buf())?;
    // what stands there from other runs is not of these results
    let read = |name: &str| {
        let mut files = facts.files.iter();
        files.find(|f| f.file_name().is_some_and(|n| n == name))?;
        std::fs::read(folder.join(name)).ok()
    };
    let text_of = |name: &str| read(name).and_then(|bytes| String::from_utf8(bytes).ok());
    // found in the order of the routes, the model last
    let own = facts.onsets.last();
    let answers = facts.flutter.answers.iter();
    let without = answers.filter(|a| a.search.onset().is_none());
    let without = without.map(|a| sentence_row(&a.forces, "", a.search.explain()));
    let mut page = StudyPage {
        title: facts.bridge.clone(),
        subtitle: "Flutter of a whole bridge",
        kind: "bridge file",
        beyond: "The verdict leaves out amplitudes beyond the tests, turbulence, towers and cables in the wind.",
        generator: facts.generator.clone(),
        of: file.report.dated(facts.date.as_deref()),
        verdict: facts.verdict.clone(),
        card: own.map_or(vec![], card),
        whose: "The verdict is about tables read between their points, where there are some and they reach the onset; the numbers of the card \
                are those of the models of the sections, by the eigenvalues of all modes in the wind. The motion is that of the node that turns most."
            .to_owned(),
        asked: asked(&facts, &file),
        onsets: facts.onsets.iter().map(row).chain(without).collect(),
        comparisons: facts.comparisons.clone(),
        sections: vec![
            taking_part(facts.flutter.shares()),
            fewer(&facts.flutter.left_out, own.map(|o| o.at.speed_m_s)),
        ],
        appendix: vec![data(&facts), modes(&facts)],
        figures: figures(&text_of, &facts.sections),
        command: facts.command.clone(),
        licence: licences(&facts),
        onset: own.map(|o| o.at.speed_m_s),
        interval: own.and_then(|o| known(&o.interval)),
        text: facts.bridge_file.clone(),
        ..StudyPage::default()
    };
    page.derivatives = first_derivatives(&mut page.figures);
    let turbulent = std::fs::read_to_string(folder.join(BUFFETING_PAGE)).unwrap_or_default();
    let key = digest(facts.bridge_file.as_bytes());
    page.taken_up = sections_of(&turbulent, &key).unwrap_or_default();
    page.sections.retain(|s| !s.rows.is_empty());
    if let Some(curves) = text_of(CURVES) {
        let (speeds, curves) = curves_of(&curves, "")?;
        let shown = facts.flutter.shown_modes(own.map(|o| o.branch.as_str()));
        (page.speeds, page.curves) = (speeds, chosen(curves, &shown));
    }
    page.summary = summary_figure(&page)?;
    if read(BRIDGE_FMU).is_some() {
        page.fmu = BRIDGE_FMU.to_owned();
        page.variables = variables_of(&Fmu::open(folder.join(BRIDGE_FMU))?);
    }
    let own = digest(facts.bridge_file.as_bytes());
    page.hashes.push(("bridge file".to_owned(), own));
    let inputs = facts.inputs.iter();
    let inputs = inputs.map(|i| (i.name.clone(), i.sha1.clone()));
    let fmu = (!in_the_archive).then_some(BRIDGE_FMU);
    let files = fmu.into_iter().chain([CURVES]);
    let files = files.filter_map(|name| Some((name.to_owned(), digest(&read(name)?))));
    page.hashes.extend(inputs.chain(files));
    rendered(&page)
}

/// The curves of the modes that are drawn in colour, in the same colours.
fn chosen(curves: Vec<PageCurve>, shown: &[String]) -> Vec<PageCurve> {
    let place = |curve: &PageCurve| {
        let rest = |name: &String| curve.label.strip_suffix(name.as_str());
        let own = |name: &String| rest(name).is_some_and(|rest| rest.ends_with(", "));
        shown.iter().position(own)
    };
    let chosen = curves.into_iter().filter_map(|curve| {
        let model = place(&curve)?;
        Some(PageCurve {
            model,
            branch: 0,
            own: true,
            label: shown[model].clone(),
            ..curve
        })
    });
    let mut all: Vec<PageCurve> = chosen.collect();
    all.sort_by_key(|c| c.model);
    all
}

fn asked(facts: &BridgeSummary, file: &BridgeFile) -> Vec<(&'static str, String)> {
    let damping = match &file.modes.damping_ratio {
        DampingRatios::Same(ratio) => format!("damping ratio {} % each", round(100.0 * ratio)),
        DampingRatios::Each(_) => "damping ratios of their own".to_owned(),
    };
    let wind = match file.wind.profile.len() {
        0 => "the same along the girder, square to it".to_owned(),
        points => format!("a profile along the girder of {points} points, square to it"),
    };
    let (modes, of) = (facts.modes.len(), file.modes.path.display());
    let (highest, speeds) = (file.flutter.speed_max_m_s, file.flutter.speeds);
    let (length, width) = (facts.length_m, facts.width_m);
    let speeds = format!("up to {highest} m/s, {speeds} looked at");
    vec![
        ("girder", format!("{length:.1} m in {} nodes", facts.nodes)),
        ("modes", format!("{modes} of {of}, {damping}")),
        ("air density ρ", format!("{} kg/m³", file.air_density_kg_m3)),
        ("reduced frequency K", format!("ωB/V with B = {width} m")),
        ("wind", wind),
        ("wind speeds", speeds),
    ]
}

fn licences(facts: &BridgeSummary) -> String {
    let sections = facts.sections.iter();
    let first_lines = sections.map(|s| s.licence.lines().next().unwrap_or(""));
    let mut all: Vec<&str> = first_lines.collect();
    all.dedup();
    all.join("; ")
}

fn taking_part(shares: &[ModeShare]) -> PageSection {
    let named = shares.iter().filter(|m| m.energy_share >= NAMED_SHARE);
    let row = |m: &ModeShare| {
        vec![
            m.mode.to_string(),
            format!("{:.4}", m.frequency_hz),
            format!("{:.2}", 100.0 * m.energy_share),
            format!("{:.1}", m.phase_deg),
        ]
    };
    let text =
        "Shares of the kinetic energy at the onset; phases to the mode with the largest share.";
    let title = "Modes that take part in the flutter";
    let header = "mode | f in still air, Hz | share % | phase °";
    PageSection {
        text: vec![text.to_owned()],
        ..PageSection::table(title, header, named.map(row).collect())
    }
}

fn fewer(left_out: &[LeftOut], full: Option<f64>) -> PageSection {
    let row = |l: &LeftOut| {
        let numbers: Vec<String> = l.modes.iter().map(usize::to_string).collect();
        let change = |v: f64, full: f64| format!("{:+.2}", 100.0 * (v / full - 1.0));
        let change = l.onset_m_s.zip(full).map(|(v, full)| change(v, full));
        let onset = l.onset_m_s.map(|v| format!("{v:.3}"));
        vec![
            format!("{}", 100.0 * l.below_share),
            numbers.join(", "),
            onset.unwrap_or("no flutter".to_owned()),
            change.unwrap_or("–".to_owned()),
        ]
    };
    let header = "share from, % | modes | V m/s | change %";
    let rows = left_out.iter().map(row).collect();
    PageSection::table("Onset with fewer modes", header, rows)
}

fn data(facts: &BridgeSummary) -> PageSection {
    let row = |s: &SectionFacts| {
        let tested = s.tested_range.map_or("–".to_owned(), |r| {
            format!("{:.3} to {:.3}", r.min.full_width(), r.max.full_width())
        });
        vec![
            s.name.clone(),
            s.width_m.to_string(),
            tested,
            s.source.clone(),
            s.licence.lines().next().unwrap_or("").to_owned(),
        ]
    };
    let header = "section | B m | tested K = ωB/V | forces from | licence";
    let rows = facts.sections.iter().map(row).collect();
    PageSection::table("Sections and their data", header, rows)
}

fn modes(facts: &BridgeSummary) -> PageSection {
    let row = |m: &ModeFacts| {
        vec![
            m.mode.to_string(),
            format!("{:.4}", m.frequency_hz),
            mass(m.generalised_mass),
            format!("{:.3}", 100.0 * m.damping_ratio),
            m.main_motion.clone(),
        ]
    };
    PageSection {
        title: "Modes in still air".to_owned(),
        text: vec!["Generalised masses belong to the shapes as they were read.".to_owned()],
        header: "mode | f Hz | generalised mass, kg | ζ % | main motion",
        rows: facts.modes.iter().map(row).collect(),
        ..PageSection::default()
    }
}

/// A mass in plain digits where it has few.
fn mass(kg: f64) -> String {
    match kg {
        _ if (1e-2..1e12).contains(&kg) => {
            let unit = 10f64.powf(kg.log10().floor() - 4.0);
            round((kg / unit).round() * unit).to_string()
        }
        _ => format!("{kg:.4e}"),
    }
}

fn figures(read: &dyn Fn(&str) -> Option<String>, sections: &[SectionFacts]) -> Vec<PageFigure> {
    let drawn =
        |stem: &str, title: &str, caption| of_svg(&read(&format!("{stem}.svg"))?, title, caption);
    let of_section = |(i, section): (usize, &SectionFacts)| {
        drawn(
            &format!("{DERIVATIVES_FIGURE}{}", i + 1),
            &format!("Derivatives of {}: measured and modelled", section.name),
            "Points: measured. Line: the model, where it was tested. Bars: its 95 % interval.",
        )
    };
    let of_bridge = [
        (
            FLUTTER_FIGURE,
            "Frequency and damping over wind speed",
            "In colour the modes with the largest shares of the kinetic energy at the onset, the one that flutters with the widest line; grey \
             the others that take part. The lowest panel magnifies the damping where it is lost.",
        ),
        (
            ROOTS_FIGURE,
            "Root locus",
            "Eigenvalues of the same modes as the wind rises; right of the upright line motions grow.",
        ),
        (
            MOTION_FIGURE,
            "Motion at flutter",
            "Displacements along the girder at two moments a quarter of a period T apart; rotations count with half the width.",
        ),
        (
            RESPONSE_FIGURE,
            "Motion below, at and above the onset",
            "The mode that flutters, released with a rotation of 1° where the girder turns most. The scale is that of the motions that \
             do not grow.",
        ),
    ];
    let of_bridge = of_bridge.into_iter();
    let of_bridge = of_bridge.filter_map(|(stem, title, caption)| drawn(stem, title, caption));
    let sections = sections.iter().enumerate().filter_map(of_section);
    sections.chain(of_bridge).collect()
}
