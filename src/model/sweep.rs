//! How the light past flat figures changes as these, flat walls and hidden surfaces, camera and
//! spots move.
//!
//! > ċ_p = Σ_k d/dθ (f_r3 G E)(piece k),   ḋ_l = Σ_k d/dθ (f_r1 G Φ dA/π)(piece k)
//!
//! over the pieces that [`Obstructed`] takes at their centroids: corners, areas and centroids are
//! followed ([`Moving`]), so that the rates are those of its own sums, but where a shadow begins or
//! ends to meet a piece. A shadow is that of relative motion: figures and pieces are followed in
//! the frame of the point that it is seen from.

mod beams;
mod lit;

use super::beam::Lit;
use super::cells::HiddenCell;
use super::occlusion::Obstructed;
use super::patch::Patch;
use super::tangent::{self, HiddenRate, ViewRate, WallRate};
use super::wall_point::{self, WallPoint};
use crate::geometry::{AT_ONCE, DVec3, Moving, Pieces, PlaneRate, Shadow, ShapeId};
use crate::scene::{Role, Scene, Surface, Twist, Velocity};

/// Rates per unit of each parameter.
pub(super) type Rates = [f64; AT_ONCE];

/// Whether a parameter moves nothing but surfaces that are neither wall nor hidden.
pub(super) fn moves_figures_alone(scene: &Scene, velocity: &Velocity) -> bool {
    let Velocity {
        surfaces,
        spots,
        view,
        view_growth,
        camera,
        laser,
        spot_growth,
        materials,
    } = velocity;
    let stands = |(surface, twist): (&Surface, &Twist)| {
        *twist == Twist::default() || !matches!(surface.role, Role::Relay | Role::Hidden)
    };
    *view == [0.0; 2]
        && *view_growth == 0.0
        && *camera == DVec3::ZERO
        && *laser == DVec3::ZERO
        && *spot_growth == 0.0
        && materials.is_empty()
        && spots.iter().all(|s| *s == [0.0; 2])
        && scene.surfaces.iter().zip(surfaces).all(stands)
}

