//! The Picard data as a table for programs and as a figure.

use super::chart::{Axis, Run, Series, legend, panel, sheet};
use crate::recovery::{Directions, Picard};

/// One line per singular direction: its number from 1, σ, coefficient and noise level (in W but for weighted directions; empty where the noise is not
/// known).
pub fn picard_csv(picard: &Picard) -> String {
    let head = match picard.directions {
        Directions::LaserSide | Directions::Joint => "direction,sigma,coefficient_W,noise_W\n",
        Directions::JointWeighted => "direction,sigma,coefficient,noise\n",
    };
    let mut out = String::from(head);
    for (i, (sigma, coefficient)) in picard
        .sigma
        .iter()
        .zip(picard.coefficient.iter())
        .enumerate()
    {
        let noise = picard
            .noise
            .as_ref()
            .map_or(String::new(), |n| format!("{:e}", n[i]));
        out += &format!("{},{sigma:e},{coefficient:e},{noise}\n", i + 1);
    }
    out
}

/// Coefficients, noise level and singular values over the direction, on a logarithmic axis. The singular values are scaled to begin at the first
/// coefficient: where the coefficients stay above them after that, an inverse amplifies what is there.
pub fn picard_svg(picard: &Picard) -> String {
    let curve = |name: &str, values: &[f64], scale: f64| Series {
        name: name.to_owned(),
        points: values
            .iter()
            .enumerate()
            .map(|(i, x)| [(i + 1) as f64, x * scale])
            .collect(),
    };
    let (sigma, coefficient) = (picard.sigma.as_slice(), picard.coefficient.as_slice());
    let (title_x, title_y) = match picard.directions {
        Directions::LaserSide => (
            "singular direction i of the laser side",
            "root mean square over the pixels, W",
        ),
        Directions::Joint => ("singular direction i of all pixels and spots", "W"),
        Directions::JointWeighted => (
            "singular direction i of all pixels and spots, weighted",
            "standard deviations of the noise, about",
        ),
    };
    let scale = match coefficient[0] / sigma[0] {
        scale if scale > 0.0 => scale,
        _ => 1.0,
    };
    let mut series = vec![
        curve("data in direction i", coefficient, 1.0),
        curve("singular value σᵢ, scaled", sigma, scale),
    ];
    if let Some(noise) = &picard.noise {
        series.push(curve("noise in direction i", noise.as_slice(), 1.0));
    }
    let x = Axis {
        run: Run::Linear,
        ends: [0.0, (sigma.len() + 1) as f64],
        title: title_x.to_owned(),
    };
    let values = series.iter().flat_map(|s| &s.points).map(|p| p[1]);
    let y = Axis::decades(values, title_y);
    let title = "Which singular directions rise above the noise";
    let mut svg = sheet([900, 440], title, "");
    panel(&mut svg, [80.0, 50.0], [560.0, 320.0], [&x, &y], &series);
    legend(&mut svg, [660.0, 64.0], &series);
    svg.raw("</svg>");
    svg.text
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;

    fn sample(noise: Option<DVector<f64>>) -> Picard {
        Picard {
            directions: Directions::LaserSide,
            sigma: DVector::from_row_slice(&[2.0, 1e-3, 1e-9]),
            coefficient: DVector::from_row_slice(&[4e-12, 3e-15, 0.0]),
            noise,
        }
    }

    /// Data without any light along the first direction are no reason for a figure without singular values.
    #[test]
    fn a_first_coefficient_of_zero() {
        let picard = Picard {
            directions: Directions::JointWeighted,
            coefficient: DVector::zeros(3),
            ..sample(None)
        };
        let svg = picard_svg(&picard);
        assert!(
            !svg.contains("NaN") && !svg.contains("inf") && svg.contains("standard deviations")
        );
        assert!(picard_csv(&picard).starts_with("direction,sigma,coefficient,noise\n"));
    }

    #[test]
    fn every_direction_has_its_line() {
        let noise = DVector::from_element(3, 1e-15);
        let text = picard_csv(&sample(Some(noise.clone())));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 4);
        assert_eq!(lines[2], "2,1e-3,3e-15,1e-15");
        assert!(
            picard_csv(&sample(None))
                .lines()
                .skip(1)
                .all(|l| l.ends_with(','))
        );
        for (picard, lines) in [(sample(Some(noise)), 3), (sample(None), 2)] {
            let svg = picard_svg(&picard);
            // A coefficient of zero has no place on a logarithmic axis; everything drawn is finite.
            assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"));
            assert_eq!(
                svg.matches("direction i<").count() + svg.matches("scaled<").count(),
                lines
            );
        }
    }
}
