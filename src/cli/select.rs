//! `aerodeck select`: how many filters, with which pole or decay factor.

mod text;

use super::stages::{MODELS, Stages};
use super::vocabulary::{
    Answer, Error, FlutterSearch, OutputDir, Progress, Recommendation, Result, Study, StudyArgs,
    Written, ensure, list,
};
use crate::identification::{DiscreteFit, Form, Grid, GridAxis, PoleSearch, TimeFit, TimeWeights};
use crate::selection::{Selection, metric_grid, select};
use crate::signal::extremes;
use crate::study::{Deck, ModelBlock, RecordSet};
use crate::units::in_equal_ratios;
use crate::wind_tunnel::RecordSource;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
pub(super) use text::parameter_maps;
use text::{figures, text};

/// More values of a pole than any figure shows.
const MOST_VALUES: usize = 2000;
/// Frequency at which forces are compared, Hz.
const FREQUENCY_HZ: f64 = 1.1;
/// Name of the recommended model in a study.
pub(crate) const SELECTED: &str = "selected";

/// Choose the number of filters and their pole (or decay factor) by the error on records left out
///
/// Example: aerodeck select study.toml --filters 8 --values 25 --write selected.toml
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct SelectArgs {
    #[command(flatten)]
    study: StudyArgs,
    #[command(flatten)]
    choice: Choice,
    /// Frequency of motion near which forces are compared, Hz; by default 1.1.
    #[arg(long)]
    frequency: Option<f64>,
    /// Write a study with the recommended model in front of the others under this name, beside the study.
    #[arg(long, value_name = "NAME", num_args = 0..=1, default_missing_value = "selected.toml")]
    write: Option<PathBuf>,
    /// Replace a study that differs from the one of --write.
    #[arg(long)]
    force: bool,
}

/// Among which models is chosen.
#[derive(clap::Args)]
pub(crate) struct Choice {
    /// Continuous filters over `L` and `p`, or the thesis's discrete ones over `L` and `α`.
    #[arg(long, value_enum, default_value_t = ModelKind::Continuous)]
    kind: ModelKind,
    /// Greatest number of filters.
    #[arg(long, default_value_t = 8)]
    filters: usize,
    /// Number of values of the pole or decay factor.
    #[arg(long, default_value_t = 25)]
    values: usize,
    /// Lowest value; by default half the lowest tested K, or α = 0.2.
    #[arg(long)]
    min: Option<f64>,
    /// Highest value; by default twice the highest tested K, or α = 0.98.
    #[arg(long)]
    max: Option<f64>,
}

