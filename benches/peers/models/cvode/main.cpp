// CVODE on five text models: BDF with an analytic Jacobian, dense or banded, and Adams with fixed-point iteration (Newton's on what is
// stiff); its root finding with modes frozen, its dense output at the samples. `main MODEL TIMES FOLDER` prints a line a run:
// tool, method, tolerance, events, seconds on the processor (or what went wrong), file of the samples.
//
// Traps worked around: a mode starts by CVodeReInit, as history and step are of the mode before; an instant known beforehand is its
// stop time and no root; only falling guards count, else a guard that rounding left below zero ends its mode as it rises; all guards found
// at once are to be served, as the second will not fall again; a sample within rounding of a start is refused; of the rocking block the
// absolute tolerance must shrink with the flights, else impacts are lost, and a first step longer than a flight topples the block.
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "models.hpp"

constexpr int MOST_EVENTS = 5000;
// A ladder ends at its first run beyond this [s], as in ../run.py.
constexpr double LONGEST = 20.0 / 3.0;

template <class M>
class Solver {
    M model;
    const double rtol;
    SUNContext context;
    N_Vector y, atol;
    SUNMatrix matrix;
    SUNLinearSolver linear;
    SUNNonlinearSolver fixed_point;
    void* cvode;

    static int rates(double, N_Vector y, N_Vector slope, void* self) {
        static_cast<Solver*>(self)->model.rates(N_VGetArrayPointer(y), N_VGetArrayPointer(slope));
        return 0;
    }

    static int guards(double, N_Vector y, double* g, void* self) {
        static_cast<Solver*>(self)->model.guards(N_VGetArrayPointer(y), g);
        return 0;
    }

    static int jacobian(double, N_Vector y, N_Vector, SUNMatrix matrix, void* self, N_Vector, N_Vector, N_Vector) {
        static_cast<Solver*>(self)->model.jacobian(N_VGetArrayPointer(y), [&](int row, int column, double value) {
            (M::BAND ? SM_ELEMENT_B(matrix, row, column) : SM_ELEMENT_D(matrix, row, column)) = value;
        });
        return 0;
    }

    void set_tolerances() {
        for (int i = 0; i < M::N; ++i) NV_Ith_S(atol, i) = rtol * model.scale[i];
        CVodeSVtolerances(cvode, rtol, atol);
    }

public:
    Solver(int method, double rtol) : rtol(rtol) {
        SUNContext_Create(nullptr, &context);
        y = N_VNew_Serial(M::N, context);
        atol = N_VNew_Serial(M::N, context);
        cvode = CVodeCreate(method, context);
        CVodeInit(cvode, rates, 0.0, y);
        set_tolerances();
        CVodeSetUserData(cvode, this);
        CVodeSetMaxNumSteps(cvode, 100000000);
        CVodeSetErrFile(cvode, nullptr);
        if (M::N_GUARDS) {
            std::vector<int> down(M::N_GUARDS, -1);
            CVodeRootInit(cvode, M::N_GUARDS, guards);
            CVodeSetRootDirection(cvode, down.data());
            CVodeSetNoInactiveRootWarn(cvode);
        }
        matrix = M::BAND ? SUNBandMatrix(M::N, M::BAND, M::BAND, context) : SUNDenseMatrix(M::N, M::N, context);
        linear = M::BAND ? SUNLinSol_Band(y, matrix, context) : SUNLinSol_Dense(y, matrix, context);
        fixed_point = SUNNonlinSol_FixedPoint(y, 0, context);
        if (method == CV_BDF || M::STIFF) {
            CVodeSetLinearSolver(cvode, linear, matrix);
            CVodeSetJacFn(cvode, jacobian);
        } else {
            CVodeSetNonlinearSolver(cvode, fixed_point);
        }
    }

    ~Solver() {
        CVodeFree(&cvode);
        SUNNonlinSolFree(fixed_point);
        SUNLinSolFree(linear);
        SUNMatDestroy(matrix);
        N_VDestroy(atol);
        N_VDestroy(y);
        SUNContext_Free(&context);
    }

