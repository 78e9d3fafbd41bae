//! The codes against simulated blocks: what is flagged, and how good the rest is.

use super::*;
use crate::num::stream::{Key, Sampling, Stream};
use crate::num::summation::mean_and_stderr;
use crate::transport::spread::Spread;

const PIXELS: usize = 256;
const COLUMNS: usize = 64;
const BLOCKS: usize = 32;
/// Student's quantiles of 31 degrees of freedom at 95 % and 99.9 %, two-sided.
const QUANTILES: [f64; 2] = [2.0395, 3.6335];

/// The total of one block: how it is drawn, and its mean.
#[derive(Clone, Copy, Debug)]
enum Law {
    /// Mean 10, σ 1.
    Normal,
    Exponential,
    /// exp(σ·normal).
    Lognormal(f64),
    /// Lit with a probability, then 1 + 0.15·normal.
    Lit(f64),
    /// [`Law::Normal`] and, with a probability, a spike.
    Spiked(f64, f64),
    /// x > 1 with density ∝ x^−(a+1).
    Pareto(f64),
}

impl Law {
    fn draw(self, stream: &mut Stream) -> f64 {
        match self {
            Self::Normal => 10.0 + stream.normal(),
            Self::Exponential => -libm::log(stream.uniform()),
            Self::Lognormal(sigma) => libm::exp(sigma * stream.normal()),
            Self::Lit(p) if stream.uniform() < p => 1.0 + 0.15 * stream.normal(),
            Self::Lit(_) => 0.0,
            Self::Spiked(p, height) if stream.uniform() < p => height + 10.0 + stream.normal(),
            Self::Spiked(..) => 10.0 + stream.normal(),
            Self::Pareto(a) => libm::pow(1.0 - stream.uniform(), -1.0 / a),
        }
    }

    fn mean(self) -> f64 {
        match self {
            Self::Normal => 10.0,
            Self::Exponential => 1.0,
            Self::Lognormal(sigma) => libm::exp(0.5 * sigma * sigma),
            Self::Lit(p) => p,
            Self::Spiked(p, height) => 10.0 + p * height,
            Self::Pareto(a) => a / (a - 1.0),
        }
    }
}

/// Totals joined one by one.
fn spread(totals: &[f64]) -> Spread {
    let mut whole = Spread::of_block(totals[0]);
    let mut sum = totals[0];
    for (n, total) in (1..).zip(&totals[1..]) {
        let n = f64::from(n);
        whole = whole.join(Spread::of_block(*total), [n, 1.0], total - sum / n);
        sum += total;
    }
    whole
}

/// Shares: flagged by themselves, flagged in all, and of those that are left outside 95 % and
/// outside 99.9 %.
#[derive(Debug)]
struct Found {
    own: f64,
    flagged: f64,
    left: usize,
    outside: [f64; 2],
}

