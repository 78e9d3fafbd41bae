//! Surfaces of the drawing: their geometry and what their fronts look like.

use std::sync::Arc;

use serde::Serialize;

use super::super::super::encode::base64;
use crate::geometry::{DVec3, Facing, Mesh, Shape, Side};
use crate::scene::{Role, Surface, Texture, Wrap};

/// A texture has at most so many values a side here.
const MOST_VALUES: usize = 128;
/// Along a ramp.
const RAMP_VALUES: usize = 64;

/// A surface as the page's script draws it.
#[derive(Serialize)]
pub(super) struct SurfaceBlock<'a> {
    name: &'a str,
    role: &'static str,
    #[serde(flatten)]
    geometry: Geometry,
    texture: Grey,
}

/// Its geometry, in the scene's unit.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Geometry {
    /// corner + a·u + b·v, 0 ≤ a, b ≤ 1.
    Patch {
        corner: [f64; 3],
        u: [f64; 3],
        v: [f64; 3],
        normal: [f64; 3],
    },
    /// `u` and `v`: from the centre to where the rim has the parameters (1, ½) and (½, 1).
    Disc {
        centre: [f64; 3],
        u: [f64; 3],
        v: [f64; 3],
        normal: [f64; 3],
    },
    /// A ball, or a cavity whose front is inside.
    Sphere {
        centre: [f64; 3],
        radius: f64,
        inside: bool,
    },
    /// One of the block's meshes after an affine motion (three columns of its matrix, then where
    /// the origin goes); its front is where corners run counterclockwise, or the other side.
    Mesh {
        mesh: usize,
        motion: [f64; 12],
        inner: bool,
    },
}

/// Albedo as bytes, 255 for 1: `count` values along u and v, u fastest, in base64.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Grey {
    pub(super) count: [usize; 2],
    grey: String,
    /// What lies outside of the parameters [0, 1]: the same again, or the border.
    repeat: bool,
    /// Whether values are means, or samples, of finer or of continuous ones.
    reduced: bool,
}

impl<'a> SurfaceBlock<'a> {
    /// `meshes` are those of the block.
    pub(super) fn of(surface: &'a Surface, meshes: &[Arc<Mesh>]) -> Self {
        let point = DVec3::to_array;
        let geometry = match &surface.shape {
            Shape::Parallelogram(patch) => Geometry::Patch {
                corner: point(&patch.corner()),
                u: point(&patch.u()),
                v: point(&patch.v()),
                normal: point(&patch.normal()),
            },
            Shape::Disc(disc) => Geometry::Disc {
                centre: point(&disc.centre()),
                u: point(&(disc.at([1.0, 0.5]).position - disc.centre())),
                v: point(&(disc.at([0.5, 1.0]).position - disc.centre())),
                normal: point(&disc.normal()),
            },
            Shape::Sphere(sphere) => Geometry::Sphere {
                centre: point(&sphere.centre),
                radius: sphere.radius,
                inside: sphere.facing == Facing::Inside,
            },
            Shape::Instance(body) => Geometry::Mesh {
                mesh: meshes
                    .iter()
                    .position(|m| Arc::ptr_eq(m, body.mesh()))
                    .unwrap_or(0),
                motion: body.placement().to_cols_array(),
                inner: body.side() == Side::Inner,
            },
        };
        let plain = matches!(&surface.shape, Shape::Instance(body) if body.mesh().uv().is_none());
        Self {
            name: &surface.name,
            role: match surface.role {
                Role::Relay => "relay",
                Role::Hidden => "hidden",
                Role::Occluder => "occluder",
            },
            geometry,
            // Where a mesh has no coordinates, its texture is asked at (0, 0) everywhere.
            texture: if plain {
                Grey::of(&Texture::Constant(surface.albedo.albedo([0.0, 0.0])))
            } else {
                Grey::of(&surface.albedo)
            },
        }
    }

    /// Whether its texture is coarser here than in the scene.
    pub(super) fn is_reduced(&self) -> bool {
        self.texture.reduced
    }
}

impl Grey {
    /// Cells as they are where they are few enough, else their means over a grid that is.
    pub(super) fn of(texture: &Texture) -> Self {
        let (whole, continuous) = match texture {
            Texture::Constant(_) => ([1, 1], false),
            Texture::Ramp(_) => ([RAMP_VALUES, 1], true),
            Texture::Cells(cells) | Texture::Tiles(cells) => (cells.count, false),
            Texture::Bilinear(texels) => (texels.count.map(|n| 2 * n), true),
        };
        let count = whole.map(|n| n.min(MOST_VALUES));
        let [nu, nv] = count;
        let interval = |i: usize, n: usize| [i, i + 1].map(|k| k as f64 / n as f64);
        let value = |k: usize| {
            let (u, v) = (interval(k % nu, nu), interval(k / nu, nv));
            match (texture, count == whole) {
                (Texture::Cells(cells) | Texture::Tiles(cells), true) => cells.albedo[k],
                // The middle of a half-texel is its mean.
                (Texture::Bilinear(_), true) => {
                    texture.albedo([0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1])])
                }
                _ => texture.mean(u, v),
            }
        };
        let bytes: Vec<u8> = (0..nu * nv)
            .map(|k| (255.0 * value(k)).round() as u8)
            .collect();
        Self {
            count,
            grey: base64(&bytes),
            repeat: match texture {
                Texture::Tiles(_) => true,
                Texture::Bilinear(texels) => texels.wrap == Wrap::Repeat,
                _ => false,
            },
            reduced: continuous || count != whole,
        }
    }
}

#[cfg(test)]
mod tests {
    use base64::prelude::{BASE64_STANDARD, Engine};

    use super::*;
    use crate::scene::{Cells, Scene};

    fn bytes(grey: &Grey) -> Vec<u8> {
        BASE64_STANDARD.decode(&grey.grey).unwrap()
    }

    /// A checkerboard's cell (0, 0), at `corner`, is dark (design.md, 6).
    #[test]
    fn every_check_is_there_and_the_first_is_dark() {
        for n in [2, 8, 128] {
            let text = include_str!("../../../../scenes/bench.toml").replace(
                "checkerboard = [2, 2]",
                &format!("checkerboard = [{n}, {n}]"),
            );
            let scene = Scene::from_toml("test", &text).unwrap();
            let grey = Grey::of(&scene.surfaces[1].albedo);
            assert!(grey.count == [n, n] && !grey.reduced);
            for (k, byte) in bytes(&grey).into_iter().enumerate() {
                let light = (k % n + k / n) % 2 == 1;
                assert_eq!(byte, if light { 255 } else { 0 }, "{n}: {k}");
            }
        }
    }

    /// 256 columns of 0, 1, 0, 1, …: each value here is the mean of two.
    #[test]
    fn what_is_too_fine_is_averaged() {
        let albedo = (0..256).map(|i| f64::from(i % 2)).collect();
        let fine = Texture::Cells(Cells {
            count: [256, 1],
            albedo,
        });
        let grey = Grey::of(&fine);
        assert!(grey.count == [128, 1] && grey.reduced);
        // 255 · ½ = 127.5, rounded.
        assert!(bytes(&grey).iter().all(|b| *b == 128));
    }

    #[test]
    fn a_ramp_rises_evenly() {
        let grey = Grey::of(&Texture::Ramp([0.0, 1.0]));
        for (k, byte) in bytes(&grey).into_iter().enumerate() {
            assert_eq!(f64::from(byte), (255.0 * (k as f64 + 0.5) / 64.0).round());
        }
    }
}
