#!/usr/bin/env python3
"""Runs clang-tidy over the product's sources (not the tests) with the compile commands of a build folder.

    tools/checks/tidy.py BUILD_DIR            a folder that has been configured with Ninja
    tools/checks/tidy.py BUILD_DIR --alone    each source by itself, so that an include that is missing is found, too

Most of clang-tidy's time goes into the headers of Eigen and of the standard library. So sources that are compiled in the same
way are looked at together, twelve at a time, as if they were one. Where that finds something, each half of them is looked at
anew, down to the single source, and what is said of that one counts.

A source that passed is not looked at again until it, a header of the project that it includes, or the rules change. What
passed is remembered in the user's cache folder, for every checkout.

Exit status: 0 nothing found; 1 something found, said on stderr; 2 wrong arguments.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("core", "drivers", "sim", "firmware_app", "tools")
TOGETHER = 12
# Names at the top of a file. Two sources that share one, each in its own unnamed namespace, cannot be looked at as one.
TOP_LEVEL_NAME = re.compile(
    r"^(?:(?:inline |static )?(?:constexpr|const) .*?\b(k[A-Z]\w*)|(?:struct|class|enum class|enum) (\w+)|using (\w+) ="
    r"|[A-Za-z_].*?\b(\w+)\([^;]*$)", re.MULTILINE)


def fail(message):
    print(f"tidy.py: {message}", file=sys.stderr)
    sys.exit(1)


class Sources:
    """What is built, in which way, and from which files of the project."""

    def __init__(self, build):
        self.entries = {}
        self.direct = {}
        for entry in json.loads((build / "compile_commands.json").read_text()):
            # Clang cannot read what GCC has precompiled.
            entry["command"] = re.sub(r" -Winvalid-pch -include \S*/cmake_pch\.hxx", "", entry["command"])
            for file in self._grouped(entry["file"]):
                path = os.path.relpath(file, ROOT)
                # Clang 14 does not parse libtorch's headers as C++20.
                if path.split("/")[0] in FOLDERS and not path.split("/")[-1].startswith("torch_"):
                    own = dict(entry, file=file, command=entry["command"].replace(entry["file"], file))
                    self.entries.setdefault(path, own)

    @staticmethod
    def _grouped(file):
        """The sources that are compiled as one, or the source itself."""
        if pathlib.Path(file).parent.name != "groups":
            return [file]
        return [str(ROOT / path) for path in Sources._named_in(file) if path.endswith(".cpp")]

    @staticmethod
    def _named_in(file):
        return re.findall(r'^#include "(.*)"$', pathlib.Path(file).read_text(), re.MULTILINE)

    def _included(self, path):
        """The project's files that one names, itself among them, and those that they name."""
        found, waiting = set(), [path]
        while waiting:
            file = waiting.pop()
            if file not in found and (ROOT / file).is_file():
                found.add(file)
                if file not in self.direct:
                    self.direct[file] = self._named_in(ROOT / file)
                waiting += self.direct[file]
        return found

    def digest(self, path, rules):
        text = hashlib.sha1(f"{rules} {path}".encode())
        for file in sorted(self._included(path)):
            text.update((ROOT / file).read_bytes())
        return text.hexdigest()

    def flags(self, path):
        """The command without what names this one source."""
        entry = self.entries[path]
        command = entry["command"].replace(entry["file"], "SOURCE")
        return re.sub(r" -o \S+", "", command)

    def batches(self, paths):
        """Sources of the same flags, no two of which share a name at the top, TOGETHER at most."""
        result = []
        for path in paths:
            text = (ROOT / path).read_text()
            names = {name for match in TOP_LEVEL_NAME.finditer(text) for name in match.groups() if name}
            flags = self.flags(path)
            for batch in result:
                if batch["flags"] == flags and len(batch["paths"]) < TOGETHER and not batch["names"] & names:
                    batch["paths"].append(path)
                    batch["names"] |= names
                    break
            else:
                result.append({"flags": flags, "paths": [path], "names": names})
        return [batch["paths"] for batch in result]


class Linter:
    def __init__(self, sources, passed, alone, scratch):
        self.sources = sources
        self.scratch = pathlib.Path(scratch)
        self.program = shutil.which("clang-tidy-22") or shutil.which("clang-tidy") or fail("clang-tidy is not there")
        rules = self._rules() + (" alone" if alone else "")
        self.stamps = {path: passed / sources.digest(path, rules) for path in sorted(sources.entries)}

    def _rules(self):
        version = subprocess.run([self.program, "--version"], capture_output=True, check=True).stdout
        files = (ROOT / ".clang-tidy", ROOT / "tools/cmake/CompilerSettings.cmake")
        return hashlib.sha1(version + b"".join(file.read_bytes() for file in files)).hexdigest()

    def _run(self, paths):
        """Whether nothing is found, and what is said."""
        entry = self.sources.entries[paths[0]]
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.scratch))
        file = ROOT / paths[0]
        if len(paths) > 1:
            file = folder / "together.cpp"
            file.write_text("".join(f'#include "{ROOT / path}"\n' for path in paths))
        command = entry["command"].replace(entry["file"], str(file))
        (folder / "compile_commands.json").write_text(
            json.dumps([{"directory": entry["directory"], "command": command, "file": str(file)}]))
        run = subprocess.run([self.program, "--quiet", "-p", folder, f"--config-file={ROOT / '.clang-tidy'}",
                              "--extra-arg=-Wno-unknown-warning-option", file],
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        return run.returncode == 0, run.stdout

    def look(self, paths):
        """What is said of those of the sources that do not pass."""
        passed, said = self._run(paths)
        if passed:
            for path in paths:
                self.stamps[path].touch()
            return []
        if len(paths) == 1:
            return [said]
        half = len(paths) // 2
        return self.look(paths[:half]) + self.look(paths[half:])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, metavar="BUILD_DIR")
    parser.add_argument("--alone", action="store_true", help="each source by itself")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    if not (build / "build.ninja").exists():
        fail(f"'{arguments.build}', expected a folder that was configured with Ninja")

    passed = pathlib.Path(os.environ.get("XDG_CACHE_HOME", pathlib.Path.home() / ".cache")) / "patella/tidy"
    passed.mkdir(parents=True, exist_ok=True)
    sources = Sources(build)
    with tempfile.TemporaryDirectory() as scratch, \
            concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        linter = Linter(sources, passed, arguments.alone, scratch)
        waiting = [path for path, stamp in linter.stamps.items() if not stamp.exists()]
        print(f"clang-tidy: {len(linter.stamps)} sources, {len(waiting)} to look at", flush=True)
        batches = [[path] for path in waiting] if arguments.alone else sources.batches(waiting)
        said = [text for texts in pool.map(linter.look, batches) for text in texts]
    if said:
        print("\n".join(said), file=sys.stderr)
        sys.exit(1)
    print("clang-tidy has nothing to say")


if __name__ == "__main__":
    main()
