// GSL: the joints one after the other, each a system of six states, by rk8pd and rkck stopped at the
// samples, since it has no dense output. Naive: it has no events. Absolute tolerances are rtol times the
// scale of each state, and by rk8pd also times the clearance.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_version.h>

#include <algorithm>

#include "../common/peer.hpp"

struct Problem {
    const Joint& joint;
    Track& track;
};

static int rhs(double, const double y[], double dydt[], void* parameters) {
    Problem& problem = *static_cast<Problem*>(parameters);
    if (++problem.track.n_rhs > MAX_RHS) return GSL_EBADFUNC;
    problem.joint.naive(y, dydt);
    return GSL_SUCCESS;
}

using Control = gsl_odeiv2_control* (*)(const Joint&, double rtol);

static gsl_odeiv2_control* scaled(const Joint& joint, double rtol) {
    return gsl_odeiv2_control_scaled_new(rtol, rtol, 1.0, 0.0, joint.scale().data(), 6);
}

static gsl_odeiv2_control* by_clearance(const Joint& joint, double rtol) {
    return gsl_odeiv2_control_standard_new(rtol * joint.c, rtol, 1.0, 0.0);
}

static void run(const gsl_odeiv2_step_type* type, Control control_of, const Joint& joint, double rtol,
                Track& track) {
    Problem problem{joint, track};
    gsl_odeiv2_system system{rhs, nullptr, 6, &problem};
    gsl_odeiv2_step* step = gsl_odeiv2_step_alloc(type, 6);
    gsl_odeiv2_control* control = control_of(joint, rtol);
    gsl_odeiv2_evolve* evolve = gsl_odeiv2_evolve_alloc(6);
    State y = joint.start();
    double t = 0.0, h = 1e-6;
    int status = GSL_SUCCESS;
    while (track.samples.size() < N_SAMPLES && status == GSL_SUCCESS) {
        const double at = track.next_sample();
        while (t < at && status == GSL_SUCCESS) {
            const double own = h;
            status = gsl_odeiv2_evolve_apply(evolve, control, step, &system, &t, at, &h, y.data());
            // A step cut short for a sample says nothing against the step of before.
            if (t >= at) h = std::max(h, own);
            track.look(joint, t, y);
        }
        track.sample(y);
    }
    gsl_odeiv2_evolve_free(evolve);
    gsl_odeiv2_control_free(control);
    gsl_odeiv2_step_free(step);
    if (status != GSL_SUCCESS) throw std::runtime_error(gsl_strerror(status));
}

int main(int, char** arguments) {
    gsl_set_error_handler_off();
    const auto with = [](const gsl_odeiv2_step_type* type, Control control) {
        return [=](double rtol, Track tracks[2]) {
            for (int j = 0; j < 2; ++j) run(type, control, Joint(j + 1), rtol, tracks[j]);
        };
    };
    const auto rk8pd = gsl_odeiv2_step_rk8pd, rkck = gsl_odeiv2_step_rkck;
    ladder("GSL", GSL_VERSION, "rk8pd", "naive", arguments[1], with(rk8pd, scaled));
    ladder("GSL", GSL_VERSION, "rk8pd (one atol)", "naive", arguments[1], with(rk8pd, by_clearance));
    ladder("GSL", GSL_VERSION, "rkck", "naive", arguments[1], with(rkck, scaled));
}
