//! From where the searches end to the estimate with its errors.

use super::descent::State;
use super::elsewhere;
use super::field::End;
use super::geometry::Light;
use super::left_out::Group;
use super::{
    Beforehand, Calibrated, Calibration, CalibrationPlan, Direction, Identified, LEVEL, Problem,
    Profile, Starts, profile,
};
use crate::lab::comparison::validation::Integration;
use crate::lab::error::LabError;
use crate::lab::geometry::located::Grid;
use crate::lab::uncertainty::certainty::{Errors, correlated, fits_better};
use crate::matrix::Matrix;
use crate::metrics::{correlation, mtf_raw};
use crate::model::MatrixModel;
use crate::num::linalg::Cholesky;
use crate::store::digest_of;
use crate::transport::Control;

/// Starts that end within so many standard errors of each other agree.
const AGREE: f64 = 1.0;

impl CalibrationPlan {
    pub(super) fn finish(
        &self,
        problem: &Problem<'_>,
        (model, told, untold): (&MatrixModel, Vec<Identified>, Vec<Direction>),
        ends: Vec<End>,
        control: Control<'_>,
    ) -> Result<Calibration, LabError> {
        let alone = ends.iter().map(|end| end.without);
        let alone = alone.fold(f64::INFINITY, f64::min);
        let End {
            state: best,
            stages,
            field,
            total,
            ..
        } = &ends[0];
        let left = ends[0].left_over(problem)?;
        let with_field = field.as_ref().map(|field| problem.with_field(field));
        let with_field = with_field.transpose()?;
        let is_noise_known = problem.photographs.stderr.is_some();
        let known = problem.photographs.certainty;
        let problem = with_field.as_ref().unwrap_or(problem);
        let information = problem.information(&best.slope);
        let information = Cholesky::new(&information).ok_or(LabError::DARK)?;
        let covariance = information.inverse();
        let unknowns = problem.unknowns() as f64;
        let dof = (best.value.count - best.value.freedom - unknowns).max(1.0);
        let light = problem.light(&best.values, problem.relative(best.factor), true)?;
        let chi2 = problem.chi2(best, &light);
        let p = is_noise_known.then(|| known.by_noise(chi2, dof));
        // Of less than noise leaves nothing is told.
        let is_close = p.is_some_and(|p| fits_better(chi2 / dof, p));
        let neighbours = problem.neighbours(best, &light)?.filter(|_| !is_close);
        let more_than_noise = p.is_none_or(|p| p < LEVEL) || neighbours.is_some();
        let robust = |scores: &Matrix| {
            let moved = &covariance * scores;
            &moved * moved.transpose()
        };
        let enough_frames = problem.photographs.phi.ncols() > 2;
        let (seen, given) = (problem.seen(best.factor), &best.slope.covariance);
        let columns = seen.columns(&light, &best.value.rho, given, problem.unknowns())?;
        let of = (&light, &columns[..]);
        let by = |group: Group| -> Result<Matrix, LabError> {
            let scores = problem.left_out(best, of, &information, group)?;
            Ok(robust(&scores))
        };
        let by_frames = (more_than_noise && enough_frames).then(|| by(Group::Frame));
        let by_frames = by_frames.transpose()?;
        // Along the cosines there are no blocks of pixels.
        let by_blocks = (more_than_noise && field.is_none()).then(|| by(Group::Block));
        let by_blocks = by_blocks.transpose()?;
        let sums = problem.sums(best, of)?;
        let light_left_out = problem.light_left_out(best, &sums, &information);
        let even_light = problem.even_light(best, &sums, &information);
        let brightest = problem.brightest(best, &light)?;
        let picture = problem.averaged((best, model), of, control)?;
        drop(columns);
        let scene = problem.geometry.scene;
        let names = self.names(problem);
        let held = problem.held(best);
        let by_pictures = problem.by_pictures(best, &light, &held)?;
        let finer = problem.finer(best, &covariance)?;
        let elements = problem.finer_elements(model, best, control)?;
        let is_integrated =
            problem.geometry.is_obstructed() || self.integration == Integration::Quadrature;
        let mut found: Vec<Calibrated> = Vec::new();
        let mut whole = covariance.clone();
        for (k, identified) in told.into_iter().enumerate() {
            let root = |m: &Matrix| m[(k, k)].max(0.0).sqrt();
            let by_curvature = root(&covariance);
            let by_frames = by_frames.as_ref().map(root);
            let by_blocks = by_blocks.as_ref().map(root);
            let profile = profile::profile(problem, best, &covariance, k)?;
            let by_profile = profile.as_ref().map_or(0.0, Profile::stderr);
            let others = [by_frames, by_blocks].map(|x| x.unwrap_or(0.0));
            let by_rule = finer.as_ref().map(|(moved, _)| moved[k].abs());
            let rule = by_rule.filter(|_| is_integrated);
            let noise = [by_curvature, by_profile, by_pictures[k]];
            let noise = noise.into_iter().chain(others).fold(0.0, f64::max);
            let by_elements = elements.as_ref().and_then(|e| e.moved.get(k));
            let by_elements = by_elements.map(|moved| moved.abs());
            let [rule, even] = [rule, by_elements].map(|moved| moved.unwrap_or(0.0));
            let finer = rule * rule + even * even;
            let stderr = (noise * noise + finer).sqrt();
            let pictures = by_pictures[k] * by_pictures[k] - by_curvature * by_curvature;
            let more = stderr / by_curvature;
            (0..whole.nrows()).for_each(|j| {
                whole[(k, j)] *= more;
                whole[(j, k)] *= more;
            });
            let (name, unit) = names[k].clone();
            found.push(Calibrated {
                name,
                unit,
                prior: problem.priors[k],
                value: best.values[k],
                stderr,
                by_curvature,
                by_frames,
                by_blocks,
                by_pictures: by_pictures[k],
                by_rule,
                by_elements,
                by_even_light: even_light.as_ref().map(|even| even.moved[k]),
                beside_noise: pictures.max(0.0) + finer,
                identified,
                profile,
            });
        }
        let starts = Starts {
            tried: self.starts.max(1),
            agree: ends
                .iter()
                .filter(|end| end.is_of_start && agree(&end.state, best, &found))
                .count(),
        };
        let scale = best.prior.scale;
        let rho = &picture.rho;
        let moved = &picture.shift * &whole * picture.shift.transpose();
        let both = &picture.given + moved.diagonal();
        let grids = model.grids.iter().map(|g| Grid {
            surface: g.surface.clone(),
            count: g.count,
            values: rho.rows(g.first, g.len()).iter().copied().collect(),
            stderr: both
                .rows(g.first, g.len())
                .map(f64::sqrt)
                .iter()
                .copied()
                .collect(),
        });
        let truth = scene.unknown().is_none().then_some(&model.albedo);
        let count = problem.geometry.parameters.len();
        let mut file = scene.displaced_file(problem.geometry.parameters, &best.values[..count])?;
        file.name = format!("{} calibrated", scene.name);
        let toml = file.toml()?;
        Ok(Calibration {
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            is_integrated,
            finer_elements: elements,
            untold,
            beforehand: Beforehand::of(&found[..problem.geometry.parameters.len()], &covariance),
            light_left_out,
            even_light_chi2: even_light.map(|even| even.chi2),
            brightest,
            replicates: known.replicates.filter(|_| is_noise_known),
            too_small: known.too_small().filter(|_| is_noise_known),
            shared: known.shared().filter(|_| is_noise_known),
            follows_entries: known.follows_entries,
            neighbours,
            noise: ends[0].noise(),
            field: field.as_ref().map(|f| f.errors),
            log_likelier: field.as_ref().map(|_| alone - total),
            misfit: chi2 / dof,
            finer_misfit: finer.as_ref().map(|(_, chi2)| chi2 / dof),
            finer_p: finer
                .as_ref()
                .and_then(|(_, chi2)| is_noise_known.then(|| known.by_noise(*chi2, dof))),
            dof,
            p,
            left,
            scale,
            spread: best.prior.spread,
            length: best.prior.length,
            stages: stages.clone(),
            is_settled: best.is_settled,
            held,
            starts,
            is_looked_around: problem.is_looked_around(),
            elsewhere: elsewhere::not_told(&ends, &found),
            resized: None,
            grids: grids.collect(),
            stderr_given: picture.given.iter().map(|x| x.sqrt()).collect(),
            covariance: picture.covariance.map(|given| given + moved),
            directions: picture.directions,
            picture_warnings: picture.warnings,
            correlation: truth.and_then(|t| correlation(rho.as_slice(), t)),
            mtf_raw: truth.and_then(|t| mtf_raw(rho.as_slice(), t)),
            scene_sha256: digest_of(toml.as_bytes()),
            toml,
            found,
        })
    }

