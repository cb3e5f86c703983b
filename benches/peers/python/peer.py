"""What every peer in Python shares: samples, ladder, stopwatch, and the lines that Rust reads."""

import os
import sys
import time

from model import JOINTS

N_SAMPLES, T_END = 200, 2.0
TIMES = [0.01 * k for k in range(1, N_SAMPLES)] + [T_END]
LADDER = [f"{('1', '5.6', '3.2', '1.8')[k % 4]}e-{3 + (k + 3) // 4}" for k in range(41)]
# Seconds on the processor: the longest run of a ladder, and the repeats of a run.
LONGEST = float(os.environ.get("PEERS_LONGEST", "1"))
BUDGET = float(os.environ.get("PEERS_BUDGET", "0.3"))


class Track:
    """What a run delivers of one joint."""

    def __init__(self, mode=0):
        self.samples, self.events, self.n_rhs, self.mode = [], [], 0, mode

    def change(self, t, after):
        if after != self.mode:
            self.events.append((t, self.mode, after))
        self.mode = after


def one_by_one(solve):
    """A run of both joints, from `solve(joint number, rtol) -> Track`."""
    return lambda rtol: [solve(number, rtol) for number in JOINTS]


def once(solve, rtol):
    wall, cpu = time.perf_counter(), time.thread_time()
    tracks = solve(rtol)
    return (time.perf_counter() - wall, time.thread_time() - cpu), tracks


def ladder(tool, version, method, handling, solve, rtols=LADDER, warm_up=False):
    """Runs `solve(rtol) -> Tracks of both joints` over the ladder and prints its lines."""
    folder = sys.argv[-1]
    label = f"{tool},{version},{method},{handling}"
    for text in rtols:
        try:
            if warm_up:  # compilation is apart
                once(solve, float(text))
            best, tracks = once(solve, float(text))
            spent, repeats = best[1], 1
            while spent + 0.5 * best[1] < BUDGET:
                taken, _ = once(solve, float(text))
                best = tuple(map(min, best, taken))
                spent, repeats = spent + taken[1], repeats + 1
        except Exception as error:  # a failed run is a row too
            print(f"failed,{label},{text},{type(error).__name__} {error}".replace("\n", " "), flush=True)
            continue
        name = f"{tool}-{method}-{handling}-{text}".replace(" ", "_")
        with open(os.path.join(folder, name), "w") as file:
            for joint, track in zip(JOINTS, tracks):
                for y in track.samples:
                    file.write("s,%d," % joint + ",".join("%.17g" % float(v) for v in y) + "\n")
                for t, before, after in track.events:
                    file.write("e,%d,%.17g,%d,%d\n" % (joint, t, before, after))
        counts = [track.n_rhs for track in tracks]
        n_rhs = "" if None in counts else sum(counts)
        print(f"run,{label},{text},{n_rhs},{1e3 * best[0]:.6f},{1e3 * best[1]:.6f},{repeats},{name}", flush=True)
        if best[1] > LONGEST:
            break
