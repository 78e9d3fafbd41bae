//! The lit spots: the light that goes from each of them to a vertex (next-event estimation).

mod footprint;

use std::borrow::Cow;
use std::ops::Range;

use rayon::prelude::*;

use super::beam::Beams;
use super::light_path::LightPaths;
use super::vertex::{Batch, Vertex, geometry_term};
use super::visibility::{Place, hide};
use crate::geometry::{Blockers, DVec3, Region, ShapeId};
use crate::num::stream::Sampling;
use crate::scene::Scene;
use footprint::SpotFootprint;

/// A range of spots, and what can stand between each of them and the shapes around.
#[derive(Debug)]
pub(super) struct LitSpots<'a> {
    pub scene: &'a Scene,
    /// The beams to all spots of the scene.
    pub beams: Beams<'a>,
    pub range: Range<usize>,
    /// Points drawn from the spots that surfaces come close to.
    pub light_paths: LightPaths,
    /// By column: where its light is expected to land.
    footprints: Vec<Option<SpotFootprint>>,
    /// By column and shape, for the expected footprint.
    blockers: Vec<Vec<Blockers>>,
    /// By shape: whether nothing can stand between it and any spot.
    clear: Vec<bool>,
    /// Whether any surface is not Lambertian.
    glossy: bool,
    /// The lit points of all columns, where beams have no width.
    fixed: Option<Batch>,
}

/// Lit points of some columns of Φcam for a number of places in the beams: the same for all places
/// where beams have no width. `None` where the light is lost.
#[derive(Debug)]
pub(super) struct LitPoints<'p> {
    pub columns: Range<usize>,
    /// By place and column, or by column alone.
    points: Cow<'p, [Option<Vertex>]>,
}

impl LitPoints<'_> {
    /// Whether all places have the same points.
    pub(super) fn is_fixed(&self) -> bool {
        self.points.len() == self.columns.len()
    }

    /// The points of all columns for place `k`.
    pub(super) fn at(&self, k: usize) -> &[Option<Vertex>] {
        let n = self.columns.len();
        if self.is_fixed() {
            &self.points
        } else {
            &self.points[k * n..(k + 1) * n]
        }
    }
}

/// A lit point, its column, and the shape of a vertex that it may light.
pub(super) type Connection<'p> = (usize, &'p Vertex, ShapeId);

impl<'a> LitSpots<'a> {
    /// For the spots of `range`, in blocks of `size` samples.
    pub(super) fn new(
        scene: &'a Scene,
        range: Range<usize>,
        (sampling, size): (Sampling, u32),
    ) -> Self {
        let beams = Beams::new(scene);
        let shapes = scene.surfaces.iter().map(|s| Region::around(&s.shape));
        let shapes: Vec<Region> = shapes.collect();
        let footprints = range
            .clone()
            .map(|spot| SpotFootprint::new(scene, &beams, spot));
        let footprints: Vec<Option<SpotFootprint>> = footprints.collect();
        let blockers = footprints.iter().zip(range.clone());
        let blockers: Vec<Vec<Blockers>> = blockers
            .map(|(footprint, spot)| match footprint {
                Some(footprint) => footprint.blockers(scene, spot, &shapes),
                None => vec![Blockers::Any; shapes.len()],
            })
            .collect();
        let clear = (0..shapes.len())
            .map(|t| !beams.has_width() && blockers.iter().all(|b| b[t].none()))
            .collect();
        let fixed =
            (!beams.has_width()).then(|| batch(scene, &beams.ideal[range.clone()], range.len()));
        Self {
            scene,
            fixed,
            light_paths: LightPaths::new(scene, &beams, &range, (sampling, size)),
            beams,
            range,
            footprints,
            blockers,
            clear,
            glossy: scene.surfaces.iter().any(|s| !s.is_lambertian()),
        }
    }

