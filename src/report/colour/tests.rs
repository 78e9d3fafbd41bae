//! Colour maps as published, and scales at the edge of their data.

use super::*;

#[test]
fn maps_have_their_published_colours() {
    // Published: viridis runs from #440154 through #21918c (entry 128) to #fde725; RdBu's
    // middle is #f7f7f7.
    assert_eq!(Map::Viridis.at(0.0), [0x44, 0x01, 0x54]);
    assert_eq!(Map::Viridis.at(128.0 / 255.0), [0x21, 0x91, 0x8c]);
    assert_eq!(Map::Viridis.at(1.0), [0xfd, 0xe7, 0x25]);
    assert_eq!(Map::Diverging.at(0.0), [0x05, 0x30, 0x61]);
    assert_eq!(Map::Diverging.at(0.5), [0xf7, 0xf7, 0xf7]);
    assert_eq!(Map::Diverging.at(1.0), [0x67, 0x00, 0x1f]);
    assert_eq!(Map::Grey.at(0.5), [128; 3]);
}

#[test]
fn viridis_grows_lighter_all_the_way() {
    // A sequential map must order by lightness: relative luminance of linear sRGB (IEC
    // 61966-2-1).
    let luminance = |c: Rgb| {
        let linear = c.map(|x| {
            let x = f64::from(x) / 255.0;
            if x <= 0.04045 {
                x / 12.92
            } else {
                ((x + 0.055) / 1.055).powf(2.4)
            }
        });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    };
    for i in 0..255 {
        let [a, b] = [i, i + 1].map(|k| luminance(Map::Viridis.at(f64::from(k) / 255.0)));
        // Rounding to 8 bits may lower one channel by one step: at most 0.7152·(slope 2.3)/255.
        assert!(b > a - 0.0065, "{i}");
    }
    assert_eq!(VIRIDIS.len(), 6 * 256);
}

/// Four decades: each takes a quarter of the colours.
#[test]
fn a_logarithmic_scale_gives_each_decade_as_many_colours() {
    let scale = Scale::between(Map::Viridis, Law::Logarithmic, [1e-13, 1e-9]).unwrap();
    for (k, value) in [1e-13, 1e-12, 1e-11, 1e-10, 1e-9].into_iter().enumerate() {
        let share = k as f64 / 4.0;
        assert!((scale.share(value) - share).abs() < 1e-12);
        assert!((scale.value(share) / value - 1.0).abs() < 1e-12);
        assert_eq!(scale.colour(value), Map::Viridis.at(share));
    }
    for below in [0.0, -1.0, 0.9e-13] {
        assert_eq!(scale.colour(below), scale.below().0);
    }
    for (law, range) in [
        (Law::Logarithmic, [0.0, 1.0]),
        (Law::Logarithmic, [-1.0, 1.0]),
        (Law::Linear, [1.0, 1.0]),
        (Law::Linear, [0.0, f64::INFINITY]),
        (Law::Linear, [f64::NAN, 1.0]),
    ] {
        assert_eq!(Scale::between(Map::Grey, law, range), None);
    }
}

#[test]
fn the_reflectance_scale_is_fixed_and_marks_what_lies_outside() {
    let scale = Scale::reflectance();
    assert_eq!(scale.colour(0.0), [0; 3]);
    assert_eq!(scale.colour(1.0), [255; 3]);
    assert_eq!(scale.colour(-1e-9), scale.below().0);
    assert_eq!(scale.colour(1.0 + 1e-9), scale.above().0);
    assert_eq!(scale.colour(f64::NEG_INFINITY), scale.below().0);
    assert_eq!(scale.colour(f64::NAN), NOT_A_NUMBER.0);
    let outside = [scale.below().0, scale.above().0, NOT_A_NUMBER.0];
    for c in outside {
        assert!(c[0] != c[1] || c[1] != c[2], "a mark that is itself a grey");
    }
}

#[test]
fn scales_survive_empty_constant_and_huge_data() {
    for values in [
        vec![],
        vec![f64::NAN],
        vec![0.0, 0.0],
        vec![-3.0],
        vec![1e300],
        vec![-1e308, 1e308],
    ] {
        let scale = Scale::sequential(&values);
        let [low, high] = scale.range();
        assert!(
            low < high && low.is_finite() && high.is_finite(),
            "{values:?}"
        );
        for v in values.iter().filter(|v| v.is_finite()) {
            assert_ne!(scale.colour(*v), scale.above().0, "{values:?}");
            assert_ne!(scale.colour(*v), scale.below().0, "{values:?}");
        }
    }
    let scale = Scale::symmetric(4.0);
    assert_eq!(scale.colour(0.0), [0xf7; 3]);
    assert_eq!(scale.colour(4.1), scale.above().0);
}
