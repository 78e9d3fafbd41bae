//! Hidden surfaces in small cells.

use super::kernel::HiddenPoint;
use super::place::{Place, grid};
use crate::geometry::{DVec3, Polygon, Shape, ShapeId};
use crate::scene::{Division, Element, Surface};

/// A small part of a hidden surface, taken at its middle.
#[derive(Debug)]
pub(super) struct HiddenCell {
    pub point: HiddenPoint,
    /// The place whose view of the wall stands for all of the cell.
    pub viewpoint: DVec3,
    /// Its area/π, length².
    pub area: f64,
    pub albedo: f64,
    pub surface: ShapeId,
    /// Its corners, where it is flat.
    pub corners: Option<Polygon>,
}

impl HiddenCell {
    /// `None` without area.
    pub(super) fn new(
        (id, surface): (ShapeId, &Surface),
        element: &Element,
        corners: Option<Polygon>,
    ) -> Option<Self> {
        (element.area > 0.0).then(|| Self {
            point: HiddenPoint::new(surface, element),
            viewpoint: element.position,
            area: element.area * std::f64::consts::FRAC_1_PI,
            albedo: element.albedo,
            surface: id,
            corners,
        })
    }

    /// The same, one of the 2^h × 2^h cells of an element or a texture's cell. Their viewpoints
    /// have 4^h different places along either axis, evenly spaced (a turned Hammersley set), so
    /// that a shadow's edge along a row of cells does not pass all of them alike. Where a cell is
    /// no parallelogram, its middle.
    pub(super) fn viewed_from(mut self, place: &Place, h: u32) -> Self {
        if let (Place::Cell { from, size }, Some([p, q, _, s])) = (place, self.corners.as_deref()) {
            let [iu, iv] = [0, 1].map(|axis| (from[axis] / size[axis]).round() as u32);
            self.viewpoint = *p + (*q - *p) * spread(iv, h) + (*s - *p) * (1.0 - spread(iu, h));
        }
        self
    }
}

/// The middles of cells, each with its area/π.
pub(super) fn middles(cells: &[HiddenCell]) -> Vec<(HiddenPoint, f64)> {
    cells.iter().map(|cell| (cell.point, cell.area)).collect()
}

/// The last h bits of a number in reverse order, every other one flipped, in the middle of the 2^h
/// steps from 0 to 1. Over the 2^h numbers at x in such steps Σ (x − ½)(spread − ½) is 0 for even h
/// and ⅛ for odd, where it would be h/8 with no bit flipped: viewpoints do not lean with the place.
fn spread(number: u32, h: u32) -> f64 {
    let flipped = number ^ 0xAAAA_AAAA;
    let reversed = flipped.reverse_bits().checked_shr(32 - h).unwrap_or(0);
    (f64::from(reversed) + 0.5) / f64::from(1u32 << h)
}

/// The elements of a hidden surface, `count` a side, each in 4^`halvings` cells: squares of its
/// parameters, or of its texture's on a mesh; of triangles triangles.
pub(super) fn cells_of_elements(
    (id, surface): (usize, &Surface),
    count @ [nu, nv]: [usize; 2],
    halvings: u32,
) -> Vec<Vec<HiddenCell>> {
    let surface = surface.lambertian_equivalent();
    let id = id as ShapeId;
    let of_place = |place: &Place| {
        let (element, corners) = place.cell(&surface)?;
        HiddenCell::new((id, &surface), &element, corners)
    };
    let mut found = Vec::new();
    if let (Shape::Instance(body), Division::Faces | Division::Whole) =
        (&surface.shape, surface.division)
    {
        for triangle in 0..body.mesh().triangles().len() as u32 {
            let whole = Place::Triangle {
                id: triangle,
                corners: body.corners(triangle),
            };
            let quarter = |all: Vec<Place>, _| all.iter().flat_map(Place::quarters).collect();
            let parts = (0..halvings).fold(vec![whole], quarter);
            found.push(parts.iter().filter_map(of_place).collect());
        }
        return match surface.division {
            Division::Whole => vec![found.into_iter().flatten().collect()],
            _ => found,
        };
    }
    found.resize_with(nu * nv, Vec::new);
    let fine = count.map(|n| n << halvings);
    let element =
        |cell: usize| ((cell % fine[0]) >> halvings) + ((cell / fine[0]) >> halvings) * nu;
    if let Shape::Instance(body) = &surface.shape
        && !body.is_exact_patch()
    {
        for (k, e) in surface.divided(fine).iter().enumerate() {
            found[element(k)].extend(HiddenCell::new((id, &surface), e, None));
        }
    } else {
        for (k, place) in grid(fine).enumerate() {
            let cell = of_place(&place);
            found[element(k)].extend(cell.map(|cell| cell.viewed_from(&place, halvings)));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn viewpoints_do_not_lean_with_the_place() {
        for h in 0..8 {
            let count = 1u32 << h;
            let lean = |k: u32| (f64::from(k) + 0.5) / f64::from(count) - 0.5;
            let sum: f64 = (0..count).map(|k| lean(k) * (spread(k, h) - 0.5)).sum();
            let wanted = if h % 2 == 0 { 0.0 } else { 0.125 };
            assert!((sum - wanted).abs() < 1e-12, "{h}: {sum}");
        }
    }

    /// Along either axis the viewpoints of an element lie in the middles of equal steps, one in
    /// each.
    #[test]
    fn viewpoints_have_as_many_places_along_an_axis_as_there_are_cells() {
        let scene = Scene::load("thesis").expect("built in");
        let hidden = scene.hidden().next().expect("one");
        let Shape::Parallelogram(shape) = &hidden.1.shape else {
            panic!("a board");
        };
        let (count, corner) = ([3, 2], shape.at([0.0; 2]).position);
        for h in 0..4 {
            let of = cells_of_elements(hidden, count, h);
            for axis in 0..2 {
                let end = shape.at([[1.0, 0.0], [0.0, 1.0]][axis]).position - corner;
                for (number, cells) in of.iter().enumerate() {
                    let own = [number % 3, number / 3][axis] as f64;
                    let steps = cells.iter().map(|cell| {
                        let along = (cell.viewpoint - corner).dot(end) / end.length_squared();
                        (along * count[axis] as f64 - own) * cells.len() as f64
                    });
                    let mut steps: Vec<f64> = steps.collect();
                    steps.sort_by(f64::total_cmp);
                    for (k, step) in steps.iter().enumerate() {
                        assert!(
                            (step - k as f64 - 0.5).abs() < 1e-9,
                            "{h}, {axis}: {steps:?}"
                        );
                    }
                }
            }
        }
    }
}
