"""heyoka: one integrator for all modes, one propagate_grid from the start to the end, samples and all.

The modes are parameters, 1 for the one that holds and 0 for the others; an event calls Python, which makes the transition, and
compiled code goes on. An integrator a mode and a call from event to event takes 2 to 3 times as long.

Traps worked around: a mode begins at a root of its event, which would fire for ever, and within its cool-down a return would be
lost; so each guard is shifted to the inside of its mode and needs no cool-down. A guard is part of the norm that tolerances are
relative to, so one that a mode has not is small. The search for a root gives up, with no more than a warning, where it is at less
than some 1e-8 of the step: bounces that accumulate end in rest before.
"""

import copy
import types

import heyoka as hy
import numpy as np

hy.set_logger_level_critical()

# What a guard is in a mode that has none.
NONE = 1e-9
MOST_EVENTS = 5000


class State:
    """The mode of a model, what it remembers, and the number of events."""

    def __init__(self, model):
        self.model = model

    def begin(self):
        self.mode, self.data, self.n_events = self.model.mode, None, 0
        return self.settle(0.0, list(self.model.start))

    def settle(self, t, y):
        guard = self.model.at_once(self.mode, y)
        return y if guard is None else self.jump(guard, t, y)

    def jump(self, guard, t, y):
        self.mode, y, self.data = self.model.jump(self.mode, guard, t, y, self.data)
        self.n_events += 1
        if self.n_events > MOST_EVENTS:
            raise RuntimeError(f"more than {MOST_EVENTS} events")
        return self.settle(t, y)


class Callback:
    """Calls this at an event of that guard; heyoka copies it with its integrator, and what it calls stays one."""

    def __init__(self, call, guard):
        self.call, self.guard = call, guard

    def __call__(self, ta, _, *lane):
        self.call(ta, self.guard, *lane)
        return True

    def __deepcopy__(self, _):
        return copy.copy(self)


def functions(weight=None):
    """Those of a mode; a root has no series below zero, so outside its mode it is that of one."""
    root = hy.sqrt if weight is None else lambda x: hy.sqrt(weight * x + (1.0 - weight))
    return types.SimpleNamespace(sin=hy.sin, cos=hy.cos, exp=hy.exp, sqrt=root, join=lambda a, b: list(a) + list(b))


def expression(x):
    return hy.expression(x) if isinstance(x, float) else x


def weighted(weights, terms):
    """The term of the mode that holds."""
    if len(terms) == 1:
        return expression(terms[0])
    return hy.sum([weight * expression(term) for weight, term in zip(weights, terms)])


def whole(model, tol):
    """A run of a model in one part."""
    modes, state = model.modes, State(model)
    n = len(modes)
    y = [hy.expression(f"y{i}") for i in range(len(model.start))]
    weights, until, data = [hy.par[i] for i in range(n)], hy.par[n], hy.par[n + 1]
    of = [functions(weight) if n > 1 else functions() for weight in weights]
    rates = [model.rates(mode, hy.time, y, data, f) for mode, f in zip(modes, of)]
    guards = [model.guards(mode, hy.time, y, data, f) for mode, f in zip(modes, of)]
    holds = {mode: row for mode, row in zip(modes, np.eye(n))}

    def enter(ta, y):
        ta.state[:] = y
        pars = ta.pars
        if n > 1:
            pars[:n] = holds[state.mode]
        if model.timed:
            end = model.until(state.mode, state.data)
            pars[n] = 2.0 * model.t_end if end is None else end
        if model.keeps:
            pars[n + 1] = 1.0 if state.data is None else state.data

    def event(function, guard):
        call = lambda ta, guard: enter(ta, state.jump(guard, ta.time, ta.state.tolist()))
        return hy.t_event(function, callback=Callback(call, guard), direction=hy.event_direction.negative, cooldown=0.0)

    events = []
    for i in range(max(map(len, guards))):
        own = [guard[i] if i < len(guard) else NONE for guard in guards]
        events.append(event(weighted(weights, own) + model.shift, i))
    if model.timed:
        events.append(event(NONE * (until - hy.time), None))
    slopes = [weighted(weights, own) for own in zip(*rates)]
    ta = hy.taylor_adaptive(list(zip(y, slopes)), list(model.start), t_events=events, tol=tol)

    def run(times):
        ta.time = 0.0
        enter(ta, state.begin())
        samples = ta.propagate_grid(np.append(0.0, times))[-1]
        return samples[1:], state.n_events

    return run


def lanes(parts, tol):
    """A run of all parts of a model, each in a lane of a vector register: one integrator, whose parameters are their constants."""
    states, n = [State(part) for part in parts], len(parts)
    y = [hy.expression(f"y{i}") for i in range(len(parts[0].start))]
    rates, guards, constants = parts[0].in_lanes(y, hy.par, functions())

    def enter(ta, y, lane):
        ta.state[:, lane] = y
        ta.pars[:, lane] = constants(parts[lane], states[lane].mode)

    def call(ta, guard, lane):
        enter(ta, states[lane].jump(guard, None, ta.state[:, lane].tolist()), lane)

    def event(function, guard):
        return hy.t_event_batch(function, callback=Callback(call, guard), direction=hy.event_direction.negative, cooldown=0.0)

    events = [event(guard + parts[0].shift, i) for i, guard in enumerate(guards)]
    pars = np.transpose([constants(part, "free") for part in parts])
    start = np.transpose([part.start for part in parts])
    ta = hy.taylor_adaptive_batch(list(zip(y, rates)), start, pars=pars, t_events=events, tol=tol)

    def run(times):
        ta.set_time(0.0)
        for lane, state in enumerate(states):
            enter(ta, state.begin(), lane)
        samples = ta.propagate_grid(np.append(0.0, times)[:, None] * np.ones(n))[-1]
        return [(samples[1:, :, lane], state.n_events) for lane, state in enumerate(states)]

    return run


def prepare(parts, tol):
    """Runs all parts for their sample times."""
    if len(parts) == 1:
        run = whole(parts[0], tol)
        return lambda times: [run(times[0])]
    run = lanes(parts, tol)
    return lambda times: run(times[0])
