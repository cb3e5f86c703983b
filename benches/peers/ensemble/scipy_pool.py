"""scipy's solve_ivp and odeint over processes, the right-hand side of several variants at once in numba, naive (it branches on the state).

solve_ivp's steps are Python, so a group of variants is one system: its Python is shared, and so is its step. odeint (LSODA) steps in
Fortran and calls the right-hand side through Python; it tells of no steps, so events are not counted.
"""

import multiprocessing
import time
import warnings

import numba
import numpy as np
import scipy
import variants
from scipy.integrate import odeint, solve_ivp

import model

T_END = 2.0
PIN = model.PIN
# Method, joints in a group, tolerances.
LADDER = (
    ("DOP853", 2, ("1e-5", "1e-6")),
    ("DOP853", 16, ("1e-5", "1e-6")),
    ("DOP853", 64, ("1e-5", "1e-6")),
    ("DOP853", 200, ("1e-5",)),
    ("RK45", 16, ("1e-5", "1e-6")),
    ("LSODA", 1, ("1e-6", "1e-7")),
)


@numba.njit
def slope(t, y, numbers):
    """The slope of a group; `numbers` has a row a joint: the joint, then its contact."""
    out = np.empty_like(y)
    for k in range(numbers.shape[0]):
        m_x, m_y, p, q, j_0, j_c, moment, stiffness, damping, clearance, mu = numbers[k]
        o = 6 * k
        x, y_, v_x, v_y, omega = y[o], y[o + 1], y[o + 3], y[o + 4], y[o + 5]
        s, c = np.sin(y[o + 2]), np.cos(y[o + 2])
        rho = np.sqrt(x * x + y_ * y_)
        moment += j_c * s * c * omega * omega
        q_x, q_y = 0.0, 0.0
        if rho > clearance:
            normal = stiffness * (rho - clearance) + damping * (x * v_x + y_ * v_y) / rho
            v_t = (y_ * v_x - x * v_y) / rho + omega * PIN
            q_x, q_y = -normal * x / rho, -normal * y_ / rho
            moment -= (-1.0 if v_t < 0.0 else 1.0) * mu * PIN * normal
        alpha = (moment - p * c * q_x + q * s * q_y) / (j_0 + j_c * c * c)
        out[o], out[o + 1], out[o + 2] = v_x, v_y, omega
        out[o + 3] = p * s * omega * omega + q_x / m_x - p * c * alpha
        out[o + 4] = q * c * omega * omega + q_y / m_y + q * s * alpha
        out[o + 5] = alpha
    return out


def n_events(y, group):
    """Changes of the mode that the states at the ends of steps name."""
    y = y.reshape(len(group), 6, -1)
    rho = np.hypot(y[:, 0], y[:, 1])
    v_t = (y[:, 1] * y[:, 3] - y[:, 0] * y[:, 4]) / rho + y[:, 5] * PIN
    clearance = np.array([own.clearance for own in group])[:, None]
    mode = np.where(rho <= clearance, 0, np.where(v_t < 0.0, -1, 1))
    mode[:, 0] = [model.first_mode(own.joint) for own in group]
    return np.count_nonzero(np.diff(mode, axis=1), axis=1).tolist()


def one_group(job):
    group, method, rtol = job
    numbers = np.array([(*own.joint, own.stiffness, own.damping, own.clearance, own.mu) for own in group])
    start = np.array([x for own in group for x in own.start()])
    atol = rtol * np.array([x for own in group for x in own.scale()])
    if method == "LSODA":
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            y, told = odeint(slope, start, (0.0, T_END), (numbers,), rtol=rtol, atol=atol, tfirst=True, mxstep=1_000_000, full_output=True)
        return y[-1].reshape(-1, 6)[:, :3].tolist(), None
    found = solve_ivp(slope, (0.0, T_END), start, method=method, args=(numbers,), rtol=rtol, atol=atol)
    return found.y[:, -1].reshape(-1, 6)[:, :3].tolist(), n_events(found.y, group)


def solve(pool, jobs, n):
    ended = pool.map(one_group, jobs, chunksize=1)
    states = [own for group, _ in ended for own in group]
    counts = None if ended[0][1] is None else [own for _, group in ended for own in group]
    pair = lambda all_of_them: [list(both) for both in zip(all_of_them[:n], all_of_them[n:])]
    return variants.Ends(pair(states), [sum(both) for both in pair(counts)] if counts else [])


def settings(_, all_variants, workers):
    began = time.perf_counter()
    slope(0.0, np.ones(6), np.ones((1, 11)))
    apart = time.perf_counter() - began
    flat = [own[j] for j in (0, 1) for own in all_variants]
    version = f"{scipy.__version__} + numba {numba.__version__}"
    for method, size, tolerances in LADDER:
        groups = [flat[k : k + size] for k in range(0, len(flat), size)]
        for rtol in tolerances:
            jobs = [(group, method, float(rtol)) for group in groups]

            def own(jobs=jobs):
                # The pool is part of it: its processes are waited for at its end, and counted.
                with multiprocessing.get_context("fork").Pool(workers) as pool:
                    ends = solve(pool, jobs, len(all_variants))
                    pool.close()
                    pool.join()
                return ends

            yield ("scipy", version, f"{method}, {size} joints together", f"rtol {rtol}"), apart, own
