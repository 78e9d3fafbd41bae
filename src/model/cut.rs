//! A scene cut into parts on which the rules of quadrature converge.

use std::f64::consts::FRAC_1_PI;

use rayon::prelude::*;

use super::extent::{Extent, Take};
use super::kernel::{HiddenPoint, HiddenPoints, Kernel};
use super::overhang;
use super::parts::{Ball, FootprintPart, Footprints, HiddenParts};
use super::spot::reach;
use super::wall_point::{self, WallPoint};
use crate::geometry::DVec3;
use crate::matrix::Matrix;
use crate::scene::{Profile, Scene, Surface};

/// Nodes, and pixels, handled at once.
pub(super) const CHUNK: usize = 4096;
const STRIP: usize = 64;
/// Multiplications of a product in the time of a connection.
const PRODUCTS: f64 = 8.0;
/// M at a point of the surface that shines, W length⁻²: 0 where it is dark in that column. `None`
/// where a laser lights the scene.
pub(super) fn exitance(scene: &Scene, column: usize, at: DVec3) -> Option<f64> {
    let (_, surface) = scene.shining()?;
    let uv = surface.shape.at_position(at).uv;
    Some(scene.laser.exitance(surface, column, uv))
}

/// Levels of refinement of the hidden surfaces, and of footprints and spots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Level {
    pub hidden: usize,
    pub walls: usize,
}

impl Level {
    pub(super) fn both(level: usize) -> Self {
        Self {
            hidden: level,
            walls: level,
        }
    }

    /// The hidden surfaces alone.
    pub(super) fn hidden(level: usize) -> Self {
        Self {
            hidden: level,
            walls: 0,
        }
    }

    /// Footprints and spots alone.
    pub(super) fn walls(level: usize) -> Self {
        Self {
            hidden: 0,
            walls: level,
        }
    }
}

/// A scene cut into parts on which the rules converge.
pub(super) struct Cut<'a> {
    elements: Take,
    pub(super) hidden: HiddenParts<'a>,
    /// Of each pixel.
    footprints: Vec<Vec<FootprintPart>>,
    scene: &'a Scene,
    profile: Profile,
}

impl<'a> Cut<'a> {
    pub(super) fn new(scene: &'a Scene, extent: Extent) -> Self {
        let profile = match extent.spots {
            Take::Centre => Profile::Ideal,
            Take::Integral => scene.laser.profile,
        };
        let reach = reach(profile);
        let pixels = 0..scene.camera.pixels();
        let footprints: Vec<_> = match extent.footprints {
            Take::Centre => pixels
                .map(|p| vec![FootprintPart::centre(scene, p)])
                .collect(),
            Take::Integral => {
                let footprints = Footprints::new(scene);
                pixels.map(|p| footprints.parts(p)).collect()
            }
        };
        let spots = scene.laser.spots.iter().map(|s| Ball {
            middle: s.target.position,
            radius: reach,
        });
        let near: Vec<Ball> = footprints
            .iter()
            .flatten()
            .map(|p| p.ball)
            .chain(spots)
            .collect();
        Self {
            elements: extent.elements,
            hidden: HiddenParts::new(scene, &near),
            footprints,
            scene,
            profile,
        }
    }

    /// Connections between wall points and hidden points at `level`.
    pub(super) fn connections(&self, level: Level) -> f64 {
        let seen = self.footprints.iter().flatten();
        let seen: usize = seen.map(|part| part.nodes(level.walls).len()).sum();
        let lit = overhang::count(self.scene, self.profile, 2 + 2 * level.walls);
        self.hidden.count(level.hidden) as f64 * (seen + lit) as f64
    }

    /// What an integration at `level` costs, in connections.
    pub(super) fn cost(&self, level: Level) -> f64 {
        let products = (self.footprints.len() * self.scene.laser.spots.len()) as f64;
        self.connections(level) + self.hidden.count(level.hidden) as f64 * products / PRODUCTS
    }

    /// The wall as each pixel sees it, at `level`.
    pub(super) fn seen(&self, level: usize) -> Vec<Vec<WallPoint>> {
        let seen = |p: usize| {
            let nodes = self.footprints[p].iter().flat_map(|part| part.nodes(level));
            nodes
                .map(|(ab, w)| wall_point::seen(self.scene, p, ab, w))
                .collect()
        };
        (0..self.footprints.len()).map(seen).collect()
    }

    /// The wall as each spot lights it, at `level`; nothing where a surface shines.
    pub(super) fn lit(&self, level: usize) -> Vec<Vec<WallPoint>> {
        overhang::lit(self.scene, self.profile, 2 + 2 * level)
    }

