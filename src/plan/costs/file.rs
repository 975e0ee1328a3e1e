//! Costs as a file: JSON.

use serde_json::{Map, Value, json};

use super::{CostKey, Costs, Step};
use crate::plan::Evidence;

/// Why a file holds no costs for this machine.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CostsError {
    /// The text is no JSON.
    #[error("costs are no JSON: {0}; write them with `umbrage plan --calibrate -o FILE`")]
    Json(String),
    /// A part is missing, or is not what it has to be.
    #[error("costs have no {0}; write them anew with `umbrage plan --calibrate -o FILE`")]
    Part(String),
    /// The costs are those of another machine.
    #[error("costs of another machine: {}; measure here with `umbrage plan --calibrate -o FILE`", .0.join(", "))]
    Machine(Vec<String>),
}

impl Costs {
    /// The costs as JSON, with the machine that they belong to.
    ///
    /// ```
    /// use umbrage::plan::{CostKey, Costs};
    /// let costs = Costs::default();
    /// assert_eq!(Costs::from_json(&costs.to_json(), &CostKey::here())?, costs);
    /// # Ok::<(), umbrage::plan::CostsError>(())
    /// ```
    #[must_use]
    pub fn to_json(&self) -> String {
        let CostKey { adapter, driver, cpu, threads, version } = &self.key;
        let step = |step: Step| {
            let features = step.features().iter().zip(self.coefficients(step));
            let of_step: Map<String, Value> =
                features.map(|(name, ns)| ((*name).to_owned(), json!(ns))).collect();
            (step.name().to_owned(), Value::Object(of_step))
        };
        let steps: Map<String, Value> = Step::ALL.into_iter().map(step).collect();
        let key = json!({
            "adapter": adapter, "driver": driver, "cpu": cpu, "threads": threads, "version": version,
        });
        let all = json!({ "machine": key, "evidence": self.evidence.name(), "nanoseconds": steps });
        format!("{all:#}\n")
    }

    /// Reads what [`Costs::to_json`] writes.
    ///
    /// # Errors
    ///
    /// [`CostsError`] if the text is not complete, or if the costs are those of another machine.
    pub fn from_json(text: &str, here: &CostKey) -> Result<Self, CostsError> {
        let all: Value = serde_json::from_str(text).map_err(|error| CostsError::Json(error.to_string()))?;
        let part = |name: &str| CostsError::Part(format!("`{name}`"));
        let word = |name: &str| {
            let word = all["machine"][name].as_str();
            word.map(str::to_owned).ok_or_else(|| part(&format!("machine.{name}")))
        };
        let threads = all["machine"]["threads"].as_u64().ok_or_else(|| part("machine.threads"))?;
        let key = CostKey {
            adapter: word("adapter")?,
            driver: word("driver")?,
            cpu: word("cpu")?,
            threads: usize::try_from(threads).unwrap_or(usize::MAX),
            version: word("version")?,
        };
        let differences = key.differences(here);
        if !differences.is_empty() {
            return Err(CostsError::Machine(differences));
        }
        let evidence = [Evidence::Sampled, Evidence::Assumed]
            .into_iter()
            .find(|evidence| all["evidence"].as_str() == Some(evidence.name()));
        let evidence = evidence.ok_or_else(|| part("evidence"))?;
        let mut coefficients = Vec::with_capacity(Step::ALL.len());
        for step in Step::ALL {
            let of_step = step.features().iter().map(|&feature| {
                let ns = all["nanoseconds"][step.name()][feature].as_f64();
                ns.filter(|ns| *ns >= 0.0)
                    .ok_or_else(|| part(&format!("nanoseconds.{}.{feature} from 0 on", step.name())))
            });
            coefficients.push(of_step.collect::<Result<Vec<f64>, _>>()?);
        }
        Ok(Self { evidence, key, coefficients })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_of_another_machine_are_refused_by_name() {
        let here = CostKey::here();
        let text = Costs::default().to_json();
        let there = here.clone().with_adapter("Adapter", "1.2");
        let error = Costs::from_json(&text, &there).unwrap_err().to_string();
        assert!(error.contains("adapter: ``, not `Adapter`, driver: ``, not `1.2`"), "{error}");
        let more = CostKey { threads: here.threads + 1, ..here.clone() };
        let error = Costs::from_json(&text, &more).unwrap_err().to_string();
        assert!(
            error.contains(&format!("threads: `{}`, not `{}`", here.threads, here.threads + 1)),
            "{error}"
        );
    }

    #[test]
    fn costs_that_are_not_complete_are_refused_with_the_part() {
        let here = CostKey::here();
        let text = Costs::default().to_json();
        let error = |text: &str| Costs::from_json(text, &here).unwrap_err().to_string();
        assert!(error("{").starts_with("costs are no JSON: "));
        assert!(error("{}").starts_with("costs have no `machine.threads`"));
        let without = text.replacen("\"ray_steps\"", "\"rays\"", 1);
        assert!(error(&without).contains("`nanoseconds.rays.ray_steps from 0 on`"));
        let mut negative: Value = serde_json::from_str(&text).unwrap();
        negative["nanoseconds"]["tree"]["faces"] = json!(-1.0);
        assert!(error(&negative.to_string()).contains("`nanoseconds.tree.faces from 0 on`"));
    }
}
