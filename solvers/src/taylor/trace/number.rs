//! The scalar that notes what is computed with it.

use std::fmt;

use super::super::coefficient::Coefficient;
use super::super::recurrence::LARGEST_PRODUCT;
use super::Trace;
use super::notes::{CONSTANT, Derivative, Notes, Place, Term, Written};
use crate::real::{
    Divisor, Length, Real, Shortcuts, Turning, length_of_values, less_turning_of_values,
    turning_of_values,
};

/// A number that notes what is computed with it in the [trace](super) that it belongs to: a multiple of a result there, and
/// a constant. Constants belong to none.
#[derive(Clone, Copy)]
pub struct Noted<'a, B: Copy> {
    /// The value, by the same operations as without a trace.
    value: B,
    of: Option<Of<'a, B>>,
}

/// A multiple of a result in a trace.
#[derive(Clone, Copy)]
struct Of<'a, B: Copy> {
    trace: &'a Trace<B>,
    place: Place,
    factor: B,
}

impl<'a, B: Coefficient> Noted<'a, B> {
    /// A constant.
    pub(super) fn constant(value: B) -> Self {
        Self { value, of: None }
    }

    /// The result at `place`.
    pub(super) fn at(trace: &'a Trace<B>, place: Place, value: B) -> Self {
        Self { value, of: Some(Of { trace, place, factor: B::cst(1.0) }) }
    }

    /// Its value.
    pub(super) fn number(self) -> B {
        self.value
    }

    /// Place and factor of the number, which is the factor times the result there, and a constant.
    pub(super) fn term(self) -> Term<B> {
        self.times(B::cst(1.0))
    }

    /// The same of `factor` times the number.
    fn times(self, factor: B) -> Term<B> {
        self.of.map_or(Self::nothing(), |of| (of.place, of.factor * factor))
    }

    /// The same of a constant.
    fn nothing() -> Term<B> {
        (CONSTANT, B::cst(0.0))
    }

    pub(super) fn is_constant(self) -> bool {
        self.of.is_none()
    }

    /// The number of this `value` that differs by a constant.
    pub(super) fn shifted(self, value: B) -> Self {
        Self { value, ..self }
    }

    /// `factor` times this number, which is `value`.
    pub(super) fn scaled(self, value: B, factor: B) -> Self {
        Self { value, of: self.of.map(|of| Of { factor: of.factor * factor, ..of }) }
    }

    /// The result of this `value` that `note` notes, given its place.
    fn result(trace: &'a Trace<B>, value: B, note: impl FnOnce(&mut Notes<B>, Place)) -> Self {
        let mut notes = trace.notes.borrow_mut();
        let place = notes.place(value);
        note(&mut notes, place);
        Self::at(trace, place, value)
    }

    /// This number and `factor` times `other`, which is `value`.
    pub(super) fn with(self, other: Self, value: B, factor: B) -> Self {
        match (self.of, other.of) {
            (_, None) => self.shifted(value),
            (None, Some(_)) => other.scaled(value, factor),
            (Some(of), Some(_)) => Self::result(of.trace, value, |notes, to| {
                notes.operation(to, 0, [self.term(), other.times(factor)]);
            }),
        }
    }

    /// The product `value` of this number and `other`.
    pub(super) fn product(self, other: Self, value: B) -> Self {
        let (Some(a), Some(b)) = (self.of, other.of) else {
            return if self.is_constant() {
                other.scaled(value, self.value)
            } else {
                self.scaled(value, other.value)
            };
        };
        Self::result(a.trace, value, |notes, to| {
            let rows = [notes.row(a.place, Written::Plainly), notes.row(b.place, Written::Plainly)];
            let sum = notes.sum(rows, a.factor * b.factor);
            notes.sums.push(sum);
            notes.operation(to, sum.to, [self.times(other.value), other.times(self.value)]);
        })
    }

    /// The quotient `value` of this number and `by`, whose reciprocal is given.
    ///
    /// ```text
    /// b_0 c_k = a_k − c_0 b_k − Σ c_j b_(k−j)
    /// ```
    pub(super) fn quotient(self, by: Self, value: B, reciprocal: B) -> Self {
        let Some(b) = by.of else { return self.scaled(value, reciprocal) };
        Self::result(b.trace, value, |notes, to| {
            let rows = [notes.row(to, Written::Plainly), notes.row(b.place, Written::Plainly)];
            let sum = notes.sum(rows, -(reciprocal * b.factor));
            notes.sums.push(sum);
            let terms = [self.times(reciprocal), by.times(-(value * reciprocal))];
            notes.operation(to, sum.to, terms);
        })
    }

