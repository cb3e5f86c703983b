"""The variants, what a tool delivers of them, how that is judged, and the stopwatch."""

import csv
import math
import os
import resource
import shutil
import subprocess
import sys
from dataclasses import dataclass, field

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))

import model

HERE = os.path.dirname(os.path.abspath(__file__))
PROGRAM = os.environ.get("DELTAZERO", "deltazero")
# Largest error that a run may have, and the part of the runs that must keep to it.
ACCURACY, PART = 1e-3, 0.99
# Seconds after which a setting is not repeated.
LONG = 10.0


@dataclass
class Variant:
    """A joint of a variant in the numbers of `model.py`."""

    joint: tuple
    stiffness: float
    damping: float
    mu: float
    clearance: float

    def start(self):
        return (0.0, -self.clearance, 0.0, 0.0, 0.0, 0.0)

    def scale(self):
        """Natural scale of each state, from which absolute tolerances follow."""
        return model.scale(self.joint, self.clearance)


@dataclass
class Ends:
    """What a tool delivers: of each variant both joints' X, Y, theta at the end, and events of both together, if it counts them."""

    states: list = field(default_factory=list)
    events: list = field(default_factory=list)


def sweep(folder, workers, *sets):
    """Runs ours anew, and returns the rows."""
    # A sweep that is finished is not made again.
    shutil.rmtree(folder, ignore_errors=True)
    plan = os.path.join(HERE, "plan.toml")
    more = [word for pair in sets for word in ("--set", pair)]
    subprocess.run([PROGRAM, "sweep", plan, "--out", folder, "--quiet", "--threads", str(workers), *more], check=True,
                   stdout=subprocess.DEVNULL)
    with open(os.path.join(folder, "runs.csv"), newline="") as file:
        return list(csv.DictReader(file))


def ends_of(rows):
    """X is x01 of joint 1, z02 of joint 2."""
    columns = {1: ("d1_m", "d2_m", "theta_rad"), 2: ("d2_m", "d1_m", "theta_rad")}
    of_joint = lambda row, j: [float(row[f"bay1_joint{j}_{column}"]) for column in columns[j]]
    return Ends([[of_joint(row, j) for j in (1, 2)] for row in rows], [int(row["n_events"]) for row in rows])


def variants_of(rows):
    """Of each row both joints, by the same bits that ours has."""

    def variant(row, j):
        number = lambda key: float(row[key])
        joint = (*model.JOINTS[j][:-1], number("drive.m1" if j == 1 else "drive.m4"))
        contact = [number(f"contact.{key}") for key in ("stiffness", "damping")]
        return Variant(joint, *contact, number("friction.coefficient"), number("joint.clearance"))

    return [[variant(row, j) for j in (1, 2)] for row in rows]


def error(variants, own, reference):
    """The error of a variant at the end: of the pin over the clearance, or of the angle over the angle, the worse of both joints."""
    if own is None:
        return math.inf
    worst = 0.0
    for variant, a, b in zip(variants, own, reference):
        pin = math.hypot(a[0] - b[0], a[1] - b[1]) / variant.clearance
        worst = max(worst, pin, abs(a[2] / b[2] - 1.0))
    return worst


COLUMNS = ("tool", "version", "method", "setting", "workers", "variants", "repeats", "cpu_s", "runs_per_s_and_core", "e_median",
           "e_99_percent", "e_max", "within_1e-3", "events_right", "seconds_apart")


def judged(label, n_workers, all_variants, ends, reference, cpu, repeats, apart=0.0):
    """A row: a run of the ladder."""
    n = len(ends.states)
    errors = sorted(map(error, all_variants[:n], ends.states, reference.states))
    quantile = lambda part: errors[min(n - 1, math.ceil(part * n) - 1)]
    right = sum(a == b for a, b in zip(ends.events, reference.events)) if ends.events else ""
    within = sum(e <= ACCURACY for e in errors)
    row = (*label, n_workers, n, repeats, f"{cpu:.4g}", f"{n / cpu:.4g}", f"{quantile(0.5):.2e}", f"{quantile(PART):.2e}",
           f"{errors[-1]:.2e}", within, right, f"{apart:.2g}")
    return dict(zip(COLUMNS, row))


def cpu_s():
    """Seconds of the processor of this process and of those that it waited for."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(own.ru_utime + own.ru_stime for own in used)


def quickest(solve, repeats):
    """The least time of the processor of several runs, fewer where they are long; how many, and what the last one delivered."""
    best, spent, n = math.inf, 0.0, 0
    while n < repeats and (n == 0 or spent < LONG):
        before = cpu_s()
        ends = solve()
        took = cpu_s() - before
        best, spent, n = min(best, took), spent + took, n + 1
    return best, n, ends
