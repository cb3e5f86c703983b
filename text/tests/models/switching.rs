//! The thermostat, the neuron, the converter, and van der Pol's oscillator without any event.

use deltazero_solvers::problems::{Heater, Thermostat};

use super::arcs::bisect;
use super::oscillator::Oscillator;
use super::runs::{METHODS, Run, below, distance, latest, model, of, parameter, t_end};

#[test]
fn the_thermostat_switches_as_in_closed_form() {
    let name = "thermostat";
    let [heat_capacity, conductance, power] = ["C", "G", "P"].map(|own| parameter(name, own));
    let [outside, low, high, start] =
        ["T_out", "T_low", "T_high", "T_0"].map(|own| parameter(name, own));
    let heater = Heater::On;
    let room = Thermostat { heat_capacity, conductance, power, outside, low, high, start, heater };
    let exact: Vec<f64> = room.pieces(t_end(name))[1..].iter().map(|piece| piece.t).collect();
    let model = model(name, &[]);
    for method in METHODS.into_iter().chain(["bdf"]) {
        let run = Run::by(&model, method, 1e-10, t_end(name));
        let times: Vec<f64> = run.changes.iter().map(|change| change.t).collect();
        let late = latest(&times, &exact);
        let off = distance(&model, &run.y, &room.state(t_end(name)));
        // Measured: 8.2e-8 s (rodas5p), 1.1e-5 s (radau5), 4.7e-6 s (bdf); of the end a thousandth of it.
        let late_bound = of(method, [8e-7, 1e-4, 4e-5]);
        below(&format!("{method} {} switches [s]", exact.len()), late, late_bound);
        below(&format!("{method} end"), off, 1e-3 * late_bound);
    }
}

/// The membrane charges towards `V_∞ = E_L + R I`: from V to the threshold in `τ ln((V_∞ − V)/(V_∞ − V_th))`.
#[test]
fn the_neuron_fires_as_often_as_its_closed_form_and_counts_its_spikes() {
    let name = "integrate_and_fire";
    let [tau, r, i, rest] = ["tau", "R", "I", "E_L"].map(|own| parameter(name, own));
    let [threshold, reset, pause] = ["V_th", "V_r", "t_ref"].map(|own| parameter(name, own));
    let end = rest + r * i;
    let charge = |from: f64| tau * libm::log((end - from) / (end - threshold));
    let (first, interval) = (charge(rest), pause + charge(reset));
    let count = 1 + ((t_end(name) - first) / interval) as usize;
    let exact: Vec<f64> = (0..count).map(|n| first + n as f64 * interval).collect();
    let model = model(name, &[]);
    for method in METHODS.into_iter().chain(["bdf"]) {
        let run = Run::by(&model, method, 1e-10, t_end(name));
        let late = latest(&run.times_of("refractory"), &exact);
        // Measured: 4.0e-12 s (dop853), 9.2e-11 s (radau5), 2.0e-9 s (bdf).
        let bound = of(method, [4e-11, 9e-10, 2e-8]);
        below(&format!("{method} {count} spikes [s]"), late, bound);
        assert_eq!(observed(&model, &run, "spikes"), count as f64);
    }
}

/// The last value of a column.
fn observed(model: &deltazero_text::TextModel, run: &Run, name: &str) -> f64 {
    use deltazero_study::Problem as _;
    let index = model.columns(0).iter().position(|column| column.name == name).unwrap();
    let mut value = f64::NAN;
    let end = &run.end;
    model.rows(&end.mode, end.t, &end.y, &mut |_, row| value = row[index]);
    value
}

/// The part of a period that a run of the converter goes on after the last whole one.
const LAST: f64 = 0.2;

