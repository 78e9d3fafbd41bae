//! What a gallery holds, and how much work that is.

use crate::recovery::{Method, Parameter};

/// What a gallery shall hold.
#[derive(Clone, Debug, PartialEq)]
pub struct GalleryPlan {
    /// The methods.
    pub methods: Vec<Method>,
    /// ε: standard deviations of the noise added, as fractions of the mean of |Φ|; the first is 0,
    /// and they grow.
    pub noises: Vec<f64>,
    /// Steps of a regularisation, beside those that the methods take of themselves.
    pub steps: usize,
    /// Seed of the noise.
    pub seed: u64,
    /// Multiplications that the methods by directions may take, and those that work on everything
    /// at once.
    pub work: f64,
    /// Reflectances that may be kept.
    pub values: usize,
}

impl GalleryPlan {
    /// That of a run: the usual methods, the photographs as traced and with noise of 1e-6 to 1e-1,
    /// as much as is little beside the run.
    pub fn of_run(seed: u64) -> Self {
        Self {
            methods: Method::USUAL.to_vec(),
            noises: vec![0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1],
            steps: 15,
            seed,
            work: 2e10,
            values: 400_000,
        }
    }

    /// As much of the plan as its limits allow for so many pixels, spots and elements: a count, so
    /// that no machine's speed decides. Where the plan is too much every second noise is left out,
    /// the loudest kept, until it is not; then steps.
    pub(super) fn fitted(&self, [pixels, spots, elements]: [usize; 3]) -> Fitted {
        let size = Size {
            pixels: pixels as f64,
            spots: spots as f64,
            elements: elements as f64,
        };
        let by_directions = self.methods.iter().any(|m| works_by_directions(*m));
        let mut noises = self.noises.clone();
        let mut left_out = Vec::new();
        let fits = |noises: &[f64]| {
            let work = size.directions() * noises.len() as f64;
            (!by_directions || work <= self.work) && self.steps(noises.len(), elements) >= FEWEST
        };
        while !fits(&noises) && noises.len() > 1 {
            noises = thinned(&noises);
        }
        if !fits(&noises) || pixels as f64 * spots as f64 > MOST_ENTRIES {
            return Fitted::nothing(size);
        }
        if noises.len() < self.noises.len() {
            left_out.push(format!(
                "{} of {} noise levels are shown: more would take too long beside the run, for \
                 {size}.",
                noises.len(),
                self.noises.len()
            ));
        }
        let steps = self.steps(noises.len(), elements);
        if by_directions && steps < self.steps {
            left_out.push(format!(
                "A regularisation has {steps} steps beside the automatic ones, not {}: more pictures of {size} would be too much for this page.",
                self.steps
            ));
        }
        let louder = (noises.len() - 1) as f64;
        let dear = |m: &&Method| !works_by_directions(**m) && size.whole(**m) * louder > self.work;
        let traced_alone: Vec<Method> = self.methods.iter().filter(dear).copied().collect();
        for method in &traced_alone {
            left_out.push(format!(
                "{method} is shown for the photographs as traced alone: with added noise it would \
                 take too long beside the run, for {size}."
            ));
        }
        Fitted {
            noises,
            steps,
            by_directions,
            traced_alone,
            left_out,
        }
    }

    /// Steps of each of the two regularisations that the limit on values leaves beside the methods
    /// without one and the automatic choices; no more than asked for.
    fn steps(&self, noises: usize, elements: usize) -> usize {
        let pictures = self.values / (noises * elements).max(1);
        let regularised = self.methods.iter().filter(|m| ladder_of(**m)).count();
        let alone = self.methods.len() - regularised;
        let left = pictures.saturating_sub(alone + regularised * noises);
        (left / regularised.max(1)).min(self.steps)
    }
}

/// More entries of Φcam than this are not copied for noise to be added: each copy takes eight bytes
/// an entry, and each thread has three.
const MOST_ENTRIES: f64 = 4e7;

/// Fewer steps than these are no slider.
const FEWEST: usize = 4;

