"""heyoka (Taylor series, compiled just in time), events located: both joints in two lanes of one batch integrator.

Joint and mode are parameters of a lane, so that one propagate_grid runs from the start to the end, samples and all, in compiled
code; an event calls Python, which sets the mode of its lane. Of those tried it is the quickest: one joint after the other in
the same way takes 1.3 to 1.6 times as long, twelve states in one scalar integrator 1.4 to 1.9 times, and an integrator a mode,
called from event to event, as this script did once, 1.7 to 1.8 times. `fast_math` takes 2 % off and no digit.

Traps worked around: a mode begins at a root of its event, which would fire for ever, and within its cool-down a return would be
lost without a message; so each event function is shifted by EPS to the inside of its mode, has a direction, and needs no
cool-down. A shift of 1e-16 shows in e from 1e-12 on. Time, state and parameters are looked at through arrays made once: to make
them at each event takes longer than all else there. Compilation is apart. Right-hand sides are not counted: a Taylor step has none.
"""

import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))

try:
    import heyoka as hy
    import numpy as np

    hy.set_logger_level_error()
except ImportError:
    print("skip,heyoka is not installed (pip install -r heyoka/requirements.txt)")
    sys.exit(0)

import model
from peer import LADDER, TIMES, Track, ladder

MAX_EVENTS = 5000
# How far beyond its root an event fires [m, m/s]. Where rounding is more, the function rises from below zero, which is no event.
EPS = 1e-18
JOINTS = list(model.JOINTS.values())
# The parameters of a lane by number: those of the joint, and those of the mode: K and D in contact, the sign of v_T there, 1 in contact.
JOINT, STIFFNESS, DAMPING, SIGN, CONTACT = slice(0, 7), 7, 8, 9, 10
OF_MODE = {sigma: (abs(sigma) * model.STIFFNESS, abs(sigma) * model.DAMPING, sigma, abs(sigma)) for sigma in (0, 1, -1)}
GRID = np.transpose([[0.0] + TIMES] * 2)


class Both:
    """Both joints at a tolerance, compiled."""

    def __init__(self, tol):
        y = hy.make_vars("X", "Y", "theta", "v_x", "v_y", "omega")
        p = [hy.par[i] for i in range(11)]
        contact = (p[STIFFNESS], p[DAMPING], model.CLEARANCE, model.MU)
        slopes = model.slope(p[JOINT], p[SIGN], y, hy.sin, hy.cos, hy.sqrt, contact)
        surface = (2.0 * p[CONTACT] - 1.0) * model.delta(y, hy.sqrt) + EPS
        reversal = p[SIGN] * model.v_t(y, hy.sqrt) + (1.0 - p[CONTACT]) + EPS
        events = [
            hy.t_event_batch(function, callback=callback, direction=hy.event_direction.negative, cooldown=0.0)
            for function, callback in (
                (surface, lambda ta, _, lane: self.at_surface(lane)),
                (reversal, lambda ta, _, lane: self.enter(lane, -self.tracks[lane].mode)),
            )
        ]
        start, pars = np.transpose([model.START] * 2), np.zeros((11, 2))
        ta = hy.taylor_adaptive_batch(list(zip(y, slopes)), start, pars=pars, t_events=events, tol=tol, fast_math=True)
        self.ta, self.time, self.state, self.pars = ta, ta.time, ta.state, ta.pars

    def enter(self, lane, mode):
        track = self.tracks[lane]
        track.change(float(self.time[lane]), mode)
        self.pars[STIFFNESS:, lane] = OF_MODE[mode]
        return len(track.events) < MAX_EVENTS

    def at_surface(self, lane):
        if self.tracks[lane].mode != 0:
            return self.enter(lane, 0)
        return self.enter(lane, -1 if model.v_t(self.state[:, lane].tolist()) < 0.0 else 1)

    def run(self):
        self.tracks = [Track(), Track()]
        self.ta.set_time(0.0)
        for lane, joint in enumerate(JOINTS):
            self.state[:, lane], self.pars[JOINT, lane] = model.START, joint
            self.enter(lane, model.first_mode(joint))
        samples = self.ta.propagate_grid(GRID)[-1]
        for lane, track in enumerate(self.tracks):
            track.n_rhs, track.samples = None, samples[1:, :, lane]
            if len(track.events) >= MAX_EVENTS:
                raise RuntimeError(f"more than {MAX_EVENTS} events")
        return self.tracks


COMPILED = {}


def solve(tol):
    if tol not in COMPILED:
        COMPILED[tol] = Both(tol)
    return COMPILED[tol].run()


if __name__ == "__main__":
    TOLS = LADDER[::2] + ["1e-14", "1e-15", "1e-16"]
    ladder("heyoka", hy.__version__, "taylor", "located", solve, TOLS, warm_up=True)
