"""heyoka (Taylor series, compiled just in time), events located.

Traps worked around: a flight begins at delta = 0 to the last bit and is often one step long; within its
cool-down the return of the same event would be lost without a message, and without one the event would
fire at its own start for ever. So each mode is an integrator of its own whose events have a direction
and whose cool-downs are reset when it is entered. Even so a root at the start of a step hides one inside
it (a flight of 6 ms in a step of 9 ms was lost), so a mode first takes a step of 1 us off its surface. From there one
propagate_grid runs to the next event, samples and all, in compiled code: stepping from Python, as this script did once, takes
twice as long. The start at 0+ begins in contact (v_T would fire at t = 0 for ever).
Compilation is apart. Right-hand sides are not counted: a Taylor step has none.
"""

import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))

try:
    import heyoka as hy

    hy.set_logger_level_error()
except ImportError:
    print("skip,heyoka is not installed (pip install -r heyoka/requirements.txt)")
    sys.exit(0)

import model
from peer import LADDER, T_END, TIMES, Track, ladder

NAMES = ["X", "Y", "theta", "v_x", "v_y", "omega"]
MAX_EVENTS = 5000
# Time that a mode runs before its events are looked at [s]: the speed takes it off its surface.
CLEAR = 1e-6
# The events by their number.
SURFACE, REVERSAL = 0, 1


def integrator(joint, mode, tol):
    y = hy.make_vars(*NAMES)
    slopes = model.slope(joint, mode, y, hy.sin, hy.cos, hy.sqrt)
    falling, rising = hy.event_direction.negative, hy.event_direction.positive
    events = [hy.t_event(model.delta(y, hy.sqrt), direction=falling if mode else rising)]
    if mode != 0:
        direction = falling if mode > 0 else rising
        events.append(hy.t_event(model.v_t(y, hy.sqrt), direction=direction))
    return hy.taylor_adaptive(list(zip(y, slopes)), list(model.START), t_events=events, tol=tol)


COMPILED = {}


def solve(number, tol):
    joint = model.JOINTS[number]
    key = (number, tol)
    if key not in COMPILED:
        COMPILED[key] = {mode: integrator(joint, mode, tol) for mode in (0, 1, -1)}
    modes = COMPILED[key]
    track = Track()
    track.n_rhs = None
    track.change(0.0, model.first_mode(joint))
    t, y = 0.0, model.START
    while t < T_END:
        ta = modes[track.mode]
        ta.time = t
        ta.state[:] = y
        ta.reset_cooldowns()
        # No sample lies in the step off the surface.
        ahead = TIMES[len(track.samples)] if len(track.samples) < len(TIMES) else T_END
        ta.propagate_until(min(t + CLEAR, ahead, T_END))
        grid = [ta.time] + TIMES[len(track.samples) :]
        outcome, _, _, _, _, samples = ta.propagate_grid(grid)
        track.samples.extend(samples[1:])
        t, y, outcome = ta.time, ta.state.copy(), int(outcome)
        if outcome not in (-1 - SURFACE, -1 - REVERSAL):
            break
        if outcome == -1 - SURFACE:
            entered = -1 if model.v_t(y) < 0.0 else 1
            track.change(t, entered if track.mode == 0 else 0)
        else:
            track.change(t, -track.mode)
        if len(track.events) > MAX_EVENTS:
            raise RuntimeError(f"more than {MAX_EVENTS} events")
    return track


if __name__ == "__main__":
    TOLS = LADDER[::2] + ["1e-14", "1e-15", "1e-16"]
    ladder("heyoka", hy.__version__, "taylor", "located", solve, TOLS, warm_up=True)
