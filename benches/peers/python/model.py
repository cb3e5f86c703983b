"""The model, written once for the peers in Python: reading `pin` of Table 1, one joint of six states.

State: X, Y [m], theta [rad] and their rates; joint 2 is joint 1 with other constants (X = z02, Y = y02).
Equations as in `common/model.hpp`; checked against the golden samples by the error e of every run.
"""

import math

LENGTH, RADIUS, DENSITY = 2.5, 0.005, 7800.0
CLEARANCE, PIN, STIFFNESS, DAMPING, MU = 1e-4, 4.9e-3, 1e7, 178.7, 0.1
MASS = DENSITY * math.pi * RADIUS * RADIUS * LENGTH
INERTIA = MASS * RADIUS * RADIUS / 2.0

# m_x, m_y, p, q, j_0, j_c, torque: mass sums, mean arms, Schur complement j_0 + j_c cos^2, drive.
JOINTS = {
    1: (5 * MASS, 4 * MASS, 6 * LENGTH / 5, LENGTH / 2, 4 * INERTIA, 1.8 * MASS * LENGTH**2, 1.0),
    2: (4 * MASS, 2 * MASS, 3 * LENGTH / 4, LENGTH / 2, 2 * INERTIA, 0.25 * MASS * LENGTH**2, 0.3),
}
START = (0.0, -CLEARANCE, 0.0, 0.0, 0.0, 0.0)
# Of the contact: K, D, clearance, coefficient of friction.
CONTACT = (STIFFNESS, DAMPING, CLEARANCE, MU)


def slope(joint, sigma, y, sin, cos, sqrt, contact=CONTACT):
    """The slope in a mode, sigma 0 free or the sign of v_T, over any scalar with these functions."""
    stiffness, damping, clearance, mu = contact
    m_x, m_y, p, q, j_0, j_c, torque = joint
    x, y_, theta, v_x, v_y, omega = y
    s, c = sin(theta), cos(theta)
    omega_sq = omega * omega
    moment = torque + j_c * s * c * omega_sq
    q_x = q_y = 0.0
    if sigma != 0:
        rho = sqrt(x * x + y_ * y_)
        normal = stiffness * (rho - clearance) + damping * (x * v_x + y_ * v_y) / rho
        pull = -normal / rho
        q_x, q_y = pull * x, pull * y_
        moment = moment - sigma * mu * PIN * normal
    alpha = (moment - p * c * q_x + q * s * q_y) / (j_0 + j_c * c * c)
    return (
        v_x,
        v_y,
        omega,
        p * s * omega_sq + q_x / m_x - p * c * alpha,
        q * c * omega_sq + q_y / m_y + q * s * alpha,
        alpha,
    )


def delta(y, sqrt=math.sqrt, clearance=CLEARANCE):
    """Penetration [m]."""
    return sqrt(y[0] * y[0] + y[1] * y[1]) - clearance


def v_t(y, sqrt=math.sqrt):
    """Tangential velocity of the pin's surface [m/s]."""
    return (y[1] * y[3] - y[0] * y[4]) / sqrt(y[0] * y[0] + y[1] * y[1]) + y[5] * PIN


def mode_of(y):
    """The mode that the signs of a state name."""
    return 0 if delta(y) <= 0.0 else (-1 if v_t(y) < 0.0 else 1)


def first_mode(joint):
    """The mode in which the start goes on: the sign of the frictionless v_T', n_Y X'' + theta'' r."""
    d = slope(joint, 0, START, math.sin, math.cos, math.sqrt)
    return -1 if -d[3] + d[5] * PIN < 0.0 else 1


def scale(joint, clearance=CLEARANCE):
    """Natural scale of each state, from which absolute tolerances follow."""
    m_x, _, p, _, j_0, j_c, torque = joint
    v = math.sqrt(2.0 * torque * p / (j_0 + j_c + m_x * p * p) * clearance)
    return (clearance, clearance, clearance / LENGTH, v, v, v / LENGTH)
