"""`deltazero sweep` of the plan: from the start of the program to `runs.csv`, writing and all."""

import subprocess

import variants

LADDER = {
    "taylor": ("1e-5", "3e-6", "1e-6", "1e-7", "1e-8", "1e-9"),
    "dop853": ("1e-6", "1e-7", "1e-8"),
    "rk45": ("1e-6", "1e-7", "1e-8"),
    "vern98": ("1e-4", "3e-5", "1e-5", "1e-6"),
}


def settings(folder, all_variants, workers):
    """Label, seconds apart from the runs, and what makes the runs."""
    version = subprocess.run([variants.PROGRAM, "--version"], check=True, capture_output=True, text=True).stdout.split()[1]
    for method, tolerances in LADDER.items():
        for rtol in tolerances:
            sets = (f"solver.method={method}", f"solver.rtol={rtol}")
            solve = lambda sets=sets: variants.ends_of(variants.sweep(f"{folder}/sweep", workers, *sets))
            yield ("deltazero", version, method, f"rtol {rtol}"), 0.0, solve
