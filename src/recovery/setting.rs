//! The settings of a recovery: to which methods each means something, and which values it takes.

use super::method::Method;
use crate::num::named::named;

named! {
    /// A setting, by the name it has in the command line and, with underscores, in Python.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Setting {
        /// Standard errors relative to each entry.
        Noise = "noise",
        /// How the parameter is chosen that is not given.
        Rule = "rule",
        /// Singular values that are kept.
        Rank = "rank",
        /// Damping of small singular values, a fraction of σ1.
        Damping = "damping",
        /// Where singular values count as 0, a fraction of σ1.
        Tolerance = "tolerance",
        /// Weight of differences between neighbours, a fraction of σ1².
        Tv = "tv",
        /// The two values of reflectances.
        Levels = "levels",
        /// Confidence of bands.
        Bands = "bands",
        /// How entries are weighted.
        Weighting = "weighting",
        /// Errors of unknown noise as a field over the photograph.
        ErrorField = "error-field",
        /// A constant in each photograph.
        FrameConstant = "frame-constant",
        /// A polynomial of this degree in each photograph.
        FramePolynomial = "frame-polynomial",
        /// Given patterns in each photograph.
        FramePatterns = "frame-patterns",
        /// A background that all photographs share.
        Background = "background",
        /// Glare of this shape in each photograph.
        GlarePattern = "glare-pattern",
        /// A free scale of all light.
        FreeScale = "free-scale",
        /// Gains of the photographs, known to this standard deviation.
        FrameGain = "frame-gain",
        /// The scale of all light, known to this standard deviation.
        ScaleError = "scale-error",
        /// Entries that do not count.
        LeftOut = "left-out",
        /// Occluders that reflect, recovered like the hidden surfaces.
        OccluderLight = "occluder-light",
    }
}

impl Setting {
    /// Whether the method does anything with it.
    pub fn means_something_to(self, method: Method) -> bool {
        match self {
            Setting::Noise => true,
            Setting::Bands => ![Method::JointTv, Method::JointTwoValued].contains(&method),
            Setting::Rule => {
                [Method::Tsvd, Method::Tikhonov, Method::TikhonovGradient].contains(&method)
            }
            Setting::Rank => method == Method::Tsvd,
            Setting::Damping => [Method::Tikhonov, Method::TikhonovGradient].contains(&method),
            Setting::Tolerance => [
                Method::Pinv,
                Method::LeftInverse,
                Method::RightInverse,
                Method::Rdivide,
                Method::RdivideMinNorm,
                Method::JointUnbounded,
            ]
            .contains(&method),
            Setting::Tv => method == Method::JointTv,
            Setting::Levels => method == Method::JointTwoValued,
            Setting::ErrorField => method == Method::JointGp,
            Setting::OccluderLight => method.is_joint() && method != Method::JointTwoValued,
            Setting::Weighting
            | Setting::FrameConstant
            | Setting::FramePolynomial
            | Setting::FramePatterns
            | Setting::Background
            | Setting::GlarePattern
            | Setting::FreeScale
            | Setting::FrameGain
            | Setting::ScaleError
            | Setting::LeftOut => method.is_joint(),
        }
    }

    /// The methods that do something with it, in the order of [`Method::ALL`].
    pub fn methods(self) -> Vec<Method> {
        let takes = |method: &Method| self.means_something_to(*method);
        Method::ALL.into_iter().filter(takes).collect()
    }

    /// Which numbers it can be, in words; none where it is no number of its own range.
    pub fn range(self) -> Option<&'static str> {
        Some(match self {
            Setting::Noise => "positive: relative to each entry, e.g. 0.01",
            Setting::Rank => "at least 1",
            Setting::Damping => "0 or more: a fraction of σ1",
            Setting::Tolerance => "0 or more and below 1: a fraction of σ1",
            Setting::Tv => "0 or more: a fraction of σ1²",
            Setting::Bands => "above 0 and below 1: a probability, e.g. 0.95",
            Setting::FrameGain | Setting::ScaleError => {
                "above 0 and at most 1: a standard deviation relative to 1, e.g. 0.05"
            }
            _ => return None,
        })
    }

    /// Whether it can have this value.
    pub fn allows(self, value: f64) -> bool {
        match self {
            Setting::Noise => value > 0.0 && value.is_finite(),
            Setting::Rank => value >= 1.0,
            Setting::Damping | Setting::Tv => value >= 0.0 && value.is_finite(),
            Setting::Tolerance => (0.0..1.0).contains(&value),
            Setting::Bands => value > 0.0 && value < 1.0,
            Setting::FrameGain | Setting::ScaleError => value > 0.0 && value <= 1.0,
            _ => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_what_is_allowed() {
        // What the words of a range exclude, and what they include.
        for setting in Setting::ALL {
            let Some(words) = setting.range() else {
                continue;
            };
            assert_eq!(setting.allows(0.0), words.starts_with("0 or more"));
            assert!(
                !setting.allows(-0.5) && !setting.allows(f64::NAN),
                "{words}"
            );
            assert!(setting.allows(0.5) || words.starts_with("at least 1"));
            assert_eq!(setting.allows(1.0), !words.contains("below 1"));
            let bounded = words.contains("below 1") || words.contains("at most 1");
            assert_eq!(setting.allows(2.0), !bounded, "{words}");
        }
    }

    #[test]
    fn every_setting_has_a_name_of_its_own_and_a_method() {
        for setting in Setting::ALL {
            let same = Setting::ALL.iter().filter(|s| s.name() == setting.name());
            assert_eq!(same.count(), 1, "{}", setting.name());
            assert!(!setting.methods().is_empty(), "{}", setting.name());
        }
    }
}
