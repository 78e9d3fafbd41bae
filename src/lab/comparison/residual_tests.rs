use super::*;
use crate::lab::uncertainty::certainty::Certainty;
use crate::num::stream::{Key, Sampling, Stream};
use crate::num::summation::mean_and_stderr;

const ROWS: usize = 120;
const COLUMNS: usize = 80;
const BLOCKS: u32 = 32;

/// Light whose logarithm is no sum of a term by pixel and one by spot, and its means of blocks
/// that each have m (1 + 1 − e), e of the exponential law: where a block lacks light the standard
/// error is large, so that weights by an entry's own error find too much light.
fn lacking() -> [Matrix; 3] {
    let light = Matrix::from_fn(ROWS, COLUMNS, |p, l| {
        (3.0 * (0.1 * p as f64 + 0.3 * l as f64).cos()).exp()
    });
    let (mut traced, mut stderr) = (light.clone(), light.clone());
    for at in 0..light.len() {
        let key = Key {
            seed: 1,
            spot: (at / ROWS) as u32,
            pixel: (at % ROWS) as u32,
            block: 0,
        };
        let mut stream = Stream::new(Sampling::Pcg, key);
        let block = |_| light[at] * (2.0 + (1.0 - stream.next_four()[0]).ln());
        let blocks: Vec<f64> = (0..BLOCKS).map(block).collect();
        (traced[at], stderr[at]) = mean_and_stderr(&blocks);
    }
    [light, traced, stderr]
}

/// Of errors that are known entry by entry the fit has the variance 1/Σ (d/σ)² (Gauss and Markov).
#[test]
fn known_errors_weigh_their_own_entries() {
    let [light, traced, _] = lacking();
    let stderr = Matrix::from_fn(ROWS, COLUMNS, |p, l| {
        libm::exp(4.0 * (1.3 * p as f64 * (1 + l) as f64).sin())
    });
    let fit = fitted([&light, &traced, &stderr], None);
    let information = light.component_div(&stderr).norm_squared();
    let off = fit.stderr * information.sqrt() - 1.0;
    assert!(off.abs() < 1e-9, "{off}");
}

/// The fit of the light to what was traced.
fn fitted([light, traced, stderr]: [&Matrix; 3], replicates: Option<u32>) -> Fit {
    let evidence = Evidence {
        traced,
        stderr,
        model: light,
        bound: None,
        left_out: None,
        eliminated: None,
    };
    let test = Test {
        significance: 0.01,
        known: Certainty::new(Errors::Independent, replicates),
    };
    let residual = Residual::new(evidence, test, Weights::Least);
    residual.fit(light, &(0..COLUMNS)).expect("light")
}

/// The scale of right light is 1 within its error: the law of the blocks is known.
#[test]
fn errors_that_hang_together_with_the_light_do_not_shift_its_scale() {
    let [light, traced, stderr] = lacking();
    let fit = fitted([&light, &traced, &stderr], Some(BLOCKS));
    assert!(fit.z().abs() < 4.0, "{fit:?}");
    // The least error that noise of this share allows, 1/√(entries × blocks).
    let least = 1.0 / f64::sqrt((ROWS * COLUMNS) as f64 * f64::from(BLOCKS));
    assert!(fit.stderr < 1.1 * least, "{fit:?}, least {least}");
}
