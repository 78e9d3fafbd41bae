//! The camera: an off-axis pinhole whose pixel grid covers a rectangle of the wall exactly.

use super::axes::upright;
use super::device;
use super::error::{Fault, keys};
use super::file::CameraTable;
use super::surface::{Surface, facing_at_xy, is_off_the_wall};
use super::{FARTHEST, FINEST};
use crate::geometry::{DAffine3, DVec3, Parallelogram};

/// More pixels than this are taken for a mistake.
const MOST_PIXELS: u64 = 1 << 26;

/// A pinhole of small area, parallel to the view's plane. Pixel p collects what passes through its
/// footprint on that plane towards the pinhole: étendue E_p = ∫ A_lens·cosθ_cam dΩ over the
/// footprint.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The pinhole.
    pub position: DVec3,
    /// Its area, length².
    pub aperture_area: f64,
    /// What the grid covers: u along the columns (+x), v along the rows (+y).
    pub view: Parallelogram,
    /// Pixels along x.
    pub columns: usize,
    /// Pixels along y.
    pub rows: usize,
}

impl Camera {
    /// Number of pixels; pixel index = column + row·columns.
    pub fn pixels(&self) -> usize {
        self.columns * self.rows
    }

    /// The footprint of a pixel in the view's plane.
    pub fn footprint(&self, pixel: usize) -> Footprint {
        let u = self.view.u() / self.columns as f64;
        let v = self.view.v() / self.rows as f64;
        let [column, row] = [pixel % self.columns, pixel / self.columns];
        let corner = self.view.corner() + u * column as f64 + v * row as f64;
        Footprint {
            corner,
            u,
            v,
            area: self.view.area() / self.pixels() as f64,
        }
    }

    /// The pixel whose footprint the line from the pinhole through `point` crosses, if any.
    pub fn pixel_of(&self, point: DVec3) -> Option<usize> {
        let normal = self.view.normal();
        let direction = point - self.position;
        let slope = normal.dot(direction);
        if slope == 0.0 {
            return None;
        }
        let t = normal.dot(self.view.corner() - self.position) / slope;
        let [a, b] = self.view.coordinates(self.position + direction * t);
        let inside = t > 0.0 && (0.0..1.0).contains(&a) && (0.0..1.0).contains(&b);
        inside.then(|| {
            let column = ((a * self.columns as f64) as usize).min(self.columns - 1);
            let row = ((b * self.rows as f64) as usize).min(self.rows - 1);
            column + row * self.columns
        })
    }

    /// The same camera with its view between these ends in x and in y.
    pub(super) fn with_view(
        &self,
        [x, y]: [[f64; 2]; 2],
        surfaces: &[Surface],
    ) -> Result<Self, Fault> {
        let view = on_the_wall(x, y, self.position, surfaces)
            .map_err(|fault| fault.within(keys!["camera"]))?;
        Ok(Self {
            view,
            ..self.clone()
        })
    }

    pub(super) fn from_table(
        table: &CameraTable,
        axes: &DAffine3,
        surfaces: &[Surface],
    ) -> Result<Self, Fault> {
        let refuse = |key, cause: String, cure: &str| {
            Err(Fault::new(keys![key], cause, cure).within(keys!["camera"]))
        };
        let [columns, rows] = table.pixels;
        let count = u64::from(columns) * u64::from(rows);
        if count == 0 {
            return refuse(
                "pixels",
                format!("{columns} × {rows} pixels"),
                "use at least 1 × 1",
            );
        }
        if count > MOST_PIXELS {
            let cause = format!("{columns} × {rows} pixels are more than 2²⁶");
            return refuse("pixels", cause, "use fewer");
        }
        if !(FINEST * FINEST..=FARTHEST * FARTHEST).contains(&table.aperture_area) {
            let cause = format!("aperture area {}", table.aperture_area);
            return refuse(
                "aperture_area",
                cause,
                "give a positive area in unit², from 1e-30 to 1e30",
            );
        }
        let position = device::position("camera", table.position, axes)?;
        let ([x0, x1], [y0, y1]) = (table.view.x, table.view.y);
        if !(x0 < x1 && y0 < y1 && [x0, x1, y0, y1].iter().all(|c| c.is_finite())) {
            let cause = format!("the view [{x0}, {x1}] × [{y0}, {y1}] has no area");
            return refuse("view", cause, "give x and y as [lower, upper]");
        }
        let view = on_the_wall([x0, x1], [y0, y1], position, surfaces)
            .map_err(|fault| fault.within(keys!["camera"]))?;
        Ok(Self {
            position,
            aperture_area: table.aperture_area,
            view,
            columns: columns as usize,
            rows: rows as usize,
        })
    }
}

