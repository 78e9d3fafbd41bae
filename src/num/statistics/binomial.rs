//! The binomial distribution.

/// The counts between which a binomial variable of `n` trials and probability `p` lies with
/// probability ≥ `level`, cut off equally at both ends: the smallest k with P(X ≤ k) > ½(1 − level)
/// and the smallest with P(X ≤ k) ≥ ½(1 + level). Exact sums of the probabilities n!/(k!(n −
/// k)!)·pᵏ(1 − p)ⁿ⁻ᵏ.
pub fn binomial_interval(n: u64, p: f64, level: f64) -> [u64; 2] {
    let ln_factorial = |k: u64| libm::lgamma(k as f64 + 1.0);
    let probability = |k: u64| {
        if p <= 0.0 || p >= 1.0 {
            return f64::from(u8::from(k == if p >= 1.0 { n } else { 0 }));
        }
        let choose = ln_factorial(n) - ln_factorial(k) - ln_factorial(n - k);
        libm::exp(choose + k as f64 * libm::log(p) + (n - k) as f64 * libm::log1p(-p))
    };
    let tail = 0.5 * (1.0 - level);
    let (mut sum, mut low) = (0.0, None);
    for k in 0..=n {
        sum += probability(k);
        if low.is_none() && sum > tail {
            low = Some(k);
        }
        if sum >= 1.0 - tail {
            return [low.unwrap_or(k), k];
        }
    }
    [low.unwrap_or(n), n]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten throws of a coin: P(X ≤ 1) = 11/1024, P(X ≤ 2) = 56/1024; by hand the 95 % interval is 2
    /// … 8. A certain event.
    #[test]
    fn small_cases_are_those_of_pascals_triangle() {
        assert_eq!(binomial_interval(10, 0.5, 0.95), [2, 8]);
        // 11/1024 = 0.0107 is above 0.005, 1/1024 below: the 99 % interval starts at 1.
        assert_eq!(binomial_interval(10, 0.5, 0.99), [1, 9]);
        assert_eq!(binomial_interval(7, 0.0, 0.99), [0, 0]);
        assert_eq!(binomial_interval(7, 1.0, 0.99), [7, 7]);
    }
}
