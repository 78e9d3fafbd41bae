use super::*;

/// Expected bits: Python's `float` of the product in `fractions.Fraction`, with 1 in = 254/10000 m
/// and π to 120 digits.
#[test]
fn conversions_are_the_doubles_nearest_to_the_exact_products() {
    for (dimension, text, unit, bits) in [
        (Dimension::Length, "0.1 in", Unit::Inch, 0x3fb999999999999a),
        (
            Dimension::Length,
            "0.0254 m",
            Unit::Inch,
            0x3ff0000000000000,
        ),
        (Dimension::Length, "1 cm", Unit::Inch, 0x3fd93264c993264d),
        (Dimension::Length, "0.1 in", Unit::Metre, 0x3f64cec41dd1a21f),
        (Dimension::Length, "3 in", Unit::Metre, 0x3fb381d7dbf487fd),
        (
            Dimension::Length,
            "0.7 ft",
            Unit::Centimetre,
            0x40355604189374bc,
        ),
        (
            Dimension::Length,
            "1.1 m",
            Unit::Millimetre,
            0x4091300000000000,
        ),
        (
            Dimension::Length,
            "632.8 nm",
            Unit::Inch,
            0x3efa1fa2d675fc79,
        ),
        (Dimension::Length, "-7.3 mm", Unit::Inch, 0xbfd264c993264c99),
        (
            Dimension::Metres,
            "632.8 nm",
            Unit::Inch,
            0x3ea53bb5ea8666cf,
        ),
        (
            Dimension::Metres,
            "0.6328 um",
            Unit::Metre,
            0x3ea53bb5ea8666cf,
        ),
        (Dimension::Area, "1 cm²", Unit::Inch, 0x3fc3d70cd729487d),
        (
            Dimension::Area,
            "0.05 in^2",
            Unit::Metre,
            0x3f00e99870b5dbd6,
        ),
        (
            Dimension::Area,
            "30 mm2",
            Unit::Centimetre,
            0x3fd3333333333333,
        ),
        (Dimension::Power, "5 mW", Unit::Inch, 0x3f747ae147ae147b),
        (Dimension::Power, "0.3 uW", Unit::Inch, 0x3e9421f5f40d8376),
        (
            Dimension::Exitance,
            "3 W/m²",
            Unit::Inch,
            0x3f5fb5fdd354fc31,
        ),
        (
            Dimension::Exitance,
            "2.5 mW/cm²",
            Unit::Inch,
            0x3f90841ede1198af,
        ),
        (
            Dimension::Exitance,
            "0.1 W/in²",
            Unit::Inch,
            0x3fb999999999999a,
        ),
        (Dimension::Degrees, "45 deg", Unit::Inch, 0x4046800000000000),
        (
            Dimension::Degrees,
            "0.3 rad",
            Unit::Inch,
            0x40313050dca2412e,
        ),
        (
            Dimension::Degrees,
            "12 mrad",
            Unit::Inch,
            0x3fe6006780cfaf97,
        ),
        (Dimension::Radians, "20 deg", Unit::Inch, 0x3fd657184ae74487),
        (
            Dimension::Radians,
            "0.3 rad",
            Unit::Inch,
            0x3fd3333333333333,
        ),
        (Dimension::Time, "100 ms", Unit::Inch, 0x3fb999999999999a),
        (Dimension::Time, "1.1 min", Unit::Inch, 0x4050800000000000),
        (Dimension::Percent, "0.3 %", Unit::Inch, 0x3fd3333333333333),
    ] {
        let number = dimension.number(text, unit).unwrap();
        assert_eq!(
            number.to_bits(),
            bits,
            "{text} as {dimension:?} in {unit:?}: {number}"
        );
    }
}

#[test]
fn the_unit_of_the_scene_changes_no_digit() {
    for text in [
        "0.1",
        "1e-9",
        "15.5",
        "4.373476808130942",
        "-2.82842712474619",
    ] {
        for unit in [Unit::Metre, Unit::Centimetre, Unit::Millimetre, Unit::Inch] {
            let with = format!("{text} {}", unit.symbol());
            assert_eq!(
                Dimension::Length.number(&with, unit),
                Ok(text.parse().unwrap()),
                "{with}"
            );
        }
    }
}

#[test]
fn texts_without_number_or_unit_are_told_apart() {
    let of = |text| Dimension::Power.number(text, Unit::Metre);
    assert_eq!(of("much"), Err(NoNumber::Text));
    assert_eq!(of("5"), Err(NoNumber::Bare));
    assert_eq!(
        of("5 mm"),
        Err(NoNumber::Unit("mm".to_owned(), Some(Dimension::Length)))
    );
    assert_eq!(of("5 hp"), Err(NoNumber::Unit("hp".to_owned(), None)));
    assert_eq!(of("5e-3W"), Ok(5e-3));
    assert_eq!(of(" 5mW "), Ok(5e-3));
}
