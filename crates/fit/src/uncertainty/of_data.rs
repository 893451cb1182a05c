//! What the data of a model say: its fit, how far they leave it open, and other forms that explain them as well.

use super::{CoefficientUncertainty, FormEnsemble};
use super::{discrete_uncertainty, record_uncertainty, table_uncertainty};
use crate::aerodynamics::derivatives::TransferSample;
use crate::error::Result;
use crate::identification::{
    DiscreteFit, Fitted, FrequencyFit, TimeFit, fit_discrete, fit_records, fit_table,
};
use crate::numbered::OnDone;
use crate::section::Dof;
use crate::wind_tunnel::RecordSource;

/// A fit with all that its data leave open. What cannot be estimated takes the fit with it no more than the forms do.
pub struct ModelOfData {
    /// The model and the account of its fit.
    pub fitted: Fitted,
    /// How far they leave the coefficients open.
    pub estimate: Result<CoefficientUncertainty>,
    /// Other forms for the same data; none for a model in discrete time, whose bias is known.
    pub forms: Result<Option<FormEnsemble>>,
}

impl ModelOfData {
    /// Of a table; what `deck`, where it is an embedded one, says of the scatter between mean speeds is left out, for it is no witness
    /// of its own.
    ///
    /// # Errors
    /// Those of [`fit_table`].
    pub fn of_table(
        samples: &[TransferSample],
        dofs: &[Dof],
        fit: &FrequencyFit,
        deck: Option<&str>,
    ) -> Result<Self> {
        let fitted = fit_table(samples, dofs, fit)?;
        let estimate = table_uncertainty(samples, dofs, fit, &fitted.report, deck);
        let own = |f: &FrequencyFit| (f == fit).then(|| fitted.clone());
        let forms = FormEnsemble::new(samples, dofs, &own).map(Some);
        Ok(Self {
            fitted,
            estimate,
            forms,
        })
    }

    /// Of records, with the forms that fit the derivatives they show; `deck` as for a table.
    ///
    /// # Errors
    /// Those of [`fit_records`].
    pub fn of_records(
        records: &[&dyn RecordSource],
        dofs: &[Dof],
        fit: &TimeFit,
        deck: Option<&str>,
        progress: OnDone<'_>,
    ) -> Result<Self> {
        let own = || -> Result<(Fitted, Result<CoefficientUncertainty>)> {
            let fitted = fit_records(records, fit, progress)?;
            let estimate = record_uncertainty(records, fit, &fitted.report, deck, progress);
            Ok((fitted, estimate))
        };
        // the order of every matrix, whatever that of the channels
        let mut dofs = dofs.to_vec();
        dofs.sort();
        let others = || FormEnsemble::of_records(records, &dofs).map(Some);
        let (own, forms) = rayon::join(own, others);
        let (fitted, estimate) = own?;
        Ok(Self {
            fitted,
            estimate,
            forms,
        })
    }

    /// Of records in discrete time.
    ///
    /// # Errors
    /// Those of [`fit_discrete`].
    pub fn of_discrete(
        records: &[&dyn RecordSource],
        fit: &DiscreteFit,
        deck: Option<&str>,
        progress: OnDone<'_>,
    ) -> Result<Self> {
        let fitted = fit_discrete(records, fit, progress)?;
        let estimate = discrete_uncertainty(records, fit, &fitted.model, deck, progress);
        Ok(Self {
            fitted,
            estimate,
            forms: Ok(None),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::Transfer;
    use crate::aeroelastic::CoupledSection;
    use crate::files::derivatives::embedded;
    use crate::flutter::{OnsetSearch, find_onset};
    use crate::section::SectionModel;
    use crate::uncertainty::{AdmissibleForm, ModelUncertainty};
    use crate::wind_tunnel::TunnelPlan;

    /// Channels in another order are the same data: the forms that explain them are the same.
    #[test]
    fn the_order_of_channels_is_no_matter() {
        let plan = TunnelPlan {
            segment_s: 8.0,
            sampling_hz: 50.0,
            ..TunnelPlan::default()
        };
        let table = embedded::deck("LN21-5200").unwrap();
        let mut records = plan.records_from_table(&table, &Dof::TWO).unwrap();
        let mut forms = Vec::new();
        for _ in 0..2 {
            let sources: Vec<&dyn RecordSource> = records.iter().map(|r| r as _).collect();
            let dofs = sources[0].header().dofs.clone();
            let fit = TimeFit::default();
            let of = ModelOfData::of_records(&sources, &dofs, &fit, None, &|_, _| ()).unwrap();
            let found = of.forms.unwrap().unwrap().fits;
            let in_order = |f: &AdmissibleForm| f.model.dofs() == Dof::TWO;
            assert!(found.iter().all(in_order));
            forms.push(found.into_iter().map(|f| f.form).collect::<Vec<_>>());
            for record in &mut records {
                record.header.dofs.reverse();
                record.motion.reverse();
                record.force.reverse();
            }
        }
        assert_eq!(forms[0], forms[1]);
    }

    /// That mean speeds contradict each other is said of another onset too, also by a file, which no longer knows its tests.
    #[test]
    fn contradictions_outlive_their_file() {
        let table = embedded::deck("LN21-6100").unwrap();
        let (samples, fit) = (table.samples(&Dof::TWO), FrequencyFit::default());
        let of = ModelOfData::of_table(&samples, &Dof::TWO, &fit, None).unwrap();
        let structure = SectionModel::table_4_1().structure().unwrap();
        let section = CoupledSection::with_model(&structure, &of.fitted.model).unwrap();
        let (search, tested) = (OnsetSearch::up_to(60.0), of.fitted.report.tested_range);
        let found = find_onset("6100", &section, &search, Some(tested)).unwrap();
        let onset = found.onset().unwrap();
        let estimate = of.estimate.unwrap();
        let known = ModelUncertainty::new(estimate, &structure, Some(onset), search, tested);
        let known = known.unwrap();
        let said = known.warning().unwrap();
        let mut other = onset.clone();
        other.at.speed_m_s *= 1.01;
        assert!(known.warning_of(&structure, &other).is_some());
        let read = ModelUncertainty::from_json(&known.to_json().unwrap()).unwrap();
        assert_eq!(read.warning_of(&structure, &other), Some(said));
    }
}
