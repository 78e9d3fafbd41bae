//! What is said of the picture of a calibration.

use crate::lab::geometry::calibrate::{Calibration, FinerElements};
use crate::num::digits::{figure, perhaps};

/// Standard errors, and beside them a part of 1, by which reflectances are surely beyond 0 and 1.
const SURELY: f64 = 5.0;
const ROOM: f64 = 0.05;

impl Calibration {
    /// Whether the photographs ask for a finer picture.
    pub(super) fn asks_for_elements(&self) -> bool {
        let finer = self.finer_elements.as_ref();
        finer.is_some_and(FinerElements::is_asked)
    }

    /// Whether the picture may be even within its elements.
    pub(super) fn elements(&self) -> String {
        let counts = self.grids.first().map_or([0; 2], |g| g.count);
        let [own, twice] = [1, 2].map(|n| counts.map(|count| (n * count).to_string()).join(" × "));
        let even = format!("The picture is taken as even within each of {own} elements");
        match &self.finer_elements {
            None => format!(
                "{even}; whether the photographs ask for finer ones was not tried. If it is not, the geometry \
                 bends for it, and its errors do not know."
            ),
            Some(finer) if finer.is_asked() => format!(
                "{even}, and the photographs ASK FOR FINER ONES: {twice} are e^{} times as likely. What they \
                 move is counted in the errors. Use --elements {}.",
                figure(finer.log_likelier, 2),
                finer.elements.map(|n| n.to_string()).join("x")
            ),
            Some(_) => format!("{even}; the photographs do not ask for {twice}."),
        }
    }

    /// That no surface can be so, where the picture is beyond what one reflects by more than its
    /// errors; of a free scale below 0 alone.
    pub(super) fn impossible(&self) -> Option<String> {
        let each = self
            .grids
            .iter()
            .flat_map(|g| g.values.iter().zip(&g.stderr));
        let is_free = self.scale != 1.0;
        let beyond = |(x, s): &(&f64, &f64)| {
            **x < -SURELY * **s - ROOM || !is_free && **x - 1.0 > SURELY * **s + ROOM
        };
        each.clone().find(beyond)?;
        let (least, most) = each.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (x, _)| {
            (a.min(*x), b.max(*x))
        });
        Some(format!(
            "Beware: the picture has reflectances from {} to {}, and no surface reflects less than 0 or more \
             than all. Sign, unit or scale of the photographs is wrong, or something that is not free.",
            figure(least, 2),
            figure(most, 2)
        ))
    }

    /// What it assumes, and how good it is.
    pub(super) fn picture(&self) -> String {
        let scale = if self.scale == 1.0 {
            String::new()
        } else {
            format!(
                " The scale of all light is {} if the mean of the picture is of the size that its prior takes: \
                 that is no measurement of the scale, and of reflectances only the ratios are told. Errors are \
                 those of the light, in units of that scale.",
                figure(self.scale, 3)
            )
        };
        let length = if self.length == 0.0 {
            "elements that know nothing of each other".to_owned()
        } else {
            format!("elements alike over {}", figure(self.length, 2))
        };
        let taken = if self.field.is_some() {
            ", if what is left over is such errors"
        } else if self.is_more_than_noise() {
            ", if what is left over were independent noise: it need not be, and then the picture and its \
             errors claim too much (`phicam locate` draws one that the photographs bear out)"
        } else {
            ""
        };
        let truth = match (self.mtf_raw, self.correlation) {
            (None, None) => String::new(),
            (mtf, correlation) => format!(
                " Against the scene's own picture: MTF raw {}, correlation {}.",
                perhaps(mtf, 3),
                perhaps(correlation, 3)
            ),
        };
        format!(
            "The picture is the mean of all that fit by this geometry, however much and over whatever length they \
             vary, as likely as the photographs make them (`joint-gp`), not bounded; {} of its directions are \
             determined{taken}. Its errors include those of the geometry and hold for such pictures: `phicam \
             recover` with the calibrated scene compares other assumptions. The geometry was found by the \
             likeliest: pictures of spread {} and {length}.{truth}{scale}",
            figure(self.directions, 3),
            figure(self.spread, 2)
        )
    }
}
