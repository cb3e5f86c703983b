// Boost.Numeric.Odeint: both joints as one system of twelve states, by dopri5 with dense output and by
// Fehlberg 7(8) stopped at the samples. Naive: it has no events. One absolute tolerance for all states:
// rtol times the clearance.
#include <boost/numeric/odeint.hpp>
#include <boost/version.hpp>

#include "../common/peer.hpp"

namespace ode = boost::numeric::odeint;

using Pair = std::array<double, 12>;

struct Rhs {
    Both& both;
    void operator()(const Pair& y, Pair& dydt, double) const {
        for (int j = 0; j < 2; ++j) {
            if (++both.tracks[j].n_rhs > MAX_RHS) throw std::runtime_error("too many right-hand sides");
            double* slope = Both::part(j, dydt.data());
            both.joints[j].naive(Both::part(j, y.data()), slope);
        }
    }
};

static double atol(const Both& both, double rtol) { return rtol * both.joints[0].c; }

static Pair start(const Both& both) {
    Pair y;
    for (int j = 0; j < 2; ++j) {
        const State own = both.joints[j].start();
        std::copy(own.begin(), own.end(), Both::part(j, y.data()));
    }
    return y;
}

static void look(const Both& both, double t, const Pair& y) {
    for (int j = 0; j < 2; ++j) both.tracks[j].look(both.joints[j], t, Both::part(j, y.data()));
}

static void dopri5(double rtol, Track tracks[2]) {
    Both both(tracks);
    auto stepper = ode::make_dense_output(atol(both, rtol), rtol, ode::runge_kutta_dopri5<Pair>());
    stepper.initialize(start(both), 0.0, 1e-6);
    while (!both.done()) {
        stepper.do_step(Rhs{both});
        const double t = stepper.current_time();
        while (both.next_sample() <= t) {
            Pair y;
            stepper.calc_state(both.next_sample(), y);
            both.sample(y.data());
        }
        look(both, t, stepper.current_state());
    }
}

static void fehlberg78(double rtol, Track tracks[2]) {
    Both both(tracks);
    auto stepper = ode::make_controlled(atol(both, rtol), rtol, ode::runge_kutta_fehlberg78<Pair>());
    Pair y = start(both);
    double t = 0.0, h = 1e-6;
    while (!both.done()) {
        const double at = both.next_sample(), own = h;
        const bool cut = t + h >= at;
        double taken = cut ? at - t : h;
        if (stepper.try_step(Rhs{both}, y, t, taken) != ode::success) {
            h = taken;
            continue;
        }
        // A step cut short for a sample says nothing against the step of before.
        h = cut && taken < own ? own : taken;
        look(both, t, y);
        if (cut) {
            t = at;
            both.sample(y.data());
        }
    }
}

int main(int, char** arguments) {
    const std::string version = std::to_string(BOOST_VERSION / 100000) + "." +
                                std::to_string(BOOST_VERSION / 100 % 1000);
    ladder("boost odeint", version, "dopri5", "naive", arguments[1], dopri5);
    ladder("boost odeint", version, "fehlberg78", "naive", arguments[1], fehlberg78);
}
