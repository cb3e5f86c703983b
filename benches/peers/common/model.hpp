// The model, written once for the peers in C++: reading `pin` of Table 1, one joint of six states.
//
// State: X, Y [m], theta [rad] and their rates; joint 2 is joint 1 with other constants, X = z02,
// Y = y02. The equations are those of the documentation of the Rust package (`src/lib.rs`):
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

struct Joint {
    double per_mx, per_my, p, q, j0, jc, torque;
    double c = 1e-4, r = 4.9e-3, stiffness = 1e7, damping = 178.7, mu = 0.1;

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
        if (sigma != 0) touching(sigma, rho(y), y, dydt);
        else rates(0.0, 0.0, 0.0, y, dydt);
    }

    // The naive slope: the mode is read off the state.
    template <class Y, class D>
    void naive(const Y& y, D& dydt) const {
        const double length = rho(y);
        if (length > c) touching(v_t(y, length) < 0.0 ? -1 : 1, length, y, dydt);
        else rates(0.0, 0.0, 0.0, y, dydt);
    }

    // Distance of the pin from the centre.
    template <class Y>
    double rho(const Y& y) const { return std::sqrt(y[0] * y[0] + y[1] * y[1]); }

    template <class Y>
    double delta(const Y& y) const { return rho(y) - c; }

    template <class Y>
    double v_t(const Y& y) const { return v_t(y, rho(y)); }

    // The mode that the signs of a state name.
    template <class Y>
    int mode_of(const Y& y) const { return delta(y) > 0.0 ? (v_t(y) < 0.0 ? -1 : 1) : 0; }

    // Natural scale of each state, from which absolute tolerances follow.
    State scale() const {
        const double about_pin = j0 + jc + p * p / per_mx;
        const double v = std::sqrt(2.0 * torque * p / about_pin * c), length = 2.5;
        return {c, c, c / length, v, v, v / length};
    }

private:
    template <class Y>
    double v_t(const Y& y, double rho) const {
        return (y[1] * y[3] - y[0] * y[4]) * (1.0 / rho) + y[5] * r;
    }

    // Slope in contact, at the distance rho.
    template <class Y, class D>
    void touching(int sigma, double rho, const Y& y, D& dydt) const {
        const double per_rho = 1.0 / rho;
        const double delta_dot = (y[0] * y[3] + y[1] * y[4]) * per_rho;
        const double normal = stiffness * (rho - c) + damping * delta_dot;
        const double along = -normal * per_rho;
        rates(along * y[0], along * y[1], -sigma * mu * r * normal, y, dydt);
    }

    // Slope under the force (qx, qy) on the pin and the moment of friction.
    template <class Y, class D>
    void rates(double qx, double qy, double friction, const Y& y, D& dydt) const {
        const double sin = std::sin(y[2]), cos = std::cos(y[2]);
        const double omega_sq = y[5] * y[5];
        const double per_schur = 1.0 / (j0 + jc * cos * cos);
        const double moment = torque + jc * sin * cos * omega_sq + friction;
        const double alpha = (moment - p * cos * qx + q * sin * qy) * per_schur;
        dydt[0] = y[3];
        dydt[1] = y[4];
        dydt[2] = y[5];
        dydt[3] = p * sin * omega_sq + qx * per_mx - p * cos * alpha;
        dydt[4] = q * cos * omega_sq + qy * per_my + q * sin * alpha;
        dydt[5] = alpha;
    }
};