    /// Name and unit of each unknown.
    fn names(&self, problem: &Problem<'_>) -> Vec<(String, String)> {
        let own = problem.geometry.parameters.iter();
        let own = own.map(|p| (p.name.clone(), p.unit.clone()));
        let gains =
            (0..problem.geometry.gains).map(|l| (format!("gain of frame {l}"), String::new()));
        own.chain(gains).collect()
    }
}

impl Problem<'_> {
    /// χ² of what is found: of counts by the errors of the light that is found.
    fn chi2(&self, best: &State, light: &Light) -> f64 {
        let of = &self.photographs;
        let is_alone = of.patterns.is_none() && self.common.is_none() && self.cosines.is_none();
        if !is_alone || of.stderr.is_none() || of.certainty.counted.is_none() {
            return best.value.chi2;
        }
        let frame = |l: usize| -> f64 {
            let seen = light.frame(l) * &best.value.rho;
            let roots = of.roots_of(l, &seen);
            (of.phi.column(l) - seen)
                .component_mul(&roots)
                .norm_squared()
        };
        (0..of.phi.ncols()).map(frame).sum()
    }

    /// The correlation of what is left of neighbouring pixels, where it is more than chance, of
    /// noise that is each entry's own: of one that is not stated too, by the scatter
    /// √Σ (z z′)² of Σ z z′, whatever the variances are.
    fn neighbours(&self, best: &State, light: &Light) -> Result<Option<f64>, LabError> {
        let own = self.photographs.certainty.errors == Errors::Independent;
        if self.cosines.is_some() || !own {
            return Ok(None);
        }
        let [beside, products, squares] = self.seen(best.factor).beside(light, &best.value.rho)?;
        Ok(correlated(beside, squares, squares * squares / products))
    }
}

/// Whether an end is where the best one is.
fn agree(end: &State, best: &State, found: &[Calibrated]) -> bool {
    let each = end.values.iter().zip(&best.values).zip(found);
    each.into_iter()
        .all(|((a, b), own)| (a - b).abs() <= AGREE * own.stderr)
}
