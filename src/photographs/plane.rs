//! One channel of photographs as light, and the average of repeated ones.

use super::error::{PhotographError, refused};
use super::highest::Highest;
use super::response::Response;
use crate::image::{Channel, Samples};

/// Which channel of a photograph is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chosen {
    /// The only one; of a coloured photograph it has to be said which.
    Grey,
    /// One colour.
    One(Channel),
    /// The mean of the light in red, green and blue.
    Mean,
}

/// One channel of one photograph, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Columns and rows.
    pub size: [usize; 2],
    /// R⁻¹ of the stored values, counts.
    pub light: Vec<f64>,
    /// Variance of the rounding to integers, LSB²/12 as light, counts².
    pub rounding: Vec<f64>,
    /// Whether a stored value has reached saturation.
    pub saturated: Vec<bool>,
    /// 1/n where `light` is the mean of n channels: their noise is independent, so that its
    /// variance is that of one channel over n.
    pub share: f64,
    /// Stored values that are 0, in any of the channels: cut off below.
    pub zeros: usize,
    /// The largest stored integers below saturation.
    pub highest: Highest,
}

/// The chosen channel of `samples` as light. Stored values from `saturation` on are saturated.
///
/// # Errors
/// [`PhotographError::Refused`] if `name` has other channels than were chosen.
pub fn linearised(
    name: &str,
    samples: &Samples,
    chosen: Chosen,
    response: &Response,
    saturation: f64,
) -> Result<Plane, PhotographError> {
    let colours = [Channel::Red, Channel::Green, Channel::Blue];
    let grey = samples.is_grey();
    let wanted = match chosen {
        Chosen::One(channel) if samples.channels.len() == 1 => {
            return Err(refused(
                format!("{name} is grey, and has no channel {channel:?}"),
                "leave `channel` out, or give photographs in colour alone",
            ));
        }
        Chosen::One(channel) => vec![channel],
        _ if grey => vec![samples.channels[0]],
        Chosen::Grey => {
            return Err(refused(
                format!("{name} is in colour, and nothing says which channel is the laser's light"),
                "choose `channel`: red, green, blue, mean, or all for one folder each",
            ));
        }
        Chosen::Mean => colours.to_vec(),
    };
    let pixels = samples.width * samples.height;
    let share = 1.0 / wanted.len() as f64;
    let mut plane = Plane {
        size: [samples.width, samples.height],
        light: vec![0.0; pixels],
        rounding: vec![0.0; pixels],
        saturated: vec![false; pixels],
        share,
        zeros: 0,
        highest: Highest::default(),
    };
    let step = if samples.full_scale.is_some() {
        1.0
    } else {
        0.0
    };
    for channel in wanted {
        let at = samples.channels.iter().position(|c| *c == channel);
        let at = at.ok_or_else(|| {
            let cause = format!("{name} has no channel {channel:?}").to_lowercase();
            refused(cause, "leave `channel` out for grey photographs")
        })?;
        let stored = samples
            .values
            .iter()
            .skip(at)
            .step_by(samples.channels.len());
        for (k, s) in stored.enumerate() {
            let [light, slope] = response.light(*s);
            let rounded = share * slope * step;
            plane.light[k] += share * light;
            plane.rounding[k] += rounded * rounded / 12.0;
            plane.saturated[k] |= *s >= saturation;
            plane.zeros += usize::from(*s == 0.0 && step > 0.0);
            if step > 0.0 && *s < saturation {
                plane.highest.count(*s);
            }
        }
    }
    Ok(plane)
}

/// The mean of repeated photographs, updated one by one (Welford, *Technometrics* 4, 1962).
#[derive(Clone, Debug, PartialEq)]
pub struct Averaged {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Photographs so far.
    pub frames: usize,
    /// Their mean, counts.
    pub light: Vec<f64>,
    /// Mean variance of their rounding, counts².
    pub rounding: Vec<f64>,
    /// Whether one of them was saturated.
    pub saturated: Vec<bool>,
    /// Mean of their shares: see [`Plane::share`].
    pub share: f64,
    /// Stored values that were 0.
    pub zeros: usize,
    /// The largest stored integers below saturation.
    pub highest: Highest,
    squares: Vec<f64>,
    /// Pixels that make up a whole: those that the first photograph has not saturated.
    in_whole: Vec<bool>,
    /// Mean and squares of the light of wholes.
    whole: [f64; 2],
}

