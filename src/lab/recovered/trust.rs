//! Which picture is shown first.

use std::collections::BTreeMap;

use super::objects::RecoveredObject;
use crate::recovery::Method;

/// No surface's reflectance is as far from ½ as this.
const IMPOSSIBLE: f64 = 1.0;
/// Below this probability of exact levels a picture of two is taken for refuted.
const EXACT: f64 = 0.05;

/// Methods whose pictures something holds where the photographs do not: bounds, or a prior.
const HELD: [Method; 5] = [
    Method::Joint,
    Method::Nnls,
    Method::JointTv,
    Method::JointTwoValued,
    Method::JointGp,
];
/// A picture of which the photographs determine less than this share is not told by them alone.
const DETERMINED: f64 = 0.9;

/// Puts first what can be vouched for, and last pictures that no bounds hold where they are
/// impossible or the photographs do not determine them, whatever is said of their fit. Of the
/// others methods that explain the photographs come first; of those the ones that know how likely
/// their assumption makes the photographs, that of the least expected squared error first, then the
/// likeliest; then those that a surface can be, and those with the fewest warnings. What is equal
/// stays in its order, and so do the surfaces of one method, which stand together.
pub fn by_trust(objects: &mut [RecoveredObject]) {
    let mut ranks: BTreeMap<String, Rank> = BTreeMap::new();
    for (first, object) in objects.iter().enumerate() {
        let rank = ranks.entry(object.method.clone()).or_insert(Rank {
            evidence: evidence(object).unwrap_or(f64::NEG_INFINITY),
            nearest: object.likelier.is_some(),
            first,
            ..Rank::default()
        });
        rank.refuted |= object.fit.as_ref().is_some_and(|fit| !fit.fits);
        rank.refuted |= object
            .patterns
            .as_ref()
            .is_some_and(|p| p.assumed().exact.is_some_and(|p| p < EXACT));
        rank.impossible |= is_impossible(object);
        rank.unheld |= is_unheld(object);
        rank.warnings = rank.warnings.max(object.warnings.len());
    }
    objects.sort_by(|a, b| {
        let [a, b] = [a, b].map(|object| &ranks[&object.method]);
        let fits = a.unheld.cmp(&b.unheld).then(a.refuted.cmp(&b.refuted));
        fits.then(b.nearest.cmp(&a.nearest))
            .then(b.believed().total_cmp(&a.believed()))
            .then(a.impossible.cmp(&b.impossible))
            .then(a.warnings.cmp(&b.warnings))
            .then(a.first.cmp(&b.first))
    });
}

/// What speaks for and against a method, all surfaces together.
#[derive(Default)]
struct Rank {
    /// Whether neither photographs nor bounds hold its picture.
    unheld: bool,
    refuted: bool,
    /// Whether its picture is expected to be the nearest to the truth.
    nearest: bool,
    evidence: f64,
    impossible: bool,
    warnings: usize,
    /// Where it stood.
    first: usize,
}

impl Rank {
    /// The evidence, which says nothing of what does not explain the photographs.
    fn believed(&self) -> f64 {
        if self.refuted {
            f64::NEG_INFINITY
        } else {
            self.evidence
        }
    }
}

/// How likely its assumption makes the photographs, ln; none where that was summed over patterns
/// and is not to be believed.
fn evidence(object: &RecoveredObject) -> Option<f64> {
    let believed = object
        .patterns
        .as_ref()
        .is_none_or(|p| p.believed().is_some());
    object.log_evidence.filter(|_| believed)
}

fn is_unheld(object: &RecoveredObject) -> bool {
    let is_held = HELD.iter().any(|method| method.name() == object.method);
    let least = DETERMINED * object.unknowns as f64;
    let undetermined = object.determined.is_some_and(|rank| rank < least);
    !is_held && (undetermined || is_impossible(object))
}