    /// A result whose derivative is noted later.
    fn integral(trace: &'a Trace<B>, value: B) -> Self {
        Self::result(trace, value, |_, _| ())
    }

    /// Notes that the result `rate` is the derivative of this result.
    fn has_derivative(self, rate: Self) {
        if let Some(of) = self.of {
            let (to, of_rate) = (of.place, rate.term().0);
            of.trace.notes.borrow_mut().derivatives.push(Derivative { to, of: of_rate });
        }
    }

    /// This number as a result of its own, whose value is noted too.
    fn as_result(self, trace: &'a Trace<B>) -> Self {
        Self::result(trace, self.value, |notes, to| {
            notes.operation(to, 0, [Self::nothing(), self.term()]);
        })
    }
}

impl<B: Coefficient> fmt::Debug for Noted<'_, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.of {
            None => write!(f, "{:?}", self.value),
            Some(of) => write!(f, "{:?} at {}", self.value, of.place),
        }
    }
}

impl<B: Coefficient> Real for Noted<'_, B> {
    fn cst(x: f64) -> Self {
        Self::constant(B::cst(x))
    }

    fn value(self) -> f64 {
        self.value.value()
    }

    /// `2 c_0 c_k = a_k − Σ c_j c_(k−j)`
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        let Some(a) = self.of else { return Self::constant(value) };
        let half = B::cst(0.5) / value;
        Self::result(a.trace, value, |notes, to| {
            let rows = [notes.row(to, Written::Plainly); 2];
            let sum = notes.sum(rows, -half);
            notes.sums.push(sum);
            notes.operation(to, sum.to, [Self::nothing(), self.times(half)]);
        })
    }

    /// `k s_k = Σ j a_j c_(k−j)` and `k c_k = −Σ j a_j s_(k−j)` over `j = 1 … k`
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        let Some(a) = self.of else { return (Self::constant(sin), Self::constant(cos)) };
        let mut notes = a.trace.notes.borrow_mut();
        let (to_sin, to_cos) = (notes.place(sin), notes.place(cos));
        let of = notes.row(a.place, Written::Weighed);
        let rows = [to_cos, to_sin].map(|other| [of, notes.row(other, Written::Plainly)]);
        for (to, rows, factor, weight) in
            [(to_sin, rows[0], cos, a.factor), (to_cos, rows[1], -sin, -a.factor)]
        {
            let sum = notes.sum(rows, weight);
            notes.of_integrals.push(sum);
            notes.operation(to, sum.to, [Self::nothing(), self.times(factor)]);
        }
        (Self::at(a.trace, to_sin, sin), Self::at(a.trace, to_cos, cos))
    }

    /// `k c_k = Σ j a_j c_(k−j)` over `j = 1 … k`
    fn exp(self) -> Self {
        let value = self.value.exp();
        let Some(a) = self.of else { return Self::constant(value) };
        Self::result(a.trace, value, |notes, to| {
            let rows = [notes.row(a.place, Written::Weighed), notes.row(to, Written::Plainly)];
            let sum = notes.sum(rows, a.factor);
            notes.of_integrals.push(sum);
            notes.operation(to, sum.to, [Self::nothing(), self.times(value)]);
        })
    }

    /// `a_0 c_k = a_k − Σ j c_j a_(k−j)/k`
    fn ln(self) -> Self {
        let value = self.value.ln();
        let Some(a) = self.of else { return Self::constant(value) };
        let reciprocal = B::cst(1.0) / self.value;
        Self::result(a.trace, value, |notes, to| {
            let rows = [notes.row(to, Written::Weighed), notes.row(a.place, Written::Plainly)];
            let sum = notes.sum(rows, -(reciprocal * a.factor));
            notes.of_integrals.push(sum);
            notes.operation(to, sum.to, [Self::nothing(), self.times(reciprocal)]);
        })
    }

    /// `k a_0 c_k = Σ (p (k − j) − j) c_j a_(k−j)` over `j < k`
    fn powf(self, p: f64) -> Self {
        let value = self.value.powf(p);
        let Some(a) = self.of else { return Self::constant(value) };
        if p == 0.0 || p == 1.0 {
            return if p == 0.0 { Self::cst(1.0) } else { self };
        }
        if (2.0..=LARGEST_PRODUCT).contains(&p) && p.fract() == 0.0 {
            // Unlike the recurrence, products have no singular point where the base is zero.
            return self.powi(p as u32).shifted(value);
        }
        let reciprocal = B::cst(1.0) / self.value;
        Self::result(a.trace, value, |notes, to| {
            let rows = [notes.row(to, Written::Plainly), notes.row(a.place, Written::Plainly)];
            let sum = notes.sum(rows, reciprocal * a.factor);
            notes.of_powers.push((sum, p));
            notes.operation(to, sum.to, [Self::nothing(), self.times(value * p * reciprocal)]);
        })
    }
}

