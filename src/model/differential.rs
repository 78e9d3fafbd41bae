//! Elements' light as products of a camera's and a laser's side, and how it changes with the
//! geometry.
//!
//! > A_j\[p,l\] = Σ_{s∈j} c\[p,s\] d\[s,l\],   ∂A_j = Σ_{s∈j} ∂c d + c ∂d

use rayon::prelude::*;

use super::cells::{HiddenCell, cells_of_elements};
use super::cut::Cut;
use super::error::ModelError;
use super::extent::Extent;
use super::factors::ElementGrid;
use super::kernel::Kernel;
use super::matrix_model::element_grids;
use super::tangent::{self, HiddenRate, ViewRate, WallRate};
use super::terms::{Terms, TermsRate};
use super::wall_point::{self, WallPoint};
use crate::geometry::DVec3;
use crate::matrix::Matrix;
use crate::scene::{Scene, Surface, Velocity};

/// What a model takes its light by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fineness {
    /// Elements, footprints and spots at their centres.
    Centres,
    /// Integrated over them: an element by its 4ᵏ parts and the 4ᵏ⁻¹ twice as long, of which the
    /// error falls as the fourth power of their size, footprints and spots by a rule of level k,
    /// at least 1. What the next k changes is what this leaves out.
    Areas(u32),
}

impl Fineness {
    /// The next one.
    pub fn next(self) -> Self {
        match self {
            Self::Centres => Self::Areas(1),
            Self::Areas(k) => Self::Areas(k + 1),
        }
    }

    /// Halvings of an element, and the level of the rules on footprints and spots.
    fn rule(self) -> Option<(u32, usize)> {
        match self {
            Self::Centres => None,
            Self::Areas(k) => Some((k.max(1), k.max(1) as usize)),
        }
    }
}

/// The points of a scene between which its model takes light, with nothing in the way and the
/// physical kernel.
#[derive(Debug)]
pub struct Differential<'a> {
    scene: &'a Scene,
    /// Hidden cells with their surfaces and elements.
    cells: Vec<(HiddenCell, usize)>,
    /// Of each pixel.
    seen: Vec<Vec<WallPoint>>,
    /// Of each spot; none where a surface shines.
    lit: Vec<Vec<WallPoint>>,
    /// Of each spot, the ends of the wall across it.
    ends: Vec<Vec<(WallPoint, DVec3)>>,
    grids: Vec<ElementGrid>,
}

impl<'a> Differential<'a> {
    /// The points of `scene`; `elements` replaces the elements a side that it gives.
    ///
    /// # Errors
    /// [`ModelError::NothingHidden`].
    pub fn new(
        scene: &'a Scene,
        elements: Option<[usize; 2]>,
        fineness: Fineness,
    ) -> Result<Self, ModelError> {
        let grids = element_grids(scene, elements)?;
        let hidden: Vec<(usize, &Surface)> = scene.hidden().collect();
        let by = |halvings, weight: f64| {
            let each = hidden.iter().zip(&grids);
            let mut of: Vec<Vec<HiddenCell>> = each
                .flat_map(|(surface, grid)| cells_of_elements(*surface, grid.count, halvings))
                .collect();
            of.iter_mut().flatten().for_each(|cell| cell.area *= weight);
            of
        };
        let of = match fineness.rule() {
            None => by(0, 1.0),
            Some((halvings, _)) => {
                let mut fine = by(halvings, 4.0 / 3.0);
                let coarse = by(halvings - 1, -1.0 / 3.0);
                fine.iter_mut()
                    .zip(coarse)
                    .for_each(|(all, own)| all.extend(own));
                fine
            }
        };
        let numbered = of.into_iter().enumerate();
        let cells = numbered.flat_map(|(j, own)| own.into_iter().map(move |cell| (cell, j)));
        let (seen, lit, ends) = match fineness.rule() {
            None => {
                let pixels = 0..scene.camera.pixels();
                let spots = 0..scene.laser.spots.len();
                let lit = |l| {
                    if scene.laser.is_shining() {
                        Vec::new()
                    } else {
                        vec![wall_point::lit(scene, l, DVec3::ZERO, 1.0)]
                    }
                };
                (
                    pixels
                        .map(|p| vec![wall_point::seen(scene, p, [0.5, 0.5], 1.0)])
                        .collect(),
                    spots.clone().map(lit).collect(),
                    spots.map(|_| Vec::new()).collect(),
                )
            }
            Some((_, level)) => {
                let cut = Cut::new(scene, Extent::UNOBSTRUCTED);
                (cut.seen(level), cut.lit(level), cut.ends(level))
            }
        };
        Ok(Self {
            scene,
            cells: cells.collect(),
            seen,
            lit,
            ends,
            grids,
        })
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.grids.iter().map(ElementGrid::len).sum()
    }

