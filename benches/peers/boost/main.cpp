// Boost.Numeric.Odeint: both joints at once in a state of six vectors of two, with one step for both, by
// dopri5 with dense output and by Fehlberg 7(8) stopped at the samples. Naive: it has no events. One
// absolute tolerance for all states: rtol times the clearance.
#include <boost/numeric/odeint.hpp>
#include <boost/version.hpp>

#include "../common/peer.hpp"

namespace ode = boost::numeric::odeint;

using Pair = std::array<Lanes, 6>;

// The error of odeint's own checker, the larger of the lanes; that takes numbers alone.
struct Checker {
    double atol, rtol;

    template <class Algebra>
    double error(Algebra&, const Pair& y, const Pair& dydt, const Pair& error, double h) const {
        Lanes worst = {};
        for (int i = 0; i < 6; ++i) {
            const Lanes of = abs(error[i]) / (atol + rtol * (abs(y[i]) + h * abs(dydt[i])));
            worst = of > worst ? of : worst;
        }
        return std::max(worst[0], worst[1]);
    }

    static Lanes abs(Lanes x) { return x < 0.0 ? -x : x; }
};

template <class Stepper>
using Controlled = ode::controlled_runge_kutta<Stepper, Checker>;

struct Both {
    const Joint joints[2] = {Joint(1), Joint(2)};
    const Joints at_once{joints[0], joints[1]};
    Track* tracks;

    explicit Both(Track* tracks) : tracks(tracks) {}

    Checker checker(double rtol) const { return {rtol * joints[0].c, rtol}; }

    Pair start() const {
        Pair y;
        const State one = joints[0].start(), two = joints[1].start();
        for (int i = 0; i < 6; ++i) y[i] = Lanes{one[i], two[i]};
        return y;
    }

    bool done() const { return tracks[0].samples.size() == N_SAMPLES; }

    double next_sample() const { return tracks[0].next_sample(); }

    void sample(const Pair& y) {
        for (int j = 0; j < 2; ++j) tracks[j].samples.push_back(lane(y, j));
    }

    void look(double t, const Pair& y) {
        for (int j = 0; j < 2; ++j) tracks[j].look(joints[j], t, lane(y, j));
    }

    static State lane(const Pair& y, int j) {
        return {y[0][j], y[1][j], y[2][j], y[3][j], y[4][j], y[5][j]};
    }
};

struct Rhs {
    const Both& both;
    void operator()(const Pair& y, Pair& dydt, double) const {
        for (int j = 0; j < 2; ++j)
            if (++both.tracks[j].n_rhs > MAX_RHS) throw std::runtime_error("too many right-hand sides");
        both.at_once.naive(y, dydt);
    }
};

static void dopri5(double rtol, Track tracks[2]) {
    Both both(tracks);
    using Stepper = Controlled<ode::runge_kutta_dopri5<Pair, double>>;
    ode::dense_output_runge_kutta<Stepper> stepper(Stepper(both.checker(rtol)));
    stepper.initialize(both.start(), 0.0, 1e-6);
    while (!both.done()) {
        stepper.do_step(Rhs{both});
        const double t = stepper.current_time();
        while (both.next_sample() <= t) {
            Pair y;
            stepper.calc_state(both.next_sample(), y);
            both.sample(y);
        }
        both.look(t, stepper.current_state());
    }
}

static void fehlberg78(double rtol, Track tracks[2]) {
    Both both(tracks);
    Controlled<ode::runge_kutta_fehlberg78<Pair, double>> stepper(both.checker(rtol));
    Pair y = both.start();
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
        both.look(t, y);
        if (cut) {
            t = at;
            both.sample(y);
        }
    }
}

int main(int, char** arguments) {
    const std::string version = std::to_string(BOOST_VERSION / 100000) + "." +
                                std::to_string(BOOST_VERSION / 100 % 1000);
    ladder("boost odeint", version, "dopri5", "naive", arguments[1], dopri5);
    ladder("boost odeint", version, "fehlberg78", "naive", arguments[1], fehlberg78);
}