impl Default for Choice {
    fn default() -> Self {
        Self {
            kind: ModelKind::Continuous,
            filters: 8,
            values: 25,
            min: None,
            max: None,
        }
    }
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum ModelKind {
    Continuous,
    Discrete,
}

/// Runs the command.
pub(crate) fn run(args: &SelectArgs, progress: &Progress) -> Result<Answer> {
    let study = args.study.read()?;
    let deck = Deck::load(&study)?;
    let made = study.deck.records.is_empty();
    let all = match made {
        true => RecordSet::in_memory(deck.virtual_records(&study)?),
        false => RecordSet::measured(&study)?,
    };
    let records = all.select(study.deck.speed_groups.as_deref().filter(|_| !made))?;
    let note = all.note.as_ref().map(|n| format!("note: {n}\n"));
    let frequency_hz = compared_frequency_hz(args.frequency, &records)?;
    let (grid, selection) = judge(&args.choice, &study, &deck, &records, progress)?;
    let work = || metric_grid(&grid, &records, frequency_hz);
    let metrics = progress.during("comparing forces", work)?;
    let mut out = OutputDir::new(&args.study.directory())?;
    for (stem, figure) in figures(&study, &selection, &metrics)? {
        super::figures::write(stem, &mut out, || Ok(figure))?;
    }
    let mut written = out.commit()?;
    let note = note.unwrap_or_default();
    let head = format!("{}\n{}\n{note}\n", study.name, deck.description());
    let mut text = head + &text(&selection, &metrics);
    if let Some(name) = &args.write {
        match recommended(&args.choice, &study, &selection) {
            Ok(block) => written.extend(write_study(args, &study, block, name)?),
            Err(reason) => {
                let _ = writeln!(text, "no study is written: {reason}");
            }
        }
    }
    text.push_str(&list(&written));
    let value = serde_json::json!({ "selection": selection, "metrics": metrics, "files": written });
    Answer::new(text, &value)
}

/// The frequency that was asked for, which is among those that were tested.
fn compared_frequency_hz(asked: Option<f64>, records: &[&dyn RecordSource]) -> Result<f64> {
    let Some(asked) = asked else {
        return Ok(FREQUENCY_HZ);
    };
    let tested = records.iter().flat_map(|r| &r.header().segments);
    let (low, high) = extremes(tested.map(|s| s.frequency_hz));
    // records without segments have no forces to compare, which is said of them
    let within = low > high || (0.99 * low..=1.01 * high).contains(&asked);
    let expected = format_args!("a frequency of the tests, {low:.2} to {high:.2} Hz");
    ensure(within, "--frequency", expected, asked)?;
    Ok(asked)
}

/// All cells of the grid, judged, and the onset of the table of the deck beside that of the recommended model.
fn judge(
    choice: &Choice,
    study: &Study,
    deck: &Deck,
    records: &[&dyn RecordSource],
    progress: &Progress,
) -> Result<(Grid, Selection)> {
    let axis = axis(choice, study, records)?;
    let grid = progress.counting("fitting the grid", |on_done| {
        Grid::new(records, axis, choice.filters, on_done)
    })?;
    let (structure, search) = (study.section.structure()?, study.speeds().search());
    let mut selection = progress.counting("judging the cells", |on_done| {
        select(&grid, &structure, &search, on_done)
    })?;
    let own = deck.table();
    let own = own.map(|_| deck.own_onset(&structure, search.speed_max_m_s));
    if let Some(Ok(FlutterSearch::Onset(own))) = own {
        selection.put_beside(own.at.speed_m_s);
    }
    Ok((grid, selection))
}

impl Stages<'_> {
    /// Puts the recommended model in front of the study, where `select = true` asks for one, and says what speaks for it; that key is
    /// done with.
    pub(super) fn select(&mut self, records: Option<&RecordSet>) -> Result<Option<Recommendation>> {
        let Some(records) = records.filter(|_| self.study.select) else {
            return Ok(None);
        };
        let selected = self.selected(records);
        match self.attempt("selection", selected)? {
            Some((study, recommended)) => {
                self.study = study;
                Ok(recommended)
            }
            // that of an earlier run is not of these records
            None => {
                let file = format!("{}.json", selected_block().slug());
                self.out.outdated(Path::new(MODELS).join(file));
                Ok(None)
            }
        }
    }

    fn selected(&self, records: &RecordSet) -> Result<(Study, Option<Recommendation>)> {
        let (study, choice) = (&self.study, Choice::default());
        let chosen = records.select(study.deck.speed_groups.as_deref())?;
        let (_, selection) = judge(&choice, study, &self.deck, &chosen, self.progress)?;
        let block = recommended(&choice, study, &selection)?;
        Ok((in_front(study, block), selection.recommended))
    }
}

/// The study with the model that `train` has selected, where it asks for one, among those to be read.
pub(crate) fn with_saved(study: Study) -> Study {
    match study.select {
        true => in_front(&study, selected_block()),
        false => study,
    }
}

fn selected_block() -> ModelBlock {
    ModelBlock {
        name: SELECTED.to_owned(),
        ..ModelBlock::default()
    }
}

fn in_front(study: &Study, block: ModelBlock) -> Study {
    let mut study = study.clone();
    study.select = false;
    study.models.retain(|m| m.slug() != block.slug());
    study.models.insert(0, block);
    study
}

