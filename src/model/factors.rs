//! The three-bounce integral of each element past what stands in the way, as few products.

mod own;

use rayon::prelude::*;

use super::cells::{HiddenCell, cells_of_elements, middles};
use super::cut::Cut;
use super::divided;
use super::effort::Effort;
use super::error::ModelError;
use super::extent::Extent;
use super::kernel::{HiddenPoints, Kernel};
use super::occlusion::{Both, Obstructed};
use super::terms::{NEGLIGIBLE, NEGLIGIBLE_SMOOTH, Terms, averaged, compressed};
use super::visible::DEVIATIONS;
use super::wall_point::{self, WallPoint};
use crate::geometry::ShapeId;
use crate::matrix::Matrix;
use crate::scene::{Scene, Surface};
use own::{Own, chance, moved, stacked};

/// Element j's light between every spot and every pixel where something stands in the way:
///
/// > A_j\[p,l\] = ∫_j c_p(x) d_l(x) dA/π = Σ_s camera\[p,s\] laser\[s,l\],   s over the terms of j.
///
/// One term alone is C\[p,j\] D\[j,l\] of the element's centre; where nothing stands in the way c
/// and d vary little over an element, past an edge both jump, and the mean of the product is not
/// the product of the means.
#[derive(Clone, Debug)]
pub struct Factors {
    /// A_j.
    pub terms: Terms,
    /// Relative Frobenius norm of what the last halving of the cells changed in all A_j, past
    /// obstacles at least half of what the one before did and two standard deviations of what
    /// viewpoints leave to chance where camera and laser both see a part of a cell; and what
    /// another division of footprints and spots does.
    pub change: f64,
    /// Cells of the hidden surfaces in the last step.
    pub cells: usize,
    /// All A_j before and after the last halving of the cells, and by two divisions of footprints
    /// and spots; none where they were not to be kept.
    pub steps: Vec<[Terms; 2]>,
}

impl Factors {
    /// How far Φcam of elements with these albedos may be off, pixels × spots, W: what all steps
    /// move, and a millionth of the light, below which nothing is refined and terms are left out.
    pub fn bound(&self, albedo: &[f64]) -> Matrix {
        let least = self.terms.phi(albedo).map(|x| SMOOTH_TARGET * x.abs());
        let moved = self.moved(albedo);
        moved.fold(least, |sum, step| sum + step.abs())
    }

    /// What each of the steps moves in Φcam of elements with these albedos, pixels × spots, W.
    pub fn moved(&self, albedo: &[f64]) -> impl Iterator<Item = Matrix> {
        let steps = self.steps.iter();
        steps.map(|[before, after]| after.phi(albedo) - before.phi(albedo))
    }

    /// Multiplies the camera's side by `factor`.
    pub(super) fn scale(&mut self, factor: f64) {
        let all = self.steps.iter_mut().flatten();
        all.chain([&mut self.terms])
            .for_each(|terms| terms.camera *= factor);
    }
}

/// How one hidden surface is divided.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementGrid {
    /// Name of the surface.
    pub surface: String,
    /// Elements along u and v.
    pub count: [usize; 2],
    /// Index of its first element; element iu + iv·nu follows by that much.
    pub first: usize,
    /// Whether its albedo is known.
    pub is_known: bool,
}