fn is_impossible(object: &RecoveredObject) -> bool {
    let mut beyond = object.reflectance.iter().map(|x| (x - 0.5).abs());
    let known = object.estimated.as_ref().is_none_or(|e| e.scale.is_none());
    known && beyond.any(|x| x > IMPOSSIBLE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::study::tests::small;
    use crate::lab::{Certainty, Noise, recover_objects};
    use crate::model::{Kernel, MatrixModel};
    use crate::num::control::Control;
    use crate::recovery::{Nuisance, Options, Sum};

    /// Of a board of two levels the pattern comes first, then what fits, the possible before the
    /// impossible; what does not fit is last, in its order.
    #[test]
    fn what_explains_comes_first_and_what_is_likeliest_before_it() {
        let model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([4, 4])).unwrap();
        let exact = model.phi();
        let stderr = exact.map(|x| 1e-3 * x.abs());
        let phi = exact.map_with_location(|p, l, x| {
            x * (1.0 + 1e-3 * libm::sin((p * 37 + l * 101) as f64) * std::f64::consts::SQRT_2)
        });
        let noise = Noise::StandardError(&stderr, Certainty::STATED);
        let tried = Method::tried(16);
        let (nuisance, options) = (Nuisance::default(), Options::default());
        let found = recover_objects(
            &model,
            &phi,
            noise,
            nuisance,
            &tried,
            &options,
            Control::none(),
        );
        let mut objects: Vec<_> = found.into_iter().flat_map(|a| a.outcome.unwrap()).collect();
        by_trust(&mut objects);
        assert_eq!(objects[0].method, "joint-two-valued");
        assert_eq!(objects[1].method, "joint-gp");
        let fits: Vec<bool> = objects
            .iter()
            .map(|o| o.fit.as_ref().unwrap().fits)
            .collect();
        assert!(fits[0] && fits.is_sorted_by(|a, b| a >= b), "{fits:?}");
        let at = |name: &str| objects.iter().position(|o| o.method == name);
        assert!(at("joint") < at("joint-unbounded"), "{fits:?}");
        // Surfaces of one method stand together, whichever of them speaks against it.
        let of = |surface: &str, x: f64| RecoveredObject {
            surface: surface.to_owned(),
            reflectance: vec![x; 16],
            ..objects[1].clone()
        };
        let mut surfaces = vec![of("a", -0.9), of("b", 0.5)];
        by_trust(&mut surfaces);
        assert_eq!(surfaces[0].surface, "a");
        // Probabilities that are not to be believed put no pattern first.
        let mut untold = objects.clone();
        let patterns = untold[0].patterns.as_mut().unwrap();
        patterns.if_alike = None;
        patterns.sum = Sum::Sampled {
            draws: 1000,
            listed: 0.5,
            disagreement: 0.2,
        };
        untold[0].likelier = None;
        by_trust(&mut untold);
        assert_eq!(untold[0].method, "joint-gp");
        // Without its fit the first is no longer one to be shown.
        let mut refuted = objects[0].clone();
        refuted.fit.as_mut().unwrap().fits = false;
        objects[0] = refuted;
        by_trust(&mut objects);
        assert_eq!(objects[0].method, "joint-gp");
    }

    /// A picture without bounds that is impossible, or that few directions tell, comes after those
    /// that something holds, though it alone fits and has no warnings. Where all of it is
    /// determined it keeps its place.
    #[test]
    fn nothing_leads_that_only_fits() {
        let results = crate::lab::sample::run("bench");
        let of = |method: Method, fits: bool, values: f64, determined: f64| {
            let mut object = results.recovered[0].clone();
            object.method = method.name().to_owned();
            object.warnings = if fits {
                Vec::new()
            } else {
                vec![String::new()]
            };
            object.fit.as_mut().unwrap().fits = fits;
            object.determined = Some(determined * object.unknowns as f64);
            object.reflectance.fill(values);
            object
        };
        let first = |mut objects: Vec<RecoveredObject>| {
            by_trust(&mut objects);
            objects[0].method.clone()
        };
        for held in [Method::JointGp, Method::Joint, Method::JointTwoValued] {
            for (other, values, share, leads) in [
                (Method::JointUnbounded, 1e8, 1.0, false),
                (Method::Tsvd, 0.5, 0.2, false),
                (Method::Tsvd, 0.5, 1.0, true),
            ] {
                let held = of(held, false, 0.5, share);
                let due = if leads { other.name() } else { &held.method }.to_owned();
                let other = of(other, true, values, share);
                assert_eq!(first(vec![other, held]), due, "{values} {share}");
            }
        }
    }
}
