//! One name for all fits: what is fitted follows from the data, how from the options.

use super::report::Fitted;
use super::{DiscreteFit, FrequencyFit, TimeFit, fit_discrete, fit_records, fit_table};
use crate::aerodynamics::derivatives::TransferSample;
use crate::error::Result;
use crate::section::Dof;
use crate::wind_tunnel::RecordSource;

/// How a model is fitted to data of a kind.
pub trait FitOptions<Data: ?Sized> {
    /// The model with the account of its fit; see [`fit`].
    ///
    /// # Errors
    /// As [`fit`].
    fn fit(&self, data: &Data) -> Result<Fitted>;
}

/// Fits a model: to samples of `G` by a [`FrequencyFit`], to records by a [`TimeFit`] or a [`DiscreteFit`].
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_fit::*; pub use aerodeck_lab::*; }
/// use aerodeck::files::derivatives::embedded;
/// use aerodeck::identification::{FrequencyFit, TimeFit, fit};
/// use aerodeck::section::Dof;
/// use aerodeck::wind_tunnel::TunnelPlan;
///
/// let table = embedded::deck("LN21-5200")?;
/// let of_table = fit(&table.samples(&Dof::TWO)[..], &FrequencyFit::default())?;
/// let records = TunnelPlan::default().records_from_table(&table, &Dof::TWO)?;
/// let of_records = fit(&records[..], &TimeFit::default())?;
/// assert_eq!(of_table.model.kind(), of_records.model.kind());
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// # Errors
/// As [`fit_table`], [`fit_records`] and [`fit_discrete`], which take more: motions, sources of records that do not fit into memory,
/// and somebody to tell of progress.
pub fn fit<Data: ?Sized>(data: &Data, options: &impl FitOptions<Data>) -> Result<Fitted> {
    options.fit(data)
}

impl FitOptions<[TransferSample]> for FrequencyFit {
    /// Of the motions and forces of the samples.
    fn fit(&self, samples: &[TransferSample]) -> Result<Fitted> {
        let sampled = |d: &Dof| samples.iter().any(|s| s.motion == *d || s.force == *d);
        let dofs: Vec<Dof> = Dof::THREE.into_iter().filter(sampled).collect();
        fit_table(samples, &dofs, self)
    }
}

impl<R: RecordSource> FitOptions<[R]> for TimeFit {
    fn fit(&self, records: &[R]) -> Result<Fitted> {
        fit_records(&sources(records), self, &|_, _| ())
    }
}

impl<R: RecordSource> FitOptions<[R]> for DiscreteFit {
    fn fit(&self, records: &[R]) -> Result<Fitted> {
        fit_discrete(&sources(records), self, &|_, _| ())
    }
}

/// Records as the fits take them.
pub(crate) fn sources<R: RecordSource>(records: &[R]) -> Vec<&dyn RecordSource> {
    records.iter().map(|r| r as &dyn RecordSource).collect()
}
