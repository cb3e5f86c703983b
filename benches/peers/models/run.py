"""Five text models by deltazero, heyoka and scipy: error against time, by one measure.

    DELTAZERO=target/release/deltazero python3 benches/peers/models/run.py [MODEL…]

Ours is `deltazero study` of the text as it comes with the program. The others are given the study's own reference: they deliver
its samples, and their error e is the largest difference over the largest value of that state. Time is that of the processor,
the least of three runs; what is compiled just in time is compiled before. Written to results/models.csv.
"""

import csv
import json
import math
import os
import subprocess
import sys
import tempfile
import time
import types

import numpy as np

from models import MODELS

HERE = os.path.dirname(os.path.abspath(__file__))
PROGRAM = os.environ.get("DELTAZERO", "target/release/deltazero")
TOLERANCES = [10.0 ** -k for k in range(3, 14)]
# A ladder ends at its first run beyond this [s].
LONGEST = 20.0
EXPLICIT = ["rk45", "dop853", "vern98", "taylor", "auto"]
IMPLICIT = ["rodas5p", "radau5", "bdf", "auto"]
# Errors of the summary.
ERRORS = [1e-3, 1e-6, 1e-9]


def ours(model, folder):
    """The rows of the study, its sample times and its samples."""
    text = os.path.join(folder, model.name + ".toml")
    new = subprocess.run([PROGRAM, "model", "new", model.name], capture_output=True, check=True)
    with open(text, "wb") as file:
        file.write(new.stdout)
    out = os.path.join(folder, model.name)
    sets = ["--set", f"study.methods={json.dumps(IMPLICIT if model.stiff else EXPLICIT)}", "--set", 'study.events=["located"]', "--set", "study.repeats=3"]
    subprocess.run([PROGRAM, "study", "--model", text, "--out", out, "--quiet"] + sets, stdout=subprocess.DEVNULL, check=True)
    with open(os.path.join(out, "reference.json")) as file:
        part = json.load(file)["reference"]["parts"][0]
    with open(os.path.join(out, "study.csv")) as file:
        rows = [
            ("deltazero", row["method"], row["rtol"], row["e"], row["n_events"], row["cpu_s_min"])
            for row in csv.DictReader(file)
            if row["status"] == "ok" and row["rtol"]
        ]
    samples = np.array(part["samples"], dtype=float)
    return rows, part["times"], samples


def by_scipy(method):
    from scipy.integrate import solve_ivp

    f = types.SimpleNamespace(sin=math.sin, join=lambda a, b: np.concatenate([a, b]))

    def prepare(model, tol):
        def guards_of(mode):
            n = len(model.guards(mode, np.array(model.start)))
            events = []
            for i in range(n):
                event = lambda t, y, i=i: model.guards(mode, y)[i]
                event.terminal, event.direction = True, -1.0
                events.append(event)
            return events

        modes = {}

        def step(mode, t, y, end, times):
            if mode not in modes:
                modes[mode] = (lambda t, y: model.rates(mode, y, f), guards_of(mode))
            rates, events = modes[mode]
            # The end is a sample too: without an event it is where the next mode begins.
            grid = list(times) if len(times) and times[-1] == end else list(times) + [end]
            atol = [tol * scale for scale in model.scale]
            found = solve_ivp(rates, (t, end), y, method=method, rtol=max(tol, 2.3e-14), atol=atol, t_eval=grid, events=events or None)
            if found.status < 0:
                raise RuntimeError(found.message)
            samples = list(np.transpose(found.y))
            if found.status == 1:
                guard = next(i for i, at in enumerate(found.t_events) if len(at))
                return found.t_events[guard][0], list(found.y_events[guard][0]), guard, samples[: len(times)]
            return end, list(samples[-1]), None, samples[: len(times)]

        return step

    return prepare


