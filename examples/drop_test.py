"""A drop test: the damping of a pad is found from a measured rebound, then the integrator for it, then the forces of
200 pads within the tolerances of their manufacture. Python writes the model and reads the results; it needs no package.

    cargo build --release && python3 examples/drop_test.py
"""

import csv
import json
import os
import statistics
import subprocess
import tempfile
from pathlib import Path

PROGRAM = os.environ.get("DELTAZERO", Path(__file__).parent.parent / "target/release/deltazero")

MODEL = """
name = "drop test"
t_end = 0.6

[parameters]
m = { value = 2.0, unit = "kg", above = 0 }
K = { value = 5e5, unit = "N/m", above = 0 }
D = { value = 0.0, unit = "N s/m", min = 0 }
g = { value = 9.81, unit = "m/s^2" }
h = { value = 0.2, unit = "m", above = 0 }

[states]
x = { start = "h", unit = "m", scale = 1e-3 }
v = { start = 0, unit = "m/s", scale = 1 }

[rates]
x = "v"
v = "F/m - g"

[definitions]
push = "-K*x - D*v"

[modes.flight]
definitions = { F = 0 }
events = [{ when = "x < 0", to = "contact" }]

[modes.contact]
role = "contact"
definitions = { F = "push" }
events = [{ when = "push < 0", to = "leaving" }]

# The pad does not pull. The mass is free of it while it is still dented, and rises out of the dent or falls back.
[modes.leaving]
definitions = { F = 0 }
events = [{ when = "x > 0", to = "flight" }, { when = "push > 0", to = "contact" }]

[contact]
depth = "-x"
force = "F"
"""

MEASURED = 0.125  # Height of the rebound [m].

SWEEP = """
[random]
samples = 200
seed = 1

[[random.key]]
key = "K"
uniform = [4.5e5, 5.5e5]

[[random.key]]
key = "D"
uniform = [{least}, {most}]
"""


def deltazero(*args):
    """What a command prints as JSON. An error of the program is raised with what it says."""
    done = subprocess.run([PROGRAM, *args, "--json", "--quiet"], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    return json.loads(done.stdout)


def rows(path):
    """The rows of a CSV file."""
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def main(folder):
    model, plan = folder / "drop_test.toml", folder / "plan.toml"
    model.write_text(MODEL)

    def rebound(damping):
        run = folder / "run"
        # --no-horizon saves the second run that tells how long the motion is predictable.
        deltazero("simulate", "--model", model, "--set", f"D={damping}", "--no-horizon", "--force", "--out", run)
        freed = [float(event["t_s"]) for event in rows(run / "events.csv") if event["mode_after"] == "flight"]
        return max(float(row["x_m"]) for row in rows(run / "trajectory.csv") if float(row["t_s"]) > freed[0])

    low, high = 0.0, 500.0
    while high - low > 0.01:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if rebound(middle) > MEASURED else (low, middle)
    damping = low
    print(f"D = {damping:.1f} N s/m rebounds to {MEASURED} m")

    best = deltazero("recommend", "--model", model, "--set", f"D={damping}", "--accuracy", "1e-6")
    size = "step" if best["rtol"] is None else "rtol"
    print(f"to 1e-6: {best['method']} at {size} {best[size]:g}, e = {best['expected_e']:.1e}")

    plan.write_text(SWEEP.format(least=0.9 * damping, most=1.1 * damping))
    solver = [word for key in ("method", "events", size) for word in ("--set", f"solver.{key}={best[key]}")]
    deltazero("sweep", plan, "--model", model, *solver, "--out", folder / "swept")
    forces = [float(run["peak_force_n"]) for run in rows(folder / "swept" / "runs.csv")]
    print(f"peak force of {len(forces)} pads: median {statistics.median(forces):.0f} N, largest {max(forces):.0f} N")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        main(Path(folder))
