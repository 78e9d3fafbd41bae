//! Pictures of natural statistics by `joint-gp`: how near, and how well covered.

use rayon::prelude::*;

use super::leaves;
use crate::lab::ensemble::Photographs;
use crate::model::{Kernel, MatrixModel};
use crate::num::statistics::{sidak_threshold, student_threshold};
use crate::recovery::{Method, Options};
use crate::scene::Scene;

/// Pictures, elements a side and root mean square deviation from their own means on average, that
/// of the crops of photographs of the published comparison.
const PICTURES: u64 = 4;
const ELEMENTS: usize = 16;
const FLAT: f64 = 0.147;
/// Seeds of the pictures from here on.
const FIRST: u64 = 90_000;

/// Root mean square about the mean.
fn deviation(picture: &[f64]) -> f64 {
    let n = picture.len() as f64;
    let mean = picture.iter().sum::<f64>() / n;
    (picture.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// The pictures, of one contrast that makes their deviation [`FLAT`] on average.
fn pictures() -> Vec<Vec<f64>> {
    let all = |contrast| -> Vec<Vec<f64>> {
        let of = |seed| leaves(ELEMENTS, contrast, FIRST + seed);
        (0..PICTURES).map(of).collect()
    };
    let mean = |all: &[Vec<f64>]| all.iter().map(|p| deviation(p)).sum::<f64>() / all.len() as f64;
    all(0.1 * FLAT / mean(&all(0.1)))
}

/// Over both rings and noises of 1e-3 to 1e-1: root mean square errors below those of flat
/// pictures, and bands of 95 % that cover 95 % of all elements within 2 % and what scatters from
/// picture to picture, at each ring and noise (Student's t of so few pictures, false once in a
/// hundred over the six) and in the mean over all.
#[test]
#[ignore = "slow"]
fn pictures_of_leaves_are_near_and_covered() {
    let pictures = pictures();
    let limit = student_threshold(sidak_threshold(0.01, 6), PICTURES as f64 - 1.0);
    let mut short = Vec::new();
    let mut shares = Vec::new();
    for half_width in ["3.0", "6.0"] {
        let text = Scene::load("bench").unwrap().text;
        let text = text.replace("half_width = 3.0", &format!("half_width = {half_width}"));
        // The wider ring is beyond the bench's wall.
        let text = text.replace(
            "corner = [0, 0, 0], u = [11.5, 0, 0], v = [0, 15.5, 0]",
            "corner = [-4, -4, 0], u = [18, 0, 0], v = [0, 19.5, 0]",
        );
        let scene = Scene::from_toml("ring", &text).unwrap();
        let model = MatrixModel::new(&scene, Kernel::Physical, Some([ELEMENTS; 2])).unwrap();
        for noise in [1e-3, 1e-2, 1e-1] {
            let options = Options {
                bands: Some(0.95),
                ..Options::default()
            };
            let one = |(seed, picture): (usize, &Vec<f64>)| {
                let mut model = model.clone();
                model.albedo = picture.clone();
                let photographs = Photographs::relative(&model.phi(), noise, seed as u64);
                let found = photographs
                    .recover(&model, Method::JointGp, &options)
                    .unwrap();
                let n = picture.len() as f64;
                let off = found
                    .reflectance
                    .iter()
                    .zip(picture)
                    .map(|(x, t)| (x - t).powi(2));
                let covered = found.bands.unwrap().covered(picture);
                ((off.sum::<f64>() / n).sqrt(), covered as f64 / n)
            };
            let found: Vec<(f64, f64)> = pictures.par_iter().enumerate().map(one).collect();
            let n = found.len() as f64;
            let mean = |of: fn(&(f64, f64)) -> f64| found.iter().map(of).sum::<f64>() / n;
            let (error, share) = (mean(|f| f.0), mean(|f| f.1));
            let flat = pictures.iter().map(|p| deviation(p)).sum::<f64>() / n;
            let spread = found.iter().map(|f| (f.1 - share).powi(2)).sum::<f64>();
            let stderr = (spread / (n * (n - 1.0))).sqrt();
            if error >= flat || (share - 0.95).abs() > 0.02 + limit * stderr {
                short.push((half_width, noise, error, flat, share, stderr));
            }
            shares.push((share, stderr));
        }
    }
    let n = shares.len() as f64;
    let share = shares.iter().map(|s| s.0).sum::<f64>() / n;
    // The same pictures at each ring and noise: their errors hang together.
    let stderr = shares.iter().map(|s| s.1).sum::<f64>() / n;
    assert!(short.is_empty(), "{short:?}");
    assert!(
        (share - 0.95).abs() < 0.02 + 3.0 * stderr,
        "{share} {stderr}"
    );
}
