//! Guards of one step: touches within rounding, terms that grow.

use super::*;

#[test]
fn a_guard_that_swings_with_the_states_is_clear_though_its_terms_grow() {
    // 1 + a cos(ω t) on a step of 6/ω: its fifth term is 1.8 times the third.
    let (a, phase, h) = (1e-4, 1.0_f64, 6.0);
    let derivatives = [phase.cos(), -phase.sin(), -phase.cos(), phase.sin()];
    let mut factorial = 1.0;
    let mut c: Vec<f64> = (0..=FIRST_LOOK)
        .map(|k| {
            factorial *= k.max(1) as f64;
            a * derivatives[k % 4] / factorial
        })
        .collect();
    c[0] += 1.0;
    let mut guards = GuardSeries::<[f64; 1], f64>::new(1, FIRST_LOOK + 1);
    guards.start()[0] = c[0];
    guards.low().iter_mut().zip(&c).for_each(|(g, c)| g[0] = *c);
    let end = 1.0 + a * (phase + h).cos();
    let is_clear = |explained| guards.look(0, h, FIRST_LOOK, (end, 0.0), explained).0;
    assert!(!is_clear(0.0));
    assert!(is_clear(c[FIRST_LOOK]) && is_clear(0.9 * c[FIRST_LOOK]));
}

#[test]
fn touches_within_rounding_end_the_search() {
    let bound = 1e-12;
    for touch in [0.1, 0.3, 0.7, 0.9] {
        for size in [1e-10, 1e-12, 1e-14, 1e-16, 1e-20] {
            for off in [-1.0, 0.0, 1.0] {
                // −bound/2 + size (s − touch)², lifted by the last bits of −bound/2.
                let c = [size * touch * touch, -2.0 * size * touch, size];
                let lift = off * f64::EPSILON * bound;
                let p = Polynomial::new(c.into_iter()).raised(-0.5 * bound).raised(lift);
                assert!(fall_of(&p, bound).is_none_or(|fall| !fall.rises), "{touch} {size:e}");
            }
        }
    }
    let falls = Polynomial::new([1e-12, -4e-12].into_iter());
    let found = fall_of(&falls, bound);
    assert!(found.is_some_and(|fall| (fall.at - 0.375).abs() < 1e-12 && !fall.rises), "{found:?}");
}

/// `20 ((s − a)² − d²)(1 − s/b)`, which falls at a − d, rises at a + d, and falls for good at b.
fn dip_and_fall(a: f64, d: f64, b: f64) -> Polynomial {
    let square = [a * a - d * d, -2.0 * a, 1.0, 0.0];
    let before = [0.0, square[0], square[1], square[2]];
    let c: [f64; 4] = std::array::from_fn(|k| 20.0 * (square[k] - before[k] / b));
    Polynomial::new(c.into_iter())
}

#[test]
fn a_dip_is_found_wherever_its_fall_is_rounded_to() {
    for n in 0..2000 {
        let (a, d) = (0.2 + 1e-4 * f64::from(n), 1e-4);
        let found = fall_of(&dip_and_fall(a, d, 0.9), 1e-15);
        let Some(Fall { at, deepest, rises: true }) = found else { panic!("{n}: {found:?}") };
        assert!((at - (a - d)).abs() < 1e-9 && (deepest - a).abs() < 1e-3 * d, "{n}");
    }
}

#[test]
fn a_dip_between_the_bound_and_its_half_is_passed_over() {
    // Its depth is 0.7 times the bound.
    let (d, b) = (1e-4, 0.9);
    let depth = 20.0 * d * d * (1.0 - 0.3 / b);
    let found = fall_of(&dip_and_fall(0.3, d, b), depth / 0.7);
    let Some(Fall { at, rises: false, .. }) = found else { panic!("{found:?}") };
    assert!((at - b).abs() < 1e-6, "{at}");
}
