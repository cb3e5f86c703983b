// Five text models as a user of CVODE would state them: parameters are those of text/models, modes those of ../models.py; the block rests
// below 1e-10 of the largest speed.
//
// Guards are positive inside a mode and found downwards. An instant that is known beforehand is the end of a mode, `until`.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

constexpr double FOREVER = std::numeric_limits<double>::infinity();

// What most have. A `Jacobian` sets entries: `set(row, column, value)`.
struct Model {
    static constexpr int N_GUARDS = 0;
    // Half the width of a banded Jacobian; a dense one without.
    static constexpr int BAND = 0;
    // Fixed-point iteration for Adams; Newton's for what is stiff.
    static constexpr bool STIFF = false;
    // Whether jumps change `scale`, the size of each state.
    static constexpr bool SHRINKS = false;

    void guards(const double*, double*) const {}
    // When a mode ends [s], where it is known.
    double until() const { return FOREVER; }
    // After the guards with `found`, or with nullptr at the end of a mode.
    void jump(const int*, double, double*) {}
    // Where the text has state i.
    static int place(int i) { return i; }
};

struct VanDerPol : Model {
    static constexpr const char* NAME = "van_der_pol";
    static constexpr int N = 2;
    static constexpr bool STIFF = true;
    static constexpr double T_END = 2000.0, MU = 1000.0;
    std::array<double, N> start{2.0, 0.0}, scale{2.0, 1e-3};

    void rates(const double* y, double* slope) const {
        slope[0] = y[1];
        slope[1] = MU * (1.0 - y[0] * y[0]) * y[1] - y[0];
    }

    template <class Set>
    void jacobian(const double* y, Set set) const {
        set(0, 1, 1.0);
        set(1, 0, -2.0 * MU * y[0] * y[1] - 1.0);
        set(1, 1, MU * (1.0 - y[0] * y[0]));
    }
};

struct IntegrateAndFire : Model {
    static constexpr const char* NAME = "integrate_and_fire";
    static constexpr int N = 1, N_GUARDS = 1;
    static constexpr double T_END = 0.5, TAU = 0.01, E_L = -0.070, RI = 1e8 * 2e-10, V_TH = -0.054, V_R = -0.080, T_REF = 0.002;
    std::array<double, N> start{E_L}, scale{V_TH - V_R};
    bool charging = true;
    double t_spike = 0.0;

    void rates(const double* y, double* slope) const { slope[0] = charging ? (E_L - y[0] + RI) / TAU : 0.0; }

    template <class Set>
    void jacobian(const double*, Set set) const { set(0, 0, charging ? -1.0 / TAU : 0.0); }

    void guards(const double* y, double* g) const { g[0] = charging ? V_TH - y[0] : 1.0; }

    double until() const { return charging ? FOREVER : t_spike + T_REF; }

    void jump(const int*, double t, double* y) {
        if (charging) {
            t_spike = t;
            y[0] = V_R;
        }
        charging = !charging;
    }
};

struct BuckConverter : Model {
    static constexpr const char* NAME = "buck_converter";
    static constexpr int N = 2, N_GUARDS = 1;
    static constexpr double T_END = 4e-3, V_IN = 24.0, L = 2e-5, C = 1e-4, R = 20.0, T = 1e-5, DUTY = 0.4;
    std::array<double, N> start{0.0, 0.0}, scale{V_IN * T / L, V_IN};
    enum { ON, DIODE, IDLE } mode = ON;
    int k = 0;

    void rates(const double* y, double* slope) const {
        slope[0] = mode == ON ? (V_IN - y[1]) / L : mode == DIODE ? -y[1] / L : 0.0;
        slope[1] = (y[0] - y[1] / R) / C;
    }

    template <class Set>
    void jacobian(const double*, Set set) const {
        set(0, 1, mode == IDLE ? 0.0 : -1.0 / L);
        set(1, 0, 1.0 / C);
        set(1, 1, -1.0 / (R * C));
    }

    void guards(const double* y, double* g) const { g[0] = mode == DIODE ? y[0] : 1.0; }

    double until() const { return (mode == ON ? k + DUTY : k + 1) * T; }

    void jump(const int* found, double, double* y) {
        if (mode == ON) {
            mode = DIODE;
        } else if (found) {
            mode = IDLE;
            y[0] = 0.0;
        } else {
            mode = ON;
            ++k;
        }
    }
};

