//! Quadrature: Gauss–Legendre rules.

/// Nodes and weights of a rule on [0, 1]; the weights add up to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Positions in (0, 1), ascending.
    pub nodes: Vec<f64>,
    /// Weights, positive.
    pub weights: Vec<f64>,
}

impl Rule {
    /// The n-point Gauss–Legendre rule, exact for polynomials of degree 2n − 1.
    ///
    /// The nodes are the roots of P_n, found by Newton's method from the Chebyshev-like guess
    /// cos(π(i + ¾)/(n + ½)); the weights are 2/((1 − x²)·P'_n(x)²), halved for the unit interval.
    ///
    /// # Panics
    /// If `n` is 0.
    pub fn gauss_legendre(n: usize) -> Self {
        assert!(n > 0, "a quadrature rule needs at least one node");
        let mut nodes = vec![0.0; n];
        let mut weights = vec![0.0; n];
        for i in 0..n.div_ceil(2) {
            let mut x = libm::cos(std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5));
            let mut slope = 1.0;
            for _ in 0..100 {
                let (p, d) = legendre(n, x);
                slope = d;
                let step = p / d;
                x -= step;
                if step.abs() <= 1e-16 {
                    break;
                }
            }
            let weight = 1.0 / ((1.0 - x * x) * slope * slope);
            nodes[i] = 0.5 * (1.0 - x);
            nodes[n - 1 - i] = 0.5 * (1.0 + x);
            weights[i] = weight;
            weights[n - 1 - i] = weight;
        }
        if n % 2 == 1 {
            nodes[n / 2] = 0.5;
        }
        Self { nodes, weights }
    }

    /// Node–weight pairs mapped to [a, b]; the weights then add up to b − a.
    pub fn on(&self, a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.nodes
            .iter()
            .zip(&self.weights)
            .map(move |(x, w)| (a + (b - a) * x, (b - a) * w))
    }
}

/// P_n(x) and P'_n(x) by the three-term recurrence.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut now) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (before, now) = (now, ((2.0 * k - 1.0) * x * now - (k - 1.0) * before) / k);
    }
    let slope = n as f64 * (x * now - before) / (x * x - 1.0);
    (now, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫₀¹ x^k dx = 1/(k + 1) for all k < 2n.
    #[test]
    fn polynomials_up_to_degree_2n_minus_1_are_exact() {
        for n in 1..=24 {
            let rule = Rule::gauss_legendre(n);
            for k in 0..2 * n {
                let sum: f64 = rule
                    .on(0.0, 1.0)
                    .map(|(x, w)| w * x.powi(i32::try_from(k).unwrap()))
                    .sum();
                let exact = 1.0 / (k as f64 + 1.0);
                assert!(
                    (sum - exact).abs() < 1e-14,
                    "n {n}, degree {k}: {sum} for {exact}"
                );
            }
        }
    }

    /// The published three-point rule: nodes ½(1 ± √(3/5)), weights 5/18, 8/18, 5/18.
    #[test]
    fn three_points_are_the_tabulated_ones() {
        let rule = Rule::gauss_legendre(3);
        let outer = 0.5 * (1.0 - 0.6f64.sqrt());
        for (got, want) in rule.nodes.iter().zip([outer, 0.5, 1.0 - outer]) {
            assert!((got - want).abs() < 1e-15);
        }
        for (got, want) in rule
            .weights
            .iter()
            .zip([5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0])
        {
            assert!((got - want).abs() < 1e-15);
        }
    }
}
