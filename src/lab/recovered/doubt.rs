//! What speaks against believing a recovered picture, in words, each with its cure.

mod contested;
mod errors;
mod misfit;

use super::chosen::beforehand;
use super::fit::Judged;
use crate::lab::comparison::gains::drifting;
use crate::num::digits::{figure, significant};
use crate::recovery::{Choice, Method, Patterns, Recovered, Setting, Sum, Weighting};
use contested::contested;
pub(super) use contested::{TELLS, contest};
use errors::{
    DETERMINED, HALF, between_neighbours, by_entries, few_replicates, integrated, overstated,
    shared, too_bright, undetermined, unseen, untested, with_light,
};
pub(in crate::lab) use errors::{alike_untold, uneven};
use misfit::{misfit, none_possible, outlier};

/// More than this share of the elements is most of them.
const MOST: f64 = 0.5;
/// Standard errors by which a reflectance must lie beyond 0 or 1 to be impossible; without a
/// standard error it must by the whole range.
const BEYOND: f64 = 3.0;
/// The misfit χ² that an iteration may have left above its minimum: a third of a standard deviation
/// of one direction.
const GAP: f64 = 0.1;

/// A probability below which exactly two reflectances are not to be taken for granted.
const UNLIKELY: f64 = Patterns::UNLIKELY;
/// A probability below which a pattern is one of many.
const ONE_OF_MANY: f64 = 0.05;

/// All that speaks against `found`, gravest first; nothing where nothing does.
pub(super) fn doubts(found: &Recovered, judged: &Judged) -> Vec<String> {
    let every = [
        outlier(judged),
        misfit(found, judged),
        none_possible(judged),
        contested(found.method, judged),
        unjudged(found, judged),
        shared(judged),
        between_neighbours(judged),
        with_light(judged),
        untested(judged),
        few_replicates(found, judged),
        by_entries(judged),
        integrated(found, judged),
        overstated(judged),
        impossible(found),
        undetermined(found, judged),
        unit_untold(found),
        unseen(found, judged),
        too_bright(found, judged),
        uneven(found),
        alike_untold(found, judged),
        few_directions(found),
        noise(found),
        on_bounds(found),
        stopped(found),
        unfinished(found, judged),
        drifting(found).filter(|_| !is_at_fault(judged)),
        without_bands(found),
        unsampled(found, judged),
        spread(found),
        one_of_many(found, judged),
    ];
    every.into_iter().flatten().collect()
}

/// Whether the picture does not explain the photographs, and others do: gains that were found with
/// it say nothing of the photographs.
fn is_at_fault(judged: &Judged) -> bool {
    let refuted = judged.fit.as_ref().is_some_and(|fit| !fit.fits);
    refuted && judged.best.as_ref().is_some_and(|best| best.possible.fits)
}

/// A search that was stopped.
fn stopped(found: &Recovered) -> Option<String> {
    let left = found.unfinished?;
    Some(format!(
        "NOT FINISHED: {left}. Recover again for the whole search"
    ))
}

fn unjudged(found: &Recovered, judged: &Judged) -> Option<String> {
    judged.fit.is_none().then(|| {
        let taken = match (found.field, found.alike) {
            (Some(field), _) => format!(
                "noise of the pixels and errors that neighbours share over {:.0} of them",
                field.range
            ),
            (None, Some(pixels)) => format!("noise that {pixels:.0} neighbouring pixels share"),
            (None, None) => "independent noise".to_owned(),
        };
        format!(
            "the fit CANNOT BE JUDGED: the noise of the photographs is not known, or there are not \
             more of them than unknowns. It leaves {} % of Φcam unexplained; errors that are stated \
             take that for {taken}. Give standard errors (--stderr FILE, --noise RELATIVE)",
            figure(100.0 * found.relative_residual, 2)
        )
    })
}

