//! Whether the brightest entries are what is left over, as where values are clipped or not linear.

use super::descent::{Problem, State};
use super::geometry::Light;
use crate::lab::error::LabError;

/// Share of the entries that are the brightest.
const SHARE: f64 = 0.01;

impl Problem<'_> {
    /// Mean of (y − Aρ̂)/σ of the brightest photographed entries; chosen by y they lie above Aρ̂
    /// by their noise, and below it only where bright light is too weak. All as bright as the last
    /// of these count too. None of noise that is not stated, along cosines, and of photographs less
    /// their means.
    pub(super) fn brightest(&self, best: &State, light: &Light) -> Result<Option<f64>, LabError> {
        let photographs = self.photographs;
        if photographs.stderr.is_none() || self.cosines.is_some() || self.common.is_some() {
            return Ok(None);
        }
        let seen = self.seen(best.factor);
        let mut all: Vec<(f64, f64)> = Vec::new();
        for l in 0..photographs.phi.ncols() {
            let [y, a] = seen.frame(light, l)?;
            let left = y.column(0) - &a * &best.value.rho;
            let roots = photographs.roots(l);
            let counts = (0..left.len()).filter(|p| roots[*p] > 0.0);
            all.extend(counts.map(|p| (photographs.phi[(p, l)], left[p])));
        }
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let few = (SHARE * all.len() as f64).ceil() as usize;
        let Some((least, _)) = few.checked_sub(1).and_then(|last| all.get(last).copied()) else {
            return Ok(None);
        };
        let brightest = all.iter().take_while(|(phi, _)| *phi >= least);
        let lefts: Vec<f64> = brightest.map(|(_, left)| *left).collect();
        Ok(Some(lefts.iter().sum::<f64>() / lefts.len() as f64))
    }
}
