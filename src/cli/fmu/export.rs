//! `aerodeck fmu export`: a trained model as an FMU, a bridge, or a part of one.

mod bridge;

use crate::aerodynamics::RationalAdmittance;
use crate::cli::vocabulary::{
    Answer, Error, Export, Label, Progress, Result, Runtime, TrainedModel, Verdict, ensure,
    in_input, sentences, spelt, warn,
};
use crate::cli::{headline, stages, text};
use crate::files::coefficients::gust_force;
use crate::flutter::OnsetSearch;
use crate::fmu::force_options::{ForceOptions, MAX_STRIPS};
use crate::fmu::onset_bounds::OnsetBounds;
use crate::fmu::package::{FmiVersion, growth_of, package, write_archive};
use crate::plausibility::of_model;
use crate::study::saved_evidence;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Pack a trained model (`model.json`) or a bridge as an FMU (FMI 2.0 or 3.0): with its forces, or the forces alone
///
/// Example: aerodeck fmu export model.json --out deck_section.fmu
/// Example: aerodeck fmu export bridge.toml --bridge --nodes 1001,1156
/// Example: aerodeck fmu export bridge.toml --bridge --kind force --out bridge_force.fmu
/// Example: aerodeck fmu export bridge.toml --bridge --kind force --section "side span" --out side_span.fmu
/// Example: aerodeck fmu export model.json --kind force --strips 40 --strip-length 25 --out force.fmu
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct FmuExportArgs {
    /// The trained model, or the bridge file with --bridge.
    model: PathBuf,
    /// Pack a whole bridge: the file is a bridge file (see docs/bridge.md).
    #[arg(long)]
    bridge: bool,
    /// Nodes of a bridge with inputs and outputs; left out, mid-span and both quarter points, of the structure alone all.
    #[arg(long, value_delimiter = ',', requires = "bridge")]
    nodes: Vec<String>,
    /// What is packed: the section of the model (with --bridge the whole bridge) with its forces, or its forces alone, or with
    /// --bridge the structure alone.
    #[arg(long, value_enum, default_value_t = ExportKind::Section)]
    kind: ExportKind,
    /// The section of a bridge whose forces are packed [default: all sections in one archive].
    #[arg(long, requires = "bridge")]
    section: Option<String>,
    /// Number of strips of a force FMU, with variables named strip[1].heave …; by default one strip with plain names.
    #[arg(long)]
    strips: Option<usize>,
    /// Length of each strip, m [default: 1].
    #[arg(long)]
    strip_length: Option<f64>,
    /// How far ahead of the motion a force FMU puts its forces out, in communication steps: 1.5 for an importer that
    /// holds them over its next step, others in docs/coupling.md [default: 1.5].
    #[arg(long)]
    prediction: Option<f64>,
    /// List real variables only, for importers that do not accept strings, Booleans or integers.
    #[arg(long)]
    reals_only: bool,
    /// Platforms to pack for [default: all whose runtime is here]; arm-linux makes an archive for importers on 64-bit
    /// ARM Linux, which look for it in linux64. wasm32-wasip2, a component for WebAssembly (FMI 3.0 alone), is packed
    /// where it is named.
    #[arg(long, value_delimiter = ',', value_name = "PLATFORM")]
    platforms: Vec<String>,
    /// Take gusts as inputs, whose forces follow from these static coefficients: a table (CSV), an embedded one, or
    /// `flat plate`; for the forces on a bridge `static`, those of the bridge file.
    #[arg(long, value_name = "TABLE")]
    gusts: Option<String>,
    /// Add gust inputs for this many strips of a bridge, each a group of neighbouring nodes; their forces follow from the
    /// `static` coefficients of its sections.
    #[arg(long, value_name = "COUNT", requires = "bridge")]
    gust_strips: Option<usize>,
    /// Turbulence that blows on a bridge and goes into its archive: a file as `bridge buffeting --field` or TurbSim (`.bts`) writes it.
    #[arg(long, value_name = "FILE", requires = "bridge")]
    turbulence: Option<PathBuf>,
    /// Admittance of the gusts [default: none].
    #[arg(long, value_parser = spelt::<RationalAdmittance>(["none", "sears", "liepmann"]))]
    admittance: Option<RationalAdmittance>,
    /// Version of FMI.
    #[arg(long, default_value = "2", value_parser = PossibleValuesParser::new(["2", "3"]).map(version))]
    fmi: FmiVersion,
    /// Name of the model to the importer [default: that of the trained model].
    #[arg(long)]
    name: Option<String>,
    /// Who is responsible for the FMU.
    #[arg(long)]
    author: Option<String>,
    /// Copyright holder of the FMU.
    #[arg(long)]
    copyright: Option<String>,
    /// The FMU; by default `deck_section.fmu` or `deck_force.fmu` beside the model, `bridge.fmu`, `bridge_force.fmu` or
    /// `bridge_structure.fmu` beside the bridge file.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Replace a file that is there.
    #[arg(long)]
    force: bool,
    /// Export a model that grows below its onset, at reduced frequencies that were not tested.
    #[arg(long)]
    allow_unstable: bool,
    /// Leave out the reference runs, which `fmu replay` repeats.
    #[arg(long)]
    no_reference: bool,
}