/// Most elements of a method without bounds where no surface is.
fn impossible(found: &Recovered) -> Option<String> {
    let bounded = [Method::Joint, Method::JointTv, Method::JointTwoValued];
    if found.has_free_scale() || bounded.contains(&found.method) {
        return None;
    }
    let values = found.reflectance.iter().enumerate();
    let beyond = values.filter(|(j, x)| {
        let known = found.standard_error.as_ref().map(|s| BEYOND * s[*j]);
        (**x - 0.5).abs() > 0.5 + known.unwrap_or(1.0)
    });
    let (count, all) = (beyond.count(), found.reflectance.len());
    (count as f64 > MOST * all as f64).then(|| {
        format!(
            "{count} of {all} elements lie beyond 0 to 1 by more than their error: no surface \
             reflects so. Check that Φcam is in W; use joint, which keeps to 0 to 1"
        )
    })
}

/// A free scale of which it is not certain which element is the brightest, the unit. Errors are
/// those of ratios to it, so that 1 − ρ_j has that of ρ_j.
fn unit_untold(found: &Recovered) -> Option<String> {
    let errors = found.standard_error.as_ref()?;
    let unit = found.reflectance.imax();
    let off = |j: usize| (1.0 - found.reflectance[j]) / errors[j];
    let known = (0..errors.len()).filter(|j| errors[*j] > 0.0 && errors[*j].is_finite());
    let others = known.filter(|j| found.has_free_scale() && *j != unit && off(*j) < BEYOND);
    let nearest = others.clone().min_by(|a, b| off(*a).total_cmp(&off(*b)))?;
    Some(format!(
        "the UNIT IS NOT CERTAIN: the scale is free, so that the brightest element is 1, and {} of the others \
         may be brighter (one is {} ± {} of it). Errors are those of ratios to the element that is 1: in units of \
         the truly brightest all are off together by as much. Give the scale, or compare ratios",
        others.count(),
        figure(found.reflectance[nearest], 3),
        figure(errors[nearest], 2)
    ))
}

/// Most elements known no better than that a surface reflects between 0 and 1.
fn noise(found: &Recovered) -> Option<String> {
    let errors = found.standard_error.as_ref()?;
    let (count, all) = (errors.iter().filter(|s| **s > HALF).count(), errors.len());
    (count as f64 > MOST * all as f64).then(|| {
        format!(
            "{count} of {all} elements have a standard error above {HALF}, half of all that a surface \
             can reflect: the picture is noise there. Use joint, fewer --elements, or more light"
        )
    })
}

/// Most elements where a bound holds them.
fn on_bounds(found: &Recovered) -> Option<String> {
    let (count, all) = (found.bounded(), found.reflectance.len());
    let can = Setting::Bands.means_something_to(found.method);
    let more = match found.bands {
        None if can => ", or ask for --bands",
        _ => "",
    };
    (count as f64 > MOST * all as f64).then(|| {
        format!(
            "{count} of {all} elements sit on a bound: it, not the photographs, decides their \
             values. Compare with nnls and joint-unbounded{more}"
        )
    })
}

/// Bands that were asked for and are not there.
fn without_bands(found: &Recovered) -> Option<String> {
    let why = found.no_bands?;
    let cure = if found.has_free_scale() {
        "joint-gp, to first order in ratios to the brightest element"
    } else {
        "joint, or of joint-unbounded where it drops no direction"
    };
    Some(format!("it {why}. Ask for those of {cure}"))
}

/// Probabilities of patterns that the sampling did not settle.
fn unsampled(found: &Recovered, judged: &Judged) -> Option<String> {
    let of = found.patterns.as_ref()?;
    let explains = judged.fit.as_ref().is_none_or(|fit| fit.fits);
    let Sum::Sampled { disagreement, .. } = of.assumed().sum else {
        return None;
    };
    (disagreement > Sum::AGREEMENT).then(|| {
        format!(
            "the probabilities of its patterns are NOT to be believed: that of an element may be off by \
             {}. Use fewer --elements, give the --levels, or believe joint-gp{}",
            significant(disagreement, 2),
            if explains { or_alike(of) } else { "" }
        )
    })
}

