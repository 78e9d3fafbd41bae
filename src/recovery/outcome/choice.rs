//! The parameter of a recovery, how it was chosen, and how entries are weighted.

/// A regularisation parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Parameter {
    /// The method has none.
    None,
    /// Singular directions kept.
    Rank(usize),
    /// Tikhonov's λ, as a fraction of the largest singular value: of D, or of the standard form of
    /// `tikhonov-gradient`.
    Damping(f64),
    /// λ of the total variation, as a fraction of the largest squared singular value of the
    /// weighted operator.
    TotalVariation(f64),
    /// Of `joint-gp`, the likeliest pair: standard deviation τ of the reflectances about their
    /// mean, and length ℓ over which they resemble one another, in the unit of the places.
    GaussianProcess {
        /// τ.
        spread: f64,
        /// ℓ.
        length: f64,
    },
    /// The two reflectances.
    Levels([f64; 2]),
}

/// Why the parameter has its value. Norms are Frobenius norms over pixels and spots, W.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Choice {
    /// The caller gave it.
    Given,
    /// The discrepancy principle: the strongest regularisation whose residual the noise explains.
    Discrepancy {
        /// ‖Φ P − Φ‖, what the regularised projector P leaves over.
        residual: f64,
        /// √E‖noise left over‖²: what noise alone should leave over, √Σ σ²\[p,l\] (1 − leverage_l).
        target: f64,
        /// The target two standard deviations of ‖noise‖² up: residuals to here are accepted.
        limit: f64,
    },
    /// The largest evidence: the λ of `joint-tv` at which the photographs are likeliest, whatever
    /// the picture.
    Evidence {
        /// −2 ln of it, but for a constant.
        deviance: f64,
        /// ‖R ρ − d‖², what the reduced problem leaves over, in variances of the noise.
        residual: f64,
        /// Patches of one value.
        patches: usize,
    },
    /// The likeliest of all that count, each by its evidence: the picture is their mean.
    Averaged {
        /// √ of the mean over the elements of E(ρ − ρ̂)²/σ², σ the standard errors, were
        /// neighbours not alike: how many times too small these then are. None where the
        /// photographs speak against that.
        if_unalike: Option<f64>,
        /// Probability that all is of one reflectance, one of fifty beforehand, and how many times
        /// too small the standard errors are if it is not. None where that counts for nothing.
        if_uneven: Option<[f64; 2]>,
    },
    /// Estimated together with the reflectances.
    Estimated,
    /// Generalised cross-validation: the least predicted error.
    Gcv {
        /// ‖Φ P − Φ‖, what the regularised projector P leaves over.
        residual: f64,
        /// Degrees of freedom that P leaves in each pixel's row, l − tr P.
        freedom: f64,
        /// The root of the score V: the error with which an entry is predicted from the others, W.
        predicted: f64,
    },
    /// The corner of the L-curve.
    LCurve {
        /// ‖Φ P − Φ‖.
        residual: f64,
        /// What is weighed against it: ‖X‖ (C times ρ), or the norm of the differences, of
        /// `tikhonov-gradient`.
        penalty: f64,
        /// How sharp the corner is: the angle by which the log–log curve turns there, rad.
        turn: f64,
    },
    /// A numerical rank cut.
    Tolerance {
        /// Singular values at or below this count as zero, in the unit of the matrix decomposed.
        cutoff: f64,
    },
    /// Nothing was cut and nothing chosen.
    None,
}

/// How the entries of Φ were weighted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weighting {
    /// All alike.
    Unweighted,
    /// By w_p v_l, fitted to 1/σ².
    Separable {
        /// Root mean square of ln σ\[p,l\] about the fit: 0 where σ² is separable, and then no
        /// weights are more efficient.
        misfit: f64,
    },
    /// By 1/σ²\[p,l\] itself; where σ is zero, by the separable fit.
    EntryByEntry,
}
