"""scipy: solve_ivp from event to event, right-hand sides and guards in Python."""

import bisect
import math
import types

import numpy as np
from scipy.integrate import solve_ivp

MOST_EVENTS = 5000
# A trial step may be far out.
np.seterr(all="ignore")

# A trial step may leave its mode, and there the root is none.
FUNCTIONS = types.SimpleNamespace(
    sin=math.sin, cos=math.cos, exp=math.exp, sqrt=lambda x: math.sqrt(max(x, 0.0)), join=lambda a, b: np.concatenate([a, b])
)


def guards_of(model, mode, data):
    events = []
    for i in range(len(model.guards(mode, 0.0, np.array(model.start), data, FUNCTIONS))):
        # A guard is shifted to the inside, so that a mode may begin on its surface; roots are found less exactly than by heyoka.
        event = lambda t, y, i=i: model.guards(mode, t, y, data, FUNCTIONS)[i] + 10.0 * model.shift
        event.terminal, event.direction = True, -1.0
        events.append(event)
    return events


def step(model, method, tol, start, end, times):
    """From a mode, a time, a state and what is remembered to the next event or the end: time, state, guard and samples."""
    mode, t, y, data = start
    atol = [tol * scale for scale in model.scale]
    # The end is a sample too: without an event it is where the next mode begins.
    until = times if len(times) and times[-1] == end else np.append(times, end)
    rates = lambda t, y: model.rates(mode, t, y, data, FUNCTIONS)
    events = guards_of(model, mode, data)
    options = {"rtol": max(tol, 2.3e-14), "atol": atol, "max_step": model.longest_step.get(mode, np.inf)}
    found = solve_ivp(rates, (t, end), y, method=method, t_eval=until, events=events or None, **options)
    if found.status < 0:
        raise RuntimeError(found.message)
    samples = np.transpose(found.y)[: len(times)] if len(found.t) else np.empty((0, len(y)))
    if found.status == 1:
        guard = next(i for i, at in enumerate(found.t_events) if len(at))
        return found.t_events[guard][0], found.y_events[guard][0].tolist(), guard, samples
    return end, found.y[:, -1].tolist(), None, samples


def whole(model, method, tol, times):
    """The samples and the number of events."""
    t, y, mode, data = 0.0, list(model.start), model.mode, None
    taken, n, n_events = [], 0, 0
    while t < model.t_end:
        guard = model.at_once(mode, y)
        if guard is None:
            until = model.until(mode, data)
            end = model.t_end if until is None else min(until, model.t_end)
            if end > t:
                last = bisect.bisect_right(times, end)
                t, y, guard, samples = step(model, method, tol, (mode, t, y, data), end, times[n:last])
                taken.append(samples)
                n += len(samples)
                if guard is None and (until is None or t < until):
                    break
        mode, y, data = model.jump(mode, guard, t, y, data)
        n_events += 1
        if n_events > MOST_EVENTS:
            raise RuntimeError(f"more than {MOST_EVENTS} events")
    return np.concatenate(taken), n_events


def preparing(method):
    """Runs all parts for their sample times, one after the other."""
    return lambda parts, tol: lambda times: [whole(part, method, tol, own) for part, own in zip(parts, times)]