/// What else may be believed, where it is known.
fn or_alike(of: &Patterns) -> &'static str {
    match of.told_if_alike() {
        Some(_) if !of.settled_if_alike => {
            "; or, if neighbours may be alike, as of a board or a letter, the mean where they are"
        }
        _ => "",
    }
}

/// An inverse of the laser side that lacks directions of the picture.
fn few_directions(found: &Recovered) -> Option<String> {
    let whole = matches!(
        found.method,
        Method::Pinv | Method::LeftInverse | Method::Rdivide | Method::RdivideMinNorm
    );
    let (rank, all) = (found.rank, found.reflectance.len());
    (whole && (rank as f64) < DETERMINED * all as f64).then(|| {
        format!(
            "the laser side tells {rank} directions of {all} elements apart: of the others this \
             picture shows nothing, and takes it for 0. Use joint, more spots or fewer --elements"
        )
    })
}

/// Two levels where elements that differ from theirs explain the photographs at least as well.
fn spread(found: &Recovered) -> Option<String> {
    let of = found.patterns.as_ref()?;
    let assumed = of.assumed();
    let exact = assumed.exact.filter(|p| *p < UNLIKELY)?;
    if found.rests_on_wrong_gains() {
        return Some(format!(
            "if {}, exactly two reflectances have probability {}, and the gains were found with them: \
             pattern and levels are NOT to be believed, and there are no standard errors. Believe joint-gp",
            beforehand(of),
            figure(exact, 2)
        ));
    }
    Some(format!(
        "if {}, exactly two reflectances have probability {}: elements that differ from theirs by about {} \
         explain the photographs better. Believe the standard errors, not the pattern, or joint-gp",
        beforehand(of),
        figure(exact, 2),
        assumed.spread?
    ))
}

/// A pattern that explains the photographs no better than others do.
fn one_of_many(found: &Recovered, judged: &Judged) -> Option<String> {
    let of = found.patterns.as_ref()?;
    let assumed = of.assumed();
    let explains = judged.fit.as_ref().is_none_or(|fit| fit.fits);
    let exact = assumed.exact.is_none_or(|p| p >= UNLIKELY);
    let told = explains && exact && assumed.sum.converged();
    (told && assumed.pattern < ONE_OF_MANY).then(|| {
        format!(
            "its pattern has probability {}: it is one of many that explain the photographs. Believe \
             the probability of each element and the standard errors, or joint-gp{}",
            figure(assumed.pattern, 2),
            or_alike(of)
        )
    })
}

/// An iteration that ended away from its minimum by what can be seen in the picture.
fn unfinished(found: &Recovered, judged: &Judged) -> Option<String> {
    let solver = found.solver.as_ref()?;
    // In units of the noise: known, or what the fit leaves over.
    let unit = match found.weighting {
        Weighting::Separable { .. } | Weighting::EntryByEntry => 1.0,
        Weighting::Unweighted => {
            let left = judged.fit.as_ref().map_or(1.0, |fit| fit.dof.max(1.0));
            (found.residual * found.residual / left).max(f64::MIN_POSITIVE)
        }
    };
    let above = 2.0 * solver.gap / unit;
    // The gap of a pattern is to the best of all numbers; what other patterns could do is known
    // from their probabilities.
    let known = found.patterns.as_ref();
    let known = known.is_some_and(|p| p.assumed().sum.converged());
    (above > GAP && !known).then(|| {
        let above = figure(above, 2);
        match found.method {
            Method::JointTwoValued => {
                let more = match found.choice {
                    Choice::Given => "",
                    _ => ", or give the --levels",
                };
                format!(
                    "no change of one or two elements fits better, but not every pattern was tried: χ² of \
                     another may be up to {above} lower. Compare with joint{more}"
                )
            }
            _ => format!(
                "the search ended before it was proved to be at the minimum: χ² may be {above} lower. \
                 Scale the photographs, or use joint-unbounded"
            ),
        }
    })
}

#[cfg(test)]
mod tests;
