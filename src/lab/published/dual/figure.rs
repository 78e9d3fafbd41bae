//! The item.

use super::super::item::Item;
use super::super::outcome::stretched;
use super::super::plan::ReproducePlan;
use super::super::sheet::{board, elements, finding, square};
use super::super::traced::REPLICATES;
use super::checks::checks;
use super::judged::{CHECKS, ELEMENTS, Judged, Origin, Way, seen};
use super::pair::{self, Direction, SIZE};
use super::reciprocity::Reciprocity;
use super::spectrum::{plot, spectrum};
use crate::lab::LabError;
use crate::lab::finding::{Cell, Finding, Gallery, Shades, Table};
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel};
use crate::recovery::Method;
use crate::scene::Scene;
use crate::transport::Control;

/// Pixels of camera and projector a side.
const SIDE: usize = 16;
/// Width of the camera's view, of the projector's and of the board, in.
const WIDTH: f64 = 4.0;

/// ‖a − s·b‖/‖a‖ with the best scale s.
pub(super) fn change(a: &[f64], b: &[f64]) -> f64 {
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let scale = dot(a, b) / dot(b, b);
    let left: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - scale * b).collect();
    (dot(&left, &left) / dot(a, a)).sqrt()
}

fn table(pictures: &[&Judged], spectra: [(&'static str, &[f64]); 2]) -> Table {
    let mut rows: Vec<Vec<Cell>> = pictures.iter().map(|j| j.row()).collect();
    for (matrix, sigma) in spectra {
        rows.extend(sigma.iter().enumerate().map(|(k, s)| {
            let value = [(k + 1).into(), (*s).into()];
            let names = ["singular value of T over the first", matrix].map(Cell::from);
            let none = [(); 3].map(|()| None.into());
            names.into_iter().chain(value).chain(none).collect()
        }));
    }
    let header = "what,matrix,k,value,mtf_raw,mtf_normalized,correlation";
    Table::headed(header, rows)
}

/// The item.
pub(in super::super) fn figure(
    plan: &ReproducePlan,
    control: Control<'_>,
) -> Result<Finding, LabError> {
    let scene = Scene::load("dual")?;
    let back = pair::exchanged(&scene)?;
    let there = Direction::trace(scene, SIZE, plan.first_seed, control)?;
    let back = Direction::trace(back, SIZE, plan.first_seed.wrapping_add(1), control)?;
    control.check()?;
    let law = Reciprocity::new(&there, &back)?;
    let (t, error) = (&there.traced.flux, &there.traced.stderr);

    let model = MatrixModel::new(&there.scene, Kernel::Physical, None)?;
    let grey = MatrixModel::new(&there.scene.with_mean_albedo(), Kernel::Physical, None)?.phi();
    let exact = model.phi();
    // c′ = T 1, and c″ = diag(E′) Tᵀ diag(1/E) 1.
    let flood = |t: &Matrix| t.column_sum().as_slice().to_vec();
    let dual = |t: &Matrix| {
        let (sums, power) = (there.transport(t).row_sum(), there.scene.laser.power);
        let both = sums.iter().zip(&back.etendues);
        both.map(|(k, e)| power * e * k).collect::<Vec<f64>>()
    };
    let wall = board(SIDE, CHECKS);
    let photograph =
        |what, origin, values| Judged::new(what, origin, Way::Photograph, values, &wall);
    let pictures = [
        photograph(
            "primal image, T times 1: what the camera sees",
            Origin::Traced,
            flood(t),
        ),
        photograph(
            "dual image, T transposed: what the projector sees",
            Origin::Traced,
            dual(t),
        ),
        photograph(
            "photograph by the exchanged pair",
            Origin::Exchanged,
            flood(&back.traced.flux),
        ),
    ];
    control.check()?;
    let mut found = seen(Origin::Traced, t, Some(error), &model)?;
    control.check()?;
    found.extend(seen(Origin::Modelled, &exact, None, &model)?);
    let (traced, modelled) = (spectrum(t)?, spectrum(&exact)?);
    let all: Vec<&Judged> = pictures.iter().chain(&found).collect();
    let table = table(&all, [("traced", &traced), ("modelled", &modelled)]);
    let caption = format!(
        "Scene `dual`: {SIDE} × {SIDE} laser spots (the projector's pixels) on x ∈ [6.75, 10.75] in., {SIDE} × {SIDE} camera pixels on x ∈ [0.5, 4.5] in. of the wall, both y ∈ \
         [2.375, 6.375] in.; hidden {CHECKS} × {CHECKS} board, {ELEMENTS} × {ELEMENTS} elements; three surfaces met. T is Φcam, traced ({} paths for each pixel and spot, \
         independent, Sobol' points, seed {}; noise {:.2} % of T). Exchanged pair: traced anew with the next seed, pinhole at the laser's place, its view the projector's cells, spots at the centres of the camera's \
         pixels; T′ = diag(E′) Tᵀ diag(1/E), E and E′ the étendues of the pixels. Physical kernel in the model; pinv cut at max(r, l)·2⁻⁵²·σ1; pictures of the board stretched to [0, 1] by \
         their own ends.",
        REPLICATES * SIZE,
        plan.first_seed,
        100.0 * (error.norm() / t.norm())
    );
    let notes = vec![
        format!(
            "Both pictures of the wall contain the board, but the eye cannot see it: compared \
             with a grey object of its mean albedo, it changes the primal image by {:.2} % and \
             the dual image by {:.2} % (model, after the best scale), as smooth gradients.",
            100.0 * change(&flood(&exact), &flood(&grey)),
            100.0 * change(&dual(&exact), &dual(&grey))
        ),
        "Transposing the matrix exchanges light source and camera and nothing else. A camera in \
         the projector's place would photograph the wall, because the projector lights the wall; \
         the hidden board is seen neither from there nor from the camera. To recover it, G12 and \
         G23 of T = C diag(ρ) D have to be inverted."
            .to_owned(),
    ];
    let title = "The dual image: a traced matrix transposed, and why transposing is not inverting";
    Ok(Finding {
        galleries: galleries(&pictures, &found),
        checks: checks(&law, &pictures, &found, &traced),
        notes,
        ..finding(
            Item::Dual,
            title,
            caption,
            table,
            vec![plot(&traced, &modelled)],
        )
    })
}

fn galleries(pictures: &[Judged; 3], found: &[Judged]) -> Vec<Gallery> {
    let wall = |j: &Judged| square(j.what, SIDE, j.values.clone(), ["x", "y"], WIDTH);
    let object = |title: String, j: &Judged| elements(title, ELEMENTS, stretched(&j.values));
    let traced = found.iter().filter(|j| j.origin == Origin::Traced);
    let noiseless = found
        .iter()
        .filter(|j| j.origin == Origin::Modelled && j.way == Way::Inverse(Method::Pinv));
    let mut boards = vec![elements("true board", ELEMENTS, board(ELEMENTS, CHECKS))];
    boards.extend(traced.map(|j| object(j.what.to_owned(), j)));
    boards.extend(noiseless.map(|j| object(format!("{}, noiseless T", j.what), j)));
    vec![
        Gallery {
            title: "The wall from the two places".to_owned(),
            shades: Shades::Values,
            unit: "W".to_owned(),
            pictures: pictures.iter().map(wall).collect(),
        },
        Gallery::reflectances(
            "The board by transposing and by inverting the traced T, stretched to [0, 1]",
            boards,
        ),
    ]
}
