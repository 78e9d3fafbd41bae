//! A run in short, for programs.

use serde_json::{Value, json};

use crate::lab::{RecoveredObject, RunResults, Tails};
use crate::num::summation::root_mean_square;
use crate::store::harmless_json;

/// What a run found, without any matrix, as indented JSON. What is absent or not a finite number is
/// `null`. Fluxes in W, times in s.
pub fn summary_json(results: &RunResults) -> String {
    let (scene, plan) = (&results.scene, &results.plan);
    let recovered = |r: &RecoveredObject| {
        json!({
            "surface": r.surface,
            "method": r.method,
            "elements": r.elements,
            "mtf": { "raw": r.mtf_raw, "normalized": r.mtf_normalized },
            "correlation": r.correlation,
            "rmse": r.rmse,
            "parameter": r.parameter,
            "determined": r.determined,
            "fit": r.fit,
            "best_fit": r.best_fit,
            "warnings": r.warnings,
            "effective_rank": r.effective_rank,
            "rms_standard_error": r.standard_error.as_ref().map(|s| root_mean_square(s)),
        })
    };
    let bounces = results
        .bounces
        .iter()
        .map(|(n, share)| json!({ "surfaces": n, "share": share }));
    let times = results
        .times
        .iter()
        .map(|(stage, s)| json!({ "stage": stage, "seconds": s }));
    let value = json!({
        "verdict": results.verdict(),
        "scene": {
            "name": scene.name,
            "hash": scene.hash,
            "unit": scene.unit.symbol(),
            "max_bounces": scene.max_bounces,
        },
        "settings": {
            "version": results.version,
            "estimator": plan.estimator,
            "sampler": plan.sampling,
            "seed": plan.seed,
            "samples": plan.budget.samples(),
            "blocks": plan.budget.blocks,
        },
        "phi": {
            "pixels": results.phi.nrows(),
            "spots": results.phi.ncols(),
            "total": results.phi.sum(),
            "relative_stderr": results.relative_stderr(),
            "tails": Tails::of(&results.tails),
        },
        "agreement": results.agreement,
        "bounces": bounces.collect::<Vec<Value>>(),
        "recovered": results.recovered.iter().map(recovered).collect::<Vec<Value>>(),
        "times": times.collect::<Vec<Value>>(),
    });
    // A `Value` always has a JSON text.
    harmless_json(&format!("{value:#}\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::sample::{bare, run};

    #[test]
    fn json_parses_back_and_has_no_matrix() {
        let results = run("bench");
        let value: Value = serde_json::from_str(&summary_json(&results)).unwrap();
        assert_eq!(value["scene"]["name"], "bench");
        assert_eq!(value["scene"]["hash"], results.scene.hash.as_str());
        assert_eq!(value["settings"]["seed"].as_u64(), Some(u64::MAX));
        assert_eq!(value["agreement"]["chi2_per_dof"].as_f64(), Some(1.003));
        assert_eq!(
            value["recovered"][1]["mtf"]["raw"].as_f64(),
            results.recovered[1].mtf_raw
        );
        assert_eq!(value["phi"]["total"].as_f64(), Some(results.phi.sum()));
        assert!(value["recovered"][0].get("reflectance").is_none());
        assert!(summary_json(&results).len() < 20_000);
    }

    #[test]
    fn json_of_a_run_without_model_or_with_nonsense_still_parses() {
        let mut results = bare("furnace");
        results.phi[(0, 0)] = f64::NAN;
        let value: Value = serde_json::from_str(&summary_json(&results)).unwrap();
        assert!(value["agreement"].is_null() && value["phi"]["total"].is_null());
    }
}
