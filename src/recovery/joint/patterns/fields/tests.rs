use super::*;
use crate::num::stream::{Key, Sampling, Stream};
use crate::recovery::bench::{Bench, normal_stream};
use crate::recovery::{Method, Options, Problem, recover};
use nalgebra::DVector;

/// Pictures of one comparison.
const DRAWS: u32 = 12;

/// Bonds along u and v of which both ends are alike, less those that are not.
fn alike([nu, nv]: [usize; 2], light: &[bool]) -> f64 {
    let mut sum = 0.0;
    for (iu, iv) in (0..nv).flat_map(|iv| (0..nu).map(move |iu| (iu, iv))) {
        let one = |on: bool, other: usize| match on {
            true if light[iu + iv * nu] == light[other] => 1.0,
            true => -1.0,
            false => 0.0,
        };
        sum += one(iu + 1 < nu, iu + iv * nu + 1) + one(iv + 1 < nv, iu + (iv + 1) * nu);
    }
    sum
}

/// P(s) of all patterns of a small grid, from all patterns of the fields of each size.
fn by_hand([nu, nv]: [usize; 2], sizes: &[usize]) -> Vec<f64> {
    let mut all = vec![0.0; 1 << (nu * nv)];
    for b in sizes {
        let (wide, high) = (nu / b, nv / b);
        let fields: Vec<Vec<bool>> = (0..1usize << (wide * high))
            .map(|at| (0..wide * high).map(|k| at >> k & 1 == 1).collect())
            .collect();
        let both = |light: &&Vec<bool>| light.contains(&true) && light.contains(&false);
        for k in 0..11 {
            let beta = 0.1 * f64::from(k);
            let one = |light: &Vec<bool>| libm::exp(beta * alike([wide, high], light));
            let z: f64 = fields.iter().filter(both).map(one).sum();
            for light in fields.iter().filter(both) {
                let lit = |j: usize| light[(j % nu) / b + (j / nu) / b * wide];
                let at = (0..nu * nv)
                    .filter(|j| lit(*j))
                    .map(|j| 1usize << j)
                    .sum::<usize>();
                all[at] += one(light) / z / 11.0 / sizes.len() as f64;
            }
        }
    }
    all
}