    /// A_j.
    pub fn terms(&self) -> Terms {
        let side = |walls: &[WallPoint], cell: &HiddenCell| {
            let towards = |w: &WallPoint| w.towards(self.scene, Kernel::Physical, &cell.point);
            walls.iter().map(towards).sum::<f64>()
        };
        let laser = |s: usize, l: usize| {
            let (cell, j) = &self.cells[s];
            cell.area
                * match self.shining(*j, l) {
                    Some(exitance) => exitance,
                    None => side(&self.lit[l], cell),
                }
        };
        Terms {
            camera: by_columns(self.seen.len(), self.cells.len(), |p, s| {
                side(&self.seen[p], &self.cells[s].0)
            }),
            laser: by_columns(self.cells.len(), self.lit.len(), laser),
            element: self.cells.iter().map(|(_, j)| *j).collect(),
        }
    }

    /// The exitance of element `j` in column `spot` of a surface that shines, W length⁻²; none of a
    /// laser.
    fn shining(&self, j: usize, spot: usize) -> Option<f64> {
        let (_, surface) = self.scene.shining()?;
        let exitance = surface.shining().map_or(0.0, |s| s.exitance);
        let grid = self.grids.first()?;
        Some(exitance * self.scene.laser.share(spot, (j, grid.count)))
    }

    /// ∂A_j by the parameter with which the scene moves by `velocity`.
    pub fn rate(&self, velocity: &Velocity) -> TermsRate {
        let moves = |id: usize| velocity.surfaces[id] != Default::default();
        let hidden = self.scene.hidden().any(|(id, _)| moves(id));
        // A wall that reflects in another way does so for laser and camera alike.
        let wall = self.scene.relays().any(|(id, _)| moves(id)) || !velocity.materials.is_empty();
        let view = velocity.view != [0.0; 2]
            || velocity.view_growth != 0.0
            || velocity.camera != DVec3::ZERO;
        let spots = velocity.spots.iter().any(|s| *s != [0.0; 2])
            || velocity.spot_growth != 0.0
            || velocity.laser != DVec3::ZERO;
        let moves = |(cell, _): &(HiddenCell, usize)| {
            HiddenRate::new(&cell.point, &velocity.surfaces[cell.surface as usize])
        };
        let moves: Vec<HiddenRate> = self.cells.iter().map(moves).collect();
        let side = |walls: &[WallPoint], rates: &[WallRate<'_>], s: usize| {
            let to = (&self.cells[s].0.point, &moves[s]);
            let each = walls.iter().zip(rates);
            each.map(|(w, rate)| w.towards_rate(self.scene, rate, to))
                .sum::<f64>()
        };
        let camera = (hidden || wall || view).then(|| {
            let aim = ViewRate::new(self.scene, velocity);
            let rate = |w: &WallPoint| aim.as_ref().map_or_else(WallRate::default, |a| a.seen(w));
            let rates: Vec<Vec<WallRate<'_>>> = self
                .seen
                .iter()
                .map(|own| own.iter().map(rate).collect())
                .collect();
            by_columns(self.seen.len(), self.cells.len(), |p, s| {
                side(&self.seen[p], &rates[p], s)
            })
        });
        let lasers = !self.scene.laser.is_shining() && (hidden || wall || spots);
        let laser = lasers.then(|| {
            let of = |(l, own): (usize, &Vec<WallPoint>)| {
                let rate = |w| tangent::lit(self.scene, velocity, l, w);
                own.iter().map(rate).collect::<Vec<_>>()
            };
            let rates: Vec<Vec<WallRate<'_>>> = self.lit.iter().enumerate().map(of).collect();
            // What comes and goes over the wall's ends, as spots move against it.
            let gained = |l: usize| {
                let over = |(w, out): &(WallPoint, DVec3)| {
                    let by = tangent::against_wall(self.scene, velocity, l, w);
                    (*w, -by.dot(*out))
                };
                self.ends[l].iter().map(over).collect()
            };
            let gained: Vec<Vec<(WallPoint, f64)>> = (0..self.lit.len()).map(gained).collect();
            by_columns(self.cells.len(), self.lit.len(), |s, l| {
                let (cell, _) = &self.cells[s];
                let light = |w: &WallPoint| w.towards(self.scene, Kernel::Physical, &cell.point);
                let over = gained[l].iter().map(|(w, by)| by * light(w)).sum::<f64>();
                cell.area * (side(&self.lit[l], &rates[l], s) + over)
            })
        });
        TermsRate { camera, laser }
    }
}

/// A matrix by its entries, its columns on the threads of the pool.
fn by_columns(rows: usize, columns: usize, of: impl Fn(usize, usize) -> f64 + Sync) -> Matrix {
    let each = (0..rows * columns).into_par_iter();
    let entries: Vec<f64> = each
        .with_min_len(1024)
        .map(|k| of(k % rows, k / rows))
        .collect();
    Matrix::from_vec(rows, columns, entries)
}

#[cfg(test)]
mod tests;
