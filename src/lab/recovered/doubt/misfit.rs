//! Photographs that a picture, or any picture, does not explain.

use crate::lab::recovered::fit::{Apart, Attainable, Fit, Judged};
use crate::num::digits::{figure, freedom, significant};
use crate::recovery::{Method, Recovered, Weighting};

fn told(fit: &Fit) -> String {
    format!(
        "χ²/dof {}, P {}",
        significant(fit.chi2_per_dof, 3),
        figure(fit.p, 2)
    )
}

/// An entry that noise does not explain, whatever the others say.
pub(super) fn outlier(judged: &Judged) -> Option<String> {
    let far = judged.fit.as_ref()?.outlier?;
    let others = match far.count - 1 {
        0 => String::new(),
        n => format!(" (and {n} more nearly as far)"),
    };
    Some(format!(
        "the entry of pixel {} and spot {} lies {} standard errors off what the picture would photograph{others}, \
         where chance leaves none and all others fit: a hot or dead pixel, a reflection, a cosmic ray. It moves the \
         picture. Look at it, and leave it out (--left-out)",
        far.pixel,
        far.spot,
        significant(far.z, 3)
    ))
}

/// Photographs and model that contradict each other, or a picture that does not explain them though
/// another does.
pub(super) fn misfit(found: &Recovered, judged: &Judged) -> Option<String> {
    if let Some(best) = judged.best.as_ref().filter(|best| !best.possible.fits) {
        return Some(contradiction(best, judged.sent_on.as_deref()));
    }
    let fit = judged.fit.as_ref()?;
    if fit.is_blind() {
        return Some(format!(
            "whether it fits CANNOT BE JUDGED: with so few degrees of freedom ({}) light that is off by {} times \
             the noise in every entry would pass, and no picture is told from another by that",
            freedom(fit.dof),
            significant(fit.passes(), 2)
        ));
    }
    if let Some(within) = fit.within_integration.filter(|_| fit.is_open()) {
        let has_errors = found.standard_error.is_some() || found.bands.is_some();
        let errors = match &judged.moved {
            Some(_) => {
                " The errors of the picture count the noise and the last steps of these integrals."
            }
            None if has_errors => {
                " The errors of the picture know of noise alone: they are TOO SMALL."
            }
            None => "",
        };
        return Some(format!(
            "whether it fits CANNOT BE TOLD: it differs from the photographs by more than their noise ({}), \
             but by no more than the integrals of the model may be off (with that taken off χ²/dof {}).{errors} More \
             --elements are integrated more finely",
            told(fit),
            significant(within, 3)
        ));
    }
    if fit.fits {
        return None;
    }
    if judged.left_over.is_some() {
        return Some(format!(
            "DOES NOT FIT: it leaves more of the photographs over than noise of one size could, of which \
             any reflectances leave {} times less (P {}). {}",
            significant(fit.chi2_per_dof, 3),
            figure(fit.p, 2),
            cure(found.method)
        ));
    }
    let own = format!(
        "DOES NOT FIT: what this picture would photograph differs from the photographs by more than \
         their noise ({})",
        told(fit)
    );
    let Some(best) = &judged.best else {
        return Some(format!(
            "{own}. Geometry, order of frames, unit or standard errors may be wrong, or the method; \
             recover with joint to tell"
        ));
    };
    if found.method.is_joint() && found.weighting == Weighting::Unweighted {
        return Some(format!(
            "{own}, and others explain them ({}): all entries weigh alike, whatever their noise. Leave --weighting \
             to the noise",
            told(&best.possible)
        ));
    }
    Some(format!(
        "{own}, and others explain them ({}): the method is at fault, not the photographs. {}",
        told(&best.possible),
        cure(found.method)
    ))
}

/// A search for the best of all pictures that came to no end.
pub(super) fn none_possible(judged: &Judged) -> Option<String> {
    let error = judged.none_possible.as_ref()?;
    Some(format!(
        "whether any reflectances between 0 and 1 explain the photographs is NOT KNOWN: none were \
         found ({error})"
    ))
}

/// What helps where another picture fits.
fn cure(method: Method) -> &'static str {
    match method {
        Method::Tsvd | Method::Tikhonov | Method::TikhonovGradient => {
            "Regularise less (--rank, --damping), or use joint"
        }
        Method::JointTv => "Lower --tv, or use joint",
        Method::JointTwoValued => {
            "There are more than two values, or the search has missed the pattern, or the noise is not \
             of one size, which is supposed where none is stated (--noise, --stderr): use joint, or give \
             the --levels"
        }
        Method::JointUnbounded => "Keep more directions (--tolerance), or use joint",
        Method::Joint => "Compare nnls and joint-unbounded",
        Method::Nnls | Method::JointGp => "Use joint",
        _ => "It amplifies noise: use joint, or tsvd or tikhonov",
    }
}

/// That all photographs but these fit.
fn without(apart: &Apart, possible: &Fit) -> String {
    let what = match (apart.are_spots, apart.which.len()) {
        (true, 1) => "the photograph of spot",
        (true, _) => "the photographs of spots",
        (false, 1) => "pixel",
        (false, _) => "pixels",
    };
    let which: Vec<String> = apart.which.iter().map(usize::to_string).collect();
    let (have, them) = match apart.which.len() {
        1 => ("has", "it"),
        _ => ("have", "them"),
    };
    let cause = if apart.are_spots {
        "a spot elsewhere, frames out of order, or light that is in no other frame"
    } else {
        "pixels that are hot or dead, or see what the scene does not have"
    };
    format!(
        "DOES NOT FIT, by any method ({}), for {what} {}: {have} {} % of χ² beside a picture of all others, which fits \
         without {them} (χ²/dof {}): {cause}. Look at {them}, and leave {them} out (--left-out, or the masks of \
         `phicam import`)",
        told(possible),
        which.join(", "),
        figure(100.0 * apart.share, 2),
        significant(apart.rest, 3)
    )
}