impl ElementGrid {
    /// Number of elements.
    pub fn len(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// Whether it has none (it never has).
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Visible shares of C (pixels × elements) and D (elements × spots), each weighted by the kernel
/// over the areas of both ends; 1 where no light arrives in any case.
pub(super) type Shares = [Matrix; 2];

/// Halvings of an element at first and at most: 2 × 2 cells, and 32 × 32, all of which are held
/// with all pixels.
const FIRST: u32 = 1;
const MOST_HALVINGS: u32 = 5;
/// Relative change below which what is extrapolated is fine enough.
const SMOOTH_TARGET: f64 = 1e-6;
/// Cells at the end, of each that was cut once.
const FINAL: usize = 16;

/// Level of the rule on footprints where nothing hides them, of the first division where nothing
/// is in the way at all.
const LEVEL: usize = 1;

/// Elements in cells that are fine enough.
pub(super) struct Settled<'a> {
    pub past: Past<'a>,
    /// Of each element.
    pub cells: Vec<Vec<HiddenCell>>,
    own: Vec<Own>,
    /// Of elements cut once, and by another division of footprints and spots.
    rough: Vec<Own>,
    other: Option<Vec<Own>>,
    /// Before the last halving of the cells, where that was not the first.
    before: Option<Vec<Own>>,
    change: f64,
}

/// The elements of a scene, cells of them cut in four until all A_j together change by less than
/// the target, or there are 1e8 pairs of cells with pixels and spots. With nothing in the way the
/// error falls as the square of the cells' size h and is extrapolated, A ≈ (4 A(h) − A(2h))/3, to a
/// target of 1e-6. Footprints and spots are divided until that changes the A_j of elements cut once
/// by less. Viewpoints jump from light to shadow as the geometry moves: where the light is to
/// follow it smoothly, of a cell that pixel and spot both see a part of the product of the means
/// stays, off like the size of a cell.
///
/// # Errors
/// [`ModelError::Linalg`].
pub(super) fn settled<'a>(
    scene: &'a Scene,
    kernel: Kernel,
    obstacles: &[ShapeId],
    grids: &[ElementGrid],
    Effort { target, share }: Effort,
    follows: bool,
) -> Result<Settled<'a>, ModelError> {
    let hidden: Vec<(usize, &Surface)> = scene.hidden().collect();
    let is_smooth = obstacles.is_empty();
    let target = if is_smooth { SMOOTH_TARGET } else { target };
    let cut_in = |halvings: u32| {
        if !is_smooth {
            return cells_of(&hidden, grids, halvings, 1.0);
        }
        let mut of = cells_of(&hidden, grids, halvings, 4.0 / 3.0);
        let coarse = cells_of(&hidden, grids, halvings - 1, -1.0 / 3.0);
        of.iter_mut()
            .zip(coarse)
            .for_each(|(all, own)| all.extend(own));
        of
    };
    let mut halvings = FIRST;
    let mut of = cut_in(halvings);
    let count = |of: &[Vec<HiddenCell>]| of.iter().map(Vec::len).sum::<usize>();
    let cut = Cut::new(scene, Extent::UNOBSTRUCTED);
    let by = |division| {
        let level = LEVEL + if is_smooth { division as usize } else { 0 };
        let past = Past {
            scene,
            kernel,
            footprints: cut.seen(level),
            follows,
            occlusion: divided::past(scene, kernel, obstacles, division),
            negligible: if is_smooth {
                NEGLIGIBLE_SMOOTH
            } else {
                NEGLIGIBLE
            },
        };
        let own = past.all(&of)?;
        Ok::<_, ModelError>((past, own))
    };
    let walls = divided::settled(
        by,
        |(past, _)| {
            // With nothing in the way a finer rule costs little.
            let (times, share) = if is_smooth { (1, 1.0) } else { (FINAL, share) };
            divided::can_be_finer(&past.occlusion, times * count(&of), share)
        },
        |(_, now), (_, next)| moved(now, next),
        target,
    )?;
    let (past, rough) = walls.used;
    let other = walls.other.map(|(_, other)| other);
    let left = other.as_ref().map_or(0.0, |other| moved(other, &rough));
    let occlusion = &past.occlusion;
    // Past an edge a halving may change little by luck; the one before then tells the size. Of
    // light that follows the geometry nobody asks.
    let mut earlier = if is_smooth || follows {
        0.0
    } else {
        moved(&past.all(&cut_in(FIRST - 1))?, &rough)
    };
    let mut before: Option<Vec<Own>> = None;
    loop {
        let exhausted = 4.0 * (count(&of) * occlusion.walls) as f64 > occlusion.most_pairs();
        halvings += 1;
        of = cut_in(halvings);
        let next = past.all(&of)?;
        let last = moved(before.as_ref().unwrap_or(&rough), &next);
        let change = last.max(DEVIATIONS * chance(&next));
        if exhausted || halvings == MOST_HALVINGS || change < target {
            return Ok(Settled {
                past,
                cells: of,
                own: next,
                rough,
                other,
                before,
                change: change.max(0.5 * earlier) + left,
            });
        }
        (earlier, before) = (last, Some(next));
    }
}

/// The cells of all elements, their areas times `weight`.
fn cells_of(
    hidden: &[(usize, &Surface)],
    grids: &[ElementGrid],
    halvings: u32,
    weight: f64,
) -> Vec<Vec<HiddenCell>> {
    let each = hidden.iter().zip(grids);
    let mut of: Vec<Vec<HiddenCell>> = each
        .flat_map(|(surface, grid)| cells_of_elements(*surface, grid.count, halvings))
        .collect();
    of.iter_mut().flatten().for_each(|cell| cell.area *= weight);
    of
}