    Solver(const Solver&) = delete;

    // Begins a mode, which ends at `end` unless a guard falls.
    void begin(double t, double end) {
        if (M::SHRINKS) set_tolerances();
        CVodeReInit(cvode, t, y);
        CVodeSetStopTime(cvode, end);
    }

    // Writes the samples and gives the number of events.
    int run(const M& from, const std::vector<double>& times, double* samples) {
        double* const state = N_VGetArrayPointer(y);
        double t = 0.0;
        auto next = times.begin();
        model = from;
        std::copy(model.start.begin(), model.start.end(), state);
        const auto sample = [&] {
            samples = std::copy(state, state + M::N, samples);
            ++next;
        };
        for (int n_events = 0; n_events <= MOST_EVENTS; ++n_events) {
            const double end = std::min(model.until(), M::T_END);
            begin(t, end);
            while (next != times.end() && *next - t < 1e-15 * t) sample();
            int status = CV_SUCCESS;
            while (t < end && status != CV_ROOT_RETURN) {
                status = CVode(cvode, next == times.end() ? end : std::min(*next, end), y, &t, CV_NORMAL);
                if (status < 0) throw std::runtime_error("CVODE returned " + std::to_string(status));
                while (status != CV_ROOT_RETURN && next != times.end() && *next <= t) sample();
            }
            if (status != CV_ROOT_RETURN && t >= M::T_END) {
                if (next != times.end()) throw std::runtime_error("samples are missing");
                return n_events;
            }
            int found[M::N_GUARDS + 1];
            if (status == CV_ROOT_RETURN) CVodeGetRootInfo(cvode, found);
            model.jump(status == CV_ROOT_RETURN ? found : nullptr, t, state);
        }
        throw std::runtime_error("more than 5000 events");
    }
};

static double processor_time() {
    timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

template <class M>
static void ladder(const char* name, int method, const std::vector<double>& times, const std::string& folder) {
    const M model;
    std::vector<double> samples(times.size() * M::N);
    for (int k = 3; k <= 13; ++k) {
        const std::string tolerance = "1e-" + std::to_string(k), path = folder + "/" + name + "-" + tolerance;
        double least = FOREVER;
        try {
            Solver<M> solver(method, std::stod(tolerance));
            int n_events = 0;
            for (int repeat = 0; repeat < 3 && (repeat == 0 || least < LONGEST); ++repeat) {
                const double begin = processor_time();
                n_events = solver.run(model, times, samples.data());
                least = std::min(least, processor_time() - begin);
            }
            std::ofstream file(path);
            file.precision(17);
            for (std::size_t n = 0; n < times.size(); ++n)
                for (int i = 0; i < M::N; ++i) file << samples[n * M::N + M::place(i)] << (i + 1 < M::N ? ' ' : '\n');
            std::printf("cvode,%s,%s,%d,%.4e,%s\n", name, tolerance.c_str(), n_events, least, path.c_str());
        } catch (const std::exception& error) {
            std::printf("cvode,%s,%s,0,%s,\n", name, tolerance.c_str(), error.what());
        }
        if (least < FOREVER && least > LONGEST) break;
    }
}

template <class M>
static void ladders(const std::string& name, const std::vector<double>& times, const std::string& folder) {
    if (name != M::NAME) return;
    ladder<M>("bdf", CV_BDF, times, folder);
    ladder<M>("adams", CV_ADAMS, times, folder);
}

int main(int, char** arguments) {
    const std::string name = arguments[1], folder = arguments[3];
    std::ifstream file(arguments[2]);
    std::vector<double> times;
    for (double t; file >> t;) times.push_back(t);
    ladders<VanDerPol>(name, times, folder);
    ladders<IntegrateAndFire>(name, times, folder);
    ladders<BuckConverter>(name, times, folder);
    ladders<RockingBlock>(name, times, folder);
    ladders<Carts>(name, times, folder);
}
