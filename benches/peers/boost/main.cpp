// Boost.Numeric.Odeint: dopri5 with dense output, and Fehlberg 7(8) stopped at the samples. Naive: it
// has no events. One absolute tolerance for all states: rtol times the clearance.
#include <boost/numeric/odeint.hpp>
#include <boost/version.hpp>

#include "../common/peer.hpp"

namespace ode = boost::numeric::odeint;

struct Rhs {
    const Joint& joint;
    Track& track;
    void operator()(const State& y, State& dydt, double) const {
        if (++track.n_rhs > MAX_RHS) throw std::runtime_error("too many right-hand sides");
        joint.naive(y, dydt);
    }
};

static void dopri5(const Joint& joint, double rtol, Track& track) {
    auto stepper = ode::make_dense_output(rtol * joint.c, rtol, ode::runge_kutta_dopri5<State>());
    stepper.initialize(joint.start(), 0.0, 1e-6);
    while (track.samples.size() < N_SAMPLES) {
        stepper.do_step(Rhs{joint, track});
        const double t = stepper.current_time();
        while (track.next_sample() <= t) {
            State y;
            stepper.calc_state(track.next_sample(), y);
            track.samples.push_back(y);
        }
        track.look(joint, t, stepper.current_state());
    }
}

static void fehlberg78(const Joint& joint, double rtol, Track& track) {
    auto stepper = ode::make_controlled(rtol * joint.c, rtol, ode::runge_kutta_fehlberg78<State>());
    State y = joint.start();
    double t = 0.0, h = 1e-6;
    while (track.samples.size() < N_SAMPLES) {
        const double at = track.next_sample(), own = h;
        const bool cut = t + h >= at;
        double taken = cut ? at - t : h;
        if (stepper.try_step(Rhs{joint, track}, y, t, taken) != ode::success) {
            h = taken;
            continue;
        }
        // A step cut short for a sample says nothing against the step of before.
        h = cut && taken < own ? own : taken;
        track.look(joint, t, y);
        if (cut) {
            t = at;
            track.samples.push_back(y);
        }
    }
}

int main(int, char** arguments) {
    const std::string version = std::to_string(BOOST_VERSION / 100000) + "." +
                                std::to_string(BOOST_VERSION / 100 % 1000);
    ladder("boost odeint", version, "dopri5", "naive", arguments[1], dopri5);
    ladder("boost odeint", version, "fehlberg78", "naive", arguments[1], fehlberg78);
}
