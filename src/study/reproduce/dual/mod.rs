//! The dual image: a traced light-transport matrix transposed, and why transposing is not inverting.
//!
//! T of c′ = T p′ is the Φcam that is traced for a projector whose pixels are the laser spots of the scene `dual`. Its transpose is the light transport with projector
//! and camera exchanged ([`pair`]), as in Sen et al., *Dual Photography* (ACM Transactions on Graphics 24(3), 2005). There each projector pixel lights the one
//! scene point that is to be seen, and the transpose shows it. Here projector and camera see the same matt wall, and what is hidden stands behind one more
//! diffuse reflection on either way: the dual image is another photograph of the wall. The board is in T = C diag(ρ) D, but G12 and G23 have to be inverted to see
//! it; their transposes would do that only if the singular values of T were all alike.

mod adjoint;
mod checks;
mod judged;
mod pair;
mod reciprocity;
#[cfg(test)]
mod tests;

use super::figure::{computed, decades, elements, linear};
use super::photographs::REPLICATES;
use super::{
    Cell, Gallery, Item, Picture, Plot, ReproduceError, ReproducePlan, Reproduction, Shades, Watch,
};
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel};
use crate::num::linalg::svd;
use crate::recovery::Method;
use crate::scene::Scene;
use judged::{Judged, Origin, Way, seen};
use pair::Direction;
use reciprocity::Reciprocity;

/// Pixels of camera and projector a side.
const SIDE: usize = 16;
/// Elements and checks a side of the hidden board.
const ELEMENTS: usize = 8;
const CHECKS: usize = 2;
/// Points of each replicate.
const SIZE: u32 = 8;
/// A picture shows the board where it correlates with it at least so much.
const SHOWN: f64 = 0.5;

/// A board of `CHECKS` × `CHECKS` checks, the first dark, on `side` × `side` points.
fn board(side: usize) -> Vec<f64> {
    let light = |at: usize| (at % side * CHECKS / side + at / side * CHECKS / side) % 2 == 1;
    (0..side * side)
        .map(|at| f64::from(u8::from(light(at))))
        .collect()
}

/// Singular values of T over the first.
fn spectrum(t: &Matrix) -> Result<Vec<f64>, ReproduceError> {
    let sigma = svd(t)?.sigma;
    Ok(sigma.iter().map(|s| s / sigma[0]).collect())
}

/// (Σ σ²)²/Σ σ⁴: how many alike singular values T Tᵀ would have; all of them where the transpose is the inverse.
fn participation(sigma: &[f64]) -> f64 {
    let sum = |power: i32| sigma.iter().map(|s| s.powi(power)).sum::<f64>();
    sum(2) * sum(2) / sum(4)
}

/// ‖a − s·b‖/‖a‖ with the best scale s.
fn change(a: &[f64], b: &[f64]) -> f64 {
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let scale = dot(a, b) / dot(b, b);
    let left: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - scale * b).collect();
    (dot(&left, &left) / dot(a, a)).sqrt()
}

/// Width of the camera's view, of the projector's and of the board, in.
const WIDTH: f64 = 4.0;

fn picture(title: &str, values: &[f64]) -> Picture {
    Picture {
        title: title.to_owned(),
        size: [SIDE; 2],
        values: values.to_vec(),
        axes: ["x", "y"].map(str::to_owned),
        width: WIDTH,
    }
}

