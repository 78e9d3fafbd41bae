//! What a model integrates over, and what it takes at a centre.

/// Whether a quantity is taken at its centre or integrated over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Take {
    /// One point in the middle, as the matrix model has it.
    Centre,
    /// Quadrature over all of it.
    Integral,
}

/// What the three-bounce integral is integrated over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Elements of the hidden surfaces, with their mean albedo; or the surfaces with the albedo as
    /// it varies.
    pub elements: Take,
    /// Pixels' footprints.
    pub footprints: Take,
    /// Spots' profiles.
    pub spots: Take,
    /// Whether what stands in the way is left out.
    pub occlusion: Occlusion,
}

/// Whether a model knows what stands in the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occlusion {
    /// It does not, as published.
    Ignored,
    /// It takes the part of each entry that stays visible.
    Considered,
}

impl Extent {
    /// Everything integrated, past what stands in the way.
    pub const FULL: Self = Self {
        elements: Take::Integral,
        footprints: Take::Integral,
        spots: Take::Integral,
        occlusion: Occlusion::Considered,
    };

    /// The same with nothing in the way.
    pub const UNOBSTRUCTED: Self = Self {
        occlusion: Occlusion::Ignored,
        ..Self::FULL
    };
}
