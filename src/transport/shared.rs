//! Estimator [`Shared`](super::Estimator::Shared): the paths of a pixel serve all spots.
//!
//! A path x₁, x₂, … from the camera is connected at every vertex with every lit point s_l:
//!
//! ```text
//! Φ̂_n[p, l] = 1/N Σ β(x_{n−1}) · f_r(x_{n−1}) · G(x_{n−1}, s_l) · V · f_r(s_l) · Φlaser        n ≥ 2
//! ```
//!
//! β(x₁) is the étendue of the camera sample, and β grows by f_r · G / p from one vertex to the
//! next, p the density by which that was sampled. The errors along a row of Φcam are correlated.
//! Where surfaces come close to a spot, x_{n−1} is drawn from it too
//! ([`light_path`](super::light_path)).

use std::ops::Range;

use super::camera::first_vertex;
use super::context::Context;
use super::guide::PixelGuide;
use super::light_path::{LightEnd, light_end};
use super::points::{Buffers, PixelPoints};
use super::spots::LitPoints;
use super::vertex::Vertex;
use crate::num::stream::{Key, Stream};

/// The estimate of one block for all spots: \[order\]\[column\], W; order n − 1 holds the light
/// that met n surfaces.
pub(super) fn block(row: &mut PixelRow<'_>, block: u32) -> Vec<f64> {
    let columns = row.context.spots.range.len();
    let mut sums = vec![0.0; row.context.scene.max_bounces as usize * columns];
    row.estimate(Key::ALL_SPOTS, block, 0..columns, &mut sums);
    sums
}

/// Traces one pixel.
#[derive(Debug)]
pub(super) struct PixelRow<'a> {
    pub context: &'a Context<'a>,
    pixel: usize,
    /// What takes the place of paths where the pixel is simple enough.
    points: Option<PixelPoints<'a>>,
    buffers: Buffers,
    /// Where its paths go first.
    guide: Option<PixelGuide<'a>>,
    /// The light of one vertex, a number a column.
    vertex: Vec<f64>,
}

impl<'a> PixelRow<'a> {
    pub(super) fn new(context: &'a Context<'a>, pixel: usize) -> Self {
        let (scene, points) = (context.scene, PixelPoints::new(context, pixel));
        let guide = context
            .guide
            .as_ref()
            .filter(|_| points.is_none() && scene.max_bounces > 2);
        let ways = (&context.path, &context.views[pixel]);
        let size = points.as_ref().map_or(0, |_| context.strata.block_size());
        Self {
            context,
            buffers: Buffers::new(size),
            pixel,
            guide: guide.and_then(|guide| PixelGuide::new(guide, ways, scene)),
            points,
            vertex: Vec::new(),
        }
    }

    /// Writes the estimate of one block for `columns` into `sums`, \[order\]\[column\], with the
    /// random numbers of `spot`.
    pub(super) fn estimate(
        &mut self,
        spot: u32,
        block: u32,
        columns: Range<usize>,
        sums: &mut [f64],
    ) {
        let Context { plan, .. } = self.context;
        let key = Key {
            seed: plan.seed,
            spot,
            pixel: self.pixel as u32,
            block,
        };
        sums.fill(0.0);
        if let Some(points) = &self.points {
            points.estimate(&mut self.buffers, key, &columns, sums);
            return;
        }
        self.trace_paths(key, &columns, sums);
        let size = f64::from(plan.budget.size);
        sums.iter_mut().for_each(|sum| *sum /= size);
    }

    /// Adds what the paths of a block find.
    fn trace_paths(&mut self, key: Key, columns: &Range<usize>, sums: &mut [f64]) {
        let Context {
            scene,
            plan,
            spots,
            path,
            direct,
            ..
        } = self.context;
        let (n, power) = (columns.len(), scene.laser.power);
        let two_sets = spots.beams.has_width() || path.chooses();
        let mut stream = Stream::new(plan.sampling, key);
        let near = spots.light_paths.columns(columns).iter();
        let mut streams: Vec<_> = near
            .map(|c| (*c, spots.light_paths.stream(key, *c)))
            .collect();
        self.vertex.resize(n, 0.0);
        let mut guide = self.guide.take();
        let own = guide.as_mut().map(|guide| guide.points(columns.start));
        for index in 0..plan.budget.size {
            stream.start(index);
            let [a, b, u, v] = stream.next_four();
            let [choice, _, s, t] = if two_sets {
                stream.next_four()
            } else {
                [0.0; 4]
            };
            let lit = spots.points(&[[s, t]], columns);
            let x = first_vertex(scene, self.pixel, [a, b]);
            let one = &mut sums[..n];
            direct.add(spots, self.pixel, (1, power), |_| x, &lit, one);
            let vertices = scene.max_bounces - 1;
            let ends = self.light_ends(&mut streams, index, &lit);
            let first_step = ([u, v, choice], own);
            path.trace(x, vertices, first_step, &mut stream, |order, x| {
                spots.light_vertex(x, &lit, &mut self.vertex);
                let y = (x.oriented(), x.density, 1.0);
                spots
                    .light_paths
                    .weigh(y, lit.at(0), columns.start, &mut self.vertex);
                let (these, longer) = sums[order as usize * n..].split_at_mut(n);
                let light = these.iter_mut().zip(&self.vertex);
                light.for_each(|(sum, one)| *sum += one);
                for (column, lit, end) in ends.iter().filter(|_| order < vertices) {
                    let y = path.connect(x, end, own.filter(|_| order == 1));
                    let light = y.map_or(0.0, |y| spots.light_from(lit, &y));
                    longer[column - columns.start] += light;
                }
            });
        }
        self.guide = guide;
    }

    /// The ends of the light paths that belong to path `index`, each with its column and lit point.
    fn light_ends<'l>(
        &self,
        streams: &mut [(usize, Stream)],
        index: u32,
        lit: &'l LitPoints<'_>,
    ) -> Vec<(usize, &'l Vertex, LightEnd)> {
        let scene = self.context.scene;
        let end = |(column, stream): &mut (usize, Stream)| {
            stream.start(index);
            let [u, v, ..] = stream.next_four();
            let point = lit.at(0)[*column - lit.columns.start].as_ref()?;
            Some((*column, point, light_end(scene, point, [u, v])?))
        };
        streams.iter_mut().filter_map(end).collect()
    }
}