/// Evidence, marginals and each pattern's probability are those of the sum over all patterns by the
/// prior's own definition.
#[test]
fn sums_are_those_of_all_patterns_by_the_prior() {
    let mut normal = normal_stream(9);
    for (grid, sizes) in [
        ([4, 4], vec![2, 1]),
        ([6, 2], vec![2, 1]),
        ([3, 4], vec![1]),
    ] {
        let n = grid[0] * grid[1];
        let beforehand = by_hand(grid, &sizes);
        assert!((beforehand.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        let of_size = |b: &usize| Fields::of_size(&[grid], *b);
        let fields: Vec<Fields> = sizes.iter().map(of_size).collect();
        let r = DMatrix::from_fn(n, n, |_, _| normal());
        let truth = DVector::from_fn(n, |j, _| if j % grid[0] < 2 { 0.8 } else { 0.2 });
        let d = &r * truth + DVector::from_fn(n, |_, _| normal());
        let levels = [0.2, 0.8];
        let likelihood = PatternLikelihood::new(&r, &d, Some(levels));
        let found = sum(&likelihood, &fields, &[], (1000, None))
            .unwrap()
            .unwrap();
        assert_eq!(found.sum, Sum::Exhaustive);
        let (mut whole, mut light) = (0.0, DVector::<f64>::zeros(n));
        let pattern = |at: usize| -> Vec<bool> { (0..n).map(|j| at >> j & 1 == 1).collect() };
        let weight = |at: usize| {
            let x = DVector::from_fn(n, |j, _| levels[at >> j & 1]);
            beforehand[at] * libm::exp(-0.5 * (&r * x - &d).norm_squared())
        };
        for at in 0..1usize << n {
            whole += weight(at);
            light += DVector::from_fn(n, |j, _| weight(at) * (at >> j & 1) as f64);
        }
        let off = found.log_evidence - libm::log(whole);
        assert!(off.abs() < 1e-9, "{grid:?} {off:e}");
        let off = (found.patterns.moments.light() - light / whole).amax();
        assert!(off < 1e-9, "{grid:?} {off:e}");
        for at in 0..1usize << n {
            let off = found.patterns.share(&pattern(at)) - weight(at) / whole;
            assert!(off.abs() < 1e-9, "{grid:?} {at} {off:e}");
        }
    }
}

/// Two surfaces have fields of one size; where these do not divide them, or are too few, elements
/// are by themselves, and without a grid nothing is alike.
#[test]
fn fields_divide_all_surfaces() {
    let of = |grids: &[[usize; 2]]| -> Vec<usize> {
        Fields::alike(grids)
            .iter()
            .map(|fields| fields.count)
            .collect()
    };
    assert_eq!(of(&[[8, 8]]), [16, 64]);
    assert_eq!(of(&[[8, 8], [2, 4]]), [18, 72]);
    assert_eq!(of(&[[6, 8]]), [48]);
    assert_eq!(of(&[[7, 5]]), [35]);
    assert!(of(&[]).is_empty());
    let fields = [Fields::of_size(&[[2, 2], [4, 2]], 2)];
    assert_eq!(fields[0].of, [0, 0, 0, 0, 1, 1, 2, 2, 1, 1, 2, 2]);
    assert_eq!(fields[0].fields(&[true; 12]), Some(vec![true; 3]));
    let mixed: Vec<bool> = (0..12).map(|j| j == 5).collect();
    assert_eq!(fields[0].fields(&mixed), None);
}

/// Where no two levels can be there are no probabilities, and where fields of 2 × 2 elements cannot
/// be, only those of single ones count.
#[test]
fn what_cannot_be_does_not_count() {
    let r = DMatrix::from_diagonal_element(16, 16, 1e3);
    let fields = [2, 1].map(|b| Fields::of_size(&[[4, 4]], b));
    let of = |d: &DVector<f64>, own: Option<Summed>| {
        let likelihood = PatternLikelihood::new(&r, d, None);
        sum(&likelihood, &fields, &[], (1000, own)).unwrap()
    };
    assert!(of(&DVector::from_element(16, -1e5), None).is_none());
    let board = DVector::from_fn(16, |j, _| if (j + j / 4) % 2 == 0 { 800.0 } else { 200.0 });
    let found = of(&board, None).unwrap();
    assert!(found.patterns.likeliest().unwrap().1 > 0.999);
    // Its share is one of two sizes'.
    let likelihood = PatternLikelihood::new(&r, &board, None);
    let single = fields[1].sum(&likelihood, &[], (0, 0.0)).unwrap().unwrap();
    let half = single.log_evidence - std::f64::consts::LN_2;
    assert!((found.log_evidence - half).abs() < 1e-12);
    assert!((of(&board, Some(single)).unwrap().log_evidence - half).abs() < 1e-12);
}

/// A pattern by the prior of 8 × 8 elements: a size, a degree β, and fields of it by heat bath.
fn drawn(random: &mut Stream) -> Vec<bool> {
    let mut below = |n: usize| ((random.uniform() * n as f64) as usize).min(n - 1);
    let b = [1, 2][below(2)];
    let beta = 0.1 * below(11) as f64;
    let across = 8 / b;
    loop {
        let mut light: Vec<bool> = (0..across * across)
            .map(|_| random.uniform() < 0.5)
            .collect();
        for step in 0..2000 * light.len() {
            let k = step % light.len();
            let mut sums = [0.0; 2];
            for (sum, own) in sums.iter_mut().zip([false, true]) {
                light[k] = own;
                *sum = alike([across; 2], &light);
            }
            let odds = libm::exp(beta * (sums[0] - sums[1]));
            light[k] = random.uniform() < 1.0 / (1.0 + odds);
        }
        if light.contains(&true) && light.contains(&false) {
            return (0..64)
                .map(|j| light[(j % 8) / b + j / 8 / b * across])
                .collect();
        }
    }
}

/// Pictures by the prior, levels too, at noises that leave patterns open: the recovered pattern is
/// right as often as its probability where neighbours may be alike says, and so are the settled. Of
/// 60 draws, so many once, 53 were stated and 45 right (45.0 expected), 42 settled and right
/// (40.7).
#[test]
#[ignore = "slow"]
fn patterns_are_right_as_often_as_they_say() {
    let bench = Bench::new(6.0, 8, 16);
    let (mut all, mut settled) = (Calibration::default(), Calibration::default());
    for draw in 0..DRAWS {
        let key = Key {
            seed: 21,
            spot: draw,
            pixel: 0,
            block: 0,
        };
        let random = &mut Stream::new(Sampling::Pcg, key);
        let light = drawn(random);
        let [x, y] = [random.uniform(), random.uniform()];
        let level = |light: &bool| if *light { x.max(y) } else { x.min(y) };
        let truth = DVector::from_iterator(64, light.iter().map(level));
        let exact = bench.phi(&truth);
        let stderr = &exact * [1e-3, 1e-2, 3e-2][draw as usize % 3];
        let phi = exact.zip_map(&stderr, |x, s| x + s * random.normal());
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let problem = problem.with_grids(&[[8, 8]]).unwrap();
        let found = recover(Method::JointTwoValued, &problem, &Options::default()).unwrap();
        let patterns = found.patterns.unwrap();
        let Some(of) = &patterns.if_alike else {
            continue;
        };
        let middle = 0.5 * (found.reflectance.min() + found.reflectance.max());
        let same = found
            .reflectance
            .iter()
            .zip(&light)
            .all(|(x, light)| (*x > middle) == *light);
        // Here the levels are exact.
        let probability = of.pattern / of.exact.unwrap_or(1.0);
        all.add(same, probability);
        if patterns.settled_if_alike {
            settled.add(same, probability);
            assert!(probability >= 0.5);
        }
    }
    let most = f64::from(DRAWS);
    assert!(
        all.count > 0.6 * most && settled.count > 0.4 * most,
        "{all:?} {settled:?}"
    );
    for of in [all, settled] {
        assert!(
            (of.right - of.expected).abs() < 4.0 * of.variance.sqrt() + 0.5,
            "{of:?}"
        );
    }
}

/// Of events that have stated probabilities, how many happened, and how many should have.
#[derive(Debug, Default)]
struct Calibration {
    count: f64,
    right: f64,
    expected: f64,
    variance: f64,
}

impl Calibration {
    fn add(&mut self, happened: bool, probability: f64) {
        self.count += 1.0;
        self.right += f64::from(u8::from(happened));
        self.expected += probability;
        self.variance += probability * (1.0 - probability);
    }
}
