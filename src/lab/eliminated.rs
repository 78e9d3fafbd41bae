//! Terms of unknown size that are taken out of light before a model is tested with it.
//!
//! > Φ\[p,l\] = s M\[p,l\] + Σ_k f_kl F\[p,k\] + noise
//!
//! M is the model, W; s how many of the photographs' unit are 1 W, where that is not known; F are
//! patterns of light from elsewhere, each with a strength of its own in each frame. s and f
//! minimise Σ w (Φ − s M − Σ f F)². They take ν directions of the N entries, and N − ν are left. A
//! deviation of the scene that changes the model by θ d is fitted together with them by the part
//! of d that they leave (Frisch and Waugh 1933, Lovell 1963).

use nalgebra::DVector;

use super::unexplained::Whitening;
use crate::matrix::Matrix;
use crate::num::linalg::LinalgError;

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
    /// √w M less what the patterns take of it, over its norm, where s is free.
    model: Option<Matrix>,
}

impl Eliminated {
    /// By √w of each entry, 0 where it does not count, `patterns` (pixels × patterns, any unit) and
    /// the model, W. None if the patterns could be all of the model's light.
    pub(super) fn new(
        roots: Matrix,
        patterns: Option<&Matrix>,
        model: &Matrix,
        is_scale_free: bool,
    ) -> Result<Option<Self>, LinalgError> {
        let frames = roots.column_iter().map(|own| {
            let roots = DVector::from_iterator(own.len(), own.iter().copied());
            Whitening::new(roots, patterns)
        });
        let mut found = Self {
            frames: frames.collect::<Result<_, _>>()?,
            roots,
            model: None,
        };
        let own = found.beside_patterns(model);
        if !found.is_left(&own, model) {
            return Ok(None);
        }
        found.model = is_scale_free.then(|| own.normalize());
        Ok(Some(found))
    }

    /// ν.
    pub(super) fn freedom(&self) -> usize {
        let patterns = self.frames.iter().map(|f| f.directions().ncols());
        patterns.sum::<usize>() + usize::from(self.is_scale_free())
    }

    /// Whether s is one of them.
    pub(super) fn is_scale_free(&self) -> bool {
        self.model.is_some()
    }

    /// Whether an entry has a weight.
    pub(super) fn counts(&self, at: usize) -> bool {
        self.roots[at] > 0.0
    }

    /// What the patterns leave of m, 0 where an entry has no weight.
    pub(super) fn without_patterns(&self, m: &Matrix) -> Matrix {
        self.unweighted(&self.beside_patterns(m))
    }

    /// What all terms leave of m, likewise.
    pub(super) fn without(&self, m: &Matrix) -> Matrix {
        self.unweighted(&self.weighted(m))
    }

    /// What they leave of a derivative, none if that is nothing.
    pub(super) fn left_of(&self, d: &Matrix) -> Option<Matrix> {
        let left = self.weighted(d);
        self.is_left(&left, d).then(|| self.unweighted(&left))
    }

    /// √w m less what the patterns take of it.
    fn beside_patterns(&self, m: &Matrix) -> Matrix {
        let mut left = Matrix::zeros(m.nrows(), m.ncols());
        for (l, frame) in self.frames.iter().enumerate() {
            let own = m.columns(l, 1).into_owned();
            // Of a deviation of one spot all other frames are 0.
            if own.amax() > 0.0 {
                left.set_column(l, &frame.apply(&own).column(0));
            }
        }
        left
    }

    /// √w m less what all terms take of it.
    fn weighted(&self, m: &Matrix) -> Matrix {
        let mut left = self.beside_patterns(m);
        if let Some(model) = &self.model {
            let along = model.dot(&left);
            left -= model * along;
        }
        left
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
        left.norm_squared() > TAKEN * self.roots.component_mul(m).norm_squared()
    }
}
