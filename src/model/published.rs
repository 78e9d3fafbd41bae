//! The published simulation, as it computes: its own grids, spots, kernel and measurement, without
//! a scene.
//!
//! Lengths in inches. It differs from the bench of this crate in what the study's text does not
//! say: the pixel grid is laid to the edges of the view, the spots leave the wall where the square
//! is large, and neither unit nor power appears.

use super::Kernel;
use crate::matrix::Matrix;

/// y of the hinge.
const HINGE: f64 = 15.5;
/// Distance from the hinge at which the object starts.
const NEAR: f64 = 5.867_64;
/// Side of the object.
const SIDE: f64 = 4.0;
/// x at which it starts.
const LEFT: f64 = 3.0;
/// Corners of the camera's view.
const VIEW_X: [f64; 2] = [6.5, 3.25];
const VIEW_Y: [f64; 2] = [2.75, 6.0];
/// Offsets of the stagger, cycled from the second on.
const STAGGER: [f64; 3] = [0.0, -1.0, 1.0];

/// C, the foot of the normal of S2 through the object's centre.
fn centre() -> [f64; 2] {
    [5.0, HINGE - (NEAR + 0.5 * SIDE) * 2f64.sqrt()]
}

/// How the spots stand on their lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stagger {
    /// On the lines.
    None,
    /// By turns on, 1 in. to the one side and 1 in. to the other side of them.
    OneInch,
}

/// How the pixels divide the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PixelGrid {
    /// First and last pixel on the edges, as the published code has it.
    Edges,
    /// Centres of equal footprints.
    Centres,
}

/// A configuration of the published simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Published {
    /// Kernel of G12 and G23.
    pub kernel: Kernel,
    /// R: elements a side.
    pub elements: usize,
    /// Pixels a side.
    pub pixels: usize,
    /// How they divide the view.
    pub grid: PixelGrid,
    /// n: spots a side, 4 n in all.
    pub per_side: usize,
    /// h: half the width of the square of spots, in.
    pub half_width: f64,
    /// Whether they are staggered.
    pub stagger: Stagger,
}

impl Published {
    /// Element centres (x, y, z), index j·R + i, x fastest, then growing distance from the hinge.
    pub fn element_centres(&self) -> Vec<[f64; 3]> {
        let step = SIDE / self.elements as f64;
        (0..self.elements * self.elements)
            .map(|at| {
                let (i, j) = (at % self.elements, at / self.elements);
                let z = (NEAR + (j as f64 + 0.5) * step) / 2f64.sqrt();
                [LEFT + (i as f64 + 0.5) * step, HINGE - z, z]
            })
            .collect()
    }

    /// Points of the wall that the pixels see, index row·columns + column, x falling fastest, then
    /// growing y.
    pub fn pixel_centres(&self) -> Vec<[f64; 2]> {
        let n = self.pixels;
        let place = |[from, to]: [f64; 2], k: usize| match self.grid {
            PixelGrid::Edges if n > 1 => from + (to - from) * k as f64 / (n as f64 - 1.0),
            _ => from + (to - from) * (k as f64 + 0.5) / n as f64,
        };
        (0..n * n)
            .map(|p| [place(VIEW_X, p % n), place(VIEW_Y, p / n)])
            .collect()
    }

    /// The spots: lower side by growing x, right by growing y, upper by falling x, left by falling
    /// y; corners appear twice.
    pub fn spots(&self) -> Vec<[f64; 2]> {
        let (n, h) = (self.per_side, self.half_width);
        let [cx, cy] = centre();
        let along = |i: usize| match n {
            1 => 0.0,
            _ => h * (2.0 * i as f64 / (n as f64 - 1.0) - 1.0),
        };
        let off = |i: usize| match self.stagger {
            Stagger::None => 0.0,
            Stagger::OneInch => STAGGER[(i + 1) % 3],
        };
        let side = |f: &dyn Fn(f64, f64) -> [f64; 2]| {
            (0..n).map(|i| f(along(i), off(i))).collect::<Vec<_>>()
        };
        [
            side(&|t, o| [cx + t, cy - h + o]),
            side(&|t, o| [cx + h + o, cy + t]),
            side(&|t, o| [cx - t, cy + h + o]),
            side(&|t, o| [cx - h + o, cy - t]),
        ]
        .concat()
    }

    /// G12, elements × spots.
    pub fn g12(&self) -> Matrix {
        let (elements, spots) = (self.element_centres(), self.spots());
        Matrix::from_fn(elements.len(), spots.len(), |j, l| {
            self.g(spots[l], elements[j])
        })
    }

    /// G12 of one element over a grid of `side` × `side` wall points, from C − `reach` to C +
    /// `reach` along x (fastest) and y.
    pub fn g12_over(&self, element: usize, reach: f64, side: usize) -> Vec<f64> {
        let element = self.element_centres()[element];
        let [cx, cy] = centre();
        let along = |k: usize| reach * (2.0 * k as f64 / (side as f64 - 1.0) - 1.0);
        (0..side * side)
            .map(|at| self.g([cx + along(at % side), cy + along(at / side)], element))
            .collect()
    }

