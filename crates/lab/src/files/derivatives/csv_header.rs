//! Head of a file of derivatives: where the table comes from, in which convention it is written, and what stands for what it lacks.

use crate::aerodynamics::derivatives::notation::{Argument, Axes, Convention, Notation};
use crate::aerodynamics::derivatives::{Derivative, DerivativePoint, Missing, TableHeader};
use crate::error::{Error, Result};
use crate::files::derivatives::StatedConvention;
use crate::files::header_csv::{CommentHeader, HeaderLine};
use std::collections::BTreeMap;
use std::io::Write;

/// Sign convention and scaling of every table of this project, as written in the header of its files.
pub(super) const SIGN_CONVENTION: &str = "y and lift up, theta and moment nose-up, x and drag downwind; q = G r with q = F/(rho V^2 B/2), M/(rho V^2 B^2/2), r = (y/B, x/B, theta); G_yy = K^2 (H4 + i H1), G_ytheta = K^2 (H3 + i H2), G_thetay = K^2 (A4 + i A1), G_thetatheta = K^2 (A3 + i A2)";

/// Units of the columns, as written in the header of the files.
pub(super) const UNITS: &str =
    "mean_speed_m_s in m/s; v_hat = V/(omega B) = 1/K and value dimensionless";

/// What a file of derivatives does not say of itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Name of the deck of a workbook; `None` takes the file name without `AerodynamicDerivatives_` and extension.
    pub name: Option<String>,
    /// Notation, argument and axes; what the file states must not contradict them.
    pub convention: StatedConvention,
    /// Width of the section model, m; `None` takes it from the file, or derives it from `frequencies_hz`.
    pub width_m: Option<f64>,
    /// Frequencies of motion of a workbook in test order, Hz, repeated for every further speed, from which its width follows; `None` tries
    /// those of Table 3.2.
    pub frequencies_hz: Option<Vec<f64>>,
    /// What stands for H4*, A4* when there are none; zero when nothing is stated.
    pub missing: Option<Missing>,
    /// Provenance of a workbook; an empty `source` is filled with the file name, an empty `generator` with this program.
    pub header: TableHeader,
}

/// What is said when nothing gives the width.
pub const WIDTH_ASSUMED: &str = "the width of the section model is not stated and does not follow from the table: 1 m is assumed, which affects only the \
     frequencies of virtual records (`width_m` states it)";

/// First line of the file: the one that is written, and that of files whose convention could only be the crate's own.
const FORMATS: [&str; 2] = ["aerodeck derivative table 2", "aerodeck derivative table 1"];

/// Keys of the header; `sign_convention` stands in files of the first format only.
const KEYS: [&str; 16] = [
    "name",
    "source",
    "licence",
    "units",
    "sign_convention",
    "generator",
    "width_m",
    "model_length_m",
    "angle_deg",
    "rotation_amplitude_deg",
    "notation",
    "argument",
    "axes",
    "definition",
    "note",
    "doubt",
];

/// Keys that may stand more than once.
const REPEATED: [&str; 2] = ["note", "doubt"];

/// Units of the columns in files of the second format.
const UNITS_WRITTEN: &str =
    "mean_speed_m_s in m/s; reduced velocity or frequency and value dimensionless";

/// Reads the comment lines at the head of `text`, a file of derivatives.
pub(super) fn read_head(text: &str) -> Result<CommentHeader> {
    CommentHeader::read(text, &FORMATS, &KEYS, &REPEATED)
}

/// What the header says about the convention.
///
/// # Errors
/// [`Error::Input`] with the line that says what cannot be, or contradicts another.
pub(super) fn stated(head: &CommentHeader) -> Result<StatedConvention> {
    let mut stated = StatedConvention::default();
    if head.optional("sign_convention").is_some() {
        head.must_say("sign_convention", SIGN_CONVENTION)?;
        stated = Convention::default().into();
    }
    if let Some(entry) = head.optional("units")
        && ![UNITS, UNITS_WRITTEN].contains(&entry.value.as_str())
    {
        return Err(entry.wrong(&format!("`{UNITS_WRITTEN}`")));
    }
    stated.notation = read_one::<Notation>(head.optional("notation"), stated.notation)?;
    stated.argument = read_one::<Argument>(head.optional("argument"), stated.argument)?;
    stated.axes = read_one::<Axes>(head.optional("axes"), stated.axes)?;
    if let Some(definition) = head.optional("definition") {
        let notation = stated.notation.ok_or_else(|| {
            let expected = "a line `# notation: …` with it";
            Error::input(definition.place(), expected, "none")
        })?;
        if definition.value != notation.definition() {
            let expected = format!("that of {notation}, `{}`", notation.definition());
            return Err(definition.wrong(&expected));
        }
    }
    Ok(stated)
}

