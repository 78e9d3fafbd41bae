//! The light paths of one spot, for what many pixels see at the same places of their footprints.

use super::camera::{PixelView, camera_terms};
use super::context::Context;
use super::glossy::GlossyPoint;
use super::light_path::{LightEnd, light_end};
use super::spots::LitSpots;
use super::vertex::{Batch, Vertex};
use crate::geometry::{Blockers, DVec3};
use crate::num::stream::{Key, Stream};

/// One light path.
pub(super) struct LightPoint {
    /// Place in the footprint that it is connected with.
    pub footprint: [f64; 2],
    /// Place in the beam.
    pub beam: [f64; 2],
    /// The lit point and the end; `None` if it meets nothing.
    pub ends: Option<(Vertex, LightEnd)>,
}

impl LightPoint {
    pub(super) fn draw(spots: &LitSpots<'_>, column: usize, stream: &mut Stream) -> Self {
        let [u, v, footprint @ ..] = stream.next_four();
        let beam = if spots.beams.has_width() {
            let [s, t, ..] = stream.next_four();
            [s, t]
        } else {
            [0.0; 2]
        };
        let lit = spots.points(&[beam], &(column..column + 1)).at(0)[0];
        let ends = lit.and_then(|lit| Some((lit, light_end(spots.scene, &lit, [u, v])?)));
        Self {
            footprint,
            beam,
            ends,
        }
    }
}

/// The light paths of one column in a block.
pub(super) struct LightPoints<'a> {
    pub column: usize,
    at: Batch,
    footprint: Vec<[f64; 2]>,
    /// L_3 at each, over the density of all points there.
    light: Vec<f64>,
    /// Those that are not Lambertian; L_3 is then without the factor d of their BRDF.
    glossy: Vec<(usize, GlossyPoint<'a>)>,
}

impl<'a> LightPoints<'a> {
    pub(super) fn draw(context: &Context<'a>, key: Key, column: usize) -> Self {
        let Context { scene, spots, .. } = context;
        let count = spots.light_paths.count;
        let mut points = Self {
            column,
            at: Batch::zeros(count as usize),
            footprint: Vec::with_capacity(count as usize),
            light: vec![0.0; count as usize],
            glossy: Vec::new(),
        };
        let mut stream = spots.light_paths.stream(key, column);
        for k in 0..count {
            stream.start(k);
            let point = LightPoint::draw(spots, column, &mut stream);
            points.footprint.push(point.footprint);
            let Some((lit, end)) = point.ends else {
                continue;
            };
            let all = context.strata.density(&end.at) + f64::from(count) * end.density;
            let y = Vertex::new(scene, end.at.shape, &end.at.point, DVec3::ZERO, 1.0 / all);
            if context.between.contains(&y.shape) && y.reflects(scene) {
                points.at.set(k as usize, y.oriented(), 1.0, y.shape);
                let own = GlossyPoint::new(scene, &y, &[Some(lit)]);
                points.light[k as usize] = match &own {
                    None => spots.light_from(&lit, &y),
                    Some(_) => spots.light_onto(&lit, &y),
                };
                points.glossy.extend(own.map(|own| (k as usize, own)));
            }
        }
        points
    }

    /// Σ_k C(x_k, y_k)·L_3(y_k) of the pixel, W; `blockers` by shape.
    pub(super) fn flux(
        &self,
        context: &Context<'_>,
        view: &PixelView,
        blockers: &[Blockers],
    ) -> f64 {
        let mut x = Batch::zeros(self.footprint.len());
        let mut camera = vec![0.0; self.footprint.len()];
        view.vertices(context.scene, &self.footprint, &mut x);
        let surfaces = (context.scene, context.is_glossy);
        camera_terms(surfaces, blockers, (&x, &self.at), &mut camera);
        let mut glossy = 0.0;
        for (k, y) in &self.glossy {
            let (to, _) = x.place(*k);
            let c = std::mem::take(&mut camera[*k]);
            y.add(
                c,
                to,
                &self.light[*k..=*k],
                std::slice::from_mut(&mut glossy),
            );
        }
        let matt: f64 = camera.iter().zip(&self.light).map(|(c, l)| c * l).sum();
        matt + glossy
    }
}