def by_heyoka():
    import heyoka as hy

    hy.set_logger_level_error()
    f = types.SimpleNamespace(sin=hy.sin, join=lambda a, b: list(a) + list(b))

    # heyoka tells a terminal event by −1 − its index; its other outcomes are far below.
    def is_event(outcome):
        return -1000 < outcome < 0

    def prepare(model, tol):
        compiled = {}
        names = [hy.expression(f"y{i}") for i in range(len(model.start))]

        def of(mode):
            if mode not in compiled:
                events = [hy.t_event(g, direction=hy.event_direction.negative) for g in model.guards(mode, names)]
                slopes = [hy.expression(x) if isinstance(x, float) else x for x in model.rates(mode, names, f)]
                compiled[mode] = hy.taylor_adaptive(list(zip(names, slopes)), list(model.start), t_events=events, tol=tol)
            return compiled[mode]

        def step(mode, t, y, end, times):
            ta = of(mode)
            ta.time = t
            ta.state[:] = y
            if ta.with_events:
                ta.reset_cooldowns()
            # A root at the start of a step hides one inside it: a mode first takes a short step off its surface.
            ahead = times[0] if len(times) else end
            samples, outcome = [], int(ta.propagate_until(min(t + model.clear(mode, y), ahead))[0])
            if len(times) and not is_event(outcome):
                outcome, _, _, _, _, samples = ta.propagate_grid([ta.time] + list(times))
                samples, outcome = list(samples[1:]), int(outcome)
            if not is_event(outcome):
                outcome = int(ta.propagate_until(end)[0])
            guard = -outcome - 1 if is_event(outcome) else None
            return ta.time, ta.state.copy(), guard, samples

        return step

    return prepare


def run(model, step, times):
    """The samples and the number of events."""
    t, y, mode, data = 0.0, list(model.start), model.mode, None
    samples, n_events, n = [], 0, 0
    while t < model.t_end:
        until = model.until(mode, data)
        end = model.t_end if until is None else min(until, model.t_end)
        if end > t:
            last = n
            while last < len(times) and times[last] <= end:
                last += 1
            t, y, guard, taken = step(mode, t, y, end, times[n:last])
            samples.extend(taken)
            n += len(taken)
            if guard is None and (until is None or t < until):
                break
        else:
            guard = None
        mode, y, data = model.jump(mode, guard, t, y, data)
        n_events += 1
        if n_events > 5000:
            raise RuntimeError("more than 5000 events")
    return np.array(samples), n_events


def measured(tool, method, prepare, model, times, reference):
    largest = np.abs(reference).max(axis=0)
    for tol in TOLERANCES:
        try:
            step = prepare(model, tol)
            if tool == "heyoka":
                run(model, step, times)
            took = []
            for _ in range(3):
                start = time.process_time()
                samples, n = run(model, step, times)
                took.append(time.process_time() - start)
                if took[0] > LONGEST / 3:
                    break
            e = (np.abs(samples - reference) / largest).max() if samples.shape == reference.shape else math.nan
            yield tool, method, f"{tol:.0e}", f"{e:.3e}", n, f"{min(took):.4e}"
        except Exception as error:
            yield tool, method, f"{tol:.0e}", "", 0, f"{type(error).__name__}: {error}"[:80]
            continue
        if took[0] > LONGEST / 3:
            break


def summary(rows):
    """The quickest run of each tool at or below each error, in milliseconds, as a table."""
    lines = ["| model | tool | " + " | ".join(f"e ≤ {e:.0e}".replace("e-0", "e-") for e in ERRORS) + " |", "|---|---" + "|---" * len(ERRORS) + "|"]
    for model, tool in dict.fromkeys((row[0], row[1]) for row in rows):
        cells = []
        for most in ERRORS:
            reached = [(float(row[6]), row) for row in rows if row[:2] == (model, tool) and row[4] and float(row[4]) <= most]
            cells.append("—" if not reached else "{:.3g} `{}` ({} events)".format(1e3 * min(reached)[0], *(min(reached)[1][i] for i in (2, 5))))
        lines.append(f"| {model} | {tool} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main():
    results = os.path.join(HERE, "..", "results")
    chosen = [model for model in MODELS if len(sys.argv) < 2 or model.name in sys.argv[1:]]
    peers = [("heyoka", "taylor", by_heyoka())] + [("scipy", m, by_scipy(m)) for m in ("RK45", "DOP853", "Radau", "BDF", "LSODA")]
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for model in chosen:
            own, times, reference = ours(model, folder)
            rows += [(model.name,) + row for row in own]
            for tool, method, prepare in peers:
                if tool == "scipy" and model.stiff != (method in ("Radau", "BDF", "LSODA")):
                    continue
                for row in measured(tool, method, prepare, model, times, reference):
                    rows.append((model.name,) + row)
                    print(model.name, *row, flush=True)
    with open(os.path.join(results, "models.csv"), "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["model", "tool", "method", "tolerance", "e", "n_events", "cpu_s"])
        table.writerows(rows)
    with open(os.path.join(results, "models.md"), "w") as file:
        file.write(summary(rows))


if __name__ == "__main__":
    main()