/// What of a plan is done.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fitted {
    pub(super) noises: Vec<f64>,
    pub(super) steps: usize,
    /// Whether the methods by directions are there.
    pub(super) by_directions: bool,
    /// The methods that are not recovered from noisy photographs.
    pub(super) traced_alone: Vec<Method>,
    pub(super) left_out: Vec<String>,
}

impl Fitted {
    fn nothing(size: Size) -> Self {
        Self {
            noises: Vec::new(),
            steps: 0,
            by_directions: false,
            traced_alone: Vec::new(),
            left_out: vec![format!(
                "There is no gallery over regularisation and noise: it would take too long beside \
                 the run, for {size}."
            )],
        }
    }
}

/// The numbers of a problem.
#[derive(Clone, Copy, Debug)]
struct Size {
    pixels: f64,
    spots: f64,
    elements: f64,
}

impl Size {
    /// Multiplications of a noise by k directions: the photographs along them for the parts and for
    /// the choice of two parameters, and the sums over pixels.
    fn directions(self) -> f64 {
        let k = self.spots.min(self.elements);
        self.pixels * k * (5.0 * self.spots + self.elements)
    }

    /// Multiplications of a noise by the joint operator, an upper bound: both sides compressed, its
    /// rows decomposed, and the covariance where there is one, or else thirty steps of a solver.
    fn whole(self, method: Method) -> f64 {
        let [c, d] = [self.pixels, self.spots].map(|n| n.min(self.elements));
        let square = self.elements * self.elements;
        let rest = match method {
            Method::JointUnbounded => self.spots * self.pixels * c * c,
            _ => 30.0 * square * self.elements,
        };
        (self.pixels + self.spots + c * d) * square + self.pixels * self.spots * (c + d) + rest
    }
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Size {
            pixels,
            spots,
            elements,
        } = self;
        write!(f, "{pixels} pixels, {spots} spots and {elements} elements")
    }
}

/// The first, and of the others every second, the last among them.
fn thinned(noises: &[f64]) -> Vec<f64> {
    let last = noises.len() - 1;
    let kept = |i: usize| i == 0 || (last - i).is_multiple_of(2) && noises.len() > 2;
    let all = noises.iter().enumerate();
    all.filter(|(i, _)| kept(*i)).map(|(_, x)| *x).collect()
}

/// Whether a method works by the singular directions of the laser side, with which all its
/// recoveries are had for little.
pub(super) fn works_by_directions(method: Method) -> bool {
    matches!(method, Method::Pinv | Method::Tsvd | Method::Tikhonov)
}

/// Whether it has a regularisation to choose.
fn ladder_of(method: Method) -> bool {
    matches!(method, Method::Tsvd | Method::Tikhonov)
}

/// The steps of a method's regularisation for a laser side with singular values `sigma`, from
/// strong to weak, with those `chosen` among them.
pub(super) fn ladder(
    method: Method,
    sigma: &[f64],
    count: usize,
    chosen: &[Parameter],
) -> Vec<Parameter> {
    let (Some(first), Some(last)) = (sigma.first(), sigma.last()) else {
        return vec![Parameter::None];
    };
    let share = |i: usize| i as f64 / (count.max(2) - 1) as f64;
    let mut steps: Vec<Parameter> = match method {
        // 1 to k, evenly in the logarithm.
        Method::Tsvd => (0..count)
            .map(|i| Parameter::Rank(libm::pow(sigma.len() as f64, share(i)).round() as usize))
            .collect(),
        // Powers of ten from 1 to below the last singular value, where nothing more is damped:
        // every one where there are steps enough.
        Method::Tikhonov => {
            let decades = -libm::log10(last / first).floor();
            (0..count)
                .map(|i| Parameter::Damping(10f64.powi(-((share(i) * decades).round() as i32))))
                .collect()
        }
        _ => {
            return chosen
                .first()
                .map_or_else(|| vec![Parameter::None], |c| vec![*c]);
        }
    };
    steps.extend(chosen);
    let strength = |p: &Parameter| match *p {
        Parameter::Rank(kept) => kept as f64,
        Parameter::Damping(damping) => -damping,
        _ => 0.0,
    };
    steps.sort_by(|a, b| strength(a).total_cmp(&strength(b)));
    steps.dedup();
    steps
}