/// What is packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum ExportKind {
    Section,
    Force,
    Structure,
}

fn version(number: String) -> FmiVersion {
    match number.as_str() {
        "3" => FmiVersion::Three,
        _ => FmiVersion::Two,
    }
}

impl FmuExportArgs {
    /// Packs what is exported and writes the archive, in place of another only with --force, as `file` beside the input where no other
    /// place is named; where it stands, and for which platforms.
    fn packed(
        &self,
        model: &TrainedModel,
        export: Export,
        file: &str,
    ) -> Result<(PathBuf, Vec<Runtime>)> {
        let label = Label {
            name: self.name.clone().or(export.label.name),
            author: self.author.clone(),
            copyright: self.copyright.clone(),
            generated: None,
        };
        let export = Export {
            label: label.dated()?,
            version: self.fmi,
            reals_only: self.reals_only,
            without_reference_runs: self.no_reference,
            ..export
        };
        let runtimes = match &self.platforms[..] {
            [] => Runtime::available()?,
            chosen => Runtime::chosen(chosen)?,
        };
        let bytes = package(model, &runtimes, export).map_err(stages::or_allow_unstable)?;
        let beside = || self.model.with_file_name(file);
        let path = self.out.clone().unwrap_or_else(beside);
        write_archive(&path, &bytes, self.force).map_err(|e| match e {
            Error::Input(mut input) if !self.force => {
                input.expected.push_str(" (or --force)");
                Error::Input(input)
            }
            other => other,
        })?;
        Ok((path, runtimes))
    }

    /// The options of a force FMU.
    fn force(&self, model: &TrainedModel) -> Result<Option<ForceOptions>> {
        let mut options = ForceOptions::single(model.section.width_m);
        if self.kind == ExportKind::Section {
            let expected =
                "--kind force with it: a coupled section has no strips and no prediction";
            let given = [
                ("--strips", self.strips.is_some(), expected),
                ("--strip-length", self.strip_length.is_some(), expected),
                ("--prediction", self.prediction.is_some(), expected),
            ];
            return none_of(given, "--kind section").map(|()| None);
        }
        options.strips[0].length_m = self.strip_length.unwrap_or(options.strips[0].length_m);
        options.prediction_steps = self.prediction.unwrap_or(options.prediction_steps);
        if let Some(count) = self.strips {
            options.named_strips = true;
            let some = (1..=MAX_STRIPS).contains(&count);
            ensure(some, "--strips", format_args!("1 to {MAX_STRIPS}"), count)?;
            options.strips = vec![options.strips[0].clone(); count];
        }
        options.validate()?;
        Ok(Some(options))
    }
}

