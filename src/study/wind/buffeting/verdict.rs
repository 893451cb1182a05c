//! What the self-excited forces of a wind file say of its required speed.

use super::super::quasi_steady::evidence;
use super::{Setting, WindStudy};
use crate::aerodynamics::Transfer;
use crate::error::Result;
use crate::flutter::{OnsetSearch, pk_onset, quasi_steady_onset};
use crate::study::evidence::{add_coefficients, of_theory, saved_evidence};
use crate::verdict::{Evidence, ForceBasis, Verdict};

impl WindStudy {
    /// What the self-excited forces of a wind file can say of its required speed.
    ///
    /// # Errors
    /// As `buffeting_study`.
    pub(crate) fn verdict(&self) -> Result<Verdict> {
        let setting = Setting::new(self)?;
        let search = self.speed_range()?.search();
        let evidence = match (&setting.fixed, &setting.theory) {
            (Some(fixed), _) => setting.evidence(fixed.as_ref(), &search)?,
            (None, Some(theory)) => {
                let name = format!("quasi-steady, {}", theory.coefficients().name);
                let onset = quasi_steady_onset(&name, &setting.structure, theory, &search)?;
                evidence(self, &onset)
            }
            (None, None) => Evidence::default(),
        };
        let mut evidence = Evidence {
            required: self.speeds.required(),
            searched_to_m_s: Some(search.speed_max_m_s),
            implausible: [self.findings(), setting.findings.clone()].concat(),
            ..evidence
        };
        if let (Some(block), Some(theory), true) =
            (&self.coefficients, &setting.theory, setting.fixed.is_some())
        {
            let structure = &setting.structure;
            let found = quasi_steady_onset("static coefficients", structure, theory, &search);
            let added = found.and_then(|found| {
                add_coefficients(
                    &mut evidence,
                    &block.source,
                    structure,
                    theory,
                    &found,
                    setting.angle_deg,
                )
            });
            evidence.failures.extend(added.err().map(of_theory));
        }
        Ok(Verdict::judge(&evidence))
    }
}

impl Setting<'_> {
    /// What forces that do not change with the wind speed answer.
    fn evidence(&self, fixed: &dyn Transfer, search: &OnsetSearch) -> Result<Evidence> {
        let (study, structure) = (self.study, &self.structure);
        if let Some(model) = study.trained_model()? {
            let file = study.directory.join(&study.aerodynamics);
            return saved_evidence(&file, &model, &study.section()?, search);
        }
        let name = study.aerodynamics.as_str();
        let found = pk_onset(name, structure, fixed, search, self.tested)?;
        let Some(range) = self.tested else {
            // a theory, exact as it may be, is no test of this deck
            let mut evidence = Evidence::of_exact(name, structure, fixed, found.of_exact_forces());
            for reading in &mut evidence.flutter {
                reading.basis = ForceBasis::Stated;
            }
            return Ok(evidence);
        };
        Ok(Evidence::of_table(name, structure, fixed, range, found))
    }
}
