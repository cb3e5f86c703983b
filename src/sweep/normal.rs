//! The quantile of the normal distribution.
#![allow(clippy::excessive_precision, reason = "coefficients as the source prints them")]

/// `x` with `Φ(x) = p` for the standard normal distribution function Φ, 0 < p < 1; relative error some 1e-16.
///
/// M. J. Wichura, "Algorithm AS 241: the percentage points of the normal distribution", Applied Statistics 37(3),
/// 477–484 (1988), function PPND16: a rational function of p in the middle, of `√(−ln p)` in either tail.
pub(super) fn quantile(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        return q * CENTRE.at(0.180625 - q * q);
    }
    let r = libm::sqrt(-libm::log(if q < 0.0 { p } else { 1.0 - p }));
    let x = if r <= 5.0 { MIDDLE.at(r - 1.6) } else { TAIL.at(r - 5.0) };
    if q < 0.0 { -x } else { x }
}

/// Coefficients of numerator and denominator, the highest power first.
struct Rational {
    above: [f64; 8],
    below: [f64; 8],
}

impl Rational {
    fn at(&self, r: f64) -> f64 {
        let horner = |all: &[f64; 8]| all.iter().fold(0.0, |sum, c| sum * r + c);
        horner(&self.above) / horner(&self.below)
    }
}

/// |p − 1/2| ≤ 0.425.
const CENTRE: Rational = Rational {
    above: [
        2.5090809287301226727e3,
        3.3430575583588128105e4,
        6.7265770927008700853e4,
        4.5921953931549871457e4,
        1.3731693765509461125e4,
        1.9715909503065514427e3,
        1.3314166789178437745e2,
        3.3871328727963666080,
    ],
    below: [
        5.2264952788528545610e3,
        2.8729085735721942674e4,
        3.9307895800092710610e4,
        2.1213794301586595867e4,
        5.3941960214247511077e3,
        6.8718700749205790830e2,
        4.2313330701600911252e1,
        1.0,
    ],
};

/// √(−ln p) ≤ 5.
const MIDDLE: Rational = Rational {
    above: [
        7.74545014278341407640e-4,
        2.27238449892691845833e-2,
        2.41780725177450611770e-1,
        1.27045825245236838258,
        3.64784832476320460504,
        5.76949722146069140550,
        4.63033784615654529590,
        1.42343711074968357734,
    ],
    below: [
        1.05075007164441684324e-9,
        5.47593808499534494600e-4,
        1.51986665636164571966e-2,
        1.48103976427480074590e-1,
        6.89767334985100004550e-1,
        1.67638483018380384940,
        2.05319162663775882187,
        1.0,
    ],
};

/// Beyond.
const TAIL: Rational = Rational {
    above: [
        2.01033439929228813265e-7,
        2.71155556874348757815e-5,
        1.24266094738807843860e-3,
        2.65321895265761230930e-2,
        2.96560571828504891230e-1,
        1.78482653991729133580,
        5.46378491116411436990,
        6.65790464350110377720,
    ],
    below: [
        2.04426310338993978564e-15,
        1.42151175831644588870e-7,
        1.84631831751005468180e-5,
        7.86869131145613259100e-4,
        1.48753612908506148525e-2,
        1.36929880922735805310e-1,
        5.99832206555887937690e-1,
        1.0,
    ],
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantile_has_its_probability() {
        let mut worst: f64 = 0.0;
        for k in 1..2000 {
            let p = if k < 1000 {
                f64::from(k) / 2000.0
            } else {
                libm::exp(-0.037 * f64::from(k - 999))
            };
            // Φ(x) = erfc(−x/√2)/2, whose relative condition is some x² in the tail.
            let x = quantile(p);
            let off = 0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2) / p - 1.0;
            worst = worst.max(off.abs() / (1.0 + x * x));
        }
        // Measured: 6.8e-16, by the errors of erfc.
        assert!(worst < 6e-15, "{worst:e}");
        assert_eq!(quantile(0.5), 0.0);
        assert_eq!(quantile(0.25), -quantile(0.75));
    }
}
