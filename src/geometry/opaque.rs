//! What stands in the way in a scene, seen from a point.

use super::corner::Polygon;
use super::moving::{AT_ONCE, Moving, PlaneRate};
use super::shadow::{EDGE_ON, Shadow, circle};
use super::{Blockers, Bvh, DVec3, Facing, Shape, ShapeId, Sphere};

/// Meshes of more triangles are asked ray by ray.
const MOST_TRIANGLES: usize = 256;

/// What stands in the way in a scene, ready to be seen from many points.
#[derive(Clone, Debug)]
pub struct Opaque {
    figures: Vec<(ShapeId, Polygon)>,
    spheres: Vec<(ShapeId, Sphere)>,
    /// Meshes of many triangles.
    by_rays: Vec<ShapeId>,
}

/// What is hidden from one point.
#[derive(Clone, Debug)]
pub struct Hidden {
    /// Exactly.
    pub shadows: Vec<Shadow>,
    /// Shapes that have to be asked ray by ray besides, each with what its circumsphere hides.
    pub by_rays: Vec<(ShapeId, Option<Shadow>)>,
}

impl Opaque {
    /// All shapes of a scene for which `counts` holds.
    pub fn new(bvh: &Bvh, counts: impl Fn(ShapeId) -> bool) -> Self {
        let mut found = Self {
            figures: Vec::new(),
            spheres: Vec::new(),
            by_rays: Vec::new(),
        };
        for (id, shape) in (0..).zip(bvh.shapes()).filter(|(id, _)| counts(*id)) {
            match shape {
                Shape::Parallelogram(p) => found.figures.push((id, p.corners().to_vec())),
                Shape::Disc(d) => {
                    let corners = circle(d.centre(), d.normal(), d.radius());
                    found.figures.push((id, corners));
                }
                Shape::Sphere(s) => found.spheres.push((id, *s)),
                Shape::Instance(body) => {
                    let count = body.mesh().triangles().len();
                    if count > MOST_TRIANGLES {
                        found.by_rays.push(id);
                    } else {
                        let triangles = (0..count as u32).map(|t| body.corners(t));
                        let figures = figures(triangles.collect());
                        found.figures.extend(figures.into_iter().map(|f| (id, f)));
                    }
                }
            }
        }
        found
    }

    /// Whether there are meshes that have to be asked ray by ray.
    pub fn has_meshes(&self) -> bool {
        !self.by_rays.is_empty()
    }

    /// Whether all are flat figures, whose shadows can be followed as they move.
    pub fn is_flat(&self) -> bool {
        self.spheres.is_empty() && self.by_rays.is_empty()
    }

    /// The figures of all shapes but `own`, which stays if it is a mesh.
    fn figures_but(
        &self,
        own: Option<ShapeId>,
        bvh: &Bvh,
    ) -> impl Iterator<Item = &(ShapeId, Polygon)> {
        let is_mesh = |id: ShapeId| matches!(bvh.shapes()[id as usize], Shape::Instance(_));
        self.figures
            .iter()
            .filter(move |(id, _)| Some(*id) != own || is_mesh(*id))
    }

    /// The shadows of [`Self::from`] where all are flat figures, as they move with the velocities
    /// that `velocity` gives of a point of a shape.
    pub fn moving_from(
        &self,
        from: DVec3,
        own: Option<ShapeId>,
        bvh: &Bvh,
        velocity: impl Fn(ShapeId, DVec3) -> [DVec3; AT_ONCE],
    ) -> Vec<Shadow<PlaneRate>> {
        let shadow = |(id, corners): &(ShapeId, Polygon)| {
            let corner = |at: &DVec3| Moving {
                at: *at,
                rate: velocity(*id, *at),
            };
            Shadow::of_moving(&corners.iter().map(corner).collect::<Vec<_>>(), from)
        };
        self.figures_but(own, bvh).filter_map(shadow).collect()
    }

    /// What is hidden from `from`, a point of shape `own`: that shape hides nothing of its own
    /// unless it is a mesh.
    pub fn from(&self, from: DVec3, own: Option<ShapeId>, bvh: &Bvh) -> Hidden {
        let figures = self.figures_but(own, bvh);
        let figures = figures.filter_map(|(_, corners)| Shadow::of_figure(corners, from));
        let around = |id: &ShapeId| {
            let (centre, radius) = bvh.shapes()[*id as usize].circumsphere();
            let sphere = Sphere::new(centre, radius, Facing::Outside);
            (*id, sphere.and_then(|s| Shadow::of_sphere(&s, from)))
        };
        let mut by_rays: Vec<_> = self.by_rays.iter().map(around).collect();
        let mut shadows: Vec<Shadow> = figures.collect();
        for (id, sphere) in self.spheres.iter().filter(|(id, _)| Some(*id) != own) {
            match Shadow::of_sphere(sphere, from) {
                Some(shadow) => shadows.push(shadow),
                None => by_rays.push((*id, None)),
            }
        }
        Hidden { shadows, by_rays }
    }
}

impl Hidden {
    /// The shapes that have to be asked, for segments that end on the convex hull of these points.
    /// They lie on shape `own`, flat or a sphere: seen from within neither hides any of itself.
    pub fn asked(&self, hull: &[DVec3], own: Option<ShapeId>) -> Blockers {
        let near = |around: &Option<Shadow>| around.as_ref().is_none_or(|a| !a.misses(hull));
        let others = self.by_rays.iter().filter(|(id, _)| Some(*id) != own);
        let asked = others.filter(|(_, around)| near(around));
        Blockers::Among(asked.map(|(id, _)| *id).collect())
    }
}

/// Triangles as figures: of two that follow each other and make up a parallelogram, that.
fn figures(triangles: Vec<[DVec3; 3]>) -> Vec<Polygon> {
    let mut found: Vec<Polygon> = Vec::new();
    for [a, b, c] in triangles {
        match found.last_mut() {
            // (p, q, r) and (p, r, s) with s = p + r − q.
            Some(last) if last.len() == 3 && last[0] == a && last[2] == b => {
                let expected = last[0] + last[2] - last[1];
                if (c - expected).length() <= EDGE_ON * (c - a).length() {
                    last.push(c);
                } else {
                    found.push(vec![a, b, c]);
                }
            }
            _ => found.push(vec![a, b, c]),
        }
    }
    found
}

#[cfg(test)]
mod tests;
