#!/usr/bin/env python3
"""Keeps the generated tables of docs/iec62304.md: SOUP of a bill of materials, and requirements of docs/safety.md.

    iec62304.py --sbom FILE.spdx.json --write     puts the tables into the document
    iec62304.py --sbom FILE.spdx.json --check     fails where they differ; versions are the release's, and may
"""
import argparse
import difflib
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

# What each part is used for, by Debian's source package without its version.
PURPOSES = {
    "binutils": "linker and assembler",
    "boost": "sockets and WebSocket of the viewer's server, which only reads; data sheets of drives, before the loop starts",
    "cli11": "command lines of the programs",
    "cmake": "build and packaging",
    "dpkg": "makes the Debian package",
    "console-bridge": "messages of the URDF reader, before the loop starts",
    "edflib": "EMG and motion as BDF+, in the converter",
    "eigen3": "vectors and matrices of every tick",
    "fmtlib": "text of messages and files, outside the loop thread",
    "gcc": "compiler, C++ standard library and its run time",
    "glibc": "C library: files, threads, clocks, sockets",
    "libgpiod": "emergency stop, drive enable and heartbeat lines",
    "libmd": "SHA-256 of weights and of a run's inputs",
    "libzstd": "compression of MCAP recordings, outside the loop thread",
    "linux": "the kernel's interface: SocketCAN, scheduling, memory locks",
    "ninja-build": "runs the build",
    "nlohmann-json3": "summary.json and the header of weights",
    "spdlog": "events, outside the loop thread",
    "tinyxml": "XML of the URDF reader, before the loop starts",
    "tomlplusplus": "configuration, models and maps, before the loop starts",
    "urdfdom": "URDF files of chains, before the loop starts",
    "urdfdom-headers": "URDF files of chains, before the loop starts",
    "zlib": "CRC-32 of MCAP recordings, outside the loop thread",
}
KINDS = {"Library": "shared library", "Headers": "headers", "Tool": "build tool"}


def soup_rows(sbom):
    """Rows of the table: source, how it comes in, licence, use, version."""
    parts = {}
    for package in json.loads(sbom.read_text())["packages"]:
        kind = KINDS.get(package["SPDXID"].split("-")[1])
        if kind is None:
            continue
        source, version = re.search(r" of source (\S+) (\S+)$", package["sourceInfo"]).groups()
        name = re.sub(r"(-\d+|\d+\.\d+)$", "", source)
        if name not in PURPOSES:
            sys.exit(f"iec62304.py: nothing says what '{source}' is used for, expected a line in PURPOSES of {pathlib.Path(__file__).name}")
        part = parts.setdefault(name, {"kinds": set(), "licences": set(), "versions": set()})
        part["kinds"].add(kind)
        licence = package["licenseDeclared"]
        part["licences"].add("as its copyright file states" if licence.startswith("LicenseRef") else licence)
        part["versions"].add(version)
    for name in sorted(parts):
        part = parts[name]
        yield [name, ", ".join(sorted(part["kinds"], reverse=True)), ", ".join(sorted(part["licences"])), PURPOSES[name],
               ", ".join(sorted(part["versions"]))]


def requirement_rows():
    """Rows of the table of safety functions: number, requirement, hazard, tests."""
    counts = {}
    for line in (ROOT / "docs/safety.md").read_text().splitlines():
        match = re.match(r"\| (H\d+): ", line)
        if not match:
            continue
        hazard = match.group(1)
        cells = [cell.strip() for cell in line.strip().strip("|").split(" | ")]
        if len(cells) != 6:
            sys.exit(f"iec62304.py: docs/safety.md: {len(cells)} columns, expected 6 in '{line[:60]}…'")
        # A heading of safety.md is none of the other document.
        function, detection, fault, reaction, budget, tests = (cell.replace("](#", "](safety.md#") for cell in cells)
        counts[hazard] = counts.get(hazard, 0) + 1
        raised = "" if fault == "–" else f", as {fault}"
        yield [f"{hazard}.{counts[hazard]}", f"{function.removeprefix(hazard + ': ')}: {detection}{raised}; {reaction}, {budget}",
               hazard, tests]


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return lines + ["| " + " | ".join(row) + " |" for row in rows]


def filled(text, name, lines):
    pattern = re.compile(rf"(<!-- generated: {name} -->\n).*?(<!-- end -->)", re.S)
    if not pattern.search(text):
        sys.exit(f"iec62304.py: docs/iec62304.md has no place for '{name}'")
    return pattern.sub(lambda match: match.group(1) + "\n".join(lines) + "\n" + match.group(2), text)


def without_versions(text):
    """The last column of the SOUP table left out: it is the release's."""
    start, end = text.index("<!-- generated: soup -->"), text.index("<!-- end -->")
    rows = [line.rsplit("|", 2)[0] if line.startswith("|") else line for line in text[start:end].splitlines()]
    return text[:start] + "\n".join(rows) + text[end:]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sbom", required=True, type=pathlib.Path)
    parser.add_argument("--document", type=pathlib.Path, default=ROOT / "docs/iec62304.md")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--write", action="store_true")
    what.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    requirements = list(requirement_rows())
    if len(requirements) < 20:
        sys.exit(f"iec62304.py: docs/safety.md has {len(requirements)} safety functions, expected at least 20")
    old = arguments.document.read_text()
    new = filled(old, "soup", table(["part", "comes in as", "licence", "used for", "version in Debian 12"], soup_rows(arguments.sbom)))
    new = filled(new, "requirements", table(["", "requirement", "hazard", "shown by"], requirements))
    if arguments.write:
        arguments.document.write_text(new)
        return
    if without_versions(new) != without_versions(old):
        sys.stdout.writelines(difflib.unified_diff(without_versions(old).splitlines(True), without_versions(new).splitlines(True),
                                                   "docs/iec62304.md", "as it should be"))
        sys.exit(f"iec62304.py: make them agree by tools/release/iec62304.py --sbom {arguments.sbom} --write")


if __name__ == "__main__":
    main()
