//! Each operation as machine code, against the same in Rust, to the bit.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test panics to fail")]

use deltazero_machine::{Error, Function, Number, Routine, Shape};

/// Numbers of every kind, ordinary and not.
const NUMBERS: [f64; 14] = [
    0.0,
    -0.0,
    1.0,
    -2.5,
    1e-310,
    -3e-320,
    1e300,
    -7.25e-200,
    std::f64::consts::PI,
    1.0 + 1.0 / (1 << 30) as f64,
    -1.0 + 1.0 / (1 << 30) as f64,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

const OF_TWO: Shape = Shape { n_states: 2, n_held: 0, n_first: 1, n_second: 0 };

/// Bits of a number; one for all that are none.
fn bits(x: f64) -> u64 {
    if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() }
}

/// Compares an operation of two numbers, all pairs of them.
fn compare(
    name: &str,
    write: impl FnOnce(&mut Function<'_>, Number, Number) -> Number,
    rust: impl Fn(f64, f64) -> f64,
) {
    let routine = Routine::new(OF_TWO, |f| {
        let (a, b) = (f.state(0), f.state(1));
        let result = write(f, a, b);
        f.write_first(0, result);
    })
    .unwrap();
    for (a, b) in NUMBERS.iter().flat_map(|a| NUMBERS.map(|b| (*a, b))) {
        let mut result = [0.0];
        routine.call(0.0, &[a, b], &[], &mut result, &mut []);
        assert_eq!(bits(result[0]), bits(rust(a, b)), "{name} of {a:e} and {b:e}: {result:?}");
    }
}

#[test]
fn operations_have_the_bits_of_rust() {
    compare("a + b", |f, a, b| f.add(a, b), |a, b| a + b);
    compare("a − b", |f, a, b| f.subtract(a, b), |a, b| a - b);
    compare("a b", |f, a, b| f.multiply(a, b), |a, b| a * b);
    compare("a/b", |f, a, b| f.divide(a, b), |a, b| a / b);
    compare("−a", |f, a, _| f.negative(a), |a, _| -a);
    compare("√a", |f, a, _| f.sqrt(a), |a, _| a.sqrt());
    compare("a < b", |f, a, b| f.if_less([a, b], b, a), |a, b| if a < b { b } else { a });
    compare("a = a", |f, a, b| f.if_number(a, b, a), |a, b| if a.is_nan() { a } else { b });
    // Fused, (1 + 2⁻³⁰)(−1 + 2⁻³⁰) + (1 + 2⁻³⁰) would be 2⁻⁶⁰ off.
    compare(
        "a b + a",
        |f, a, b| {
            let product = f.multiply(a, b);
            f.add(product, a)
        },
        |a, b| a * b + a,
    );
}

extern "C" fn cube(x: f64) -> f64 {
    x * x * x
}

extern "C" fn less_twice(x: f64, y: f64) -> f64 {
    x - 2.0 * y
}

extern "C" fn halves(x: f64, both: &mut [f64; 2]) {
    *both = [0.5 * x, -0.5 * x];
}

#[test]
fn functions_are_called_where_they_are() {
    compare("cube", |f, a, _| f.call(cube, a), |a, _| cube(a));
    compare("less twice", |f, a, b| f.call_of_two(less_twice, [a, b]), |a, b| less_twice(a, b));
    compare(
        "halves",
        |f, a, b| {
            let [up, down] = f.call_for_two(halves, a);
            let [other, _] = f.call_for_two(halves, b);
            let first = f.subtract(up, other);
            f.multiply(first, down)
        },
        |a, b| (0.5 * a - 0.5 * b) * (-0.5 * a),
    );
}

#[test]
fn everything_is_read_and_written_at_its_place() {
    let shape = Shape { n_states: 3, n_held: 2, n_first: 2, n_second: 3 };
    let routine = Routine::new(shape, |f| {
        let (t, y, k) = (f.time(), f.state(2), f.held(1));
        let c = f.constant(0.25);
        f.write_first(1, y);
        f.write_second(0, k);
        f.write_second(2, t);
        f.write_first(0, c);
        let sum = f.add(t, k);
        f.write_second(1, sum);
    })
    .unwrap();
    let (mut first, mut second) = ([0.0; 2], [0.0; 4]);
    routine.call(1.5, &[7.0, 8.0, 9.0], &[3.0, 4.0], &mut first, &mut second);
    assert_eq!((first, second), ([0.25, 9.0], [4.0, 5.5, 1.5, 0.0]));
}

/// More numbers than the processor has registers, alive across a call.
#[test]
fn many_numbers_are_kept() {
    const N: usize = 100;
    let shape = Shape { n_states: N, n_first: 1, ..Shape::default() };
    let routine = Routine::new(shape, |f| {
        let numbers: Vec<_> = (0..N).map(|i| f.state(i)).collect();
        let mut sum = f.call(cube, numbers[0]);
        for number in numbers {
            sum = f.add(sum, number);
        }
        f.write_first(0, sum);
    })
    .unwrap();
    let y: Vec<f64> = (1..=N).map(|i| i as f64).collect();
    let mut result = [0.0];
    routine.call(0.0, &y, &[], &mut result, &mut []);
    assert_eq!(result, [5051.0]);
}

#[test]
fn several_threads_may_call_at_once() {
    let routine = Routine::new(OF_TWO, |f| {
        let (a, b) = (f.state(0), f.state(1));
        let result = f.multiply(a, b);
        f.write_first(0, result);
    })
    .unwrap();
    std::thread::scope(|scope| {
        for c in [1.0, 2.0, 3.0] {
            let routine = &routine;
            scope.spawn(move || {
                for i in 0..10_000 {
                    let (x, mut result) = (f64::from(i), [0.0]);
                    routine.call(0.0, &[x, c], &[], &mut result, &mut []);
                    assert_eq!(result, [c * x]);
                }
            });
        }
    });
}

/// What panics, and its message.
fn panic_of(of: impl FnOnce() + std::panic::UnwindSafe) -> String {
    let payload = std::panic::catch_unwind(of).expect_err("a panic");
    let text = payload.downcast_ref::<String>().cloned();
    text.or_else(|| payload.downcast_ref::<&str>().map(|text| (*text).to_owned())).unwrap()
}

#[test]
fn a_list_that_is_too_short_is_refused() {
    let shape = Shape { n_states: 2, n_held: 3, n_first: 4, n_second: 5 };
    let call = |lengths: [usize; 4]| {
        let routine = Routine::new(shape, |_| {}).unwrap();
        let [states, held, mut first, mut second] = lengths.map(|n| vec![0.0; n]);
        routine.call(0.0, &states, &held, &mut first, &mut second);
    };
    call([2, 3, 4, 5]);
    for lengths in [[1, 3, 4, 5], [2, 2, 4, 5], [2, 3, 3, 5], [2, 3, 4, 4]] {
        assert_eq!(
            panic_of(move || call(lengths)),
            "a list is shorter than that of the routine",
            "{lengths:?}"
        );
    }
}

#[test]
fn a_place_beyond_a_list_is_refused() {
    let shape = Shape { n_states: 2, n_held: 3, n_first: 4, n_second: 5 };
    let refused = |message: &str, use_place: fn(&mut Function<'_>)| {
        let found = panic_of(move || drop(Routine::new(shape, use_place)));
        assert_eq!(found, message);
    };
    refused("there are 2 states", |f| {
        let _ = f.state(2);
    });
    refused("there are 3 held values", |f| {
        let _ = f.held(3);
    });
    refused("there are 4 first results", |f| {
        let t = f.time();
        f.write_first(4, t);
    });
    refused("there are 5 second results", |f| {
        let t = f.time();
        f.write_second(5, t);
    });
}

#[test]
fn a_list_that_is_too_long_is_refused() {
    let shape = Shape { n_states: usize::MAX, ..OF_TWO };
    assert!(matches!(Routine::new(shape, |_| {}), Err(Error::TooLong)));
}
