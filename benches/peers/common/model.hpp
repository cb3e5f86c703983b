// The model, written once for the peers in C++: reading `pin` of Table 1, one joint of six states.
//
// State: X, Y [m], theta [rad] and their rates; joint 2 is joint 1 with other constants, X = z02,
// Y = y02. The equations are those of the documentation of the Rust package (`joints/src/lib.rs`):
//
//   | Mx         0          Sx cos       | |X''|     | Sx sin w^2 - F_N n_X               |
//   | 0          My        -Sy sin       | |Y''|   = | Sy cos w^2 - F_N n_Y               |
//   | Sx cos    -Sy sin     I0 + Ic cos^2| |theta''| | Ic sin cos w^2 + M - sigma mu F_N r |
//
// They are checked against the golden samples by the error e that every run is given.
#pragma once

#include <array>
#include <cmath>

using State = std::array<double, 6>;

// Both joints at once, a lane each: GCC's vector of two.
using Lanes = double __attribute__((vector_size(16)));

inline Lanes sqrt(Lanes x) { return Lanes{std::sqrt(x[0]), std::sqrt(x[1])}; }
inline Lanes sin(Lanes x) { return Lanes{std::sin(x[0]), std::sin(x[1])}; }
inline Lanes cos(Lanes x) { return Lanes{std::cos(x[0]), std::cos(x[1])}; }

// The equations, of one joint (S = double) or of both.
template <class S>
struct Equations {
    S per_mx, per_my, p, q, j0, jc, torque;
    double c = 1e-4, r = 4.9e-3, stiffness = 1e7, damping = 178.7, mu = 0.1;

    // Distance of the pin from the centre.
    template <class Y>
    S rho(const Y& y) const { return sqrt(y[0] * y[0] + y[1] * y[1]); }

    template <class Y>
    S v_t(const Y& y, S rho) const { return (y[1] * y[3] - y[0] * y[4]) * (1.0 / rho) + y[5] * r; }

    // F_N in contact.
    template <class Y>
    S normal(const Y& y, S rho) const {
        const S delta_dot = (y[0] * y[3] + y[1] * y[4]) * (1.0 / rho);
        return stiffness * (rho - c) + damping * delta_dot;
    }

    // Slope in contact.
    template <class Y, class D>
    void touching(S sigma, S normal, S rho, const Y& y, D& dydt) const {
        const S along = -normal * (1.0 / rho);
        slope(along * y[0], along * y[1], -sigma * mu * r * normal, y, dydt);
    }

    // Slope apart.
    template <class Y, class D>
    void apart(const Y& y, D& dydt) const { slope(S{}, S{}, S{}, y, dydt); }

    // Slope under the force (qx, qy) on the pin and the moment of friction.
    template <class Y, class D>
    void slope(S qx, S qy, S friction, const Y& y, D& dydt) const {
        const S sine = sin(y[2]), cosine = cos(y[2]);
        const S omega_sq = y[5] * y[5];
        const S per_schur = 1.0 / (j0 + jc * cosine * cosine);
        const S moment = torque + jc * sine * cosine * omega_sq + friction;
        const S alpha = (moment - p * cosine * qx + q * sine * qy) * per_schur;
        dydt[0] = y[3];
        dydt[1] = y[4];
        dydt[2] = y[5];
        dydt[3] = p * sine * omega_sq + qx * per_mx - p * cosine * alpha;
        dydt[4] = q * cosine * omega_sq + qy * per_my + q * sine * alpha;
        dydt[5] = alpha;
    }
};

struct Joint : Equations<double> {
    // Joint 1 or 2.
    explicit Joint(int number) {
        const double length = 2.5, radius = 0.005, density = 7800.0;
        const double m = density * M_PI * radius * radius * length;
        const double inertia = m * radius * radius / 2.0;
        if (number == 1) {
            per_mx = 1.0 / (5 * m), per_my = 1.0 / (4 * m);
            p = 6.0 * length / 5.0, q = length / 2.0;
            // Sums of m (arm - mean)^2 along X: arms 1/2, 3/2, 2, 1/2, 3/2 struts.
            j0 = 4 * inertia, jc = 1.8 * m * length * length;
            torque = 1.0;
        } else {
            per_mx = 1.0 / (4 * m), per_my = 1.0 / (2 * m);
            p = 3.0 * length / 4.0, q = length / 2.0;
            j0 = 2 * inertia, jc = 0.25 * m * length * length;
            torque = 0.3;
        }
    }

    State start() const { return {0.0, -c, 0.0, 0.0, 0.0, 0.0}; }

    // Slope in a frozen mode: sigma is 0 free, +1 or -1 the sign of v_T in contact.
    template <class Y, class D>
    void rhs(int sigma, const Y& y, D& dydt) const {
        if (sigma == 0) return apart(y, dydt);
        const double length = rho(y);
        touching(sigma, normal(y, length), length, y, dydt);
    }

    // The naive slope: the mode is read off the state.
    template <class Y, class D>
    void naive(const Y& y, D& dydt) const {
        const double length = rho(y);
        if (length <= c) return apart(y, dydt);
        touching(Equations::v_t(y, length) < 0.0 ? -1.0 : 1.0, normal(y, length), length, y, dydt);
    }

    template <class Y>
    double delta(const Y& y) const { return rho(y) - c; }

    template <class Y>
    double v_t(const Y& y) const { return Equations::v_t(y, rho(y)); }

    // The mode that the signs of a state name.
    template <class Y>
    int mode_of(const Y& y) const { return delta(y) > 0.0 ? (v_t(y) < 0.0 ? -1 : 1) : 0; }

    // Natural scale of each state, from which absolute tolerances follow.
    State scale() const {
        const double about_pin = j0 + jc + p * p / per_mx;
        const double v = std::sqrt(2.0 * torque * p / about_pin * c), length = 2.5;
        return {c, c, c / length, v, v, v / length};
    }
};

struct Joints : Equations<Lanes> {
    Joints(const Joint& one, const Joint& two)
        : Equations{{one.per_mx, two.per_mx}, {one.per_my, two.per_my}, {one.p, two.p}, {one.q, two.q},
                    {one.j0, two.j0}, {one.jc, two.jc}, {one.torque, two.torque}} {}

    // The naive slope, lane by lane.
    template <class Y, class D>
    void naive(const Y& y, D& dydt) const {
        const Lanes length = rho(y), zero = {};
        const auto in_contact = length > c;
        if (!(in_contact[0] | in_contact[1])) return apart(y, dydt);
        const Lanes force = in_contact ? normal(y, length) : zero;
        touching(v_t(y, length) < 0.0 ? zero - 1.0 : zero + 1.0, force, length, y, dydt);
    }
};
