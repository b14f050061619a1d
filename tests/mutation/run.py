#!/usr/bin/env python3
"""Mutation check of the safety code: takes out or inverts one limit, timeout, CRC, counter or latch at a time
(mutations.txt), rebuilds the tests named for it, and shows that one of them fails.

  tests/mutation/run.py [--only TEXT]... [--jobs N]
  tests/mutation/run.py --look        # only whether what each one replaces stands there, once

Works in a copy of the tree, build/mutation. Exit status: 0 every mutation was found, 1 one survived, or did not apply.
"""
import argparse
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
COPY = ROOT / "build/mutation"
BUILD = COPY / "build/release"
TIMEOUT_S = 300


def mutations():
    """(line, file, tests, from, to) of each line; a | within a pattern is written \\|."""
    for number, line in enumerate((ROOT / "tests/mutation/mutations.txt").read_text().splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        parts = [part.replace("\0", "|").strip() for part in line.replace("\\|", "\0").split("|")]
        if len(parts) != 4:
            sys.exit(f"mutations.txt:{number}: {len(parts)} fields, expected 4")
        yield number, parts[0], parts[1].split(), parts[2], parts[3]


def prepare():
    COPY.mkdir(parents=True, exist_ok=True)
    files = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n")
    for name in filter(None, files):
        source, target = ROOT / name, COPY / name
        if not source.is_file():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_bytes() != source.read_bytes():
            target.write_bytes(source.read_bytes())
            target.chmod(source.stat().st_mode)
    subprocess.run(["cmake", "--preset", "release"], cwd=COPY, check=True, stdout=subprocess.DEVNULL)


def build(tests, jobs):
    done = subprocess.run(["cmake", "--build", "--preset", "release", f"-j{jobs}", "--target", *tests], cwd=COPY,
                          capture_output=True, text=True)
    return done.returncode == 0, done.stdout[-2000:]


def passes(tests):
    pattern = "^(" + "|".join(tests) + ")$"
    try:
        done = subprocess.run(["ctest", "--test-dir", str(BUILD), "-R", pattern, "--no-tests=error"],
                              capture_output=True, timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired:
        return False  # hangs: noticed
    return done.returncode == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", help="mutations whose file or text holds this, or another one's")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--look", action="store_true", help="build and run nothing")
    arguments = parser.parse_args()
    chosen = [m for m in mutations() if any(text in m[1] + m[3] for text in arguments.only or [""])]
    for number, file, _, old, _ in chosen:
        count = (ROOT / file).read_text().count(old)
        if count != 1:
            sys.exit(f"mutations.txt:{number}: '{old}' stands in {file} {count} times, expected once")
    if arguments.look:
        print(f"{len(chosen)} mutations apply")
        return 0
    prepare()
    tests = sorted({test for m in chosen for test in m[2]})
    built, text = build(tests, arguments.jobs)
    if not built or not passes(tests):
        sys.exit(f"the tests do not pass without a mutation\n{text}")
    survivors = 0
    for number, file, tests, old, new in chosen:
        target = COPY / file
        original = target.read_text()
        started = time.monotonic()
        target.write_text(original.replace(old, new))
        try:
            built, text = build(tests, arguments.jobs)
            verdict = "DOES NOT BUILD" if not built else "SURVIVES" if passes(tests) else "found"
        finally:
            target.write_text(original)
        survivors += verdict != "found"
        print(f"{verdict:<15}{time.monotonic() - started:6.1f} s  {file}: {old}  ->  {new or '(nothing)'}", flush=True)
        if verdict == "DOES NOT BUILD":
            print(text)
    print(f"{len(chosen) - survivors} of {len(chosen)} mutations found")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
