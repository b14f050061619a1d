"""What Debian says of a file: its package, version, source and licence."""
import os
import pathlib
import re
import subprocess

DOCUMENTS = pathlib.Path("/usr/share/doc")

# Debian's short names (the machine-readable format of /usr/share/doc/PACKAGE/copyright) in the words of spdx.org/licenses.
SPDX_NAMES = {
    "apache-2.0": "Apache-2.0", "boost-1.0": "BSL-1.0", "bsl-1.0": "BSL-1.0", "bsd-2-clause": "BSD-2-Clause",
    "bsd-3-clause": "BSD-3-Clause", "cc0-1.0": "CC0-1.0", "expat": "MIT", "gpl-2": "GPL-2.0-only", "gpl-2+": "GPL-2.0-or-later",
    "gpl-3": "GPL-3.0-only", "gpl-3+": "GPL-3.0-or-later", "isc": "ISC", "lgpl-2.1": "LGPL-2.1-only",
    "lgpl-2.1+": "LGPL-2.1-or-later", "mpl-2": "MPL-2.0", "mpl-2.0": "MPL-2.0", "zlib": "Zlib",
}


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def names_of(path):
    """The names that dpkg may know a file by: /lib and /usr/lib are one folder, and libraries are links."""
    names = []
    for name in path, os.path.realpath(path):
        names.append(name)
        names.append(name[4:] if name.startswith("/usr/") else "/usr" + name)
    return names


def owners(paths):
    """The package of every path, as `name:architecture` where dpkg says so. Raises ValueError naming a file of no package."""
    asked = {name for path in paths for name in names_of(path)}
    answer = subprocess.run(["dpkg-query", "--search", "--", *sorted(asked)], capture_output=True, text=True).stdout
    known = {}
    for line in answer.splitlines():
        packages, _, file = line.partition(": ")
        if not packages.startswith("diversion"):
            known[file] = packages.split(", ")[0]
    found = {}
    for path in paths:
        found[path] = next((known[name] for name in names_of(path) if name in known), None)
        if found[path] is None:
            raise ValueError(f"{path} belongs to no installed package, expected libraries and headers of the distribution")
    return found


def description(package):
    """Name, version, architecture and source of an installed package."""
    shown = run("dpkg-query", "--show", "--showformat",
                "${Package}\t${Version}\t${Architecture}\t${source:Package}\t${source:Version}", package)
    name, version, architecture, source, source_version = shown.split("\t")
    return {"name": name, "version": version, "architecture": architecture, "source": source, "source_version": source_version}


def paragraphs(text):
    """Paragraphs of the machine-readable format as dictionaries; continuation lines stay in the value."""
    for block in re.split(r"\n\s*\n", text):
        fields, last = {}, None
        for line in block.splitlines():
            if line.startswith("#"):
                continue
            if line[:1].isspace() and last:
                fields[last] += "\n" + line
            elif ":" in line:
                last, value = line.split(":", 1)
                last = last.lower()
                fields[last] = value.strip()
        if fields:
            yield fields


def licence(package_name):
    """A licence as Debian states it: an SPDX expression, the text behind a name of our own (or None), and what else it says.

    The licence of upstream's files at large counts ("Files: *"); others, of single files, are told of beside it. A file
    that is not machine-readable is its own licence, in full.
    """
    file = DOCUMENTS / package_name / "copyright"
    text = file.read_text(errors="replace")
    own_name = "LicenseRef-" + re.sub(r"[^A-Za-z0-9.-]", "-", package_name)
    if not text.startswith("Format:"):
        return own_name, text, ""
    files, bodies = [], {}
    for fields in paragraphs(text):
        if "license" not in fields:
            continue
        name, _, body = fields["license"].partition("\n")
        if body.strip():
            bodies.setdefault(name, body)
        if "files" in fields and not re.fullmatch(r"(\s*debian/\S*)+", fields["files"]):
            files.append((fields["files"], name))
    main = next((name for pattern, name in files if pattern.split() and pattern.split()[0] in ("*", "./*")), None)
    others = sorted({name for _, name in files} - {main})
    note = "Single files of the source package: " + "; ".join(others) if others else ""
    if main is None:
        return own_name, text, ""
    if main.lower() in SPDX_NAMES:
        return SPDX_NAMES[main.lower()], None, note
    return own_name, f"{main}\n{bodies.get(main, text)}", note
