//! Standard errors, bands and probabilities that say less than they seem to.

use crate::lab::recovered::fit::{Fit, Judged};
use crate::lab::uncertainty::certainty::{
    FOLLOWS_ENTRIES, fits_better, neighbours_share, times_too_small,
};
use crate::lab::uncertainty::pooled::ENOUGH_REPLICATES;
use crate::lab::uncertainty::with_light::goes_with_light;
use crate::num::digits::{figure, significant};
use crate::num::statistics::median;
use crate::recovery::{Choice, Method, Recovered};

/// A standard error above which an element is not known: half of the range from 0 to 1.
pub(super) const HALF: f64 = 0.5;
/// A share of an element below which the photographs do not determine it.
pub(super) const DETERMINED: f64 = 0.9;
/// What the integrals move is told from this part of a standard error on, both counted.
const NOTABLE: f64 = 0.5;
/// Standard errors larger by more than this are others.
const LARGER: f64 = 1.1;
/// And by more than this mostly what is taken from pictures in general.
const MUCH_LARGER: f64 = 3.0;

/// Errors that do not average out over the entries, as a recovery supposes.
pub(super) fn shared(judged: &Judged) -> Option<String> {
    let [which, cure] = judged.shared()?;
    Some(format!(
        "the errors of these photographs hang together: {which}, and they do not average out. So there \
         are no standard errors, bands and probabilities, and less is determined than is said. {cure}"
    ))
}

/// Entries that no test sees.
pub(super) fn untested(judged: &Judged) -> Option<String> {
    let fit = judged.fit.as_ref().filter(|fit| fit.fits)?;
    let count = judged.untested;
    (count > 0).then(|| {
        format!(
            "{count} of {} entries that the surface lights have a standard error of 0: they count for the picture as \
             if they were known, and no test sees whether they are right. Leave out those that hold no measurement \
             (--left-out), or give their errors",
            fit.entries + count
        )
    })
}

/// Errors of the picture that take those of the photographs for known, where they are not.
pub(super) fn few_replicates(found: &Recovered, judged: &Judged) -> Option<String> {
    let known = judged.certainty?;
    let (replicates, times) = (known.replicates?, known.too_small()?);
    let estimated = if known.pooled_from.is_some() {
        "even pooled over pixels and spots, are known as"
    } else {
        "were estimated"
    };
    let stated = found.standard_error.is_some() || found.bands.is_some();
    (stated && judged.shared().is_none()).then(|| {
        format!(
            "the standard errors of the photographs {estimated} from {replicates} replicates, and those of \
             the picture, bands and probabilities take them for known: they are {}. Take {ENOUGH_REPLICATES} \
             replicates or more, or state one error for all that are alike (--noise RELATIVE)",
            times_too_small(times)
        )
    })
}

/// Errors of the photographs that noise has made smaller where it has made entries darker.
pub(super) fn by_entries(judged: &Judged) -> Option<String> {
    let known = judged.certainty?;
    known.follows_entries.then(|| FOLLOWS_ENTRIES.to_owned())
}

/// Errors of the picture that are more the model's integrals than the photographs' noise.
pub(super) fn integrated(found: &Recovered, judged: &Judged) -> Option<String> {
    let fits = judged
        .fit
        .as_ref()
        .is_some_and(|fit| fit.fits && !fit.is_open());
    let (moved, errors) = (judged.moved.as_ref()?, found.standard_error.as_ref()?);
    let shares = moved.iter().zip(errors).map(|(moved, error)| moved / error);
    let share = shares.fold(0.0, f64::max);
    (share > NOTABLE && fits).then(|| {
        format!(
            "what the integrals of the model may be off by is up to {} of an element's standard error, in which \
             it is counted beside the noise. More --elements are integrated more finely",
            figure(share, 2)
        )
    })
}

/// Whether what is left over may be noise of the stated size, not what integrals are off by.
fn is_noise(fit: &&Fit) -> bool {
    fit.fits && !fit.is_open() && !fits_better(fit.chi2_per_dof, fit.p)
}

/// Noise that neighbouring pixels share where it is taken for each one's own: of what is left over
/// as noise leaves it, not of less.
pub(super) fn between_neighbours(judged: &Judged) -> Option<String> {
    let fit = judged.fit.as_ref().filter(is_noise)?;
    let errors = "errors, bands and probabilities of the picture take each entry for its own: they are TOO SMALL";
    Some(neighbours_share(fit.neighbours?, errors))
}

/// Errors that do not go with the light as the noise does, of which χ² of all may be right: of what
/// is left over as noise leaves it.
pub(super) fn with_light(judged: &Judged) -> Option<String> {
    let fit = judged.fit.as_ref().filter(is_noise)?;
    let told = goes_with_light(fit.with_light?);
    Some(format!(
        "{told}. So the errors of the picture are not right"
    ))
}

/// Photographs closer to the picture than their errors let them be.
pub(super) fn overstated(judged: &Judged) -> Option<String> {
    let fit = judged.fit.as_ref().filter(|_| judged.shared().is_none())?;
    fits_better(fit.chi2_per_dof, fit.p).then(|| {
        format!(
            "it fits BETTER than the standard errors allow (χ²/dof {}): they are too large, or entries \
             share them, and then the errors of the picture are too small. Of an exposed render take \
             more --samples",
            significant(fit.chi2_per_dof, 3)
        )
    })
}

/// A share of an element's variance below which the photographs say nothing of it.
const UNSEEN: f64 = 1e-3;

