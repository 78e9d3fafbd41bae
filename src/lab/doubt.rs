//! What speaks against believing a recovered picture, in words, each with its cure.

mod misfit;

use super::chosen::beforehand;
use super::fit::Judged;
use super::gains::drifting;
use crate::num::digits::{figure, significant};
use crate::recovery::{Choice, Method, Patterns, Recovered, Sum, Weighting};
use misfit::misfit;

/// More than this share of the elements is most of them.
const MOST: f64 = 0.5;
/// Standard errors by which a reflectance must lie beyond 0 or 1 to be impossible; without a
/// standard error it must by the whole range.
const BEYOND: f64 = 3.0;
/// A standard error above which an element is not known: half of the range from 0 to 1.
const HALF: f64 = 0.5;
/// A χ²/dof below this, and as seldom by chance, is not that of independent noise.
const CLOSE: f64 = 0.95;
const SELDOM: f64 = 1e-6;
/// The misfit χ² that an iteration may have left above its minimum: a third of a standard deviation
/// of one direction.
const GAP: f64 = 0.1;

/// Replicates from which errors are as good as known: of 10, 95 % bands of `joint-gp` held 84 to
/// 89 %, of 32 91 to 95 %.
const ENOUGH_REPLICATES: u32 = 32;
/// Standard errors larger by more than this are others.
const LARGER: f64 = 1.1;
/// A probability below which exactly two reflectances are not to be taken for granted.
const UNLIKELY: f64 = 0.5;
/// A probability below which a pattern is one of many.
const ONE_OF_MANY: f64 = 0.05;
/// A share of an element below which the photographs do not determine it.
const DETERMINED: f64 = 0.9;

