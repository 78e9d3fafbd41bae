//! What is suspicious in a scene, though not wrong.

use std::fmt;

use super::mesh::Defects;
use crate::num::digits::significant;

/// Something suspicious in a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// No surface is hidden: there is nothing to model or recover.
    NothingHidden,
    /// `max_bounces` that ends before light is back from the hidden surface.
    TooFewBounces(u32),
    /// Spots that lie in the camera's view, so that the camera sees them directly.
    SpotsInView(Vec<usize>),
    /// Spots that the beam does not reach, and the surface that stops it.
    BeamBlocked(Vec<usize>, String),
    /// Pixels whose line of sight to the wall is blocked, how many, and the surface that does it.
    PixelsBlocked(usize, String),
    /// Spots from which no element of the hidden surface can be lit: they lie behind it.
    SpotsBehind(Vec<usize>, String),
    /// Part of the view lies behind the hidden surface and sees nothing of it.
    ViewBehind(String),
    /// Edges that are not perpendicular: (surface, angle in degrees).
    Skewed(String, f64),
    /// Elements that straddle the edges of a texture's cells.
    ElementsAcrossCells(String),
    /// Spots whose line to the hidden surface is blocked for every element.
    SpotsShadowed(Vec<usize>),
    /// Defects of a surface's mesh.
    Mesh(String, Defects),
    /// Colours that come with a surface's mesh and are not used: (surface, what they are).
    MeshPaint(String, String),
    /// Entries of a surface's measured table that were not measured: (surface, their share).
    NotMeasured(String, f64),
    /// Spots at the place of an earlier one.
    SpotsTogether(Vec<usize>),
    /// Part of a hidden surface lies behind a wall: (surface, wall).
    BehindWall(String, String),
    /// Spots of which a part falls beside the wall and is lost.
    SpotsOverhang(Vec<usize>),
    /// A wavelength, m, far from those of lasers.
    Wavelength(f64),
    /// A power, W, far from those of lasers.
    Power(f64),
    /// Entries of Φcam that are fewer than the elements.
    FewPhotographs {
        /// Pixels × spots.
        entries: usize,
        /// Of all hidden surfaces.
        elements: usize,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NothingHidden => write!(
                f,
                "no surface is hidden: frames can be rendered, but there is nothing to model or recover"
            ),
            Self::TooFewBounces(most) => write!(
                f,
                "max_bounces is {most}: light by way of a hidden surface meets 3 surfaces, so frames hold none of it"
            ),
            Self::Wavelength(metres) => write!(
                f,
                "a wavelength of {metres:e} m: lasers have 1.6e-7 to 1.1e-5 m (`wavelength` is in metres whatever the unit)"
            ),
            Self::Power(watts) => write!(
                f,
                "a laser of {watts:e} W: those of a bench have 1e-6 to 1 W (`power` is in watts: 5 mW are 5e-3)"
            ),
            Self::FewPhotographs { entries, elements } => write!(
                f,
                "{entries} photographed values (pixels × spots) for {elements} elements: fewer than what is to be recovered"
            ),
            Self::Mesh(surface, defects) => write!(f, "the mesh of `{surface}`: {defects}"),
            Self::MeshPaint(surface, what) => write!(
                f,
                "the mesh of `{surface}` comes with {what}, which are not used: its albedo is what `material` says, such as `{{ lambertian = 0.5 }}` or, by its texture coordinates, `{{ lambertian = {{ image = \"picture.png\", transfer = \"srgb\" }} }}`"
            ),
            Self::NotMeasured(surface, share) => write!(
                f,
                "the measured table of `{surface}` lacks {} % of the directions above it (entries below 0): each \
                 reflects as the next smaller half angle that was measured, or not at all where none was; use a \
                 table that has them",
                significant(100.0 * share, 3)
            ),
            Self::SpotsInView(spots) => {
                let spots = Spots(spots);
                write!(
                    f,
                    "{spots} in the camera's view: the camera sees the direct light"
                )
            }
            Self::BeamBlocked(spots, by) => {
                let spots = Spots(spots);
                write!(
                    f,
                    "the beam to {spots} is stopped by `{by}`: the light lands there instead"
                )
            }
            Self::PixelsBlocked(count, by) => write!(
                f,
                "the line of sight of {count} pixels is blocked by `{by}`: they see it instead of the wall"
            ),
            Self::SpotsBehind(spots, hidden) => {
                let spots = Spots(spots);
                write!(
                    f,
                    "{spots} behind `{hidden}`, on the side of its back, and cannot light it"
                )
            }
            Self::ViewBehind(hidden) => write!(
                f,
                "part of the view lies behind `{hidden}`, on the side of its back, and receives nothing from it"
            ),
            Self::Skewed(name, angle) => write!(
                f,
                "the edges of `{name}` meet at {angle:.3}°: it is taken as the parallelogram it is"
            ),
            Self::ElementsAcrossCells(name) => write!(
                f,
                "elements of `{name}` straddle the edges of its texture: by centres the model takes their mean albedo, by quadrature that of each part; a picture has one for each element"
            ),
            Self::SpotsOverhang(spots) => {
                let spots = Spots(spots);
                write!(
                    f,
                    "{spots} hanging over the wall's edge: what falls beside it is lost"
                )
            }
            Self::SpotsTogether(spots) => {
                let spots = Spots(spots);
                write!(
                    f,
                    "{spots} at the place of an earlier one, to a millionth of the view: what its photograph shows is only shown again"
                )
            }
            Self::BehindWall(hidden, wall) => write!(
                f,
                "part of `{hidden}` lies behind `{wall}`, which stops all light to it (check corners and signs)"
            ),
            Self::SpotsShadowed(spots) => {
                let spots = Spots(spots);
                write!(
                    f,
                    "{spots} lit, but every line from there to the hidden elements is blocked"
                )
            }
        }
    }
}

/// "spot 3 lies", "spots 3, 7–9 lie": compactly, at most a dozen ranges.
struct Spots<'a>(&'a [usize]);

impl fmt::Display for Spots<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut ranges: Vec<(usize, usize)> = Vec::new();
        for &s in self.0 {
            match ranges.last_mut() {
                Some((_, end)) if *end + 1 == s => *end = s,
                _ => ranges.push((s, s)),
            }
        }
        let more = ranges.len() > 12;
        let text: Vec<String> = ranges
            .iter()
            .take(12)
            .map(|(a, b)| {
                if a == b {
                    a.to_string()
                } else {
                    format!("{a}–{b}")
                }
            })
            .collect();
        let noun = if self.0.len() == 1 { "spot" } else { "spots" };
        write!(
            f,
            "{noun} {}{}",
            text.join(", "),
            if more { ", …" } else { "" }
        )
    }
}