/// The scene past what stands in the way.
pub(super) struct Past<'a> {
    scene: &'a Scene,
    kernel: Kernel,
    /// Of each pixel.
    pub footprints: Vec<Vec<WallPoint>>,
    pub occlusion: Obstructed<'a>,
    /// Whether the light is to follow the geometry smoothly.
    follows: bool,
    /// Terms of an element that are left out.
    negligible: f64,
}

impl Past<'_> {
    /// Of the elements that these cells make up.
    fn all(&self, of: &[Vec<HiddenCell>]) -> Result<Vec<Own>, ModelError> {
        of.par_iter().map(|cells| self.own(cells)).collect()
    }

    /// Of the element that these cells make up.
    fn own(&self, cells: &[HiddenCell]) -> Result<Own, ModelError> {
        let (pixels, spots) = (self.occlusion.pixels(), self.occlusion.spots());
        let camera = self.occlusion.camera(cells);
        let of_spot = |l| self.occlusion.laser_and_viewpoints(l, cells);
        let laser: Vec<Vec<[f64; 3]>> = (0..spots).map(of_spot).collect();
        let add = |[a, b]: Both, [x, y]: Both| [a + x, b + y];
        let seen = |p: usize| {
            let each = cells.iter().zip(&camera);
            let each = each.map(|(cell, seen)| seen[p].map(|x| x * cell.area));
            each.fold([0.0; 2], add)
        };
        let lit = |l: usize| {
            let each = laser[l].iter().map(|[all, left, _]| [*all, *left]);
            each.fold([0.0; 2], add)
        };
        let ratio = self.by_rule(cells, &unobstructed(&camera, pixels));
        let c = [0, 1].map(|which: usize| {
            Matrix::from_fn(pixels, cells.len(), |p, q| {
                ratio[(q, p)] * camera[q][p][which]
            })
        });
        let d = [1, 2]
            .map(|which: usize| Matrix::from_fn(cells.len(), spots, |q, l| laser[l][q][which]));
        let (c, d, variance) = if self.follows {
            let ([_, seen], [mean, _]) = (c, d);
            (seen, mean, 0.0)
        } else {
            averaged(c, d)
        };
        let (camera, laser) = compressed((&c, &d), self.negligible)?;
        Ok(Own {
            camera,
            laser,
            seen: (0..pixels).map(seen).collect(),
            lit: (0..spots).map(lit).collect(),
            variance,
        })
    }

    /// What the rule of each pixel gives of each cell over what that sends to the middles of the
    /// pixel's parts, both cells × pixels: where nothing hides a footprint its rule holds, not its
    /// middle.
    pub(super) fn by_rule(&self, cells: &[HiddenCell], by_middles: &Matrix) -> Matrix {
        let middles = middles(cells);
        let rules = self.footprints.iter().map(|rule| rule.iter());
        let points = HiddenPoints::new(&middles);
        let by_rule = wall_point::sides((self.scene, self.kernel), &points, rules);
        by_rule.zip_map(by_middles, |rule, middles| match middles {
            0.0 => 1.0,
            middles => rule / middles,
        })
    }
}

/// What each cell sends with nothing in the way, cells × pixels, of what it sends to each pixel.
pub(super) fn unobstructed(seen: &[Vec<Both>], pixels: usize) -> Matrix {
    Matrix::from_fn(seen.len(), pixels, |q, p| seen[q][p][0])
}

impl Settled<'_> {
    /// All elements' terms one behind the other, and their visible shares.
    pub(super) fn joined(&self) -> (Factors, Shares) {
        let all = &self.own;
        let share = |[all, left]: Both| if all > 0.0 { left / all } else { 1.0 };
        let (pixels, spots) = all
            .first()
            .map_or((0, 0), |own| (own.seen.len(), own.lit.len()));
        let shares = [
            Matrix::from_fn(pixels, all.len(), |p, j| share(all[j].seen[p])),
            Matrix::from_fn(all.len(), spots, |j, l| share(all[j].lit[l])),
        ];
        let factors = Factors {
            terms: stacked(all),
            change: self.change,
            cells: self.cells.iter().map(Vec::len).sum(),
            steps: Vec::new(),
        };
        (factors, shares)
    }

    /// [`Factors::steps`].
    pub(super) fn steps(&self) -> Vec<[Terms; 2]> {
        let before = self.before.as_ref().unwrap_or(&self.rough);
        let walls = self.other.iter().map(|other| [&self.rough, other]);
        let all = [[before, &self.own]].into_iter().chain(walls);
        all.map(|pair| pair.map(|own| stacked(own))).collect()
    }
}
