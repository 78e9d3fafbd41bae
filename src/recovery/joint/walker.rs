//! A pattern and its levels on a walk through exp(−β ½ χ²).

use nalgebra::{DMatrix, DVector};

use super::ground::Ground;
use super::levels::{LevelFit, possible};
use crate::num::linalg::gram_product;
use crate::num::stream::Stream;

/// Elements whose light is most alike an element's: those with which it changes places.
const ALIKE: usize = 8;

/// What all walks share: χ² = ‖R x − d‖², and with G = RᵀR what a change of one element makes of it,
///
/// > Δχ² = −2 t g_j + t² G_jj,   g = Rᵀ(d − R x),   t the change of x_j.
pub(super) struct Land<'a> {
    pub(super) ground: &'a Ground<'a>,
    gram: DMatrix<f64>,
    /// G 1, and 1ᵀG 1.
    sums: DVector<f64>,
    one: f64,
    alike: Vec<Vec<usize>>,
}

impl<'a> Land<'a> {
    pub(super) fn new(ground: &'a Ground<'a>) -> Self {
        let n = ground.r.ncols();
        let mut gram = DMatrix::zeros(n, n);
        gram_product(&mut gram, ground.r);
        let alike = (0..n)
            .map(|j| {
                let likeness = |i: usize| gram[(i, j)] / gram[(i, i)].max(f64::MIN_POSITIVE).sqrt();
                let mut others: Vec<usize> = (0..n).filter(|i| *i != j).collect();
                others.sort_by(|a, b| likeness(*b).total_cmp(&likeness(*a)));
                others.truncate(ALIKE);
                others
            })
            .collect();
        let sums = gram.column_sum();
        Self {
            one: sums.sum(),
            sums,
            ground,
            gram,
            alike,
        }
    }
}

/// ln of the least uniform number above 0, and less.
const LEAST: f64 = -40.0;

/// Whether a change of ln probability by `gain` is made: with probability min(1, e^gain). Most gains
/// tell without a logarithm.
pub(super) fn accepted(gain: f64, random: &mut Stream) -> bool {
    let x = random.uniform();
    if gain >= 0.0 || (gain < LEAST && x > 0.0) {
        return gain >= 0.0;
    }
    libm::log(x.max(f64::MIN_POSITIVE)) < gain
}

/// One pattern with its levels.
#[derive(Clone)]
pub(super) struct Walker {
    pub(super) light: Vec<bool>,
    pub(super) levels: [f64; 2],
    pub(super) chi2: f64,
    /// g.
    slope: DVector<f64>,
    /// G s, s the light elements.
    lit: DVector<f64>,
    /// s as numbers.
    mask: DVector<f64>,
    tally: Tally,
}

/// Sums over the elements of a walk.
#[derive(Clone, Copy, Default)]
struct Tally {
    /// Light elements.
    count: usize,
    /// 1ᵀG s and sᵀG s.
    both: f64,
    own: f64,
    /// 1ᵀg and sᵀg.
    all: f64,
    along: f64,
}

impl Walker {
    pub(super) fn new(land: &Land<'_>, light: Vec<bool>, levels: [f64; 2]) -> Self {
        let n = light.len();
        let mut new = Self {
            light,
            levels,
            chi2: 0.0,
            slope: DVector::zeros(n),
            lit: DVector::zeros(n),
            mask: DVector::zeros(n),
            tally: Tally::default(),
        };
        new.measure(land);
        new
    }

    /// A pattern and levels of chance.
    pub(super) fn of_chance(land: &Land<'_>, random: &mut Stream) -> Self {
        let ground = land.ground;
        let light = (0..ground.r.ncols()).map(|_| random.uniform() < 0.5);
        let light = light.collect();
        let levels = ground.given.unwrap_or_else(|| {
            let [a, b] = [random.uniform(), random.uniform()];
            [a.min(b), a.max(b)]
        });
        Self::new(land, light, levels)
    }

    /// The likeliest levels of its pattern, where they are possible.
    pub(super) fn settle(&mut self, land: &Land<'_>) {
        if land.ground.given.is_some() {
            return;
        }
        let fit = self.fit(land);
        if let Some(best) = fit
            .map(|fit| fit.draw(1.0, [0.0; 2]))
            .filter(|b| possible(*b))
        {
            self.move_levels(land, best);
        }
    }

    /// All from the pattern, without what rounding has gathered.
    fn measure(&mut self, land: &Land<'_>) {
        let ground = land.ground;
        let [dark, light] = self.levels;
        let lit = ground.lit(&self.light);
        let left = ground.d - &ground.all * dark - &lit * (light - dark);
        self.chi2 = left.norm_squared();
        self.slope = ground.r.tr_mul(&left);
        self.lit = ground.r.tr_mul(&lit);
        for (mask, light) in self.mask.iter_mut().zip(&self.light) {
            *mask = f64::from(u8::from(*light));
        }
        self.count(land);
    }

    fn count(&mut self, land: &Land<'_>) {
        if land.ground.given.is_none() {
            self.tally = Tally {
                count: self.mask.sum() as usize,
                both: self.mask.dot(&land.sums),
                own: self.mask.dot(&self.lit),
                all: self.slope.sum(),
                along: self.mask.dot(&self.slope),
            };
        }
    }

