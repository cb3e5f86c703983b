"""A drop test: the damping of a pad is found from a measured rebound, then the integrator for it, then what the
tolerances of manufacture do to the force. Python writes the model and reads the results; it needs no package.

    cargo build --release && python3 examples/drop_test.py
"""

import csv
import json
import os
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

[modes.flight]
definitions = { F = 0 }
events = [{ when = "x < 0", to = "contact" }]

# The pad pushes and does not pull: the mass leaves it where the force ends.
[modes.contact]
role = "contact"
definitions = { F = "-K*x - D*v" }
events = [{ when = "F < 0", to = "leaving" }]

[modes.leaving]
definitions = { F = 0 }
events = [{ when = "x > 0", to = "flight" }]

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
normal = [5e5, 2.5e4]

[[random.key]]
key = "h"
uniform = [0.195, 0.205]
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
    model = folder / "drop_test.toml"
    model.write_text(MODEL)

    def rebound(damping):
        run = folder / "run"
        parameter = f"D={damping!r}"
        deltazero("simulate", "--model", model, "--set", parameter, "--no-horizon", "--force", "--out", run)
        landed = [float(event["t_s"]) for event in rows(run / "events.csv") if event["mode_after"] == "flight"]
        return max(float(row["x_m"]) for row in rows(run / "trajectory.csv") if float(row["t_s"]) > landed[0])

    low, high = 0.0, 500.0
    while high - low > 0.01:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if rebound(middle) > MEASURED else (low, middle)
    damping = f"D={low!r}"
    print(f"D = {low:.1f} N s/m rebounds to {MEASURED} m")

    best = deltazero("recommend", "--model", model, "--set", damping, "--accuracy", "1e-6")
    print(f"to 1e-6: {best['method']} at rtol {best['rtol']:g}, e = {best['expected_e']:.1e}")

    plan, swept = folder / "plan.toml", folder / "swept"
    plan.write_text(SWEEP)
    deltazero("sweep", plan, "--model", model, "--set", damping, "--out", swept)
    forces = sorted(float(run["peak_force_n"]) for run in rows(swept / "runs.csv"))
    print(f"peak force of {len(forces)} pads: median {forces[len(forces) // 2]:.0f} N, largest {forces[-1]:.0f} N")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        main(Path(folder))