    /// The points lit by the beams of `columns` for many places in the beams.
    pub(super) fn points(&self, places: &[[f64; 2]], columns: &Range<usize>) -> LitPoints<'_> {
        let spots = self.range.start + columns.start..self.range.start + columns.end;
        let points = if self.beams.has_width() {
            let at = |place: &[f64; 2]| {
                let place = *place;
                spots.clone().map(move |s| self.beams.point(s, place))
            };
            Cow::Owned(match places {
                [place] => at(place).collect(),
                _ => places
                    .par_iter()
                    .with_min_len(64)
                    .flat_map_iter(at)
                    .collect(),
            })
        } else {
            Cow::Borrowed(&self.beams.ideal[spots])
        };
        LitPoints {
            columns: columns.clone(),
            points,
        }
    }

    /// Multiplies the entries, each a geometry term and what is known without directions, by the
    /// visibility and by the factors d of both BRDFs; `factor(i, p)` is that at x for light from p,
    /// and `position(i)` the position of x.
    #[inline]
    pub(super) fn connect<'p>(
        &self,
        entries: &mut [f64],
        connection: impl Fn(usize) -> Option<Connection<'p>>,
        position: impl Fn(usize) -> DVec3,
        factor: impl Fn(usize, DVec3) -> f64,
    ) {
        let blockers = |i: usize| {
            let (column, lit, x) = connection(i)?;
            (!self.clear[x as usize]).then(|| self.blockers(column, lit, x))
        };
        hide(self.scene.bvh(), entries, blockers, |i| {
            let (_, lit, x) = connection(i).expect("what can be blocked is connected");
            [(position(i), x), (lit.position, lit.shape)]
        });
        if !self.glossy {
            return;
        }
        for (i, entry) in entries.iter_mut().enumerate().filter(|(_, e)| **e != 0.0) {
            if let Some((_, lit, _)) = connection(i) {
                *entry *= lit.factor_to(self.scene, position(i));
                *entry *= factor(i, lit.position);
            }
        }
    }

    /// [`LitSpots::connect`] of one vertex with a row of points, its columns from `first` on.
    pub(super) fn connect_row(
        &self,
        (position, shape): Place,
        points: &[Option<Vertex>],
        first: usize,
        row: &mut [f64],
        factor: impl Fn(DVec3) -> f64,
    ) {
        if self.clear[shape as usize] && !self.glossy {
            return;
        }
        let connection = |i: usize| Some((first + i, points.get(i)?.as_ref()?, shape));
        self.connect(row, connection, |_| position, |_, light| factor(light));
    }

    /// Sets `row` to the light that goes from each lit point by the vertex x of a path into the
    /// pixel: β·c·Φlaser · G·c_l · V·d·d_l.
    pub(super) fn light_vertex(&self, x: &Vertex, lit: &LitPoints<'_>, row: &mut [f64]) {
        let points = lit.at(0);
        for (entry, point) in row.iter_mut().zip(points) {
            *entry = point
                .as_ref()
                .map_or(0.0, |lit| self.constant_light(lit, x));
        }
        let place = (x.position, x.shape);
        let factor = |light| x.factor_from(self.scene, light);
        self.connect_row(place, points, lit.columns.start, row, factor);
    }

    /// [`LitSpots::light_vertex`] from one lit point, with nothing between.
    pub(super) fn light_from(&self, lit: &Vertex, x: &Vertex) -> f64 {
        let factors =
            x.factor_from(self.scene, lit.position) * lit.factor_to(self.scene, x.position);
        self.constant_light(lit, x) * factors
    }

    /// The same without the factor d of the BRDF at x.
    pub(super) fn light_onto(&self, lit: &Vertex, x: &Vertex) -> f64 {
        self.constant_light(lit, x) * lit.factor_to(self.scene, x.position)
    }

    /// β·c·Φlaser · G·c_l.
    fn constant_light(&self, lit: &Vertex, x: &Vertex) -> f64 {
        let Some((term, _)) = geometry_term(x.oriented(), lit.oriented()) else {
            return 0.0;
        };
        let radiance = x.throughput * x.constant_factor(self.scene) * self.scene.laser.power;
        radiance * (term * lit.constant_factor(self.scene))
    }

    /// What can stand between shape `x` and the point that the beam of `column` lights.
    fn blockers(&self, column: usize, lit: &Vertex, x: ShapeId) -> &Blockers {
        match &self.footprints[column] {
            Some(footprint) if footprint.holds(lit) => &self.blockers[column][x as usize],
            _ => &Blockers::Any,
        }
    }

    /// Adds to `sums` the light that goes from the lit spots to each vertex x_k, all spots of a
    /// vertex at once: weight(k) · c_l·G·V·d_l · factor(k, position of l). Vertices of weight 0 are
    /// left out. `density(k)` is that of x_k beside the light paths of a block.
    pub(super) fn add_light(
        &self,
        x: &Batch,
        weight: impl Fn(usize) -> f64,
        factor: impl Fn(usize, DVec3) -> f64,
        density: impl Fn(usize) -> f64,
        lit: &LitPoints<'_>,
        sums: &mut [f64],
    ) {
        let paths = &self.light_paths;
        let mut row = vec![0.0; sums.len()];
        let known = self.fixed.as_ref();
        let mut batch = match known.filter(|all| all.len() == sums.len()) {
            Some(batch) => Cow::Borrowed(batch),
            None => Cow::Owned(batch(self.scene, lit.at(0), sums.len())),
        };
        for (k, weight) in (0..x.len()).map(|k| (k, weight(k))) {
            if weight == 0.0 {
                continue;
            }
            let points = lit.at(k);
            if !lit.is_fixed() {
                batch = Cow::Owned(self::batch(self.scene, points, sums.len()));
            }
            batch.geometry_terms_from(x.oriented(k), weight, &batch.weight, &mut row);
            let first = lit.columns.start;
            let y = (x.oriented(k), density(k), f64::from(paths.count));
            paths.weigh(y, points, first, &mut row);
            self.connect_row(x.place(k), points, first, &mut row, |p| factor(k, p));
            sums.iter_mut().zip(&row).for_each(|(s, r)| *s += r);
        }
    }
}

/// Lit points as a batch of `width`, weighted by the factor c of their BRDF.
pub(super) fn batch(scene: &Scene, points: &[Option<Vertex>], width: usize) -> Batch {
    let mut batch = Batch::zeros(width);
    for (i, point) in points.iter().enumerate() {
        if let Some(p) = point {
            batch.set(i, p.oriented(), p.constant_factor(scene), p.shape);
        }
    }
    batch
}
