//! Numbers as people read them. Files have all digits of a number; words, tables and axes have what
//! these functions give.

/// `x` with `digits` significant digits: plain between 1e-3 and 1e5, else as 1.2e-7.
pub fn significant(x: f64, digits: usize) -> String {
    if x.is_nan() {
        return "not a number".to_owned();
    }
    if x.is_infinite() {
        return if x > 0.0 { "unbounded" } else { "−unbounded" }.to_owned();
    }
    if x == 0.0 {
        return "0".to_owned();
    }
    let digits = digits.max(1);
    // Rounding first: 9.996 has the exponent of 10.0.
    let scientific = format!("{x:.*e}", digits - 1);
    let exponent: i32 = scientific
        .split_once('e')
        .and_then(|(_, e)| e.parse().ok())
        .unwrap_or(0);
    let text = if (-3..5).contains(&exponent) {
        let places = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{x:.places$}")
    } else {
        scientific
    };
    text.replace('-', "−").replace("e−", "e-")
}

/// A number as it is set: 1.2e-7 becomes 1.2 × 10⁻⁷.
pub fn scientific(text: &str) -> String {
    let power = |(mantissa, exponent): (&str, &str)| {
        let exponent = superscript(exponent.parse().ok()?);
        Some(match mantissa {
            "1" => format!("10{exponent}"),
            _ => format!("{mantissa} × 10{exponent}"),
        })
    };
    text.split_once('e')
        .and_then(power)
        .unwrap_or_else(|| text.to_owned())
}

/// A whole number in superscript digits.
pub fn superscript(n: i32) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    n.to_string()
        .chars()
        .map(|c| c.to_digit(10).map_or('⁻', |d| digits[d as usize]))
        .collect()
}

/// `x` with `digits` significant digits, powers of ten raised: 1.2 × 10⁻⁷.
pub fn figure(x: f64, digits: usize) -> String {
    scientific(&significant(x, digits))
}

/// Degrees of freedom: five digits, a whole number as one.
pub fn freedom(x: f64) -> String {
    if x.fract() == 0.0 {
        x.to_string()
    } else {
        significant(x, 5)
    }
}

/// The same of a number that may be missing: –.
pub fn perhaps(x: Option<f64>, digits: usize) -> String {
    x.map_or("–".to_owned(), |x| figure(x, digits))
}