/// The view as a patch of the wall's plane.
fn on_the_wall(
    x: [f64; 2],
    y: [f64; 2],
    camera: DVec3,
    surfaces: &[Surface],
) -> Result<Parallelogram, Fault> {
    view(x, y, camera, surfaces).map_err(|e| {
        let at = format!("the view [{}, {}] × [{}, {}]", x[0], x[1], y[0], y[1]);
        match e {
            NoView::OffTheWall => {
                let (cause, cure) = upright(surfaces).unwrap_or_else(|| {
                    (
                        format!("{at} does not lie on the wall"),
                        "keep it within a relay surface, or extend the wall".to_owned(),
                    )
                });
                Fault::new(keys!["view"], cause, cure)
            }
            NoView::Behind => Fault::new(
                keys!["position"],
                format!(
                    "the camera stands behind (or in the plane of) the wall on which {at} lies"
                ),
                "move it to the front (the side of u × v)",
            ),
        }
    })
}

/// Where the lines of sight of one pixel cross the view's plane: corner + a·u + b·v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Corner with the smallest x and y.
    pub corner: DVec3,
    /// Width along +x.
    pub u: DVec3,
    /// Height along +y.
    pub v: DVec3,
    /// Area, length².
    pub area: f64,
}

impl Footprint {
    /// The point with coordinates a, b ∈ [0, 1].
    pub fn at(&self, [a, b]: [f64; 2]) -> DVec3 {
        self.corner + self.u * a + self.v * b
    }
}

/// Why a camera has no view.
enum NoView {
    /// Some of it has no relay surface below it.
    OffTheWall,
    /// The camera is on the back of the relay.
    Behind,
}

/// The view as a patch of the relay's plane (of a curved relay: of its tangent plane at the view's
/// centre), normal towards the relay's front.
fn view(
    x: [f64; 2],
    y: [f64; 2],
    camera: DVec3,
    surfaces: &[Surface],
) -> Result<Parallelogram, NoView> {
    const STEPS: usize = 64;
    let at = |c: [f64; 2], k: usize| c[0] + (c[1] - c[0]) * k as f64 / STEPS as f64;
    for (i, j) in (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| (i, j))) {
        if is_off_the_wall(surfaces, [at(x, i), at(y, j)]) {
            return Err(NoView::OffTheWall);
        }
    }
    let (cx, cy) = (0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]));
    let (_, centre) = facing_at_xy(surfaces, [cx, cy], camera).ok_or(NoView::Behind)?;
    let n = centre.normal;
    if n.z.abs() < 1e-9 {
        return Err(NoView::OffTheWall);
    }
    let lift = |px: f64, py: f64| {
        let dz = -(n.x * (px - cx) + n.y * (py - cy)) / n.z;
        DVec3::new(px, py, centre.position.z + dz)
    };
    let corner = lift(x[0], y[0]);
    let (u, v) = (lift(x[1], y[0]) - corner, lift(x[0], y[1]) - corner);
    let patch = Parallelogram::new(corner, u, v).ok_or(NoView::OffTheWall)?;
    // u × v points along +z; where the wall's front is below, the patch is kept and its normal
    // turned.
    Ok(if n.z > 0.0 { patch } else { patch.turned() })
}