impl Averaged {
    /// The first photograph.
    pub fn of(first: Plane) -> Self {
        let in_whole: Vec<bool> = first.saturated.iter().map(|is| !is).collect();
        Self {
            whole: [whole(&first.light, &in_whole), 0.0],
            in_whole,
            size: first.size,
            frames: 1,
            squares: vec![0.0; first.light.len()],
            light: first.light,
            rounding: first.rounding,
            saturated: first.saturated,
            share: first.share,
            zeros: first.zeros,
            highest: first.highest,
        }
    }

    /// One more photograph of the same; `name` is for messages.
    ///
    /// # Errors
    /// [`PhotographError::Refused`] if it has another size.
    pub fn add(&mut self, name: &str, next: &Plane) -> Result<(), PhotographError> {
        same_size(name, next.size, self.size)?;
        self.frames += 1;
        self.zeros += next.zeros;
        self.highest.add(&next.highest);
        let n = self.frames as f64;
        let light = whole(&next.light, &self.in_whole);
        let off = light - self.whole[0];
        self.whole[0] += off / n;
        self.whole[1] += off * (light - self.whole[0]);
        self.share += (next.share - self.share) / n;
        for k in 0..self.light.len() {
            let off = next.light[k] - self.light[k];
            self.light[k] += off / n;
            self.squares[k] += off * (next.light[k] - self.light[k]);
            self.rounding[k] += (next.rounding[k] - self.rounding[k]) / n;
            self.saturated[k] |= next.saturated[k];
        }
        Ok(())
    }

    /// Pixels' worth of stored values that were 0: a third for each of three channels.
    pub fn cut_off(&self) -> f64 {
        self.zeros as f64 * self.share
    }

    /// Sample variance of the light of whole photographs, and that by the scatter of each pixel
    /// alone, counts²; `None` without repeats.
    pub(super) fn of_wholes(&self) -> Option<[f64; 2]> {
        let pixels = whole(&self.squares, &self.in_whole);
        (self.frames > 1).then(|| [self.whole[1], pixels].map(|x| x / (self.frames - 1) as f64))
    }

    /// Mean light of a whole above dark frames, counts.
    pub(super) fn light_above(&self, below: Option<&Self>) -> f64 {
        self.whole[0] - below.map_or(0.0, |dark| whole(&dark.light, &self.in_whole))
    }

    /// Sample variance of one photograph at a pixel, counts²; `None` without repeats.
    pub fn scatter(&self, pixel: usize) -> Option<f64> {
        (self.frames > 1).then(|| self.squares[pixel] / (self.frames - 1) as f64)
    }
}

/// Σ over the pixels of a whole.
fn whole(values: &[f64], pixels: &[bool]) -> f64 {
    let counted = values.iter().zip(pixels).filter(|(_, is_in)| **is_in);
    counted.map(|(x, _)| x).sum()
}

/// Refuses a photograph of another size than the first.
///
/// # Errors
/// [`PhotographError::Refused`].
pub(super) fn same_size(
    name: &str,
    found: [usize; 2],
    expected: [usize; 2],
) -> Result<(), PhotographError> {
    if found == expected {
        return Ok(());
    }
    let cause = format!(
        "{name} has {} × {} pixels, the first photograph {} × {}",
        found[0], found[1], expected[0], expected[1]
    );
    Err(refused(
        cause,
        "give photographs of one size: crop or scale none of them alone",
    ))
}

