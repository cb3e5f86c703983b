"""The text models by deltazero, heyoka and scipy: error against time, by one measure.

    DELTAZERO=target/release/deltazero python3 benches/peers/models/run.py [MODEL…]

Ours is `deltazero study` of the text as it comes with the program. The others are given the study's own reference: they deliver
its samples, and their error e is the largest difference over the largest value of that state. Time is that of the processor,
the least of nine runs, of fewer where they are long, and of four such rounds of ours and heyoka; what is compiled just in
time is compiled before. Written to results/models.csv, where rows of models that are not named stay as they are.
"""

import csv
import json
import math
import os
import subprocess
import sys
import tempfile
import time

import numpy as np

import by_heyoka
import by_scipy
import contacts
import models

HERE = os.path.dirname(os.path.abspath(__file__))
PROGRAM = os.environ.get("DELTAZERO", "target/release/deltazero")
TOLERANCES = [10.0 ** -k for k in range(3, 14)]
# The most runs of which the least counts; fewer where they are long.
REPEATS = 9
# Ours and heyoka, which are the closest, are run by turns as often, as other work on the machine comes and goes.
ROUNDS = 4
# A ladder ends at its first run beyond this [s].
LONGEST = 7.0
EXPLICIT = ["rk45", "dop853", "vern98", "taylor", "auto"]
IMPLICIT = ["rodas5p", "radau5", "bdf", "auto"]
# Errors of the summary.
ERRORS = [1e-3, 1e-6, 1e-9]


class Reference:
    """The samples of one part, and what an error is measured by: the largest length of each group of states."""

    def __init__(self, part):
        self.times, self.samples = np.array(part["times"], dtype=float), np.array(part["samples"], dtype=float)
        self.groups = [(group["states"], group["scale"]) for group in part["scale"]["groups"]]

    def error(self, samples):
        if samples.shape != self.samples.shape:
            return math.nan
        off = samples - self.samples
        return np.max([np.linalg.norm(off[:, states], axis=1).max() / scale for states, scale in self.groups])


def ours(model, folder, repeats=REPEATS):
    """The rows of the study and the reference of each part."""
    os.makedirs(folder, exist_ok=True)
    text = os.path.join(folder, model.name + ".toml")
    new = subprocess.run([PROGRAM, "model", "new", model.name], capture_output=True, check=True)
    with open(text, "wb") as file:
        file.write(new.stdout)
    out = os.path.join(folder, model.name)
    methods = list(dict.fromkeys((EXPLICIT if not model.stiff else []) + (IMPLICIT if model.stiff is not False else [])))
    sets = {"methods": methods, "rtol": TOLERANCES, "events": ["located"], "repeats": repeats}
    options = [word for key, value in sets.items() for word in ("--set", f"study.{key}={json.dumps(value)}")]
    subprocess.run([PROGRAM, "study", "--model", text, "--out", out, "--quiet"] + options, stdout=subprocess.DEVNULL, check=True)
    with open(os.path.join(out, "reference.json")) as file:
        parts = json.load(file)["reference"]["parts"]
    with open(os.path.join(out, "study.csv")) as file:
        rows = [
            ("deltazero", row["method"], row["rtol"], row["e"], row["n_events"], row["cpu_s_min"])
            for row in csv.DictReader(file)
            if row["status"] == "ok" and row["rtol"]
        ]
    return rows, [Reference(part) for part in parts]


def measured(tool, method, prepare, model, references):
    times = [reference.times for reference in references]
    for tol in TOLERANCES:
        try:
            whole = prepare(model.parts(), tol)
            if tool == "heyoka":
                whole(times)
            took = []
            while len(took) < REPEATS and sum(took) < LONGEST / 3:
                start = time.process_time()
                found = whole(times)
                took.append(time.process_time() - start)
            e = np.max([reference.error(samples) for reference, (samples, _) in zip(references, found)])
            yield tool, method, f"{tol:.0e}", f"{e:.3e}", sum(n for _, n in found), f"{min(took):.4e}"
        except Exception as error:
            yield tool, method, f"{tol:.0e}", "", 0, f"{type(error).__name__}: {error}"[:80]
            continue
        if took[0] > LONGEST:
            break


def least(rows):
    """The least time of rows that are the same but for it."""
    found = {}
    for *key, took in rows:
        found.setdefault(tuple(key), []).append(took)
    return [key + (min(times, key=lambda took: float(took) if key[3] else 0.0),) for key, times in found.items()]


def summary(rows):
    """The quickest run of each tool at or below each error, in milliseconds, as a table."""
    errors = " | ".join(f"e ≤ {e:.0e}".replace("e-0", "e-") for e in ERRORS)
    lines = [f"| model | tool | {errors} |", "|---|---" + "|---" * len(ERRORS) + "|"]
    for model, tool in dict.fromkeys((row[0], row[1]) for row in rows):
        cells = []
        for most in ERRORS:
            reached = [(float(row[6]), row) for row in rows if row[:2] == (model, tool) and row[4] and float(row[4]) <= most]
            if not reached:
                cells.append("—")
                continue
            took, row = min(reached)
            cells.append(f"{1e3 * took:.3g} `{row[2]}`" + (f" ({row[5]} events)" if int(row[5]) else ""))
        lines.append(f"| {model} | {tool} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def write(name, rows):
    """Writes the rows to results/ in the place of those of the same models, and their summary."""
    path = os.path.join(HERE, "..", "results", name)
    before = []
    if os.path.exists(path + ".csv"):
        with open(path + ".csv", newline="") as file:
            before = [tuple(row) for row in csv.reader(file)][1:]
    names, order = {row[0] for row in rows}, [model.name for model in models.MODELS + contacts.MODELS]
    rows = [row for row in before if row[0] in order and row[0] not in names] + rows
    rows.sort(key=lambda row: order.index(row[0]))
    with open(path + ".csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["model", "tool", "method", "tolerance", "e", "n_events", "cpu_s"])
        table.writerows(rows)
    with open(path + ".md", "w") as file:
        file.write(summary(rows))


def main():
    chosen = [model for model in models.MODELS + contacts.MODELS if len(sys.argv) < 2 or model.name in sys.argv[1:]]
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for model in chosen:
            own = []
            for k in range(ROUNDS):
                found, references = ours(model, os.path.join(folder, str(k)))
                own += found + list(measured("heyoka", "taylor", by_heyoka.prepare, model, references))
            own = least(own)
            for method in ("RK45", "DOP853", "Radau", "BDF", "LSODA"):
                if model.stiff is None or model.stiff == (method in ("Radau", "BDF", "LSODA")):
                    own += measured("scipy", method, by_scipy.preparing(method), model, references)
            rows += [(model.name,) + row for row in own]
            print(summary([(model.name,) + row for row in own]), flush=True)
    write("models", rows)


if __name__ == "__main__":
    main()