impl<B: Coefficient> Shortcuts for Noted<'_, B> {
    fn divisor(self) -> Divisor<Self> {
        Divisor { value: self, reciprocal: Self::constant(B::cst(1.0) / self.value) }
    }

    fn over(self, by: &Divisor<Self>) -> Self {
        let reciprocal = by.reciprocal.value;
        self.quotient(by.value, self.value * reciprocal, reciprocal)
    }

    /// `ρ ρ̇ = d·v`, and ρ̇ is the derivative of ρ: neither squares nor a root are expanded.
    fn length([x, y]: [Self; 2], [v_x, v_y]: [Self; 2]) -> Length<Self> {
        let (Some(Of { trace, .. }), false) = (x.of, [y, v_x, v_y].iter().any(|x| x.is_constant()))
        else {
            return length_of_values([x, y], [v_x, v_y]);
        };
        let rho = B::length([x.value, y.value], [v_x.value, v_y.value]).rho;
        let value = Self::integral(trace, rho.value);
        let rho = Divisor { value, reciprocal: Self::constant(rho.reciprocal) };
        let rate = (x * v_x + y * v_y).over(&rho);
        rho.value.has_derivative(rate);
        Length { rho, rate }
    }

    /// Sine and cosine have their rates as derivatives, which have derivatives in turn.
    fn turning(arms: [Self; 2], [theta, omega]: [Self; 2]) -> Turning<Self> {
        let (Some(Of { trace, .. }), false, [true, true]) =
            (theta.of, omega.is_constant(), arms.map(Self::is_constant))
        else {
            return turning_of_values(arms, [theta, omega]);
        };
        let (sin, cos) = theta.value.sin_cos();
        let new = |value| Self::integral(trace, value);
        let rates = [new(cos * omega.value), new(-(sin * omega.value))];
        let (sin, cos) = (new(sin), new(cos));
        trace.notes.borrow_mut().open_curves += 1;
        Turning { sin, cos, along: [cos * arms[0], -(sin * arms[1])], rates, arms, omega }
    }

    /// With `s = sin θ` and `c = cos θ`: `s̈_k = (k + 1) ṡ_(k+1)`, and `ṡ = c θ̇`, of which the next order is known but for
    /// the one of θ̇, θ̈_k/(k + 1).
    fn less_turning(a: [Self; 2], turning: Turning<Self>, theta_dd: Self) -> [Self; 2] {
        let Turning { sin, cos, along, rates, arms, omega } = turning;
        let (Some(Of { trace, .. }), false, [true, true]) =
            (sin.of, omega.is_constant(), arms.map(Self::is_constant))
        else {
            return less_turning_of_values(a, [along, rates, arms], omega, theta_dd);
        };
        let [x, y] = less_turning_of_values(
            a.map(|a| a.value),
            [along, rates, arms].map(|pair| pair.map(|number| number.value)),
            omega.value,
            theta_dd.value,
        );
        let omega = Self::integral(trace, omega.value);
        omega.has_derivative(theta_dd.as_result(trace));
        // The second derivative from the factor, the rate of the factor, and the sign.
        let second = |factor: Self, rate: Self, sign: f64| {
            let value = (factor.value * theta_dd.value + omega.value * rate.value) * sign;
            Self::result(trace, value, |notes, to| {
                let rows = [factor, omega].map(|number| notes.row(number.term().0, Written::Early));
                let sum = notes.sum(rows, B::cst(sign));
                notes.ahead.push(sum);
                let terms = [theta_dd.times(factor.value * sign), rate.times(omega.value * sign)];
                notes.operation(to, sum.to, terms);
            })
        };
        let sin_dd = second(cos, rates[1], 1.0);
        let cos_dd = second(sin, rates[0], -1.0);
        sin.has_derivative(rates[0]);
        cos.has_derivative(rates[1]);
        rates[0].has_derivative(sin_dd);
        rates[1].has_derivative(cos_dd);
        trace.notes.borrow_mut().open_curves -= 1;
        [a[0].with(sin_dd, x, -arms[0].value), a[1].with(cos_dd, y, -arms[1].value)]
    }
}
