#!/usr/bin/python3
"""Writes a run as BDF+ and for OpenSim, and holds what MNE and a plain reader make of the files against ticks.csv.

    read_back.py PATELLA PATELLA_CONVERT CONFIGURATION
"""
import csv
import math
import os
import subprocess
import sys
import tempfile

try:
    import mne
except ImportError:
    print("=" * 84 + "\nSKIPPED, no BDF+ file was read by MNE: no module mne (package python3-mne)\n" + "=" * 84, file=sys.stderr)
    sys.exit(77)

RATE_HZ = 1000
SCALES = {"mV": 1e-3, "rad": 1.0, "N.m": 1.0, "": 1.0}  # MNE gives volts
failures = 0


def check(holds, words):
    global failures
    print(("ok    " if holds else "FAILS ") + words)
    failures += not holds


def convert(program, kind, run, out, *more):
    return subprocess.run([program, f"--{kind}", run, "--out", out, *more], capture_output=True, text=True)


def table(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return {name: [float(row[i]) if row[i] else math.nan for row in rows[1:]] for i, name in enumerate(rows[0])}


def held(times, values, count):
    """The newest value at each instant of a uniform time base; zero before the first."""
    out, newest, row = [], 0.0, 0
    for k in range(count):
        while row < len(times) and round((times[row] - times[0]) * RATE_HZ) <= k:
            newest = values[row] if math.isfinite(values[row]) else newest
            row += 1
        out.append(newest)
    return out


def range_of(largest):
    return next(r for d in range(-3, 7) for s in (1, 2, 5) if largest <= (r := s * 10.0 ** d))


def check_bdf(path, ticks, columns, events, label):
    raw = mne.io.read_raw_bdf(path, preload=True, verbose="error")
    count = round((ticks["t_s"][-1] - ticks["t_s"][0]) * RATE_HZ) + 1
    names = ["EMG " + c[3] if c.startswith("emg") else c for c in columns]
    check(raw.info["sfreq"] == RATE_HZ and raw.ch_names[: len(names)] == names, f"{label}: MNE finds {len(raw.ch_names)} signals at {RATE_HZ} Hz")
    check(raw.n_times == math.ceil(count / RATE_HZ) * RATE_HZ, f"{label}: {raw.n_times} samples, {count} of the run in whole seconds")
    worst = 0.0
    for name, (column, unit) in zip(names, columns.items()):
        want = held(ticks["t_s"], ticks[column], count)
        step = range_of(max(abs(v) for v in want)) / 8388607
        got = raw.get_data(picks=[name])[0][:count] / SCALES[unit]
        worst = max(worst, max(abs(g - w) for g, w in zip(got, want)) / step)
    check(worst <= 0.5001, f"{label}: every sample is that of ticks.csv, at most {worst:.4f} steps of 24 bits away")
    found = list(zip([round(o, 4) for o in raw.annotations.onset], raw.annotations.description))
    check(sorted(found) == sorted(events + [(round(count / RATE_HZ, 4), "end of the run")]), f"{label}: {len(found)} annotations are the events: {found}")
    return raw


def read_opensim(path):
    with open(path) as file:
        header = []
        while (line := file.readline().rstrip("\n")) != "endheader":
            header.append(line)
        names = file.readline().rstrip("\n").split("\t")
        rows = [[float(cell) for cell in line.rstrip("\n").split("\t")] for line in file]
    return header, names, rows


def check_opensim(path, want_names, columns, ticks):
    header, names, rows = read_opensim(path)
    fields = dict(line.split("=") for line in header[1:])
    check(fields == {"version": "1", "nRows": str(len(rows)), "nColumns": str(len(names)), "inDegrees": "no"}, f"{path[-3:]}: the header counts {len(rows)} rows of {len(names)} columns")
    check(names == ["time"] + want_names, f"{path[-3:]}: columns {' '.join(names)}")
    worst_time = max(abs(row[0] - t) for row, t in zip(rows, ticks["t_s"]))
    equal = all(row[i + 1] == ticks[column][k] for i, column in enumerate(columns) for k, row in enumerate(rows))
    check(len(rows) == len(ticks["t_s"]) and worst_time < 1e-9 and equal, f"{path[-3:]}: every value equals ticks.csv")


def made_up_run(folder):
    """2.2 s with a loss of 50 ticks and an electrode that comes late."""
    os.mkdir(folder)
    with open(os.path.join(folder, "ticks.csv"), "w") as file:
        file.write("t_s,q1_rad,emg1_mV\n")
        for k in range(2200):
            if not 700 <= k < 750:
                file.write(f"{k / RATE_HZ!r},{math.sin(k / 300)!r},{'' if k < 100 else 0.3 * math.cos(k / 7)}\n")
    with open(os.path.join(folder, "events.log"), "w") as file:
        file.write("input=model file=a.toml sha256=0\nt_s=0 state=init\nt_s=0.7501 state=fault raised=encoder_stale warning=disk_low\n")


def main(patella, program, configuration):
    with tempfile.TemporaryDirectory() as folder:
        at = lambda name: os.path.join(folder, name)
        run = at("run")
        subprocess.run([patella, "run", "--config", configuration, "--clock", "virtual", "--duration", "2.5", "--out", run], check=True, capture_output=True)
        ticks = table(os.path.join(run, "ticks.csv"))
        with open(os.path.join(run, "events.log")) as file:
            events = [(round(float(line.split()[0][4:]), 4), part) for line in file if line.startswith("t_s=") for part in line.split()[1:]]
        check(convert(program, "bdf", run, at("a.bdf")).returncode == 0 and convert(program, "bdf", run, at("b.bdf")).returncode == 0, "a run is written as BDF+")
        with open(at("a.bdf"), "rb") as a, open(at("b.bdf"), "rb") as b:
            check(a.read() == b.read(), "the same run gives the same bytes")
        names = {f"EMG {c}": f"emg{c}_mV" for c in range(1, 5)}
        raw = check_bdf(at("a.bdf"), ticks, {column: "mV" for column in names.values()}, events, "run")
        for name, column in {"angle 2": "q2_rad", "torque 1": "tau1_Nm", "activation 3": "activation3"}.items():
            got = raw.get_data(picks=[name])[0][: len(ticks["t_s"])]
            step = range_of(max(abs(v) for v in ticks[column])) / 8388607
            check(max(abs(g - w) for g, w in zip(got, ticks[column])) <= 0.5001 * step, f"run: '{name}' is {column}")
        inferred = mne.io.read_raw_bdf(at("a.bdf"), infer_types=True, verbose="error").get_channel_types()
        check(inferred[:4] == ["emg"] * 4, "MNE takes the electrodes for EMG by their labels")

        made_up_run(at("lossy"))
        answer = convert(program, "bdf", at("lossy"), at("lossy.bdf"))
        check(answer.returncode == 0 and "50 of them held" in answer.stdout, f"a loss is told of: {answer.stdout.strip()}")
        check_bdf(at("lossy.bdf"), table(os.path.join(at("lossy"), "ticks.csv")), {"emg1_mV": "mV"},
                  [(0.0, "state=init"), (0.7501, "state=fault"), (0.7501, "raised=encoder_stale"), (0.7501, "warning=disk_low")], "losses")

        columns = ["tau1_Nm", "tau2_Nm"] + [f"emg{c}_mV" for c in range(1, 5)] + [f"activation{c}" for c in range(1, 5)]
        check(convert(program, "sto", run, at("a.sto")).returncode == 0, "a run is written as .sto")
        check_opensim(at("a.sto"), columns, columns, ticks)
        coordinates = ["hip_flexion_r", "knee_angle_r"]
        check(convert(program, "mot", run, at("a.mot"), "--coordinates", ",".join(coordinates)).returncode == 0, "and as .mot")
        check_opensim(at("a.mot"), coordinates, ["q1_rad", "q2_rad"], ticks)

        with open(os.path.join(at("lossy"), "ticks.csv"), "w") as file:
            file.write("t_s,q1_rad\n0,1\n0.0013,2\n0.0026,3\n")
        answer = convert(program, "bdf", at("lossy"), at("no.bdf"))
        check(answer.returncode == 1 and "expected a whole number" in answer.stderr, f"another rate is refused: {answer.stderr.strip()}")
        answer = convert(program, "mot", run, at("no.mot"), "--coordinates", "one")
        check(answer.returncode == 1 and "expected 2 as the run has joints" in answer.stderr, f"too few names are refused: {answer.stderr.strip()}")
        left = [name for name in os.listdir(folder) if name.startswith("no.") or "partial" in name]
        check(not left, f"nothing is left behind {left or ''}")
    return failures


if __name__ == "__main__":
    sys.exit(1 if main(*sys.argv[1:]) else 0)