struct RockingBlock : Model {
    static constexpr const char* NAME = "rocking_block";
    static constexpr int N = 2, N_GUARDS = 3;
    static constexpr bool SHRINKS = true;
    static constexpr double T_END = 10.0, LEAST = 1e-10;
    double alpha = std::atan2(0.2, 0.8), r_g = std::hypot(0.2, 0.8) / 9.81, p2 = 0.75 / r_g;
    double r = 1.0 - 1.5 * std::sin(alpha) * std::sin(alpha);
    std::array<double, N> start{0.15, 0.0}, scale{alpha, std::sqrt(p2) * alpha};
    // The corner, 1 to the right and -1 to the left; 0 at rest.
    int corner = 1;

    void rates(const double* y, double* slope) const {
        slope[0] = corner ? y[1] : 0.0;
        slope[1] = corner ? -corner * p2 * std::sin(alpha - corner * y[0]) : 0.0;
    }

    template <class Set>
    void jacobian(const double* y, Set set) const {
        if (corner == 0) return;
        set(0, 1, 1.0);
        set(1, 0, p2 * std::cos(alpha - corner * y[0]));
    }

    // The angle, what it lacks to overturn, what the corner carries.
    void guards(const double* y, double* g) const {
        std::fill(g, g + N_GUARDS, 1.0);
        if (corner == 0) return;
        const double angle = corner * y[0], sine = std::sin(alpha - angle), cosine = std::cos(alpha - angle);
        g[0] = angle;
        g[1] = alpha + std::atan(1.0) - angle;
        g[2] = 1.0 - 0.75 * sine * sine - r_g * cosine * y[1] * y[1];
    }

    void jump(const int* found, double, double* y) {
        if (found[1] || found[2]) throw std::runtime_error("it overturns or lifts off");
        const double omega = r * y[1];
        y[0] = y[1] = 0.0;
        corner = -corner;
        // The impacts accumulate: below this speed the block is at rest.
        if (std::abs(omega) < LEAST * std::sqrt(p2) * alpha) {
            corner = 0;
            return;
        }
        y[1] = omega;
        // Height and speed of this flight: small ones are lost in an error allowed of the first.
        scale[0] = std::min(alpha, omega * omega / (2.0 * p2 * std::sin(alpha)));
        scale[1] = std::min(std::sqrt(p2) * alpha, std::abs(omega));
    }
};

// Position and velocity of a cart side by side, so that the Jacobian is banded.
struct Carts : Model {
    static constexpr const char* NAME = "carts";
    static constexpr int CARTS = 50, N = 2 * CARTS, N_GUARDS = CARTS - 1, BAND = 1;
    static constexpr double T_END = 1.5, K = 40.0, GAP = 0.1, E = 0.9;
    std::array<double, N> start, scale;

    Carts() {
        for (int i = 0; i < CARTS; ++i) {
            start[2 * i] = 0.0;
            start[2 * i + 1] = std::sin((i + 1.0) * (i + 1.0));
            scale[2 * i] = GAP;
            scale[2 * i + 1] = 1.0;
        }
    }

    static int place(int i) { return i < CARTS ? 2 * i : 2 * (i - CARTS) + 1; }

    void rates(const double* y, double* slope) const {
        for (int i = 0; i < N; i += 2) {
            slope[i] = y[i + 1];
            slope[i + 1] = -K * y[i];
        }
    }

    template <class Set>
    void jacobian(const double*, Set set) const {
        for (int i = 0; i < N; i += 2) {
            set(i, i + 1, 1.0);
            set(i + 1, i, -K);
        }
    }

    void guards(const double* y, double* g) const {
        for (int i = 0; i < N_GUARDS; ++i) g[i] = GAP - (y[2 * i] - y[2 * i + 2]);
    }

    void jump(const int* found, double, double* y) {
        if (!found) return;
        for (int i = 0; i < N_GUARDS; ++i) {
            if (!found[i]) continue;
            double &x_a = y[2 * i], &v_a = y[2 * i + 1], &x_b = y[2 * i + 2], &v_b = y[2 * i + 3];
            const double middle = (x_a + x_b) / 2.0, a = v_a, b = v_b;
            x_a = middle + GAP / 2.0;
            x_b = middle - GAP / 2.0;
            v_a = ((1.0 - E) * a + (1.0 + E) * b) / 2.0;
            v_b = ((1.0 + E) * a + (1.0 - E) * b) / 2.0;
        }
    }
};
