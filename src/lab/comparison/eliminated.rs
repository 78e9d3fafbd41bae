//! Terms of unknown size that are taken out of light before a model is tested with it.
//!
//! > Φ\[p,l\] = (1 + ε + ε_l) s M\[p,l\] + Σ_k f_kl F\[p,k\] + a_p + noise
//!
//! M is the model, W; s how many of the photographs' unit are 1 W, where that is not known; F are
//! patterns of light from elsewhere, each with a strength of its own in each frame; a is an image
//! that is the same in all frames. s, f and a minimise Σ w (Φ − s M − Σ f F − a)². They take ν
//! directions of the N entries, and N − ν are left. The factors 1 + ε are known to a standard
//! deviation: they take no direction, but count as noise ([`Factors`]). A deviation of the scene
//! that changes the model by θ d is fitted together with all these by the part of d that they leave
//! (Frisch and Waugh 1933, Lovell 1963).

mod background;
mod factors;

use nalgebra::DVector;

use crate::lab::uncertainty::unexplained::Whitening;
use crate::matrix::Matrix;
use crate::num::linalg::LinalgError;
use crate::recovery::{Gains, Nuisance};
use background::Background;
use factors::Factors;

/// A derivative of which the terms leave less than this part, of its square, is one of theirs:
/// derivatives are off by as much.
const TAKEN: f64 = 1e-9;

/// The terms, ready to be taken out of what has the photographs' shape.
#[derive(Debug)]
pub struct Eliminated {
    /// √w.
    roots: Matrix,
    /// The patterns of each frame.
    frames: Vec<Whitening>,
    /// The image that is in all frames.
    background: Option<Background>,
    /// √w M less what patterns and image take of it, over its norm, where s is free.
    model: Option<Matrix>,
    factors: Option<Factors>,
    /// Directions of patterns and image.
    other: usize,
}

impl Eliminated {
    /// By √w of each entry, 0 where it does not count, what is `beside` the model, and the model,
    /// W; without factors ([`Self::with_factors`]). None if the terms could be all of the model's
    /// light.
    pub(super) fn new(
        roots: Matrix,
        beside: &Nuisance<'_>,
        model: &Matrix,
    ) -> Result<Option<Self>, LinalgError> {
        let patterns = beside.of_frames(roots.nrows());
        let frames = roots.column_iter().enumerate().map(|(l, own)| {
            let own = DVector::from_iterator(own.len(), own.iter().copied());
            Whitening::new(own, Some(&beside.of_frame(&patterns, l)))
        });
        let frames: Vec<Whitening> = frames.collect::<Result<_, _>>()?;
        let of_frames = frames.iter().map(|f| f.directions().ncols()).sum::<usize>();
        let background = beside.background.then(|| Background::new(&roots));
        // Patterns that are the same in all frames are an image too.
        let of_image = match &background {
            Some(image) => {
                let seen = Whitening::new(image.seen(), Some(&patterns))?;
                image.pixels() - seen.directions().ncols()
            }
            None => 0,
        };
        let mut found = Self {
            roots,
            frames,
            background,
            model: None,
            factors: None,
            other: of_frames + of_image,
        };
        let own = found.beside_others(&found.weighted(model));
        if !found.is_left(&own, model) {
            return Ok(None);
        }
        found.model = beside.free_scale.then(|| own.normalize());
        Ok(Some(found))
    }

    /// The same with the factors that are known roughly, `s` being the scale of the `model`, W.
    pub(super) fn with_factors(
        mut self,
        beside: &Nuisance<'_>,
        model: &Matrix,
        s: f64,
    ) -> Result<Self, LinalgError> {
        let known_to = [beside.frame_gain, beside.scale_error];
        if known_to.iter().any(Option::is_some) {
            let light = self.weighted(model) * s;
            self.factors = Some(Factors::new(light, known_to, &|m| self.exactly(m))?);
        }
        Ok(self)
    }

    /// ν.
    pub(super) fn freedom(&self) -> usize {
        self.other + usize::from(self.is_scale_free())
    }

    /// Whether s is one of them.
    pub(super) fn is_scale_free(&self) -> bool {
        self.model.is_some()
    }

    /// Whether an entry has a weight.
    pub(super) fn counts(&self, at: usize) -> bool {
        self.roots[at] > 0.0
    }

    /// What patterns and image leave of m, 0 where an entry has no weight.
    pub(super) fn without_others(&self, m: &Matrix) -> Matrix {
        self.unweighted(&self.beside_others(&self.weighted(m)))
    }

    /// What these and a free scale leave of it, likewise; what all terms leave, in units in which
    /// the factors are noise like the other; and the factors that it speaks for.
    pub(super) fn split(&self, m: &Matrix) -> (Matrix, Matrix, Option<Gains>) {
        let free = self.exactly(&self.weighted(m));
        let gains = self.factors.as_ref().map(|factors| factors.found(&free));
        let unweighted = self.unweighted(&free);
        (unweighted, self.unweighted(&self.softened(free)), gains)
    }

    /// What they leave of a derivative, none if that is nothing.
    pub(super) fn left_of(&self, d: &Matrix) -> Option<Matrix> {
        let left = self.left(&self.weighted(d));
        self.is_left(&left, d).then(|| self.unweighted(&left))
    }

    /// The variance of dᵀ r for weighted d and what all terms leave of r, as far as the factors
    /// make it.
    pub(super) fn variance_of_factors(&self, weighted: &Matrix) -> f64 {
        let of = |factors: &Factors| factors.variance(&self.left(weighted));
        self.factors.as_ref().map_or(0.0, of)
    }

    /// √w m.
    fn weighted(&self, m: &Matrix) -> Matrix {
        m.component_mul(&self.roots)
    }

    /// What the patterns leave of √w m.
    fn beside_patterns(&self, weighted: &Matrix) -> Matrix {
        let mut left = Matrix::zeros(weighted.nrows(), weighted.ncols());
        for (l, frame) in self.frames.iter().enumerate() {
            let own = weighted.columns(l, 1).into_owned();
            // Of a deviation of one spot all other frames are 0.
            if own.amax() > 0.0 {
                left.set_column(l, &frame.beside(own).column(0));
            }
        }
        left
    }

    /// What patterns and image leave of it.
    fn beside_others(&self, weighted: &Matrix) -> Matrix {
        let left = self.beside_patterns(weighted);
        match &self.background {
            None => left,
            Some(image) => image.beside(left, &|m| self.beside_patterns(m)),
        }
    }

    /// What these and a free scale leave of it.
    fn exactly(&self, weighted: &Matrix) -> Matrix {
        let mut left = self.beside_others(weighted);
        if let Some(model) = &self.model {
            let along = model.dot(&left);
            left -= model * along;
        }
        left
    }

    /// What all terms leave of it.
    fn left(&self, weighted: &Matrix) -> Matrix {
        self.softened(self.exactly(weighted))
    }

    /// What the free terms leave, with the factors as noise like the other.
    fn softened(&self, left: Matrix) -> Matrix {
        match &self.factors {
            None => left,
            Some(factors) => factors.as_noise(left, &|m| self.exactly(m)),
        }
    }

    /// The m of √w m.
    fn unweighted(&self, weighted: &Matrix) -> Matrix {
        weighted.zip_map(
            &self.roots,
            |x, root| if root > 0.0 { x / root } else { 0.0 },
        )
    }

    /// Whether `left`, of √w m, is more than what rounding leaves.
    fn is_left(&self, left: &Matrix, m: &Matrix) -> bool {
        left.norm_squared() > TAKEN * self.weighted(m).norm_squared()
    }
}