/// Refuses a photograph whose integers reach to another value than those of the first: a stored
/// value would mean another light.
///
/// # Errors
/// [`PhotographError::Refused`].
pub(super) fn same_full_scale(
    name: &str,
    found: Option<f64>,
    expected: Option<f64>,
) -> Result<(), PhotographError> {
    let (Some(found), Some(expected)) = (found, expected) else {
        return Ok(());
    };
    if found == expected {
        return Ok(());
    }
    Err(refused(
        format!("{name} stores values up to {found}, the first photograph up to {expected}"),
        "give photographs of one bit depth, or `full_scale` where a stored value means the same in all",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn photo(values: &[f64], channels: usize) -> Samples {
        let all = [Channel::Red, Channel::Green, Channel::Blue];
        Samples {
            width: values.len() / channels,
            height: 1,
            channels: if channels == 1 {
                vec![Channel::Grey]
            } else {
                all.to_vec()
            },
            values: values.to_vec(),
            full_scale: Some(255.0),
            is_lossy: false,
            gamma: None,
        }
    }

    #[test]
    fn the_mean_of_colours_is_that_of_their_light() {
        let gamma = Response::gamma(2.0, 255.0).unwrap();
        let colour = photo(&[51.0, 102.0, 255.0], 3);
        let of = |chosen| linearised("a", &colour, chosen, &gamma, 255.0);
        let mean = of(Chosen::Mean).unwrap();
        // 255·(0.04 + 0.16 + 1)/3; slopes 0.4, 0.8, 2 give (0.16 + 0.64 + 4)/9/12.
        assert!((mean.light[0] - 102.0).abs() < 1e-12);
        assert!((mean.rounding[0] - 4.8 / 108.0).abs() < 1e-12);
        assert_eq!(mean.saturated, [true]);
        // Two of the three stored values of a pixel are 0.
        let dark = photo(&[0.0, 0.0, 9.0, 0.0, 1.0, 2.0], 3);
        let dark = linearised("a", &dark, Chosen::Mean, &Response::Linear, 255.0).unwrap();
        let dark = Averaged::of(dark);
        assert!((dark.share * 3.0 - 1.0).abs() < 1e-15);
        assert!((dark.cut_off() - 1.0).abs() < 1e-15);
        let green = of(Chosen::One(Channel::Green)).unwrap();
        assert!((green.light[0] - 255.0 * 0.16).abs() < 1e-12 && !green.saturated[0]);
        let error = of(Chosen::Grey).unwrap_err().to_string();
        assert!(
            error.contains("colour") && error.contains("channel"),
            "{error}"
        );
        // Grey saved in colour is grey.
        let same = photo(&[7.0, 7.0, 7.0], 3);
        let grey = linearised("a", &same, Chosen::Grey, &Response::Linear, 255.0).unwrap();
        assert_eq!((grey.light[0], grey.rounding[0]), (7.0, 1.0 / 12.0));
        // And has each of its channels, as a dark frame of zeros in colour.
        let red = Chosen::One(Channel::Red);
        let of_red = linearised("a", &same, red, &Response::Linear, 255.0).unwrap();
        assert_eq!(of_red, grey);
        let grey = photo(&[7.0], 1);
        let error = linearised("a", &grey, red, &Response::Linear, 255.0).unwrap_err();
        assert!(error.to_string().contains("is grey"), "{error}");
    }

    #[test]
    fn repeats_have_their_mean_and_their_sample_variance() {
        let plane = |x: f64| {
            linearised(
                "a",
                &photo(&[x, 0.0], 1),
                Chosen::Grey,
                &Response::Linear,
                9.0,
            )
            .unwrap()
        };
        let mut mean = Averaged::of(plane(1.0));
        assert_eq!(mean.scatter(0), None);
        for x in [4.0, 10.0] {
            mean.add("b", &plane(x)).unwrap();
        }
        assert_eq!((mean.light[0], mean.scatter(0)), (5.0, Some(21.0)));
        assert_eq!((mean.saturated, mean.zeros), (vec![true, false], 3));
        let mut other = Averaged::of(plane(1.0));
        let wide = photo(&[1.0; 3], 1);
        let wide = linearised("b", &wide, Chosen::Grey, &Response::Linear, 9.0).unwrap();
        assert!(
            other
                .add("b.png", &wide)
                .unwrap_err()
                .to_string()
                .contains("b.png has 3 × 1")
        );
    }
}