/// No reflectances between 0 and 1 explain the photographs; `sent_on` names occluders whose light
/// is none of the model's.
fn contradiction(best: &Attainable, sent_on: Option<&str>) -> String {
    if let Some(apart) = &best.apart {
        return without(apart, &best.possible);
    }
    let told = told(&best.possible);
    let beside = sent_on.map_or(String::new(), |names| {
        format!(
            " Light that {names} send on, which the model does not have, may be it: estimate it beside the \
             picture (--occluder-light). If that does not help:"
        )
    });
    if best.brightness > 1.0 && best.any.as_ref().is_none_or(|any| any.fits) {
        return format!(
            "DOES NOT FIT, by any method: the photographs are {} times as bright as a surface of \
             reflectance 1 would make them ({told}).{beside} Is Φcam in W, and are power, aperture and \
             albedos of the scene right? Give it in W, or estimate one factor (--free-scale)",
            significant(best.brightness, 3)
        );
    }
    let chi2 = |fit: &Fit| fit.chi2_per_dof * fit.dof;
    let any = match &best.any {
        Some(any) if any.fits => {
            "reflectances below 0 or above 1 could, which no surface has".to_owned()
        }
        // Weights other than those of χ²: of entries without an error, or by pixel and spot.
        Some(any) if chi2(any) > chi2(&best.possible) => {
            "it is not known whether other numbers do, as what fits best by the weights does not by the test".to_owned()
        }
        Some(any) => format!("no numbers at all do ({})", self::told(any)),
        None => "it is not known whether other numbers do".to_owned(),
    };
    let exact = match best.possible.left_out {
        0 => "",
        _ => {
            " the entries whose standard error is 0, if any: they count for the picture and no test sees them (leave \
              them out, --left-out, or give their errors);"
        }
    };
    format!(
        "DOES NOT FIT, by any method: no reflectances between 0 and 1 explain the photographs \
         ({told}); {any}.{beside} The scene is not what was photographed, or the standard errors are too \
         small. Check{exact} geometry, order and orientation of the frames, unit and --stderr; more \
         --elements where they are coarse; --frame-constant or --background for other light. Of a \
         scene check what stands in the way, and the light it sends on (--occluder-light); give \
         --integration centres where elements were taken at their centres, as `phicam model` does"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::sample::fit;
    use crate::matrix::Matrix;
    use crate::recovery::{Options, Problem, WeightRule, recover};

    /// Where another picture fits, "leave it" is said of no option that was not given.
    #[test]
    fn a_cure_takes_back_only_what_was_given() {
        let side =
            |rows, columns| Matrix::from_fn(rows, columns, |i, j| 1.0 + ((i * j) % 3) as f64);
        let (c, d) = (side(4, 2), side(2, 3));
        let phi = &c * &d;
        let stderr = Matrix::from_element(4, 3, 0.1);
        let problem = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap();
        let judged = Judged {
            fit: Some(Fit {
                p: 0.0,
                fits: false,
                ..fit(9.0)
            }),
            best: Some(Attainable {
                possible: fit(1.0),
                any: None,
                brightness: 1.0,
                apart: None,
            }),
            ..Judged::default()
        };
        let methods = [
            Method::Joint,
            Method::Nnls,
            Method::JointUnbounded,
            Method::Pinv,
        ];
        for method in methods {
            for weighting in [WeightRule::Noise, WeightRule::Unweighted] {
                let options = Options {
                    weighting,
                    ..Options::default()
                };
                let found = recover(method, &problem, &options).unwrap();
                let told = misfit(&found, &judged).unwrap();
                let is_taken_back = told.contains("Leave --weighting");
                let was_given = weighting == WeightRule::Unweighted && method.is_joint();
                assert_eq!(is_taken_back, was_given, "{method}: {told}");
                assert_eq!(
                    told.matches("Leave").count(),
                    usize::from(was_given),
                    "{told}"
                );
            }
        }
    }

    /// Light of occluders that the model does not have comes before units and errors; of a scene
    /// whose occluders are black, or none, it is not named.
    #[test]
    fn light_of_occluders_is_the_first_cause() {
        let bright = Attainable {
            possible: Fit {
                p: 0.0,
                fits: false,
                ..fit(9.0)
            },
            any: None,
            brightness: 1.4,
            apart: None,
        };
        for best in [
            bright.clone(),
            Attainable {
                brightness: 1.0,
                ..bright
            },
        ] {
            for scene in ["corner", "bench"] {
                let scene = crate::scene::Scene::load(scene).unwrap();
                let told = contradiction(&best, scene.sent_on().as_deref());
                let [own, general] = [told.find("--occluder-light)."), told.find("Is Φcam in W")];
                let general = general.or_else(|| told.find("The scene is not"));
                assert_eq!(own.is_some(), scene.name == "corner", "{told}");
                assert!(own < general, "{told}");
            }
        }
    }
}