pub(super) fn figure(
    plan: &ReproducePlan,
    watch: Watch<'_>,
) -> Result<Reproduction, ReproduceError> {
    let scene = Scene::load("dual")?;
    let back = pair::exchanged(&scene)?;
    let there = Direction::trace(scene, SIZE, plan.first_seed, watch)?;
    let back = Direction::trace(back, SIZE, plan.first_seed.wrapping_add(1), watch)?;
    watch.go_on()?;
    let law = Reciprocity::new(&there, &back)?;
    let (t, error) = (&there.traced.flux, &there.traced.stderr);

    let model = MatrixModel::new(&there.scene, Kernel::Physical, None)?;
    let grey = MatrixModel::new(&there.scene.with_mean_albedo(), Kernel::Physical, None)?.phi();
    let exact = model.phi();
    // c′ = T 1, and c″ = diag(E′) Tᵀ diag(1/E) 1.
    let flood = |t: &Matrix| t.column_sum().as_slice().to_vec();
    let dual = |t: &Matrix| {
        let (sums, power) = (there.transport(t).row_sum(), there.scene.laser.power);
        let of = |(k, e): (&f64, &f64)| power * e * k;
        sums.iter()
            .zip(&back.etendues)
            .map(of)
            .collect::<Vec<f64>>()
    };
    let wall = board(SIDE);
    let pictures = [
        Judged::new(
            "primal image, T times 1: what the camera sees",
            Origin::Traced,
            Way::Photograph,
            flood(t),
            &wall,
        ),
        Judged::new(
            "dual image, T transposed: what the projector sees",
            Origin::Traced,
            Way::Photograph,
            dual(t),
            &wall,
        ),
        Judged::new(
            "photograph by the exchanged pair",
            Origin::Exchanged,
            Way::Photograph,
            flood(&back.traced.flux),
            &wall,
        ),
    ];
    watch.go_on()?;
    let mut found = seen(Origin::Traced, t, Some(error), &model)?;
    watch.go_on()?;
    found.extend(seen(Origin::Modelled, &exact, None, &model)?);
    let (traced, modelled) = (spectrum(t)?, spectrum(&exact)?);

    let changes = [
        change(&flood(&exact), &flood(&grey)),
        change(&dual(&exact), &dual(&grey)),
    ];
    let mut rows: Vec<Vec<Cell>> = pictures.iter().chain(&found).map(Judged::row).collect();
    for (matrix, sigma) in [("traced", &traced), ("modelled", &modelled)] {
        rows.extend(sigma.iter().enumerate().map(|(k, s)| {
            vec![
                "singular value of T over the first".into(),
                matrix.into(),
                (k + 1).into(),
                (*s).into(),
                None.into(),
                None.into(),
                None.into(),
            ]
        }));
    }
    let loudest = error.norm() / t.norm();
    Ok(Reproduction {
        item: Item::Dual,
        title: "The dual image: a traced matrix transposed, and why transposing is not inverting"
            .to_owned(),
        caption: format!(
            "Scene `dual`: {SIDE} × {SIDE} laser spots (the projector's pixels) on x ∈ [6.75, 10.75] in., {SIDE} × {SIDE} camera pixels on x ∈ [0.5, 4.5] in. of the wall, both y ∈ \
             [2.375, 6.375] in.; hidden {CHECKS} × {CHECKS} board, {ELEMENTS} × {ELEMENTS} elements; three surfaces met. T is Φcam, traced ({} paths for each pixel and spot, \
             independent, Sobol' points, seed {}; noise {:.2} % of T). Exchanged pair: traced anew with the next seed, pinhole at the laser's place, its view the projector's cells, spots at the centres of the camera's \
             pixels; T′ = diag(E′) Tᵀ diag(1/E), E and E′ the étendues of the pixels. Physical kernel in the model; pinv cut at max(r, l)·2⁻⁵²·σ1; pictures of the board stretched to [0, 1] by \
             their own ends.",
            REPLICATES * SIZE,
            plan.first_seed,
            100.0 * loudest
        ),
        columns: [
            "what",
            "matrix",
            "k",
            "value",
            "mtf_raw",
            "mtf_normalized",
            "correlation",
        ].map(str::to_owned).to_vec(),
        rows,
        plots: vec![spectra(&traced, &modelled)],
        galleries: galleries(&pictures, &found),
        checks: checks::checks(&law, &pictures, &found, &traced),
        notes: vec![
            format!(
                "The board is in both pictures of the wall, but not to be seen: against a grey object of its mean albedo it changes the primal image by {:.2} % and the dual image by \
                 {:.2} % (model, after the best scale), as smooth gradients.",
                100.0 * changes[0],
                100.0 * changes[1]
            ),
            "A transposed matrix exchanges the parts of light and eye and nothing else. What the projector's place would photograph is the wall, for the wall is what the projector lights; the hidden \
             board is seen neither from there nor from the camera. To see it, G12 and G23 of T = C diag(ρ) D have to be inverted."
                .to_owned(),
        ],
    })
}

fn spectra(traced: &[f64], modelled: &[f64]) -> Plot {
    let points = |sigma: &[f64]| -> Vec<[f64; 2]> {
        let shown = sigma.iter().enumerate().take(SHOWN_VALUES);
        shown
            .filter(|(_, s)| **s > LEAST)
            .map(|(k, s)| [(k + 1) as f64, *s])
            .collect()
    };
    Plot {
        title: "Singular values of T".to_owned(),
        axes: [linear("k", [0.0, SHOWN_VALUES as f64]), decades("σk / σ1")],
        curves: vec![
            computed("T traced (its tail is noise)", points(traced)),
            computed("T modelled", points(modelled)),
            computed(
                "if the transpose were the inverse but for a scale",
                points(&[1.0; SHOWN_VALUES]),
            ),
        ],
    }
}

/// Singular values that are drawn, and the least of them; below it there is only rounding.
const SHOWN_VALUES: usize = 48;
const LEAST: f64 = 1e-17;

fn galleries(pictures: &[Judged; 3], found: &[Judged]) -> Vec<Gallery> {
    let traced = found.iter().filter(|j| j.origin == Origin::Traced);
    let mut boards = vec![elements("true board", ELEMENTS, board(ELEMENTS))];
    boards.extend(traced.map(|j| elements(j.what, ELEMENTS, j.stretched())));
    boards.extend(
        found
            .iter()
            .filter(|j| j.origin == Origin::Modelled && j.way == Way::Inverse(Method::Pinv))
            .map(|j| elements(format!("{}, noiseless T", j.what), ELEMENTS, j.stretched())),
    );
    vec![
        Gallery {
            title: "The wall from the two places".to_owned(),
            shades: Shades::Values,
            unit: "W".to_owned(),
            pictures: pictures
                .iter()
                .map(|j| picture(j.what, &j.values))
                .collect(),
        },
        Gallery {
            title: "The board by transposing and by inverting the traced T, stretched to [0, 1]"
                .to_owned(),
            shades: Shades::Reflectance,
            unit: String::new(),
            pictures: boards,
        },
    ]
}
