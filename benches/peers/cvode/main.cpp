// CVODE: BDF and Adams with its root finding, modes frozen, dense output at the samples.
//
// Traps worked around: a root function that is exactly zero after an event is ignored until it moves
// away, and loose tolerances then chatter by the thousand, so guards within rounding of zero are put
// on the inside of their mode and the run is given up at 20,000 events; history and step belong to the
// mode before, so every mode starts by CVodeReInit; the 0+ start begins in contact.
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include "../common/peer.hpp"

struct Problem {
    const Joint& joint;
    Track& track;
};

static int rhs(realtype, N_Vector y, N_Vector dydt, void* data) {
    Problem& problem = *static_cast<Problem*>(data);
    if (++problem.track.n_rhs > MAX_RHS) return -1;
    double* out = N_VGetArrayPointer(dydt);
    problem.joint.rhs(problem.track.mode, N_VGetArrayPointer(y), out);
    return 0;
}

// Guards positive inside the mode: the surface, and sigma v_T in contact.
static int guards(realtype, N_Vector vector, realtype* g, void* data) {
    const Problem& problem = *static_cast<Problem*>(data);
    const double* y = N_VGetArrayPointer(vector);
    const int mode = problem.track.mode;
    const double delta = problem.joint.delta(y), v_t = problem.joint.v_t(y);
    g[0] = mode == 0 ? -delta : delta;
    g[1] = mode == 0 ? 1.0 : mode * v_t;
    if (std::abs(g[0]) < 1e-19) g[0] = 1e-100;
    if (std::abs(g[1]) < 1e-18) g[1] = 1e-100;
    return 0;
}

static void run(int method, const Joint& joint, double rtol, Track& track) {
    Problem problem{joint, track};
    SUNContext context;
    SUNContext_Create(nullptr, &context);
    N_Vector y = N_VNew_Serial(6, context), atol = N_VNew_Serial(6, context);
    const State start = joint.start(), scale = joint.scale();
    for (int i = 0; i < 6; ++i) {
        NV_Ith_S(y, i) = start[i];
        NV_Ith_S(atol, i) = rtol * scale[i];
    }
    // Frictionless v_T' decides where v_T is zero: n_Y X'' + theta'' r.
    State slope;
    joint.rhs(0, start, slope);
    track.change(0.0, -slope[3] + slope[5] * joint.r < 0.0 ? -1 : 1);

    void* cvode = CVodeCreate(method, context);
    CVodeInit(cvode, rhs, 0.0, y);
    CVodeSVtolerances(cvode, rtol, atol);
    CVodeSetUserData(cvode, &problem);
    CVodeSetMaxNumSteps(cvode, 100000000);
    CVodeSetErrFile(cvode, nullptr);
    CVodeSetNoInactiveRootWarn(cvode);
    CVodeRootInit(cvode, 2, guards);
    SUNMatrix matrix = SUNDenseMatrix(6, 6, context);
    SUNLinearSolver solver = SUNLinSol_Dense(y, matrix, context);
    CVodeSetLinearSolver(cvode, solver, matrix);

    int status = 0;
    while (track.samples.size() < N_SAMPLES && track.events.size() < 20000) {
        double t = 0.0;
        status = CVode(cvode, track.next_sample(), y, &t, CV_NORMAL);
        if (status < 0) break;
        if (status != CV_ROOT_RETURN) {
            track.sample(N_VGetArrayPointer(y));
            continue;
        }
        int found[2];
        CVodeGetRootInfo(cvode, found);
        const double* at = N_VGetArrayPointer(y);
        const int mode = track.mode;
        if (found[0]) track.change(t, mode == 0 ? (joint.v_t(at) < 0.0 ? -1 : 1) : 0);
        else track.change(t, -mode);
        CVodeReInit(cvode, t, y);
    }
    const bool storm = track.events.size() >= 20000;
    CVodeFree(&cvode);
    SUNLinSolFree(solver);
    SUNMatDestroy(matrix);
    N_VDestroy(y);
    N_VDestroy(atol);
    SUNContext_Free(&context);
    if (storm) throw std::runtime_error("more than 20000 events");
    if (status < 0) throw std::runtime_error("CVODE returned " + std::to_string(status));
}

int main(int, char** arguments) {
    const auto with = [](int method) {
        return [method](double rtol, Track tracks[2]) {
            for (int j = 0; j < 2; ++j) run(method, Joint(j + 1), rtol, tracks[j]);
        };
    };
    ladder("CVODE", SUNDIALS_VERSION, "bdf", "located", arguments[1], with(CV_BDF));
    ladder("CVODE", SUNDIALS_VERSION, "adams", "located", arguments[1], with(CV_ADAMS));
}