    /// One turn of each element, and of the levels.
    pub(super) fn sweep(&mut self, land: &Land<'_>, beta: f64, random: &mut Stream) {
        let n = self.light.len();
        self.measure(land);
        let free = land.ground.given.is_none();
        for j in 0..n {
            self.change(land, beta, &[j], random);
            let alike = &land.alike[j];
            let other = [
                (random.uniform() * n as f64) as usize,
                *alike
                    .get((random.uniform() * alike.len() as f64) as usize)
                    .unwrap_or(&j),
            ];
            for i in other {
                if self.light[i] != self.light[j] {
                    self.change(land, beta, &[i, j], random);
                }
            }
            // Which kind is tried must not depend on the pattern, or the way back would be another.
            if free && random.uniform() < 0.5 {
                self.change_with_levels(land, beta, &[j], random);
            } else if free && self.light[other[1]] != self.light[j] {
                self.change_with_levels(land, beta, &[j, other[1]], random);
            }
        }
        if free {
            (0..4).for_each(|_| self.change_levels(land, beta, random));
        }
    }

    /// By what the elements `which` change when they change sides, in units of the contrast.
    fn sign(&self, j: usize) -> f64 {
        if self.light[j] { -1.0 } else { 1.0 }
    }

    /// Σ_i,j signs G_ij of elements that change.
    fn own(&self, land: &Land<'_>, which: &[usize]) -> f64 {
        let pairs = which
            .iter()
            .flat_map(|i| which.iter().map(move |j| (*i, *j)));
        pairs
            .map(|(i, j)| self.sign(i) * self.sign(j) * land.gram[(i, j)])
            .sum()
    }

    /// χ² after elements have changed, their levels held.
    fn after(&self, land: &Land<'_>, which: &[usize]) -> f64 {
        let step = self.levels[1] - self.levels[0];
        let along: f64 = which.iter().map(|&j| self.sign(j) * self.slope[j]).sum();
        self.chi2 - 2.0 * step * along + step * step * self.own(land, which)
    }

    fn make(&mut self, land: &Land<'_>, which: &[usize], chi2: f64) {
        let step = self.levels[1] - self.levels[0];
        for &j in which {
            let sign = self.sign(j);
            self.slope.axpy(-sign * step, &land.gram.column(j), 1.0);
            self.lit.axpy(sign, &land.gram.column(j), 1.0);
            self.light[j] = !self.light[j];
            self.mask[j] += sign;
        }
        self.chi2 = chi2;
        self.count(land);
    }

    /// Takes other levels: x changes by δa on the dark elements and by δb on the light ones.
    fn move_levels(&mut self, land: &Land<'_>, levels: [f64; 2]) {
        let [a, b] = [levels[0] - self.levels[0], levels[1] - self.levels[1]];
        let Tally {
            both,
            own,
            all,
            along,
            ..
        } = self.tally;
        let [uu, uw, ww] = [land.one - 2.0 * both + own, both - own, own];
        let along = a * (all - along) + b * along;
        self.chi2 += a * a * uu + 2.0 * a * b * uw + b * b * ww - 2.0 * along;
        self.slope.axpy(-a, &land.sums, 1.0);
        self.slope.axpy(a - b, &self.lit, 1.0);
        self.levels = levels;
        self.count(land);
    }

    /// Changes elements, their levels held.
    fn change(&mut self, land: &Land<'_>, beta: f64, which: &[usize], random: &mut Stream) {
        let after = self.after(land, which);
        if accepted(-0.5 * beta * (after - self.chi2), random) {
            self.make(land, which, after);
        }
    }

    /// The levels' fit to the pattern; after elements have changed, where any are given.
    fn fit_after(&self, land: &Land<'_>, which: &[usize]) -> Option<LevelFit> {
        let step = self.levels[1] - self.levels[0];
        let Tally {
            mut count,
            mut both,
            mut own,
            mut all,
            mut along,
        } = self.tally;
        // Of those that change: of s, then of the residual.
        let pairs = self.own(land, which);
        let mut cross = pairs;
        own += pairs;
        for &j in which {
            let sign = self.sign(j);
            count = if self.light[j] { count - 1 } else { count + 1 };
            both += sign * land.sums[j];
            own += 2.0 * sign * self.lit[j];
            along += sign * self.slope[j];
            all -= step * sign * land.sums[j];
            cross += sign * self.lit[j];
        }
        along -= step * cross;
        if count == 0 || count == self.light.len() {
            return None;
        }
        let left = self.after(land, which);
        LevelFit::about(
            self.levels,
            left,
            [all - along, along],
            [land.one - 2.0 * both + own, both - own, own],
        )
    }

    fn fit(&self, land: &Land<'_>) -> Option<LevelFit> {
        self.fit_after(land, &[])
    }

    /// Changes elements, the levels drawn anew from their Gaussian for the new pattern: accepted by
    /// the ratio of the patterns' weights over the plane of all levels, if the new ones are possible.
    fn change_with_levels(
        &mut self,
        land: &Land<'_>,
        beta: f64,
        which: &[usize],
        random: &mut Stream,
    ) {
        let (Some(before), Some(after)) = (self.fit(land), self.fit_after(land, which)) else {
            return;
        };
        let gain = after.log_plane(beta) - before.log_plane(beta);
        if !accepted(gain, random) {
            return;
        }
        let levels = after.draw(beta, [random.normal(), random.normal()]);
        if possible(levels) {
            let chi2 = self.after(land, which);
            self.make(land, which, chi2);
            self.move_levels(land, levels);
        }
    }

    /// New levels: from their Gaussian, which is accepted wherever it is possible, or from anywhere.
    fn change_levels(&mut self, land: &Land<'_>, beta: f64, random: &mut Stream) {
        if let Some(fit) = self.fit(land) {
            let levels = fit.draw(beta, [random.normal(), random.normal()]);
            if possible(levels) {
                self.move_levels(land, levels);
                return;
            }
        }
        let [a, b] = [random.uniform(), random.uniform()];
        let mut other = self.clone();
        other.move_levels(land, [a.min(b), a.max(b)]);
        if possible(other.levels) && accepted(-0.5 * beta * (other.chi2 - self.chi2), random) {
            *self = other;
        }
    }
}