/// A scene past figures, all of which may move with up to [`AT_ONCE`] parameters.
pub(super) struct Sweep<'a> {
    past: &'a Obstructed<'a>,
    velocities: &'a [&'a Velocity],
    views: Vec<ViewRate<'a>>,
    /// Whether figures that stand in the way are all that moves.
    pub is_still: bool,
    /// What the camera sees of each part of each pixel's footprint.
    seen: Vec<Vec<Vec<Vec<Moving>>>>,
    /// The middles of these parts.
    middles: Vec<Vec<[WallRate<'a>; AT_ONCE]>>,
    /// What arrives of the parts of each spot.
    lit: Vec<Vec<[WallRate<'a>; AT_ONCE]>>,
    /// What moves across each spot.
    edges: Vec<Vec<(WallPoint, Rates)>>,
}

/// Velocities of a point, per unit of each parameter.
type Carried = [DVec3; AT_ONCE];

impl<'a> Sweep<'a> {
    /// `past` has flat figures and flat walls alone ([`Obstructed::is_flat`]). None where no wall
    /// lies below the middle of the view.
    pub(super) fn new(past: &'a Obstructed<'a>, velocities: &'a [&'a Velocity]) -> Option<Self> {
        let scene = past.scene;
        let views = velocities.iter().map(|v| ViewRate::new(scene, v));
        let mut found = Self {
            past,
            velocities,
            views: views.collect::<Option<_>>()?,
            is_still: velocities.iter().all(|v| moves_figures_alone(scene, v)),
            seen: Vec::new(),
            middles: Vec::new(),
            lit: Vec::new(),
            edges: Vec::new(),
        };
        let camera = found.of(|k| velocities[k].camera);
        let shadows = found.shadows((scene.camera.position, camera), None);
        let mut pieces = Pieces::default();
        let mut of = |patch: &Patch| -> Vec<Vec<Moving>> {
            let Some(corners) = &patch.corners else {
                return Vec::new();
            };
            // In the frame of the camera, and back.
            let moving = |at: &DVec3| {
                let point = WallPoint {
                    position: *at,
                    ..patch.whole
                };
                let rate = |k: usize| found.views[k].seen(&point).position - camera[k];
                Moving {
                    at: *at,
                    rate: found.of(rate),
                }
            };
            let whole: Vec<Moving> = corners.iter().map(moving).collect();
            pieces.past([&*whole], corners, &shadows);
            let back = camera.map(|v| -v);
            pieces.iter().map(|piece| relative(piece, &back)).collect()
        };
        let seen = past.pixels.iter();
        let seen = seen.map(|patches| patches.iter().map(&mut of).collect());
        let seen = seen.collect();
        found.seen = seen;
        if !found.is_still {
            let middle = |p: &Patch| found.of(|k| found.views[k].seen(&p.whole));
            let middles = past.pixels.iter();
            let middles = middles.map(|patches| patches.iter().map(middle).collect());
            let middles = middles.collect();
            found.middles = middles;
        }
        let spot = |(l, parts): (usize, &Vec<Lit>)| {
            let lit = |w| found.of(|k| tangent::lit(scene, velocities[k], l, w));
            parts.iter().map(|part| lit(&part.left)).collect()
        };
        let lit = past.lit.iter().enumerate().map(spot).collect();
        found.lit = lit;
        let edges = (0..past.spots()).map(|l| found.edges(l)).collect();
        found.edges = edges;
        Some(found)
    }

    /// One of each parameter, and nothing of those that are not there.
    fn of<T: Default>(&self, each: impl Fn(usize) -> T) -> [T; AT_ONCE] {
        std::array::from_fn(|k| {
            if k < self.velocities.len() {
                each(k)
            } else {
                T::default()
            }
        })
    }

    /// Shadows in the frame of where they are seen from, which moves.
    fn shadows(
        &self,
        (from, carried): (DVec3, Carried),
        own: Option<ShapeId>,
    ) -> Vec<Shadow<PlaneRate>> {
        let velocity = |id: ShapeId, x: DVec3| {
            self.of(|k| self.velocities[k].surfaces[id as usize].at(x) - carried[k])
        };
        let bvh = self.past.scene.bvh();
        self.past.opaque.moving_from(from, own, bvh, velocity)
    }

    fn twist(&self, k: usize, cell: &HiddenCell) -> &Twist {
        &self.velocities[k].surfaces[cell.surface as usize]
    }

    fn moves(&self, cell: &HiddenCell) -> [HiddenRate; AT_ONCE] {
        self.of(|k| HiddenRate::new(&cell.point, self.twist(k, cell)))
    }

    /// ∂ of [`Obstructed::camera`], past what is.
    pub(super) fn camera(&self, cell: &HiddenCell) -> Vec<Rates> {
        let carried = self.of(|k| self.twist(k, cell).at(cell.viewpoint));
        let shadows = self.shadows((cell.viewpoint, carried), Some(cell.surface));
        let mut pieces = Pieces::default();
        let hidden = self.past.hidden_from(cell);
        let moves = self.moves(cell);
        let mut found: Vec<Option<Rates>> = vec![None; self.past.pixels()];
        self.past.blocks.visit(&hidden, &mut |p, met| {
            let mut sum = [0.0; AT_ONCE];
            for (i, (patch, seen)) in self.past.pixels[p].iter().zip(&self.seen[p]).enumerate() {
                let (Some(met), Some(corners)) = (met, &patch.corners) else {
                    continue;
                };
                let moved: Vec<Vec<Moving>>;
                let figures = if self.is_still {
                    seen
                } else {
                    moved = seen.iter().map(|piece| relative(piece, &carried)).collect();
                    &moved
                };
                let met = met.iter().map(|s| &shadows[*s]);
                if pieces.past(figures.iter().map(Vec::as_slice), corners, met) || !patch.open {
                    for piece in pieces.iter() {
                        let rates = self.seen_rate((piece, &carried), &patch.whole, (cell, &moves));
                        add(&mut sum, &rates);
                    }
                } else {
                    add(&mut sum, &self.whole_rate((p, i), (cell, &moves)));
                }
            }
            found[p] = Some(sum);
        });
        // Those that no shadow may meet are not visited.
        let whole = |p: usize| {
            let mut sum = [0.0; AT_ONCE];
            let all = 0..self.past.pixels[p].len();
            all.for_each(|i| add(&mut sum, &self.whole_rate((p, i), (cell, &moves))));
            sum
        };
        let each = found.into_iter().enumerate();
        each.map(|(p, met)| met.unwrap_or_else(|| whole(p)))
            .collect()
    }

    /// Of what part `i` of pixel `p` sends to a cell where nothing is in the way.
    fn whole_rate(
        &self,
        (p, i): (usize, usize),
        (cell, moves): (&HiddenCell, &[HiddenRate; AT_ONCE]),
    ) -> Rates {
        if self.is_still {
            return [0.0; AT_ONCE];
        }
        let (middle, rates) = (&self.past.pixels[p][i].whole, &self.middles[p][i]);
        self.of(|k| middle.towards_rate(self.past.scene, &rates[k], (&cell.point, &moves[k])))
    }

    /// Of what a piece of a wall, in the frame that is `carried`, sends to a cell.
    fn seen_rate(
        &self,
        (piece, carried): (&[Moving], &Carried),
        whole: &WallPoint,
        (cell, moves): (&HiddenCell, &[HiddenRate; AT_ONCE]),
    ) -> Rates {
        let scene = self.past.scene;
        let (area, middle, grown) = Moving::area_and_middle(piece);
        if area == 0.0 {
            return [0.0; AT_ONCE];
        }
        let point = wall_point::seen_piece(scene, whole, middle.at, area);
        self.of(|k| {
            let position = middle.rate[k] + carried[k];
            let rate = self.views[k].piece(&point, position, grown[k] / area);
            point.towards_rate(scene, &rate, (&cell.point, &moves[k]))
        })
    }

    /// ∂ of what its rule gives of a cell over what that sends to the middles of its parts
    /// ([`Past::by_rule`](super::factors::Past::by_rule)), of each pixel.
    pub(super) fn by_rule(
        &self,
        cell: &HiddenCell,
        footprints: &[Vec<WallPoint>],
        (by_middles, ratio): (&[f64], &[f64]),
    ) -> Vec<Rates> {
        if self.is_still {
            return vec![[0.0; AT_ONCE]; ratio.len()];
        }
        let (scene, moves) = (self.past.scene, self.moves(cell));
        let of = |p: usize| {
            if by_middles[p] == 0.0 {
                return [0.0; AT_ONCE];
            }
            self.of(|k| {
                let to = (&cell.point, &moves[k]);
                let rule = footprints[p].iter();
                let rule = rule.map(|w| w.towards_rate(scene, &self.views[k].seen(w), to));
                let parts = self.past.pixels[p].iter().zip(&self.middles[p]);
                let parts =
                    parts.map(|(patch, rate)| patch.whole.towards_rate(scene, &rate[k], to));
                (rule.sum::<f64>() - ratio[p] * parts.sum::<f64>()) / by_middles[p]
            })
        };
        (0..ratio.len()).map(of).collect()
    }
}

/// A figure in a frame that is carried along.
fn relative(figure: &[Moving], carried: &Carried) -> Vec<Moving> {
    let of = |corner: &Moving| Moving {
        at: corner.at,
        rate: std::array::from_fn(|k| corner.rate[k] - carried[k]),
    };
    figure.iter().map(of).collect()
}

fn add(sum: &mut Rates, more: &Rates) {
    sum.iter_mut().zip(more).for_each(|(x, y)| *x += y);
}

#[cfg(test)]
mod tests;