/// Width `B`, m, if the file or the caller states it; they may not contradict each other.
pub(super) fn width_stated(head: &CommentHeader, stated: Option<f64>) -> Result<Option<f64>> {
    let stated = stated.map(|width| crate::error::positive("width_m", width));
    let stated = stated.transpose()?;
    let Some(entry) = head.optional("width_m") else {
        return Ok(stated);
    };
    let width = entry.positive()?;
    match stated {
        Some(other) if other != width => Err(entry.wrong(&format!("{other} as stated on import"))),
        _ => Ok(Some(width)),
    }
}

/// Where the table comes from.
pub(super) fn provenance(head: &CommentHeader) -> Result<TableHeader> {
    let texts = |key| head.all(key).map(|e| e.value.clone()).collect();
    let stated = |key| head.optional(key).filter(|e| !e.value.is_empty());
    let positive = |key| stated(key).map(HeaderLine::positive).transpose();
    Ok(TableHeader {
        source: head.text("source"),
        licence: head.text("licence"),
        generator: head.text("generator"),
        model_length_m: positive("model_length_m")?,
        angle_deg: stated("angle_deg").map(angle_deg).transpose()?,
        rotation_amplitude_deg: positive("rotation_amplitude_deg")?,
        notes: texts("note"),
        doubts: texts("doubt"),
    })
}

/// The mean angle of tests; beyond a right angle it is in another unit.
fn angle_deg(entry: &HeaderLine) -> Result<f64> {
    let angle = entry.number()?;
    match angle.abs() <= 90.0 {
        true => Ok(angle),
        false => Err(entry.wrong("an angle between -90 and 90 degrees")),
    }
}

/// Reads one entry, which may not contradict what is known already.
fn read_one<T>(entry: Option<&HeaderLine>, known: Option<T>) -> Result<Option<T>>
where
    T: std::str::FromStr<Err = Error> + PartialEq + std::fmt::Display,
{
    let Some(entry) = entry else { return Ok(known) };
    let parsed = entry.value.parse();
    let value: T = parsed.map_err(|e: Error| e.at(entry.place()))?;
    match known {
        Some(known) if known != value => {
            Err(entry.wrong(&format!("`{known}` as the line sign_convention says")))
        }
        _ => Ok(Some(value)),
    }
}

/// Writes the header of a table in `convention`.
pub(super) fn write_head(
    out: &mut dyn Write,
    name: &str,
    width_m: f64,
    header: &TableHeader,
    convention: &Convention,
) -> std::io::Result<()> {
    let length = header.model_length_m.map(|l| l.to_string());
    let length = length.unwrap_or_default();
    let width = width_m.to_string();
    let entries = [
        ("name", name),
        ("source", &header.source),
        ("licence", &header.licence),
        ("notation", convention.notation.name()),
        ("argument", convention.argument.definition()),
        ("axes", convention.axes.words()),
        ("definition", convention.notation.definition()),
        ("units", UNITS_WRITTEN),
        ("generator", &header.generator),
        ("width_m", &width),
        ("model_length_m", &length),
    ];
    CommentHeader::write(out, FORMATS[0], &entries)?;
    for (key, value) in [
        ("angle_deg", header.angle_deg),
        ("rotation_amplitude_deg", header.rotation_amplitude_deg),
    ] {
        if let Some(value) = value {
            CommentHeader::write_line(out, key, value)?;
        }
    }
    for (key, texts) in [("note", &header.notes), ("doubt", &header.doubts)] {
        for text in texts {
            CommentHeader::write_line(out, key, text)?;
        }
    }
    Ok(())
}

/// Fills in `H4*`, `A4*` where the other derivatives of their row are there; a note says so.
pub(super) fn fill_in(
    points: &mut BTreeMap<Derivative, Vec<DerivativePoint>>,
    stated: Option<Missing>,
) -> Option<String> {
    use Derivative::{A1, A2, A4, H1, H2, H4};
    let by = stated.unwrap_or_default();
    let mut filled = Vec::new();
    for (missing, rate, rotation) in [(H4, H1, H2), (A4, A1, A2)] {
        let source = if by == Missing::Zero { rate } else { rotation };
        if points.contains_key(&missing) {
            continue;
        }
        let Some(from) = points.get(&source) else {
            continue;
        };
        let mut own = from.clone();
        for p in &mut own {
            p.value = match by {
                Missing::Zero => 0.0,
                Missing::QuasiSteady => p.value * p.k().full_width(),
            };
        }
        points.insert(missing, own);
        filled.push(match by {
            Missing::Zero => format!("{missing}*"),
            Missing::QuasiSteady => format!("{missing}* = K {rotation}*"),
        });
    }
    if filled.is_empty() {
        return None;
    }
    let words = filled.join(", ");
    Some(match (by, stated) {
        (Missing::Zero, None) => format!(
            "the table does not hold {words}: taken as zero, since nothing is stated (`missing` = \"zero\" or \
             \"quasi_steady\")"
        ),
        (Missing::Zero, _) => format!("the table does not hold {words}: taken as zero, as stated"),
        (Missing::QuasiSteady, _) => format!(
            "the table does not hold H4*, A4* in full: {words} taken, quasi-steady, as stated"
        ),
    })
}
