#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
"""One table from the cases that script/bench has run, and how cost grows with their size.

    bench_table.py DIR      reads DIR/CASE.json; writes DIR/table.md and DIR/bench.json, and prints the table
"""

import json
import math
import pathlib
import statistics
import sys

COLUMNS = ("unknowns, clusters", "method", "threads", "median s", "worst s", "to mark s", "units", "worst", "of one thread",
           "iterations", "factorisations", "MINRES", "residual", "minima", "peak / factor", "setup, frames", "lag h: largest, rms")


def median(row, key):
    return statistics.median(frame[key] for frame in row["frames"])


def setup_frames(row, rows):
    """Setup over a static frame of the same case on one thread."""
    static = [r for r in rows if case(r) == case(row) and r["method"] == "quasi-newton"]
    return f"{row['setup'] / min(static, key=lambda r: r['threads'])['median']:.2g}" if static else ""


def case(row):
    return row["unknowns"], row["clusters"]


def method(row):
    return f"damped {1e3 * row['relaxation']:g} ms" if row["relaxation"] else row["method"]


def units_of_one_thread(row, rows):
    """Frames on more threads over one thread's factorisation of the same frame: median and worst."""
    for base in rows:
        if case(base) == case(row) and method(base) == method(row) and base["threads"] == 1 < row["threads"]:
            units = [f["seconds"] / (b["seconds"] / b["units"]) for f, b in zip(row["frames"], base["frames"])]
            return f"{statistics.median(units):.1f}, {max(units):.1f}"
    return ""


def cells(row, rows):
    frames = row["frames"]
    lag = max(f["lag_max"] for f in frames)
    linear = median(row, "linear") if row["method"] in ("newton-minres", "paper") else 0
    return (f"{row['unknowns']:,}, {row['clusters']:,}", method(row), row["threads"], f"{row['median']:.3g}",
            f"{row['worst']:.3g}", f"{row['to_mark']:.3g}" if row["to_mark"] and row["method"] != "paper" else "",
            f"{row['units_median']:.1f}", f"{row['units_worst']:.1f}", units_of_one_thread(row, rows),
            f"{median(row, 'iterations'):.0f}", f"{median(row, 'factorizations'):.1f}", f"{linear:,.0f}" if linear else "",
            f"{max(f['residual'] for f in frames):.0e}", f"{row['minima']} of {len(frames)}",
            f"{row['memory_over_factor']:.2f}", setup_frames(row, rows),
            f"{lag:.1f}, {max(f['lag_rms'] for f in frames):.1f}" if lag else "")


def growth(rows):
    """Exponents of time against unknowns from about 12,500 to each larger case."""
    for row in rows:
        for base in rows:
            same = (method(row), row["threads"]) == (method(base), base["threads"])
            if same and row["method"] in ("quasi-newton", "damped") and 12e3 < base["unknowns"] < 13e3 < row["unknowns"]:
                over = math.log(row["unknowns"] / base["unknowns"])
                yield (f"{method(row)}, {row['threads']} threads, {base['unknowns']:,} to {row['unknowns']:,} "
                       f"({row['clusters']:,} clusters): n^{math.log(row['median'] / base['median']) / over:.2f} median, "
                       f"n^{math.log(row['worst'] / base['worst']) / over:.2f} worst")


def speed_up(rows):
    for row in rows:
        for base in rows:
            if case(row) == case(base) and method(row) == method(base) and row["threads"] > base["threads"]:
                bits = "same bits" if row["same_bits"] else "OTHER BITS"
                yield (f"{row['unknowns']:,}, {row['clusters']:,}, {method(row)}: {row['threads']} threads "
                       f"{base['median'] / row['median']:.2f} times as fast, {bits}")


def main():
    directory = pathlib.Path(sys.argv[1] if len(sys.argv) == 2 else "")
    paths = sorted(path for path in directory.glob("*.json") if path.name != "bench.json")
    if len(sys.argv) != 2 or not paths:
        sys.exit("usage: bench_table.py DIR, the folder of the cases' files CASE.json that script/bench wrote")
    rows = [row for path in paths for row in json.loads(path.read_text())]
    rows.sort(key=lambda row: (row["unknowns"], row["clusters"], row["threads"], row["relaxation"]))
    lines = ["| " + " | ".join(COLUMNS) + " |", "|---" * len(COLUMNS) + "|"]
    lines += ["| " + " | ".join(map(str, cells(row, rows))) + " |" for row in rows]
    lines += ["", *growth(rows), "", *speed_up(rows), "",
              "newton-minres and paper: one frame each, on one thread. paper's residual is where it ends; `to mark` is when "
              "the other first passed that."]
    text = "\n".join(lines) + "\n"
    (directory / "table.md").write_text(text)
    (directory / "bench.json").write_text(json.dumps(rows, indent=1))
    sys.stdout.write(text)


if __name__ == "__main__":
    main()
