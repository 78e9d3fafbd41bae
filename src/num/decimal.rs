//! Decimal numbers of any length: exact products, correctly rounded quotients.

/// Significant digits after which a quotient ends in one digit that stands for all the others. A
/// number halfway between two doubles has at most 767, so that digit decides every tie.
const DIGITS: usize = 800;

/// Largest power of ten that is kept apart from the digits; beyond it a number is 0 or infinite in
/// f64 whatever its digits.
const LARGEST_EXPONENT: i64 = 1 << 32;

/// A decimal number: a whole number times a power of ten.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decimal {
    negative: bool,
    /// Of the whole number, the first the most significant.
    digits: Vec<u8>,
    exponent: i64,
}

impl Decimal {
    /// Reads `-12.5e-3` and the like: a sign, digits with at most one point, an exponent. `None`
    /// for any other text.
    pub fn parse(text: &str) -> Option<Self> {
        let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
        let (mantissa, exponent) = match unsigned.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse::<i64>().ok()?),
            None => (unsigned, 0),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits: Vec<u8> = [whole, fraction].concat().into_bytes();
        if digits.is_empty() || !digits.iter().all(u8::is_ascii_digit) {
            return None;
        }
        let exponent = exponent.clamp(-LARGEST_EXPONENT, LARGEST_EXPONENT);
        Some(Self {
            negative: text.starts_with('-'),
            digits: digits.iter().map(|d| d - b'0').collect(),
            exponent: exponent - i64::try_from(fraction.len()).ok()?,
        })
    }

    /// The exact product with a number that is written in decimal digits alone.
    pub fn times(&self, digits: &str) -> Self {
        let factor: Vec<u64> = digits.bytes().map(|d| u64::from(d - b'0')).collect();
        let mut product = vec![0_u64; self.digits.len() + factor.len()];
        for (i, d) in self.digits.iter().enumerate() {
            for (j, f) in factor.iter().enumerate() {
                product[i + j + 1] += u64::from(*d) * f;
            }
        }
        for i in (1..product.len()).rev() {
            product[i - 1] += product[i] / 10;
            product[i] %= 10;
        }
        Self {
            digits: product.iter().map(|d| *d as u8).collect(),
            ..self.clone()
        }
    }

    /// The same times 10^`exponent`.
    pub fn shifted(self, exponent: i64) -> Self {
        Self {
            exponent: self.exponent + exponent,
            ..self
        }
    }

    /// The quotient by a whole number from 1 to 10¹⁵: exact where it ends within [`DIGITS`] digits,
    /// else near enough that [`Decimal::nearest`] is the double nearest to the exact quotient.
    pub fn over(&self, divisor: u64) -> Self {
        let mut digits = Vec::with_capacity(self.digits.len());
        let (mut rest, mut exponent, mut significant) = (0, self.exponent, 0);
        let mut given = self.digits.iter();
        loop {
            match given.next() {
                Some(d) => rest = rest * 10 + u64::from(*d),
                None if rest == 0 => break,
                None if significant > DIGITS => {
                    digits.push(1);
                    exponent -= 1;
                    break;
                }
                None => {
                    rest *= 10;
                    exponent -= 1;
                }
            }
            let digit = (rest / divisor) as u8;
            rest %= divisor;
            if significant > 0 || digit > 0 {
                significant += 1;
            }
            digits.push(digit);
        }
        Self {
            negative: self.negative,
            digits,
            exponent,
        }
    }

    /// The whole number that it is exactly; `None` for a fraction, below 0, and beyond u64.
    pub fn whole(&self) -> Option<u64> {
        let zeros = self.digits.iter().rev().take_while(|d| **d == 0).count();
        let digits = &self.digits[..self.digits.len() - zeros];
        if digits.is_empty() {
            return Some(0);
        }
        let tens = u32::try_from(self.exponent + zeros as i64).ok()?;
        let add = |n: u64, d: &u8| n.checked_mul(10)?.checked_add(u64::from(*d));
        let n = digits.iter().try_fold(0, add)?;
        if self.negative {
            return None;
        }
        n.checked_mul(10_u64.checked_pow(tens)?)
    }

    /// The nearest double.
    pub fn nearest(&self) -> f64 {
        let sign = if self.negative { "-" } else { "" };
        let digits: String = self.digits.iter().map(|d| char::from(b'0' + d)).collect();
        let text = format!("{sign}{digits}e{}", self.exponent);
        // Every text of this form is a number.
        text.parse().unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(text: &str) -> Decimal {
        Decimal::parse(text).unwrap()
    }

    #[test]
    fn texts_that_are_numbers_are_read() {
        for (text, value) in [
            ("5", 5.0),
            ("-0.25", -0.25),
            (".5", 0.5),
            ("5.", 5.0),
            ("+1e-3", 1e-3),
            ("1.25E+2", 125.0),
            ("0", 0.0),
            ("1e-999", 0.0),
        ] {
            assert_eq!(number(text).nearest(), value, "{text}");
        }
        assert!(number("-0").nearest().is_sign_negative());
        assert_eq!(number("1e999999").nearest(), f64::INFINITY);
        for text in [
            "", ".", "-", "e5", "1e", "1e5.5", "1,5", "1_0", "inf", "0x1", "1.2.3", "--1",
        ] {
            assert_eq!(Decimal::parse(text), None, "{text}");
        }
    }

    #[test]
    fn whole_numbers_are_exact() {
        for (text, n) in [
            ("1e4", 10_000),
            ("1.5e3", 1_500),
            ("0.00", 0),
            ("007", 7),
            ("18446744073709551615", u64::MAX),
            ("1000e-3", 1),
        ] {
            assert_eq!(number(text).whole(), Some(n), "{text}");
        }
        for text in [
            "1.5",
            "-1",
            "18446744073709551616",
            "1e20",
            "1e-1",
            "1e999999",
        ] {
            assert_eq!(number(text).whole(), None, "{text}");
        }
    }

    /// Expected values: Python's `float(Fraction(text) * factor / divisor)`, which rounds exact
    /// rational numbers correctly.
    #[test]
    fn quotients_are_the_nearest_doubles() {
        for (text, factor, shift, divisor, bits) in [
            ("0.1", "254", -4, 1, 0x3f64cec41dd1a21f),
            ("0.1", "254", -4, 254, 0x3ee4f8b588e368f1),
            ("1", "1", 0, 254, 0x3f70204081020408),
            ("1", "10000", 0, 254, 0x4043af5ebd7af5ec),
            ("632.8", "1", -9, 1, 0x3ea53bb5ea8666cf),
            ("3.7", "1000", 0, 25400, 0x3fc2a54a952a54a9),
            ("1e-300", "1", -20, 64516, 0x0000000000000000),
            ("-12.345678901234567", "10000", 0, 254, 0xc07e60ce3c43f0ae),
            ("7", "254", -4, 3, 0x3fae583356270c6d),
            ("0.3", "1", 0, 127, 0x3f6359e701359e70),
            ("2.5400000000000001", "10000", 0, 254, 0x4059000000000000),
        ] {
            let value = number(text).times(factor).shifted(shift).over(divisor);
            assert_eq!(value.nearest().to_bits(), bits, "{text} {factor} {divisor}");
        }
    }

    /// A quotient just beside the middle of two doubles: 1 + 2⁻⁵³ ± 1/(3·10⁶⁰).
    #[test]
    fn what_lies_beside_a_tie_falls_to_its_side() {
        // 1 + 2⁻⁵³ in decimal, exactly, with zeros to 60 places.
        let tie = "1.000000000000000111022302462515654042363166809082031250000000";
        let thrice = number(tie).times("3");
        assert_eq!(thrice.over(3).nearest(), 1.0, "ties go to even");
        let mut above = thrice.clone();
        *above.digits.last_mut().unwrap() += 1;
        assert_eq!(above.over(3).nearest(), 1.0 + f64::EPSILON);
        let below = number("1.000000000000000111022302462515654042363166809082031249999999");
        let below = below.times("7").over(7);
        assert_eq!(below.nearest(), 1.0);
    }
}