/// The recommended model as a block of a study, or why there is none.
fn recommended(choice: &Choice, study: &Study, selection: &Selection) -> Result<ModelBlock> {
    let none = || Error::Numerical(selection.reason.clone());
    let found = selection.recommended.as_ref().ok_or_else(none)?;
    let mut block = selected_block();
    if choice.kind == ModelKind::Discrete {
        let given = study.models.iter().find_map(|m| m.discrete.clone());
        block.discrete = Some(DiscreteFit {
            filters: found.filters,
            alpha: found.value,
            own: Vec::new(),
            ..given.unwrap_or_default()
        });
    } else {
        let fit = records_fit(study);
        block.records = Some(TimeFit {
            form: Form::Laguerre {
                filters: Some(found.filters),
                feed_through: fit.form.feed_through(),
                pole_per_transfer_function: false,
            },
            poles: PoleSearch::fixed(&[found.value]),
            own: Vec::new(),
            ..fit
        });
    }
    Ok(block)
}

/// How the study fits models to records.
fn records_fit(study: &Study) -> TimeFit {
    let given = study.models.iter().find_map(|m| m.records.clone());
    given.unwrap_or_default()
}

/// Paths in a study are read against its folder, so that is where the new one goes.
fn write_study(
    args: &SelectArgs,
    study: &Study,
    block: ModelBlock,
    name: &Path,
) -> Result<Vec<Written>> {
    let expected = "a name without a folder: paths in the study are read against its own";
    let alone = name.components().count() == 1;
    ensure(alone, "--write", expected, name.display())?;
    let text =
        toml::to_string(&in_front(study, block)).map_err(|e| Error::Numerical(e.to_string()))?;
    let from = args.study.study.display();
    let mut out = OutputDir::new(&args.study.beside())?;
    let head = format!("# {from} with the model that `aerodeck select` recommends.\n");
    out.write(name, head + &text)?;
    out.keep_edited(name, args.force)?;
    out.commit()
}

/// Values of the pole, logarithmic over the range of the pole searches; or of the decay factor.
fn axis(choice: &Choice, study: &Study, records: &[&dyn RecordSource]) -> Result<GridAxis> {
    let expected = format_args!("a number from 2 to {MOST_VALUES}");
    let several = (2..=MOST_VALUES).contains(&choice.values);
    ensure(several, "--values", expected, choice.values)?;
    let last = choice.values as f64 - 1.0;
    if choice.kind == ModelKind::Discrete {
        let (low, high) = (choice.min.unwrap_or(0.2), choice.max.unwrap_or(0.98));
        let ordered = 0.0 < low && low < high && high < 1.0;
        let expected = "two decay factors between 0 and 1, the lower one first";
        let found = format_args!("{low} and {high}");
        ensure(ordered, "--min, --max", expected, found)?;
        let given = study.models.iter().find_map(|m| m.discrete.as_ref());
        let weights = given.map_or(TimeWeights::None, |d| d.weights);
        let values = (0..choice.values).map(|i| low + (high - low) * i as f64 / last);
        return Ok(GridAxis::Discrete(values.collect(), weights));
    }
    let ks = records.iter().flat_map(|r| {
        let h = r.header();
        let rate = h.mean_speed_m_s / h.width_m;
        h.segments
            .iter()
            .map(move |s| std::f64::consts::TAU * s.frequency_hz / rate)
    });
    let (low, high) = ks.fold((f64::INFINITY, 0.0_f64), |(a, b), k| (a.min(k), b.max(k)));
    let low = choice.min.unwrap_or(0.5 * low);
    let high = choice.max.unwrap_or(2.0 * high);
    let ordered = low > 0.0 && high > low && high.is_finite();
    let expected = "two poles, the lower one first (needed for records without segments)";
    let found = format_args!("{low} and {high}");
    ensure(ordered, "--min, --max", expected, found)?;
    let values = in_equal_ratios(low, high, choice.values);
    Ok(GridAxis::Continuous(
        values.collect(),
        Box::new(records_fit(study)),
    ))
}