    /// How far a rule of `level` may be off where albedo jumps between its nodes, relative, of each
    /// pixel and each spot: of N nodes about a row of √N lies on the wrong side of an edge,
    ///
    /// > 2 (ρ_max − ρ_min)/ρ̄ /√N,   N = (Σ w)²/Σ w².
    ///
    /// 0 of those that are cut along the edges of the texture.
    pub(super) fn jumps(&self, level: usize) -> [Vec<f64>; 2] {
        let scene = self.scene;
        let surfaces = scene.surfaces.iter();
        let unseamed: Vec<bool> = surfaces.map(|s| s.seams().is_none()).collect();
        let unseamed = |w: &WallPoint| w.surface.is_some_and(|id| unseamed[id as usize]);
        let seen_of = |(nodes, parts): (Vec<WallPoint>, &Vec<FootprintPart>)| {
            let is_motley = parts.iter().any(|part| part.is_motley);
            let own = is_motley || nodes.iter().any(unseamed);
            if own { spread(&nodes) } else { 0.0 }
        };
        let seen = self.seen(level).into_iter().zip(&self.footprints);
        let seen = seen.map(seen_of).collect();
        let lit = self.lit(level).into_iter().enumerate();
        let lit = lit.map(|(l, nodes)| {
            if overhang::is_motley(scene, l, self.profile) {
                spread(&nodes)
            } else {
                0.0
            }
        });
        [seen, lit.collect()]
    }

    /// The ends of the wall across each spot, at `level`.
    pub(super) fn ends(&self, level: usize) -> Vec<Vec<(WallPoint, DVec3)>> {
        let of = |l| overhang::ends(self.scene, l, self.profile, 2 + 2 * level);
        (0..self.scene.laser.spots.len()).map(of).collect()
    }

    /// One quadrature: Φ = Σ_q C\[p,q\]·D\[q,l\] over the nodes q of the hidden surfaces, in
    /// chunks.
    pub(super) fn integrate(&self, kernel: Kernel, level: Level) -> Matrix {
        let scene = self.scene;
        let (seen, lit) = (self.seen(level.walls), self.lit(level.walls));
        let hidden = match self.elements {
            Take::Centre => elements(scene),
            Take::Integral => self.hidden.nodes(level.hidden),
        };
        // Its transpose, spots × pixels, so that the photographs of some pixels lie side by side.
        let mut phi = Matrix::zeros(lit.len(), seen.len());
        for chunk in hidden.chunks(CHUNK) {
            let points = HiddenPoints::new(chunk);
            let sides = |walls: &[Vec<WallPoint>]| {
                wall_point::sides((scene, kernel), &points, walls.iter().map(|w| w.iter()))
            };
            let mut laser = if scene.laser.is_shining() {
                Matrix::from_fn(chunk.len(), lit.len(), |q, l| {
                    exitance(scene, l, chunk[q].0.position).unwrap_or(0.0)
                })
            } else {
                sides(&lit)
            };
            for (mut row, (_, share)) in laser.row_iter_mut().zip(chunk) {
                row *= *share;
            }
            let laser = laser.transpose();
            let strips = phi.as_mut_slice().par_chunks_mut(STRIP * lit.len());
            strips.zip(seen.par_chunks(STRIP)).for_each(|(phi, seen)| {
                let more = &laser * sides(seen);
                for (sum, more) in phi.iter_mut().zip(&more) {
                    *sum += more;
                }
            });
        }
        phi.transpose()
    }
}

/// 2 (ρ_max − ρ_min)/ρ̄ /√N of the nodes that are lit or seen.
fn spread(nodes: &[WallPoint]) -> f64 {
    let (mut low, mut high) = (f64::INFINITY, 0.0f64);
    let [mut squares, mut mean] = [0.0; 2];
    for node in nodes.iter().filter(|node| node.weight > 0.0) {
        let (w, albedo) = (node.weight, node.albedo());
        (low, high) = (low.min(albedo), high.max(albedo));
        squares += w * w;
        mean += w * albedo;
    }
    if mean > 0.0 && nodes.len() > 1 {
        2.0 * (high - low) * squares.sqrt() / mean
    } else {
        0.0
    }
}

/// The middles of the scene's elements with area · albedo/π.
fn elements<'a>(scene: &'a Scene) -> Vec<(HiddenPoint, f64)> {
    let divided = |s: &'a Surface| s.divided(s.elements).into_iter().map(move |e| (s, e));
    let all = scene.hidden().flat_map(|(_, s)| divided(s));
    let light = all.filter(|(_, e)| e.albedo > 0.0 && e.area > 0.0);
    light
        .map(|(s, e)| (HiddenPoint::new(s, &e), e.area * e.albedo * FRAC_1_PI))
        .collect()
}
