"""scipy's solve_ivp: DOP853, RK45, BDF, Radau, naive, its right-hand side in numba and in Python; DOP853
with events too.

Traps worked around in the located run: a flight begins at delta = 0 to the last bit, and solve_ivp
then returns the start itself as the root, for ever, so a guard within rounding of zero is put on the
inside of its mode; a flight shorter than a step is missed (signs at step ends only), and that is left.
"""

import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))

try:
    import numpy as np
    import scipy
    from scipy.integrate import solve_ivp
except ImportError:
    print("skip,scipy is not installed (pip install -r scipy/requirements.txt)")
    sys.exit(0)
try:
    import numba
except ImportError:
    numba = None

import math

import model
from peer import T_END, TIMES, Track, ladder, one_by_one

MAX_EVENTS = 2000
GRID = np.array(TIMES)


def compiled():
    """The slope in numba, warm."""
    constants = (model.STIFFNESS, model.DAMPING, model.CLEARANCE, model.MU * model.PIN, model.PIN)
    stiffness, damping, clearance, arm, pin = constants

    @numba.njit
    def slope(sigma, joint, y):
        m_x, m_y, p, q, j_0, j_c, torque = joint
        rho = math.sqrt(y[0] * y[0] + y[1] * y[1])
        if sigma == 2:  # naive: read off the state
            v_t = (y[1] * y[3] - y[0] * y[4]) / rho + y[5] * pin
            sigma = 0 if rho - clearance <= 0.0 else (-1 if v_t < 0.0 else 1)
        s, c = math.sin(y[2]), math.cos(y[2])
        omega_sq = y[5] * y[5]
        moment, q_x, q_y = torque + j_c * s * c * omega_sq, 0.0, 0.0
        if sigma != 0:
            normal = stiffness * (rho - clearance) + damping * (y[0] * y[3] + y[1] * y[4]) / rho
            q_x, q_y = -normal * y[0] / rho, -normal * y[1] / rho
            moment -= sigma * arm * normal
        alpha = (moment - p * c * q_x + q * s * q_y) / (j_0 + j_c * c * c)
        out = np.empty(6)
        out[0], out[1], out[2] = y[3], y[4], y[5]
        out[3] = p * s * omega_sq + q_x / m_x - p * c * alpha
        out[4] = q * c * omega_sq + q_y / m_y + q * s * alpha
        out[5] = alpha
        return out

    slope(2, model.JOINTS[1], np.array(model.START))
    return slope


def plain(sigma, joint, y):
    y = y.tolist()
    sigma = model.mode_of(y) if sigma == 2 else sigma
    return np.array(model.slope(joint, sigma, y, math.sin, math.cos, math.sqrt))


def tolerances(joint, rtol):
    return {"rtol": rtol, "atol": rtol * np.array(model.scale(joint))}


def naive(slope, method):
    def solve(number, rtol):
        joint = model.JOINTS[number]
        track = Track()
        found = solve_ivp(lambda t, y: slope(2, joint, y), (0.0, T_END), model.START, method=method,
                          dense_output=True, **tolerances(joint, rtol))
        if not found.success:
            raise RuntimeError(found.message)
        track.samples, track.n_rhs = found.sol(GRID).T, found.nfev
        for t, y in zip(found.t, found.y.T.tolist()):
            track.change(t, model.mode_of(y))
        return track

    return solve


def located(slope, method):
    def inside(value):
        return 1e-100 if abs(value) < 1e-19 else value

    def surface(t, y, mode):
        d = model.delta(y.tolist())
        return inside(d if mode != 0 else -d)

    def reversal(t, y, mode):
        return inside(mode * model.v_t(y.tolist())) if mode != 0 else 1.0

    surface.terminal = reversal.terminal = True

    def solve(number, rtol):
        joint = model.JOINTS[number]
        track = Track()
        track.change(0.0, model.first_mode(joint))
        t, y = 0.0, np.array(model.START)
        while t < T_END:
            found = solve_ivp(lambda t, y, mode: slope(mode, joint, y), (t, T_END), y, method=method,
                              dense_output=True, events=(surface, reversal), args=(track.mode,),
                              **tolerances(joint, rtol))
            if found.status < 0 or len(track.events) > MAX_EVENTS:
                raise RuntimeError(found.message)
            track.n_rhs += found.nfev
            within = GRID[len(track.samples):]
            within = within[within <= found.t[-1]]
            if len(within):
                track.samples.extend(found.sol(within).T)
            t, y = found.t[-1], found.y[:, -1]
            if found.status == 1:
                if len(found.t_events[1]):
                    track.change(t, -track.mode)
                elif track.mode == 0:
                    track.change(t, -1 if model.v_t(y.tolist()) < 0.0 else 1)
                else:
                    track.change(t, 0)
        return track

    return solve


if __name__ == "__main__":
    DECADES = [f"1e-{k}" for k in range(3, 14)]
    if numba is not None:
        version = f"{scipy.__version__} + numba {numba.__version__}"
        slope = compiled()
        for method in ("RK45", "DOP853", "BDF", "Radau"):
            ladder("scipy-numba", version, method, "naive", one_by_one(naive(slope, method)), DECADES)
        ladder("scipy-numba", version, "DOP853", "located", one_by_one(located(slope, "DOP853")), DECADES)
    ladder("scipy", scipy.__version__, "DOP853", "naive", one_by_one(naive(plain, "DOP853")), DECADES)
