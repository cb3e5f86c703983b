// CVODE: both joints as one system of twelve states, by BDF with a banded Jacobian from differences and by
// Adams with functional iteration; its root finding, modes frozen, dense output at the samples.
//
// Traps worked around: a root function that is exactly zero after an event is ignored until it moves
// away, and loose tolerances then chatter by the thousand, so guards within rounding of zero are put
// on the inside of their mode and the run is given up at 20,000 events; history and step belong to the
// mode before, so every mode starts by CVodeReInit; the 0+ start begins in contact.
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "../common/peer.hpp"

// Both joints as one system of twelve states, joint 1 before joint 2: they share the step, and no term.
struct Both {
    Joint joints[2] = {Joint(1), Joint(2)};
    Track* tracks;

    explicit Both(Track* tracks) : tracks(tracks) {}

    // The states of joint j, 0 or 1.
    template <class Y>
    static Y* part(int j, Y* y) { return y + 6 * j; }

    bool done() const { return tracks[0].samples.size() == N_SAMPLES; }

    double next_sample() const { return tracks[0].next_sample(); }

    void sample(const double* y) {
        for (int j = 0; j < 2; ++j) tracks[j].sample(part(j, y));
    }
};

// Events at which a run is given up.
static constexpr std::size_t MAX_EVENTS = 20000;

static int rhs(realtype, N_Vector y, N_Vector dydt, void* data) {
    Both& both = *static_cast<Both*>(data);
    for (int j = 0; j < 2; ++j) {
        if (++both.tracks[j].n_rhs > MAX_RHS) return -1;
        double* slope = Both::part(j, N_VGetArrayPointer(dydt));
        both.joints[j].rhs(both.tracks[j].mode, Both::part(j, N_VGetArrayPointer(y)), slope);
    }
    return 0;
}

// Two guards a joint, positive inside its mode: the surface, and sigma v_T in contact.
static int guards(realtype, N_Vector vector, realtype* g, void* data) {
    const Both& both = *static_cast<Both*>(data);
    for (int j = 0; j < 2; ++j, g += 2) {
        const double* y = Both::part(j, N_VGetArrayPointer(vector));
        const int mode = both.tracks[j].mode;
        const double delta = both.joints[j].delta(y), v_t = both.joints[j].v_t(y);
        g[0] = mode == 0 ? -delta : delta;
        g[1] = mode == 0 ? 1.0 : mode * v_t;
        if (std::abs(g[0]) < 1e-19) g[0] = 1e-100;
        if (std::abs(g[1]) < 1e-18) g[1] = 1e-100;
    }
    return 0;
}

static void run(int method, double rtol, Track tracks[2]) {
    Both both(tracks);
    SUNContext context;
    SUNContext_Create(nullptr, &context);
    N_Vector y = N_VNew_Serial(12, context), atol = N_VNew_Serial(12, context);
    for (int j = 0; j < 2; ++j) {
        const Joint& joint = both.joints[j];
        const State start = joint.start(), scale = joint.scale();
        for (int i = 0; i < 6; ++i) {
            Both::part(j, N_VGetArrayPointer(y))[i] = start[i];
            Both::part(j, N_VGetArrayPointer(atol))[i] = rtol * scale[i];
        }
        // Frictionless v_T' decides where v_T is zero: n_Y X'' + theta'' r.
        State slope;
        joint.rhs(0, start, slope);
        tracks[j].change(0.0, -slope[3] + slope[5] * joint.r < 0.0 ? -1 : 1);
    }

    void* cvode = CVodeCreate(method, context);
    CVodeInit(cvode, rhs, 0.0, y);
    CVodeSVtolerances(cvode, rtol, atol);
    CVodeSetUserData(cvode, &both);
    CVodeSetMaxNumSteps(cvode, 100000000);
    CVodeSetErrFile(cvode, nullptr);
    CVodeSetNoInactiveRootWarn(cvode);
    CVodeRootInit(cvode, 4, guards);
    // Two blocks of six on the diagonal.
    SUNMatrix matrix = SUNBandMatrix(12, 5, 5, context);
    SUNLinearSolver linear = SUNLinSol_Band(y, matrix, context);
    SUNNonlinearSolver functional = SUNNonlinSol_FixedPoint(y, 0, context);
    if (method == CV_BDF) CVodeSetLinearSolver(cvode, linear, matrix);
    else CVodeSetNonlinearSolver(cvode, functional);

    int status = 0;
    const auto storm = [&] { return tracks[0].events.size() + tracks[1].events.size() >= MAX_EVENTS; };
    while (!both.done() && !storm()) {
        double t = 0.0;
        status = CVode(cvode, both.next_sample(), y, &t, CV_NORMAL);
        if (status < 0) break;
        if (status != CV_ROOT_RETURN) {
            both.sample(N_VGetArrayPointer(y));
            continue;
        }
        int found[4];
        CVodeGetRootInfo(cvode, found);
        for (int j = 0; j < 2; ++j) {
            const double* at = Both::part(j, N_VGetArrayPointer(y));
            const int mode = tracks[j].mode;
            if (found[2 * j]) tracks[j].change(t, mode == 0 ? (both.joints[j].v_t(at) < 0.0 ? -1 : 1) : 0);
            else if (found[2 * j + 1]) tracks[j].change(t, -mode);
        }
        CVodeReInit(cvode, t, y);
    }
    CVodeFree(&cvode);
    SUNNonlinSolFree(functional);
    SUNLinSolFree(linear);
    SUNMatDestroy(matrix);
    N_VDestroy(y);
    N_VDestroy(atol);
    SUNContext_Free(&context);
    if (storm()) throw std::runtime_error("more than 20000 events");
    if (status < 0) throw std::runtime_error("CVODE returned " + std::to_string(status));
}

int main(int, char** arguments) {
    const auto with = [](int method) {
        return [method](double rtol, Track tracks[2]) { run(method, rtol, tracks); };
    };
    ladder("CVODE", SUNDIALS_VERSION, "bdf", "located", arguments[1], with(CV_BDF));
    ladder("CVODE", SUNDIALS_VERSION, "adams", "located", arguments[1], with(CV_ADAMS));
}
