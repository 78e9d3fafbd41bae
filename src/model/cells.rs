//! Hidden surfaces in small cells.

use super::kernel::HiddenPoint;
use super::place::{Place, grid};
use crate::geometry::{Polygon, Shape, ShapeId};
use crate::scene::{Division, Element, Surface};

/// A small part of a hidden surface, taken at its middle.
#[derive(Debug)]
pub(super) struct HiddenCell {
    pub point: HiddenPoint,
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
            area: element.area * std::f64::consts::FRAC_1_PI,
            albedo: element.albedo,
            surface: id,
            corners,
        })
    }
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
            found[element(k)].extend(of_place(&place));
        }
    }
    found
}