/// So many elements are listed one by one.
const LISTED: usize = 8;

/// Elements of which the photographs say nothing, where no error of theirs tells it, and what a
/// method shows there.
pub(super) fn unseen(found: &Recovered, judged: &Judged) -> Option<String> {
    let (count, all) = (judged.unseen.len(), found.reflectance.len());
    if count == 0 || undetermined(found, judged).is_some() {
        return None;
    }
    let shown = match found.method {
        Method::JointGp => "values and errors are what its prior expects beside their neighbours",
        Method::JointTv => "values are those of the least total variation beside their neighbours",
        Method::JointTwoValued => "which of its levels they have is a guess",
        Method::Joint | Method::Nnls => "values are a bound's, or noise",
        _ => "values are 0, or noise",
    };
    let each = judged.unseen.iter().take(LISTED).map(usize::to_string);
    let more = match count.saturating_sub(LISTED) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    Some(format!(
        "the photographs say NOTHING of {count} of {all} elements, whose light they do not show ({}{more}; counted \
         from 0 along u, then along v): {shown}. Pass over them, or photograph by other spots or another view",
        each.collect::<Vec<String>>().join(", ")
    ))
}

/// Elements of `nnls` that reflect more than all where the photographs hardly tell them from
/// others: no bound and no error tells that of noise.
pub(super) fn too_bright(found: &Recovered, judged: &Judged) -> Option<String> {
    let known = judged.determined.as_ref();
    let known = known.filter(|_| found.method == Method::Nnls)?;
    let each = known.shares.iter().zip(&found.reflectance);
    let beyond = each.filter(|(share, rho)| **share < UNSEEN && **rho > 1.0);
    let values: Vec<f64> = beyond.map(|(_, rho)| *rho).collect();
    let largest = values.iter().copied().reduce(f64::max)?;
    Some(format!(
        "{} of {} elements, up to {}, are not seen at all: the photographs do not say what they \
         reflect. Use joint, which keeps to 0 to 1",
        values.len(),
        found.reflectance.len(),
        figure(largest, 2)
    ))
}

/// Elements that a method without bounds gives no finite standard error, or one of less than half
/// of what any method can know: directions that the photographs do not show are taken for 0.
pub(super) fn undetermined(found: &Recovered, judged: &Judged) -> Option<String> {
    let stated = found.standard_error.as_ref()?;
    let shortest = matches!(found.method, Method::JointUnbounded | Method::Pinv);
    let known = judged.determined.as_ref().filter(|_| shortest);
    let too_small = |j: usize, error: f64| {
        let share = known.map_or(1.0, |known| known.shares[j]);
        share < DETERMINED && error < 0.5 * HALF * (1.0 - share).sqrt()
    };
    let each = || stated.iter().copied().enumerate();
    let unbounded = each().filter(|(_, error)| error.is_infinite()).count();
    let hidden = each().filter(|(j, error)| too_small(*j, *error)).count();
    let count = unbounded + hidden;
    let said = match (unbounded, hidden) {
        (_, 0) => "they have no finite standard error",
        (0, _) => "the standard errors leave out what cannot be seen",
        _ => "standard errors are infinite or leave out what cannot be seen",
    };
    (count > 0).then(|| {
        format!(
            "the photographs do not determine {count} of {} elements, and this picture is one of \
             many that explain them: {said}. Use joint-gp, fewer --elements, or more photographs",
            stated.len()
        )
    })
}

/// Standard errors of a picture that is taken for one reflectance throughout.
pub(in crate::lab) fn uneven(found: &Recovered) -> Option<String> {
    let Choice::Averaged {
        if_uneven: Some([p, times]),
        ..
    } = found.choice
    else {
        return None;
    };
    (times > LARGER).then(|| {
        format!(
            "that all is of one reflectance has a probability of {} % (2 % before the photographs), and standard errors and bands \
             count it so. Of a picture that varies, if only a little, they are {} times as large in the mean",
            figure(100.0 * p, 2),
            significant(times, 2)
        )
    })
}

/// Standard errors that take neighbours to be as alike as in most pictures, where the photographs
/// do not say how alike they are.
pub(in crate::lab) fn alike_untold(found: &Recovered, judged: &Judged) -> Option<String> {
    let Choice::Averaged {
        if_unalike: Some(times),
        ..
    } = found.choice
    else {
        return None;
    };
    let own = median(found.standard_error.as_ref()?.iter().copied().collect())?;
    let is_scaled = found.nuisance.as_ref().is_some_and(|n| n.scale.is_some());
    let shares = judged.determined.as_ref().filter(|_| !is_scaled);
    let alone = |share: &f64| HALF * (1.0 - share).max(0.0).sqrt();
    let alone = shares.and_then(|known| median(known.shares.iter().map(alone).collect()));
    let alone = alone.filter(|alone| *alone > MUCH_LARGER * own);
    (times > LARGER || alone.is_some()).then(|| {
        let rest = alone.map_or(String::new(), |alone| {
            format!(
                " They are ± {} in the median, where the photographs alone tell an element of 0.5 ± 0.5 to ± {}.",
                figure(own, 2),
                figure(alone, 2)
            )
        });
        format!(
            "the photographs do not say how alike neighbouring elements are: standard errors and bands take \
             that from pictures in general.{rest} Of elements that have nothing in common with their neighbours \
             they are {} times as large in the mean, and several times where these look smooth by chance, as \
             checks do from afar. Use fewer --elements, or believe them of usual pictures only",
            significant(times, 2)
        )
    })
}