/// Refuses the first of the flags that is given, with what is expected instead, where `kind` is packed.
fn none_of<const N: usize>(flags: [(&str, bool, &str); N], kind: &str) -> Result<()> {
    match flags.into_iter().find(|(_, given, _)| *given) {
        None => Ok(()),
        Some((flag, _, expected)) => Err(Error::input(flag, expected, kind)),
    }
}

/// Runs the command.
pub(super) fn run(args: &FmuExportArgs, progress: &Progress) -> Result<Answer> {
    if args.bridge {
        let of_bridge = args.of_bridge(progress);
        return of_bridge.map_err(|e| in_input(&args.model, &[], e));
    }
    let expected = "--bridge with it: the structure of a section is its mass, spring and damper";
    let other = args.kind != ExportKind::Structure;
    ensure(other, "--kind structure", expected, "a trained model")?;
    let model = stages::read_model(&args.model)?;
    let coupled = args.kind == ExportKind::Section;
    let search = OnsetSearch::up_to(model.experiment.onset_search_limit_m_s);
    let evidence = match saved_evidence(&args.model, &model, &model.section, &search) {
        Ok(evidence) => Some(evidence),
        Err(why) if coupled => return Err(why),
        // forces are forces, whatever the section does
        Err(why) => {
            let why = format!("the section of the model is not judged: {why}");
            warn(&args.model, &[why]);
            None
        }
    };
    let verdict = evidence.as_ref().map(Verdict::judge);
    let findings = match verdict {
        // has them among its doubts
        Some(_) => Vec::new(),
        None => of_model(&model.name, &model.model, model.tested_range, &[]),
    };
    warn(&args.model, &sentences(&findings));
    let bounds = evidence.as_ref().filter(|_| coupled).and_then(|e| {
        let onset = e.flutter.first()?.search.onset()?;
        OnsetBounds::from_interval(&onset.interval)
    });
    let export = Export {
        force: args.force(&model)?,
        gusts: gust_force(
            args.gusts.as_deref(),
            args.admittance,
            &model.section.dofs(),
        )?,
        bounds,
        verdict: verdict.clone(),
        allow_unstable: args.allow_unstable,
        ..Export::default()
    };
    let strips = export.force.as_ref().map(|f| f.strips.len());
    let file = match coupled {
        true => stages::FMU_FILE,
        false => "deck_force.fmu",
    };
    let packing = || args.packed(&model, export, file);
    let (path, runtimes) = progress.during("packing the FMU", packing)?;
    let growth = growth_of(&model)?;
    let platforms: Vec<_> = runtimes.iter().map(|r| r.platform).collect();
    let headline = verdict.iter().map(|v| headline::text(&model.name, v, &[]));
    let mut text: String = headline.collect();
    let of = match strips {
        None => String::new(),
        Some(1) => "forces on one strip of ".to_owned(),
        Some(n) => format!("forces on {n} strips of "),
    };
    let (name, kind, all) = (&model.name, model.model.kind(), platforms.join(", "));
    text += &format!("wrote {}: {of}{name}, {kind}, for {all}\n", path.display());
    text.push_str(&text::growth(&model.name, &growth));
    if strips.is_some() && verdict.is_some() {
        text.push_str("the verdict is on the section that the model states, not on a structure that takes its forces\n");
    }
    if let Some(axis) = model.section.axis_offset_m.filter(|_| strips.is_some()) {
        let _ = writeln!(
            text,
            "motion and forces are those of the reference point: a structure that turns about the axis of this section, a = {axis} m from there, positive downwind, gives y + a·θ and takes M + a·F_y (docs/coupling.md)"
        );
    }
    let value = serde_json::json!({ "fmu": path, "strips": strips, "model": model.name, "platforms": platforms, "growth": growth, "verdict": verdict, "findings": findings });
    Answer::new(text, &value)
}