    /// G23, pixels × elements.
    pub fn g23(&self) -> Matrix {
        let (elements, pixels) = (self.element_centres(), self.pixel_centres());
        Matrix::from_fn(pixels.len(), elements.len(), |p, j| {
            self.g(pixels[p], elements[j])
        })
    }

    /// z2·root/R⁴, the root √(½((y − y2)² + z2²)) for the published kernel and (15.5 − y)/√2 for
    /// the physical one.
    fn g(&self, [x, y]: [f64; 2], [x2, y2, z2]: [f64; 3]) -> f64 {
        let (dx, dy) = (x - x2, y - y2);
        let r2 = dx * dx + dy * dy + z2 * z2;
        let root = match self.kernel {
            Kernel::Published => (0.5 * (dy * dy + z2 * z2)).sqrt(),
            Kernel::Physical => (HINGE - y) / 2f64.sqrt(),
        };
        z2 * root / (r2 * r2)
    }

    /// A board of `checks` a side on the elements, the first check dark: 0 or 1.
    pub fn board(&self, checks: usize) -> Vec<f64> {
        let n = self.elements;
        (0..n * n)
            .map(|at| {
                f64::from(u8::from(
                    ((at / n) * checks / n + (at % n) * checks / n) % 2 == 1,
                ))
            })
            .collect()
    }

    /// Φ = (B ∘ G23)·G12 of `board`, pixels × spots, without scale.
    pub fn phi(&self, board: &[f64]) -> Matrix {
        let mut lit = self.g12();
        for (mut row, b) in lit.row_iter_mut().zip(board) {
            row *= *b;
        }
        self.g23() * lit
    }
}

/// K of the published tables 2–4: the kernel in the flattened cross-section, by the law of sines in
/// the triangle hinge – spot line – object row with 45° at the hinge,
///
/// > K = sin α · sin β / r²,   sin α = d·sin 45°/r,   sin β = s·sin 45°/r,   r² = s² + d² − 2 s d cos 45°,
///
/// for a spot line at distance `s` and an object row at distance `d` from the hinge, in., in in.⁻².
pub fn flattened_k(s: f64, d: f64) -> f64 {
    let half = 0.5f64.sqrt();
    let r2 = s * s + d * d - 2.0 * s * d * half;
    (d * half) * (s * half) / (r2 * r2)
}

/// Distances from the hinge of the eight rows of tables 2–4 and of their two spot lines, `apart`
/// from y = 4.375: (rows, lower line, upper line).
pub fn table_distances(apart: f64) -> ([f64; 8], f64, f64) {
    let rows = std::array::from_fn(|k| NEAR + 0.25 + 0.5 * k as f64);
    (rows, HINGE - (4.375 - apart), HINGE - (4.375 + apart))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::MatrixModel;
    use crate::scene::Scene;

    const THESIS: Published = Published {
        kernel: Kernel::Published,
        elements: 8,
        pixels: 16,
        grid: PixelGrid::Centres,
        per_side: 30,
        half_width: 6.0,
        stagger: Stagger::OneInch,
    };

    /// With pixels at the centres of footprints it is the scene `thesis`, columns of pixels from
    /// the other side.
    #[test]
    fn it_is_the_scene_of_the_thesis() {
        let scene = Scene::load("thesis").unwrap();
        for kernel in [Kernel::Published, Kernel::Physical] {
            let own = Published { kernel, ..THESIS };
            let model = MatrixModel::new(&scene, kernel, None).unwrap();
            let (g12, g23) = (own.g12(), own.g23());
            assert!((&g12 - &model.g12).amax() < 1e-13 * g12.amax());
            let mirrored = Matrix::from_fn(256, 64, |p, j| g23[(p / 16 * 16 + 15 - p % 16, j)]);
            assert!((mirrored - &model.g23).amax() < 1e-13 * g23.amax());
            let board: Vec<f64> = own.board(8);
            assert_eq!(board, model.albedo);
        }
    }

    /// The K of the tables is the physical kernel of the plane through hinge, line and row.
    #[test]
    fn flattened_k_is_the_physical_kernel_in_the_plane() {
        let (rows, lower, _) = table_distances(7.5);
        for d in rows {
            let h = 0.5f64.sqrt();
            let (y, y2, z2) = (HINGE - lower, HINGE - d * h, d * h);
            let r2 = (y - y2) * (y - y2) + z2 * z2;
            let exact = z2 * (HINGE - y) * h / (r2 * r2);
            assert!((flattened_k(lower, d) / exact - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn the_edges_grid_ends_on_the_view() {
        let own = Published {
            grid: PixelGrid::Edges,
            ..THESIS
        };
        let pixels = own.pixel_centres();
        assert_eq!((pixels[0], pixels[255]), ([6.5, 2.75], [3.25, 6.0]));
    }
}
