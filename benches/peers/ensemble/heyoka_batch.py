"""heyoka in batches (a lane of a vector register a joint of a variant), by its ensemble mode where there are several workers.

One integrator for all: what differs between variants, joints and modes is in its parameters, so it is compiled once. An event
calls Python, which sets the parameters of its lane, and the integration goes on in compiled code to the end of all lanes.

Traps worked around: a mode begins at a root of its event, which would fire for ever, and within its cool-down a return would be
lost; so each event function is shifted by EPS [m, m/s] to the inside of its mode and needs no cool-down. The callbacks are copied
with the integrator, so each copy counts its own events. Joints of a kind stand together, so that lanes take about as many steps.
"""

import math
import time

import heyoka as hy
import model
import numpy as np
import variants

hy.set_logger_level_error()

LADDER = ("1e-6", "3e-7", "1e-7", "1e-8", "1e-9")
LANES = hy.recommended_simd_size()
EPS = 1e-16
# The parameters by number: the joint, its contact, and the mode: 1 in contact, and the sign of v_T there.
JOINT, STIFFNESS, DAMPING, CLEARANCE, MU, CONTACT, SIGN = slice(0, 7), 7, 8, 9, 10, 11, 12
N_PARAMETERS = 13


class Surface:
    """The pin meets the surface, or leaves it."""

    def __init__(self):
        self.count = np.zeros(LANES, int)

    def __call__(self, ta, _, lane):
        self.count[lane] += 1
        is_flight = ta.pars[CONTACT, lane] == 0.0
        ta.pars[CONTACT, lane] = float(is_flight)
        sign = -1.0 if model.v_t(ta.state[:, lane].tolist()) < 0.0 else 1.0
        ta.pars[SIGN, lane] = sign if is_flight else 0.0
        return True


class Reversal(Surface):
    """The slip turns."""

    def __call__(self, ta, _, lane):
        self.count[lane] += 1
        ta.pars[SIGN, lane] *= -1.0
        return True


def integrator(tol):
    y = hy.make_vars("X", "Y", "theta", "v_x", "v_y", "omega")
    p = [hy.par[i] for i in range(N_PARAMETERS)]
    contact = (p[CONTACT] * p[STIFFNESS], p[CONTACT] * p[DAMPING], p[CLEARANCE], p[MU])
    slopes = model.slope(p[JOINT], p[SIGN], y, hy.sin, hy.cos, hy.sqrt, contact)
    surface = (2.0 * p[CONTACT] - 1.0) * model.delta(y, hy.sqrt, p[CLEARANCE]) + EPS
    reversal = p[SIGN] * model.v_t(y, hy.sqrt) + (1.0 - p[CONTACT]) + EPS
    falling = hy.event_direction.negative
    events = [hy.t_event_batch(surface, callback=Surface(), direction=falling, cooldown=0.0),
              hy.t_event_batch(reversal, callback=Reversal(), direction=falling, cooldown=0.0)]
    start = np.full((6, LANES), 0.1)
    return hy.taylor_adaptive_batch(list(zip(y, slopes)), start, pars=np.zeros((N_PARAMETERS, LANES)), t_events=events, tol=tol)


def begin(ta, lanes):
    """Puts the start of these variants into an integrator."""
    ta.set_time(0.0)
    for event in ta.t_events:
        event.callback.count[:] = 0
    for lane, own in enumerate(lanes):
        ta.state[:, lane] = own.start()
        ta.pars[JOINT, lane] = own.joint
        ta.pars[JOINT.stop :, lane] = (own.stiffness, own.damping, own.clearance, own.mu, 1.0, model.first_mode(own.joint))
    return ta


def solve(compiled, all_variants, workers):
    n = len(all_variants)
    jobs = [(i, j) for j in (0, 1) for i in range(n)]
    batches = [jobs[k : k + LANES] for k in range(0, len(jobs), LANES)]
    lanes = lambda batch: [all_variants[i][j] for i, j in batch] + [all_variants[0][0]] * (LANES - len(batch))
    states, events = [[None, None] for _ in range(n)], [0] * n

    def take(ta, batch):
        for lane, (i, j) in enumerate(batch):
            states[i][j] = ta.state[:3, lane].tolist()
            events[i] += sum(int(event.callback.count[lane]) for event in ta.t_events)

    if workers == 1:
        for batch in batches:
            begin(compiled, lanes(batch)).propagate_until(2.0)
            take(compiled, batch)
    else:
        gen = lambda ta, k: begin(ta, lanes(batches[k]))
        for ended, batch in zip(hy.ensemble_propagate_until_batch(compiled, 2.0, len(batches), gen, max_workers=workers), batches):
            take(ended[0], batch)
    is_finite = lambda joints: all(math.isfinite(x) for own in joints for x in own)
    return variants.Ends([own if is_finite(own) else None for own in states], events)


def settings(_, all_variants, workers):
    for tol in LADDER:
        began = time.perf_counter()
        compiled = integrator(float(tol))
        apart = time.perf_counter() - began
        yield ("heyoka", hy.__version__, f"taylor, {LANES} lanes", f"tol {tol}"), apart, lambda: solve(compiled, all_variants, workers)