/// Current and voltage of the converter period by period, each phase in closed form: `LC v̈ + (L/R) v̇ + v = E`.
fn converter(periods: usize) -> (Vec<f64>, [f64; 2]) {
    let name = "buck_converter";
    let [e, l, c, r] = ["V_in", "L", "C", "R"].map(|own| parameter(name, own));
    let [period, duty] = ["T", "duty"].map(|own| parameter(name, own));
    let phase = |source: f64, t_0: f64, [i, v]: [f64; 2], t: f64| {
        let own = Oscillator {
            mass: l * c,
            damping: l / r,
            stiffness: 1.0,
            force: [source, 0.0, 0.0],
            frequency: 0.0,
        };
        let [v, v_dot] = own.flow(t_0, [v, (i - v / r) / c], t);
        [c * v_dot + v / r, v]
    };
    let (mut y, mut events) = ([0.0, 0.0], Vec::new());
    for k in 0..periods {
        let [begin, off, end] = [0.0, duty, 1.0].map(|part| (k as f64 + part) * period);
        y = phase(e, begin, y, off);
        events.push(off);
        let at = |t: f64| phase(0.0, off, y, t);
        if at(end)[0] < 0.0 {
            let dry = bisect(off, end, |t| at(t)[0] < 0.0);
            events.push(dry);
            y = [0.0, at(dry)[1] * libm::exp((dry - end) / (r * c))];
        } else {
            y = at(end);
        }
        events.push(end);
    }
    let begin = periods as f64 * period;
    (events, phase(e, begin, y, begin + LAST * period))
}

#[test]
fn the_converter_switches_as_in_closed_form_from_inrush_to_discontinuous_conduction() {
    let name = "buck_converter";
    let period = parameter(name, "T");
    let periods = (t_end(name) / period).round() as usize;
    let (exact, y) = converter(periods);
    let model = model(name, &[]);
    for method in METHODS {
        let run = Run::by(&model, method, 1e-10, (periods as f64 + LAST) * period);
        let times: Vec<f64> = run.changes.iter().map(|change| change.t).collect();
        let late = latest(&times, &exact);
        let off = distance(&model, &run.y, &y);
        // Measured: 5.8e-16 s; 5.0e-14 (rodas5p) and 2.0e-11 (radau5).
        below(&format!("{method} {} switches [s]", exact.len()), late, 5e-15);
        below(&format!("{method} end"), off, of(method, [5e-13, 2e-10, 0.0]));
    }
    let idle = exact.len() - 2 * periods;
    assert!(idle > 10 && idle < periods, "{idle}");
}

/// Erickson and Maksimović, chapter 5: `v/V_in = 2/(1 + √(1 + 4K/D²))`, K = 2L/(RT), for a small ripple.
#[test]
fn the_voltage_of_the_converter_is_that_of_discontinuous_conduction() {
    let name = "buck_converter";
    let [e, l, r] = ["V_in", "L", "R"].map(|own| parameter(name, own));
    let [period, duty] = ["T", "duty"].map(|own| parameter(name, own));
    let run = Run::by(&model(name, &[]), "dop853", 1e-9, 0.02);
    let k = 2.0 * l / (r * period);
    let exact = 2.0 * e / (1.0 + (1.0 + 4.0 * k / (duty * duty)).sqrt());
    // Measured: 3.3e-4.
    below("voltage", (run.y[1] / exact - 1.0).abs(), 3e-3);
}

/// F. Mazzia, C. Magherini, *Test Set for Initial Value Problem Solvers*, release 2.4 (2008), problem VDPOL in its
/// unscaled form: computed there with RADAU in quadruple precision.
#[test]
fn van_der_pol_ends_where_the_test_set_says() {
    let model = model("van_der_pol", &[]);
    for method in ["radau5", "rodas5p", "bdf", "auto"] {
        let run = Run::by(&model, method, 1e-9, t_end("van_der_pol"));
        let published = [1.706_167_732_170_469, -0.892_809_701_024_812_5e-3];
        let off = distance(&model, &run.y, &published);
        // Measured: 1.2e-9 (rodas5p), 7.0e-10 (radau5), 2.3e-8 (bdf).
        below(&format!("{method} end"), off, of(method, [1e-8, 7e-9, 2e-7]));
    }
}
