"""Five text models by deltazero, and the same in Rust by its solvers and by the crate diffsol, in C++ by CVODE of SUNDIALS: error
against time, as in run.py.

    DELTAZERO=target/release/deltazero SUNDIALS=PREFIX python3 benches/peers/models/run_compiled.py [MODEL…]

It needs a Rust toolchain, g++ and SUNDIALS 6. SUNDIALS names where it is installed; without, the system's is taken, which Debian 12
compiles without optimisation: three to seven times slower. This makes a fast one, in half a minute:

    git clone --depth 1 --branch v6.4.1 https://github.com/LLNL/sundials && cd sundials
    cmake -B build -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS="-O3 -march=native" -DBUILD_SHARED_LIBS=OFF -DEXAMPLES_ENABLE_C=OFF \\
        -DEXAMPLES_INSTALL=OFF -DCMAKE_INSTALL_PREFIX=PREFIX && cmake --build build --target install

All take turns, and of each run the least time counts. Written to results/models_compiled.csv and models_compiled.md.
"""

import os
import subprocess
import sys
import tempfile

import numpy as np

from models import MODELS
from run import HERE, least, ours, write

# Turns of each tool; in each a run is made three times.
ROUNDS = 10
NAMES = ["van_der_pol", "integrate_and_fire", "buck_converter", "rocking_block", "carts"]


def cvode(folder):
    """The path of the program in cvode/."""
    program, prefix = os.path.join(folder, "cvode"), os.environ.get("SUNDIALS")
    paths = [f"-I{prefix}/include", f"-L{prefix}/lib", f"-Wl,-rpath,{prefix}/lib"] if prefix else []
    source = os.path.join(HERE, "cvode", "main.cpp")
    libraries = ["-lsundials_cvode", "-lsundials_nvecserial"]
    subprocess.run(["g++", "-std=c++17", "-O3", "-march=native", source, "-o", program] + paths + libraries, check=True)
    return program


def rust():
    """The path of the program in rust/, built for this machine."""
    peers = os.path.join(HERE, "..")
    build = ["cargo", "build", "--release", "--locked", "--bin", "models-rust", "--target-dir", "target/native"]
    subprocess.run(build, cwd=peers, check=True, env=os.environ | {"RUSTFLAGS": "-C target-cpu=native"})
    return os.path.join(peers, "target", "native", "release", "models-rust")


def by(program, model, reference, folder):
    """The rows of a program that is given a model and a file of times, and prints its runs."""
    grid = os.path.join(folder, "times")
    with open(grid, "w") as file:
        file.writelines(f"{t!r}\n" for t in reference.times.tolist())
    lines = subprocess.run([program, model.name, grid, folder], capture_output=True, check=True, text=True).stdout.splitlines()
    for tool, method, tolerance, n_events, seconds, path in (line.split(",") for line in lines):
        e = f"{reference.error(np.loadtxt(path, ndmin=2)):.3e}" if path else ""
        yield tool, method, tolerance, e, int(n_events), seconds


def main():
    chosen = [model for model in MODELS if model.name in (sys.argv[1:] or NAMES)]
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        programs = [cvode(folder), rust()]
        for model in chosen:
            own, theirs = [], []
            for _ in range(ROUNDS):
                new, [reference] = ours(model, folder, 3)
                own += new
                for program in programs:
                    theirs += by(program, model, reference, folder)
            rows += [(model.name,) + row for row in least(own) + least(theirs)]
            print(model.name, flush=True)
    write("models_compiled", rows)


if __name__ == "__main__":
    main()