/// All that speaks against `found`, gravest first; nothing where nothing does.
pub(super) fn doubts(found: &Recovered, judged: &Judged) -> Vec<String> {
    let every = [
        misfit(found, judged),
        unjudged(found, judged),
        shared(judged),
        few_replicates(found, judged),
        overstated(judged),
        impossible(found),
        undetermined(found, judged),
        alike_untold(found),
        few_directions(found),
        noise(found),
        on_bounds(found),
        stopped(found),
        unfinished(found, judged),
        drifting(found),
        without_bands(found),
        unsampled(found),
        spread(found),
        one_of_many(found, judged),
    ];
    every.into_iter().flatten().collect()
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

/// Errors that do not average out over the entries, as a recovery supposes.
fn shared(judged: &Judged) -> Option<String> {
    let which = judged.shared()?;
    Some(format!(
        "the errors of these photographs hang together: {which}, and they do not average out. So there \
         are no standard errors, bands and probabilities, and less is determined than is said. Render \
         by --estimator independent for them; of dark frames that all spots share take more, or \
         estimate their part (--background)"
    ))
}

/// Errors of the picture that take those of the photographs for known, where they are not.
fn few_replicates(found: &Recovered, judged: &Judged) -> Option<String> {
    let replicates = judged.replicates.filter(|n| *n < ENOUGH_REPLICATES)?;
    let stated = found.standard_error.is_some() || found.bands.is_some();
    (stated && judged.shared().is_none()).then(|| {
        format!(
            "the standard errors of the photographs were estimated from {replicates} replicates, and those of \
             the picture, bands and probabilities take them for known: they are TOO SMALL. Take {ENOUGH_REPLICATES} \
             replicates or more, or state one error for all that are alike (--noise RELATIVE)"
        )
    })
}

/// Photographs closer to the picture than their errors let them be.
fn overstated(judged: &Judged) -> Option<String> {
    let fit = judged.fit.as_ref().filter(|_| judged.shared().is_none())?;
    (fit.chi2_per_dof < CLOSE && 1.0 - fit.p < SELDOM).then(|| {
        format!(
            "it fits BETTER than the standard errors allow (χ²/dof {}): they are too large, or entries \
             share them, and then the errors of the picture are too small. Of an exposed render take \
             more --samples",
            significant(fit.chi2_per_dof, 3)
        )
    })
}

/// Standard errors of a shortest solution that are less than half of what any method can know: they
/// are those of the directions that the photographs show, and the others are taken for 0.
fn undetermined(found: &Recovered, judged: &Judged) -> Option<String> {
    let shortest = matches!(found.method, Method::JointUnbounded | Method::Pinv);
    let known = judged.determined.as_ref().filter(|_| shortest)?;
    let stated = found.standard_error.as_ref()?;
    let shares = known.shares.iter().zip(stated.iter());
    let hidden = shares.filter(|(share, error)| {
        **share < DETERMINED && **error < 0.5 * HALF * (1.0 - **share).sqrt()
    });
    let count = hidden.count();
    (count > 0).then(|| {
        format!(
            "the photographs do not determine {count} of {} elements, of which this is the smallest picture \
             that explains them: the standard errors leave out what cannot be seen. Use joint-gp, fewer \
             --elements, or more photographs",
            stated.len()
        )
    })
}

/// Standard errors that take neighbours to be as alike as in most pictures, where the photographs
/// do not say how alike they are.
fn alike_untold(found: &Recovered) -> Option<String> {
    let Choice::Averaged { if_unalike } = found.choice else {
        return None;
    };
    let times = if_unalike.filter(|times| *times > LARGER && found.standard_error.is_some())?;
    Some(format!(
        "the photographs do not say how alike neighbouring elements are: standard errors and bands take \
         that from pictures in general. Of elements that have nothing in common with their neighbours \
         they are {} times as large. Use fewer --elements, or believe them of usual pictures only",
        significant(times, 2)
    ))
}

/// Most elements of a method without bounds where no surface is.
fn impossible(found: &Recovered) -> Option<String> {
    let bounded = [Method::Joint, Method::JointTv, Method::JointTwoValued];
    let free = found.nuisance.as_ref().is_some_and(|n| n.scale.is_some());
    if free || bounded.contains(&found.method) {
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
    (count as f64 > MOST * all as f64).then(|| {
        format!(
            "{count} of {all} elements sit on a bound: it, not the photographs, decides their \
             values. Compare with nnls and joint-unbounded, or ask for --bands"
        )
    })
}

/// Bands that were asked for and are not there.
fn without_bands(found: &Recovered) -> Option<String> {
    let why = found.no_bands?;
    Some(format!(
        "it {why}. Ask for those of joint, or of joint-unbounded where it drops no direction"
    ))
}

/// Probabilities of patterns that the sampling did not settle.
fn unsampled(found: &Recovered) -> Option<String> {
    let of = found.patterns.as_ref()?;
    let Sum::Sampled { disagreement, .. } = of.assumed().sum else {
        return None;
    };
    (disagreement > Sum::AGREEMENT).then(|| {
        format!(
            "the probabilities of its patterns are NOT to be believed: that of an element may be off by \
             {}. Use fewer --elements, give the --levels, or believe joint-gp{}",
            significant(disagreement, 2),
            or_alike(of)
        )
    })
}

/// What else may be believed, where it is known.
fn or_alike(of: &Patterns) -> &'static str {
    match of.if_alike {
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
    Some(format!(
        "if {}, exactly two reflectances have probability {}: elements that differ from theirs by about {} \
         explain the photographs better. Believe the standard errors, not the pattern, or joint-gp{}",
        beforehand(of),
        figure(exact, 2),
        assumed.spread?,
        or_alike(of)
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
            (2.0 * solver.objective / left).max(f64::MIN_POSITIVE)
        }
    };
    let above = 2.0 * solver.gap / unit;
    // The gap of a pattern is to the best of all numbers; what other patterns could do is known
    // from their probabilities.
    let known = found.patterns.as_ref();
    let known = known.is_some_and(|p| p.assumed().sum.converged());
    (above > GAP && !known).then(|| {
        let cure = match found.method {
            Method::JointTwoValued => "Compare with joint, or give the --levels",
            _ => "Scale the photographs, or use joint-unbounded",
        };
        format!(
            "the search ended before it was proved to be at the minimum: χ² may be {} lower. {cure}",
            figure(above, 2)
        )
    })
}

#[cfg(test)]
mod tests;
