//! Where a modulation falls to a limit, between two sizes of what takes it away.
//!
//! Of a modulation m, as a share of that of which nothing is taken, noise or an error takes 1 − m.
//! Where that is little it goes with a power of the size, so that ln(1 − m) is straight over the
//! logarithm of the size; a straight m would lose too much at the small end of every step.

/// Most that a loss counts as growing from one size to the next: as the square over a decade. A
/// mean of which nothing is taken, or that scatter puts above 1, is taken for one that lost as much
/// less than the next.
const STEEPEST: f64 = 100.0;

/// How far on the way from one size to the next, in their logarithms, 0 to 1, a modulation falls to
/// `limit`; it is at or above that at the first and below at the second.
pub(super) fn way_to([from, to]: [f64; 2], limit: f64) -> f64 {
    let [last, at] = [to, limit].map(|m| 1.0 - m);
    let first = (1.0 - from).max(last / STEEPEST);
    (libm::log(at / first) / libm::log(last / first)).max(0.0)
}

/// The size at which it does, of two with the modulation there. From size 0 on, which has no
/// logarithm, the loss grows in proportion to the size.
pub(super) fn size_at([[x0, from], [x1, to]]: [[f64; 2]; 2], limit: f64) -> f64 {
    if x0 > 0.0 && x1 > 0.0 {
        x0 * libm::pow(x1 / x0, way_to([from, to], limit))
    } else {
        x0 + (x1 - x0) * (from - limit) / (from - to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Losses of 5 times the noise and of 2000 times its square, over a decade: 10 % are lost at
    /// 0.02 and at √(0.1/2000), whichever end the decade is counted from.
    #[test]
    fn a_loss_that_is_a_power_of_the_noise_is_met() {
        for (m, at) in [
            ((|x| 1.0 - 5.0 * x) as fn(f64) -> f64, 0.02),
            (|x| 1.0 - 2000.0 * x * x, (0.1f64 / 2000.0).sqrt()),
        ] {
            let [quiet, loud] = [0.3 * at, 3.0 * at];
            let found = size_at([[quiet, m(quiet)], [loud, m(loud)]], 0.9);
            assert!((found / at - 1.0).abs() < 1e-12, "{found} {at}");
        }
    }

    /// From 0.99 to 0.19 the loss grows from 0.01 to 0.81, ninefold twice: 0.09 is half way.
    #[test]
    fn it_is_straight_in_the_logarithm_of_the_loss() {
        assert!((way_to([0.99, 0.19], 0.91) - 0.5).abs() < 1e-12);
    }

    /// A first mean above 1 is that of a hundredth of the next loss: from 0.01 of 1 on to 0.1, half
    /// way. Higher means never lose the limit earlier.
    #[test]
    fn a_mean_above_one_is_no_break() {
        for from in [1.0, 1.05] {
            assert!((way_to([from, 0.0], 0.9) - 0.5).abs() < 1e-12);
        }
        let ways = [0.9, 0.95, 0.98, 0.999, 1.0, 1.02].map(|from| way_to([from, 0.2], 0.9));
        assert!(ways[0].abs() < 1e-12 && ways.is_sorted(), "{ways:?}");
        assert!(way_to([1.0, 0.1], 0.999).abs() < 1e-12);
    }

    #[test]
    fn from_nothing_on_it_is_in_proportion() {
        assert_eq!(size_at([[0.0, 0.75], [2.0, 0.25]], 0.5), 1.0);
    }
}
