//! The light: a laser and its spots, or a surface that shines.

use super::axes::upright;
use super::device;
use super::error::{Fault, keys};
use super::file::{LaserTable, ProfileShape};
use super::spots;
use super::surface::{Surface, facing_at_xy, is_off_the_wall};
use super::{FARTHEST, FINEST};
use crate::geometry::{DAffine3, DVec3, Interaction, ShapeId};

/// Powers in W beyond which fluxes would leave the range of f64.
const LEAST_POWER: f64 = 1e-60;
const MOST_POWER: f64 = 1e60;

/// How the power is spread over a spot, in the wall's plane around the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Profile {
    /// A point.
    Ideal,
    /// Uniform irradiance within `radius`.
    Disc {
        /// Half the spot's diameter.
        radius: f64,
    },
    /// Irradiance ∝ exp(−2r²/w²).
    Gaussian {
        /// w: where the irradiance has fallen to 1/e².
        radius: f64,
    },
    /// No laser: each spot stands for a part of a hidden surface that shines, one of so many along
    /// u and v.
    Shining {
        /// Parts along u and v; \[1, 1\] is the whole surface.
        columns: [usize; 2],
    },
}

impl Profile {
    /// The same so many times as wide; none where nothing would be left of it.
    pub(super) fn grown(self, factor: f64) -> Option<Self> {
        let grown = |radius: f64| factor * radius;
        (factor > 0.0).then(|| match self {
            Self::Disc { radius } => Self::Disc {
                radius: grown(radius),
            },
            Self::Gaussian { radius } => Self::Gaussian {
                radius: grown(radius),
            },
            Self::Ideal | Self::Shining { .. } => self,
        })
    }
}

/// One laser spot; where a surface shines, what of it shines in one column of Φcam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The point of the wall that the beam is aimed at; the middle of what shines.
    pub target: Interaction,
    /// The relay surface it lies on, or the surface that shines.
    pub surface: ShapeId,
}

/// The light: a laser, one beam at a time, from `position` to each spot in turn; or a surface that
/// shines ([`Profile::Shining`]), which is a laser whose light has landed there: its power is what
/// a Lambertian white picture emits, and its `position` the surface's middle.
#[derive(Clone, Debug, PartialEq)]
pub struct Laser {
    /// Power that lands at a spot, W; of what shines in a column M times its area.
    pub power: f64,
    /// Wavelength, m.
    pub wavelength: f64,
    /// Where the beams start.
    pub position: DVec3,
    /// Spread of each spot.
    pub profile: Profile,
    /// Spots, in the order of the layout.
    pub spots: Vec<Spot>,
}

impl Laser {
    pub(super) fn from_table(
        table: &LaserTable,
        axes: &DAffine3,
        surfaces: &[Surface],
    ) -> Result<Self, Fault> {
        let within = |f: Fault| f.within(keys!["laser"]);
        let refuse = |key, cause, cure| Err(within(Fault::new(keys![key], cause, cure)));
        if !(LEAST_POWER..=MOST_POWER).contains(&table.power) {
            return refuse(
                "power",
                format!("laser power {} W", table.power),
                "give a positive power in W, from 1e-60 to 1e60",
            );
        }
        if !(table.wavelength > 0.0 && table.wavelength.is_finite()) {
            let cause = format!("wavelength {} m", table.wavelength);
            return refuse("wavelength", cause, "give it in metres, e.g. 632.8e-9");
        }
        let d = table.spot_diameter;
        if !(d == 0.0 || (FINEST..=FARTHEST).contains(&d)) {
            return refuse(
                "spot_diameter",
                format!("spot diameter {d}"),
                "use 0 for an ideal spot, or a length from 1e-15 to 1e15",
            );
        }
        let position = device::position("laser", table.position, axes)?;
        let profile = match table.profile {
            _ if d == 0.0 => Profile::Ideal,
            ProfileShape::Disc => Profile::Disc { radius: 0.5 * d },
            ProfileShape::Gaussian => Profile::Gaussian { radius: 0.5 * d },
        };
        let places = spots::places(&table.spots).map_err(|f| f.within(keys!["laser", "spots"]))?;
        let spots = place(&places, position, surfaces)?;
        Ok(Self {
            power: table.power,
            wavelength: table.wavelength,
            position,
            profile,
            spots,
        })
    }
}

/// Puts every (x, y) on the relay surface above or below it that shows its front to the laser: of
/// several the nearest.
pub(super) fn place(
    places: &[[f64; 2]],
    laser: DVec3,
    surfaces: &[Surface],
) -> Result<Vec<Spot>, Fault> {
    let mut spots = Vec::with_capacity(places.len());
    for (i, &[x, y]) in places.iter().enumerate() {
        let (cause, cure) = match facing_at_xy(surfaces, [x, y], laser) {
            Some((surface, target)) => {
                spots.push(Spot { target, surface });
                continue;
            }
            None if is_off_the_wall(surfaces, [x, y]) => upright(surfaces).unwrap_or_else(|| {
                (
                    format!("spot {i} at ({x}, {y}) falls off every relay surface"),
                    "move or shrink the layout, or extend the wall".to_owned(),
                )
            }),
            None => (
                format!(
                    "the laser stands behind (or in the plane of) the surface that spot {i} at ({x}, {y}) lies on"
                ),
                "move laser.position to the front of the wall (the side of u × v)".to_owned(),
            ),
        };
        return Err(Fault::new(keys!["laser", "spots"], cause, cure));
    }
    Ok(spots)
}
