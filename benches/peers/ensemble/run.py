"""Runs the tools that are installed over their ladders, and writes a row a run and the table of the quickest."""

import argparse
import csv
import importlib
import os
import sys
import tempfile

import variants

# Module, and how many of the variants it takes: a slow tool needs fewer to be timed.
TOOLS = {"ours": 1.0, "heyoka_batch": 1.0, "scipy_pool": 0.1, "exudyn_variation": 0.1}
# The reference, and what it is held against.
REFERENCE = ("solver.method=taylor", "solver.rtol=1e-14")
CHECK = ("solver.method=vern98", "solver.rtol=1e-14")


def rows_of(name, folder, all_variants, reference, asked):
    try:
        tool = importlib.import_module(name)
    except ImportError as missing:
        print(f"skipped: {name}, {missing}", file=sys.stderr)
        return
    own = all_variants[: max(1, round(TOOLS[name] * len(all_variants)))]
    for label, apart, solve in tool.settings(folder, own, asked.workers):
        cpu, repeats, ends = variants.quickest(solve, asked.repeats)
        row = variants.judged(label, asked.workers, own, ends, reference, cpu, repeats, apart)
        print(", ".join(f"{key} {value}" for key, value in row.items()), file=sys.stderr, flush=True)
        yield row


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--workers", type=int, default=1, help="processes or threads of each tool")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--only", help="tools with this in their name")
    parser.add_argument("out", help="the folder of ensemble.csv and ensemble.md; rows of other tools and workers there are kept")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = variants.sweep(f"{folder}/reference", os.cpu_count(), *REFERENCE)
        all_variants, reference = variants.variants_of(rows), variants.ends_of(rows)
        other = variants.ends_of(variants.sweep(f"{folder}/check", os.cpu_count(), *CHECK))
        apart = sorted(map(variants.error, all_variants, other.states, reference.states))
        print(f"reference: e of a check 99 % {apart[len(apart) * 99 // 100]:.1e}, most {apart[-1]:.1e}", file=sys.stderr)
        found = []
        for name in TOOLS:
            if asked.only is None or asked.only in name:
                found.extend(rows_of(name, folder, all_variants, reference, asked))
    write(asked.out, found)


def write(folder, found):
    """All runs, with those that are there of other tools or workers, and the table of the quickest."""
    path = os.path.join(folder, "ensemble.csv")
    of = lambda row: (row["tool"], str(row["workers"]))
    measured = set(map(of, found))
    if os.path.exists(path):
        with open(path, newline="") as file:
            found = [row for row in csv.DictReader(file) if of(row) not in measured] + found
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, variants.COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(found)
    with open(os.path.join(folder, "ensemble.md"), "w") as file:
        file.write(table(found))


def table(rows):
    """Of each tool the quickest method whose runs keep to the accuracy, and the quickest that also has the events right."""
    part = lambda row, column: float(row[column] or 0) / float(row["variants"])
    needs = (("", ["within_1e-3"]), (", events right", ["within_1e-3", "events_right"]))
    text = "| tool | workers | accuracy kept | quickest | runs/s and core | e: median, 99 %, most | events right |\n|---|---|---|---|---|---|---|\n"
    for tool, workers in dict.fromkeys((row["tool"], str(row["workers"])) for row in rows):
        own = [row for row in rows if (row["tool"], str(row["workers"])) == (tool, workers)]
        for name, columns in needs:
            kept = [row for row in own if all(part(row, column) >= variants.PART for column in columns)]
            best = max(kept, key=lambda row: float(row["runs_per_s_and_core"]), default=None)
            label = f"e ≤ {variants.ACCURACY:g}{name}"
            if best is None:
                text += f"| {tool} | {workers} | {label} | — | | | |\n"
                continue
            errors = ", ".join(best[column] for column in ("e_median", "e_99_percent", "e_max"))
            right = f"{100 * part(best, 'events_right'):.1f} %" if best["events_right"] != "" else "not told"
            version = best["version"].split(" + ")[0]
            text += (f"| {tool} {version} | {workers} | {label} | {best['method']}, {best['setting']} "
                     f"| {best['runs_per_s_and_core']} | {errors} | {right} |\n")
    return text


if __name__ == "__main__":
    main()
