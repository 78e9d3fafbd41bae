//! The published tables and figures, computed again.

use phicam::lab::Study;
use phicam::lab::published::{
    Item, ItemSummary, ReproducePlan, ReproduceTasks, Verdict, reproduce,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{Raise, input, raised};
use crate::findings::found;
use crate::work::run;

/// Names of the items, in the order in which they are computed.
#[pyfunction]
pub fn published() -> Vec<&'static str> {
    Item::ALL.map(Item::name).to_vec()
}

/// Computes an item; `progress` is told of how much there is to do, and what is done. With it, whether
/// the published statements hold.
#[pyfunction(name = "reproduce")]
#[pyo3(signature = (item, *, most_elements, draws, seed, threads, progress))]
pub fn again<'py>(
    py: Python<'py>,
    item: &str,
    most_elements: usize,
    draws: u64,
    seed: u64,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyDict>, bool)> {
    let item: Item = item.parse().map_err(|e| {
        let cure = format!("use one of {}", published().join(", "));
        input(format!("{e}"), &cure)
    })?;
    let plan = ReproducePlan {
        most_elements,
        seeds: draws,
        first_seed: seed,
    };
    if let Some(call) = progress {
        let all = ReproduceTasks::new(plan, vec![item]).work();
        call.call_method1("of", (all.units(),))?;
    }
    let finding = run(py, threads, progress, move |control| {
        reproduce(item, &plan, control)
    })?;
    let finding = finding.map_err(|e| raised(&e))?;
    let summary = ItemSummary::new(item, &finding, plan.settings(item), Vec::new());
    let holds = matches!(summary.verdict, Verdict::Reproduced | Verdict::InTrend);
    let json = serde_json::to_string_pretty(&summary).raise()?;
    Ok((found(py, &finding, &json)?, holds))
}