/// Entries of which a share is drawn from `law`, and the others are normal.
fn simulate(law: Law, share: f64) -> Found {
    let key = Key {
        seed: 18,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    let [mut flux, mut stderr, mut tails, mut truth] =
        [(); 4].map(|()| Matrix::zeros(PIXELS, COLUMNS));
    for i in 0..flux.len() {
        let is_of_law = stream.uniform() < share;
        let law = if is_of_law { law } else { Law::Normal };
        let totals: Vec<f64> = (0..BLOCKS).map(|_| law.draw(&mut stream)).collect();
        let (mean, error) = mean_and_stderr(&totals);
        let code = spread(&totals).code(BLOCKS as f64, mean);
        // The tracer flags what is dark and can be lit, and bounds it by the rule of three.
        let [code, error] = if mean == 0.0 {
            [f64::from(UNLIT), 3.0 / BLOCKS as f64]
        } else {
            [f64::from(code), error]
        };
        tails[i] = code;
        (flux[i], stderr[i], truth[i]) = (mean, error, law.mean());
    }
    let flagged = |tails: &Matrix| tails.iter().filter(|c| **c != 0.0).count() as f64;
    let own = flagged(&tails);
    flag_neighbours(&mut tails, &flux, &stderr);
    let all = tails.len() as f64;
    let left: Vec<usize> = (0..tails.len()).filter(|i| tails[*i] == 0.0).collect();
    let outside = QUANTILES.map(|t| {
        let outside = |i: &&usize| (flux[**i] - truth[**i]).abs() > t * stderr[**i];
        left.iter().filter(outside).count() as f64 / left.len().max(1) as f64
    });
    Found {
        own: own / all,
        flagged: flagged(&tails) / all,
        left: left.len(),
        outside,
    }
}

/// Blocks that are normal are trusted, but for fewer than 1 in 100.
#[test]
fn normal_blocks_are_trusted() {
    let found = simulate(Law::Normal, 1.0);
    assert!(found.own < 0.01 && found.flagged < 0.01, "{found:?}");
}

/// Whatever the blocks are drawn from: of the entries that are trusted at most 6 % lie outside
/// their 95 % and 0.3 % outside their 99.9 %, or hardly any is trusted. What is too heavy for 32
/// blocks is flagged to the last entry.
#[test]
fn trusted_entries_keep_their_promise() {
    let rare = |expected: f64| expected / BLOCKS as f64;
    for (law, share, heavy) in [
        (Law::Normal, 1.0, false),
        (Law::Exponential, 1.0, true),
        (Law::Lognormal(0.1), 1.0, false),
        (Law::Lognormal(0.2), 1.0, false),
        (Law::Lognormal(0.3), 1.0, false),
        (Law::Lognormal(1.0), 1.0, true),
        (Law::Lognormal(3.0), 1.0, true),
        (Law::Lit(0.9), 1.0, true),
        (Law::Lit(0.5), 1.0, false),
        (Law::Lit(0.1), 1.0, true),
        (Law::Lit(0.01), 1.0, true),
        (Law::Spiked(rare(0.03), 1000.0), 1.0, true),
        (Law::Spiked(rare(0.03), 10.0), 1.0, false),
        (Law::Spiked(rare(0.1), 30.0), 1.0, true),
        (Law::Spiked(rare(1.0), 5.0), 1.0, true),
        (Law::Pareto(1.5), 1.0, true),
        (Law::Exponential, 0.1, false),
        (Law::Lognormal(1.0), 0.1, false),
        (Law::Pareto(1.5), 0.02, false),
    ] {
        let found = simulate(law, share);
        let Found { left, outside, .. } = found;
        assert!(!heavy || left == 0, "{law:?}: {found:?}");
        // 0.3 % of fewer than 1000 entries is no count; there is 1 % of them at most.
        let kept = outside[0] <= 0.06 && outside[1] <= 0.003;
        let few = left < 1000 && found.flagged > 0.99;
        assert!(kept || few, "{law:?} {share}: {found:?}");
    }
}

/// Scatter, third sum, largest and dark blocks against their definitions, however the blocks are
/// divided.
#[test]
fn joined_blocks_have_the_moments_of_all() {
    let totals = [3.0, 0.0, 1.5, 0.0, 40.0, 2.0, 0.25, 8.0, 0.0, 1.0, 7.0];
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let central = |k: i32| {
        totals
            .iter()
            .map(|t| (t - mean(&totals)).powi(k))
            .sum::<f64>()
    };
    for cut in 1..totals.len() {
        let (a, b) = totals.split_at(cut);
        let counts = [a, b].map(|x| x.len() as f64);
        let whole = spread(a).join(spread(b), counts, mean(b) - mean(a));
        assert!(
            (whole.scatter / central(2) - 1.0).abs() < 1e-13,
            "{whole:?}"
        );
        assert!((whole.third / central(3) - 1.0).abs() < 1e-13, "{whole:?}");
        assert_eq!((whole.largest, whole.dark), (40.0, 3.0));
    }
}

/// One spike among flat blocks has their scatter, and rounding has no tail.
#[test]
fn codes_say_why() {
    let mut totals = [1.0; BLOCKS];
    totals[7] = 1.0 + 1e-15;
    assert_eq!(spread(&totals).code(32.0, 1.0), 0);
    totals[7] = 2.0;
    assert_eq!(spread(&totals).code(32.0, 33.0 / 32.0), LARGEST | SKEWED);
    let mut totals = [0.0; BLOCKS];
    totals[..10].fill(1.0);
    assert_eq!(spread(&totals).code(32.0, 10.0 / 32.0), FEW_LIT);
    totals[..10].fill(0.0);
    totals[3] = 1.0;
    assert_eq!(
        spread(&totals).code(32.0, 1.0 / 32.0),
        LARGEST | SKEWED | FEW_LIT
    );
}

/// Two flagged entries of twenty take their column along, what is known to be dark aside; a single
/// one only where its light would move the others; and to ask again changes nothing.
#[test]
fn neighbours_follow() {
    let flagged = |codes: &[(usize, u32)], stderr: f64| {
        let flux = Matrix::from_fn(20, 1, |p, _| if p == 19 { 0.0 } else { 1.0 });
        let mut errors = flux.map(|x| 0.1 * x);
        let mut tails = Matrix::zeros(20, 1);
        for (p, code) in codes {
            tails[*p] = f64::from(*code);
            errors[*p] = stderr;
        }
        flag_neighbours(&mut tails, &flux, &errors);
        let first = tails.clone();
        flag_neighbours(&mut tails, &flux, &errors);
        assert_eq!(first, tails);
        tails
            .iter()
            .filter(|c| **c == f64::from(NEIGHBOURS))
            .count()
    };
    assert_eq!(flagged(&[(3, SKEWED)], 0.1), 0);
    assert_eq!(flagged(&[(3, SKEWED), (4, FEW_LIT)], 0.1), 17);
    // 0.56/19 is less than 0.3·0.1, 0.58/19 is more.
    assert_eq!(flagged(&[(3, LARGEST)], 0.56), 0);
    assert_eq!(flagged(&[(3, LARGEST)], 0.58), 18);
    assert_eq!(flagged(&[(3, UNLIT)], 100.0), 0);
    // A shadow, however large.
    assert_eq!(flagged(&[3, 4, 5, 6].map(|p| (p, UNLIT)), 100.0), 0);
}
