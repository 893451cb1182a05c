//! `aerodeck campaign virtual`: a raw campaign with a known truth.

use crate::aerodynamics::{FlatPlate, RationalModel};
use crate::cli::vocabulary::{Answer, Dof, Error, OutputDir, Progress, Result, spelt};
use crate::files::derivatives::named_table;
use crate::wind_tunnel::campaign::{FileFormat, write_virtual_campaign};
use crate::wind_tunnel::virtual_campaign::{VirtualCampaign, VirtualCampaignPlan};
use clap::builder::PossibleValue;
use std::path::{Path, PathBuf};

/// Invent the raw campaign of a known deck: two load cells, gravity, inertia, wind, noise, drift, a spike, lags
///
/// Example: aerodeck campaign virtual LN21-5200 --out campaign
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct VirtualCampaignArgs {
    /// Name of an embedded deck, `flat plate`, `jones`, or a table of derivatives (.csv, .xlsx).
    #[arg(default_value = "LN21-5200")]
    deck: String,
    /// Where the campaign goes.
    #[arg(long, default_value = "aerodeck-campaign")]
    out: PathBuf,
    /// A plan (TOML); left out, a realistic one. What it does not state is without disturbances.
    #[arg(long)]
    plan: Option<PathBuf>,
    /// Without noise, drift, spike, lag and offset.
    #[arg(long)]
    clean: bool,
    /// Noise as a fraction of the RMS of the self-excited forces, instead of the plan's.
    #[arg(long)]
    noise: Option<f64>,
    /// Seed of everything random, instead of the plan's.
    #[arg(long)]
    seed: Option<u64>,
    /// Also sway and drag (tables only).
    #[arg(long)]
    lateral: bool,
    /// Width of the model for a deck that has none (`flat plate`, `jones`), m.
    #[arg(long, default_value_t = 0.5)]
    width: f64,
    /// How the recordings are written.
    #[arg(long, default_value = "csv", value_parser = spelt::<FileFormat>(formats()))]
    format: FileFormat,
    /// Replace a campaign file and a plan that differ from what is written.
    #[arg(long)]
    force: bool,
}

/// How the recordings are written.
fn formats() -> [PossibleValue; 2] {
    [
        PossibleValue::new("csv").help("One CSV file per recording; reads back bit for bit"),
        PossibleValue::new("ntnu").help("One HDF5 file in the layout of NTNU's tools"),
    ]
}

/// Runs the command.
pub(crate) fn run(args: &VirtualCampaignArgs, progress: &Progress) -> Result<Answer> {
    let plan = plan(args)?;
    let made = progress.during("virtual campaign", || make(args, &plan))?;
    let mut out = OutputDir::new(&args.out)?;
    let stage = progress.stage("writing the recordings");
    out.write("plan.toml", plan.to_toml()?)?;
    write_virtual_campaign(&made, args.format, &mut |name| out.stage(name))?;
    for name in ["plan.toml", "campaign.toml"] {
        out.refuse_edited(name, args.force, "choose another --out")?;
    }
    drop(stage);
    let mut text = format!("{}: {}\n", made.raw.section, made.raw.source);
    for run in &made.raw.runs {
        let (name, speed) = (&run.name, run.mean_speed_m_s);
        let (count, rate) = (run.in_wind.sample_count(), run.in_wind.sampling_hz);
        text += &format!(
            "  {name}: {speed:.2} m/s, {count} samples at {rate} Hz in wind and in still air\n"
        );
    }
    let findings = plan.tunnel.findings().into_iter();
    text.extend(findings.map(|finding| format!("  note: {finding}\n")));
    let value = serde_json::json!({
        "section": made.raw.section,
        "runs": made.disturbances,
        "plan": plan,
    });
    out.answer(text, value)
}

fn plan(args: &VirtualCampaignArgs) -> Result<VirtualCampaignPlan> {
    let mut plan = match (&args.plan, args.clean) {
        (Some(path), _) => VirtualCampaignPlan::read(path)?,
        (None, true) => VirtualCampaignPlan::default(),
        (None, false) => VirtualCampaignPlan::realistic(),
    };
    if args.clean {
        plan.tunnel.noise_fraction = 0.0;
        plan.disturbances = Default::default();
    }
    if let Some(noise) = args.noise {
        plan.tunnel.noise_fraction = noise;
    }
    if let Some(seed) = args.seed {
        plan.tunnel.seed = seed;
    }
    plan.validate()?;
    Ok(plan)
}

fn make(args: &VirtualCampaignArgs, plan: &VirtualCampaignPlan) -> Result<VirtualCampaign> {
    let name = args.deck.trim();
    let refuse_lateral = || {
        if args.lateral {
            let expected = "a table of derivatives, since sway is asked for";
            return Err(Error::input("deck", expected, name));
        }
        Ok(())
    };
    match name.to_lowercase().as_str() {
        "flat plate" => {
            refuse_lateral()?;
            plan.from_model(&FlatPlate::default(), "flat plate", args.width)
        }
        "jones" => {
            refuse_lateral()?;
            plan.from_model(&RationalModel::jones_flat_plate(), "Jones", args.width)
        }
        _ => {
            let table = named_table(name, Path::new(""))?;
            let dofs: &[Dof] = if args.lateral { &Dof::THREE } else { &Dof::TWO };
            plan.from_table(&table, dofs)
        }
    }
}
