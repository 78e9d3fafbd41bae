//! Pictures to leaf through.

use crate::lab::recovered::measures::Measures;
use crate::recovery::{Method, Parameter};

/// Pictures of a run's hidden surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct RunGallery {
    /// The hidden surfaces, in file order.
    pub surfaces: Vec<GallerySurface>,
    /// ε: standard deviation of the noise added to each entry, as a fraction of `mean`. The first
    /// is 0.
    pub noises: Vec<f64>,
    /// Mean of |Φ|, W.
    pub mean: f64,
    /// One for each method, in the order of the plan.
    pub series: Vec<Series>,
    /// What would have been too much work beside the run, in sentences.
    pub left_out: Vec<String>,
}

/// A hidden surface of a gallery.
#[derive(Clone, Debug, PartialEq)]
pub struct GallerySurface {
    /// Its name.
    pub name: String,
    /// Elements along u and v.
    pub elements: [usize; 2],
    /// Whether its elements stand side by side, and so make a picture: not those that are the
    /// triangles of a mesh.
    pub cells: bool,
    /// True albedo of element iu + iv·nu.
    pub truth: Vec<f64>,
}

/// One method over its regularisation and the noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// The method.
    pub method: Method,
    /// Its parameter, from the strongest regularisation to the weakest; [`Parameter::None`] alone
    /// for a method that has none to choose.
    pub steps: Vec<Parameter>,
    /// For each noise which step the method takes of itself, or why none.
    pub automatic: Vec<Result<Automatic, String>>,
    /// For each noise one for each step; none where nothing was recovered.
    pub pictures: Vec<Vec<Option<GalleryPicture>>>,
}

/// What a method takes of itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Automatic {
    /// Index of the step.
    pub step: usize,
    /// The parameter and why, in words.
    pub words: String,
}

/// What was recovered.
#[derive(Clone, Debug, PartialEq)]
pub struct GalleryPicture {
    /// Reflectance of the elements of all surfaces, one surface after the other.
    pub reflectance: Vec<f64>,
    /// How far it is from the truth, surface by surface.
    pub measures: Vec<Measures>,
}
