#!/usr/bin/env python3
"""Reads a run's folder: what moved, what the observer found, and how good that was where the truth is known.

    read_run.py FOLDER
"""
import csv
import json
import math
import pathlib
import sys

ACTIVE = 2  # column `state`: 0 init, 1 ready, 2 active, 3 limited, 4 fault


def columns(file):
    """Every column of a CSV file by its name, as numbers; an empty field is no number (NaN)."""
    with open(file, newline="") as stream:
        reader = csv.reader(stream)
        names = next(reader)
        # A run that was cut off may end within a row.
        rows = [[float(field) if field else math.nan for field in row] for row in reader if len(row) == len(names)]
    return {name: [row[i] for row in rows] for i, name in enumerate(names)}


def rms(values):
    values = [value for value in values if not math.isnan(value)]
    return math.sqrt(sum(value * value for value in values) / len(values)) if values else math.nan


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: read_run.py FOLDER")
    folder = pathlib.Path(sys.argv[1])
    try:
        summary = json.loads((folder / "summary.json").read_text())
        ticks = columns(folder / "ticks.csv")
    except (OSError, ValueError) as error:
        sys.exit(f"read_run.py: {folder}: {error}; expected the folder of a run, with summary.json and ticks.csv")
    active = [i for i, state in enumerate(ticks["state"]) if state == ACTIVE]
    print(f"patella {summary['patella']}: {len(ticks['t_s'])} ticks, {len(active)} of them active")
    for joint in 1, 2:
        if f"q{joint}_rad" not in ticks:
            continue

        def difference(first, second):
            return rms(ticks[first][i] - ticks[second][i] for i in active)

        print(f"  joint {joint}:"
              f" off its reference by {difference(f'q{joint}_rad', f'ref{joint}_rad'):.4f} rad,"
              f" unknown torque {rms(ticks[f'd_hat{joint}_Nm'][i] for i in active):.3f} N·m,"
              f" estimate off the truth by {difference(f'f_s{joint}_rad_s2', f'f_true{joint}_rad_s2'):.3f} rad/s² (rms)")


if __name__ == "__main__":
    main()
