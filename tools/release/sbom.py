#!/usr/bin/env python3
"""Writes the bill of materials (SPDX 2.3, JSON) of a Debian package of this project.

    sbom.py --build BUILD_DIR --package PACKAGE.deb --epoch SECONDS --out FILE.spdx.json

Shared libraries are those that the dynamic sections of the package's programs name, and the ones that these need. Parts
that are headers alone, and the compiler's, are those that the compiler read on the way to the programs: the build folder's
dependency files say so (ninja -t deps). Debian's own records give package, version and licence. The same package, built on
the same system, gives the same bytes.
"""
import argparse
import datetime
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import elf
from debian_package import description, licence, owners, run

# Version of spdx.org/licenses that the names of debian_package.py are of.
LICENCE_LIST = "3.19"
TOOLS = ("cmake", "cpack", "ninja", "strip", "dpkg-deb")


def sha256(data):
    return hashlib.sha256(data).hexdigest()


def element(kind, name):
    return f"SPDXRef-{kind}-" + re.sub(r"[^A-Za-z0-9.-]", "-", name)


class Document:
    """Elements and relationships, in the order in which they are written."""

    def __init__(self):
        self.packages = {}
        self.relationships = []
        self.texts = {}

    def add(self, identifier, kind, debian, **more):
        """A part that Debian provides."""
        expression, text, note = licence(debian["name"])
        if text is not None:
            self.texts[expression] = (debian["name"], text)
        notes = [line for line in (note, more.pop("licence_note", "")) if line]
        package = {
            "SPDXID": identifier, "name": more.pop("name", debian["name"]), "versionInfo": debian["version"],
            "supplier": "Organization: Debian", "downloadLocation": "NOASSERTION", "filesAnalyzed": False,
            "licenseConcluded": "NOASSERTION", "licenseDeclared": expression, "copyrightText": "NOASSERTION",
            "primaryPackagePurpose": kind,
            "sourceInfo": f"Debian package {debian['name']} {debian['version']} of source {debian['source']} {debian['source_version']}",
            "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",
                              "referenceLocator": "pkg:deb/debian/{name}@{version}?arch={architecture}".format(
                                  **{**debian, "version": debian["version"].replace("+", "%2B").replace(":", "%3A").replace("~", "~")})}],
            **more}
        if notes:
            package["licenseComments"] = ". ".join(notes)
        self.packages[identifier] = package

    def relate(self, first, how, second, comment=None):
        self.relationships.append({"spdxElementId": first, "relationshipType": how, "relatedSpdxElement": second,
                                   **({"comment": comment} if comment else {})})

    def written(self, name, epoch, root):
        body = {
            "SPDXID": "SPDXRef-DOCUMENT", "spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "name": name,
            "creationInfo": {
                "created": datetime.datetime.fromtimestamp(epoch, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
                "creators": ["Organization: The Patella developers", "Tool: tools/release/sbom.py"],
                "licenseListVersion": LICENCE_LIST},
            "documentDescribes": [root],
            "packages": [self.packages[key] for key in sorted(self.packages)],
            "relationships": sorted(self.relationships, key=lambda r: (r["spdxElementId"], r["relationshipType"], r["relatedSpdxElement"])),
            "hasExtractedLicensingInfos": [
                {"licenseId": key, "name": f"as Debian states it for {package}", "extractedText": text}
                for key, (package, text) in sorted(self.texts.items())]}
        # A name in the world that says which document this is: its own content.
        digest = sha256(json.dumps(body, sort_keys=True).encode())
        body["documentNamespace"] = f"https://patella.invalid/spdx/{name}-{digest}"
        return json.dumps(body, indent=1, sort_keys=True, ensure_ascii=False) + "\n"


def programs_of(package, folder):
    """Unpacks a Debian package; its programs and libraries."""
    subprocess.run(["dpkg-deb", "--extract", package, folder], check=True)
    files = sorted(str(path) for path in pathlib.Path(folder).rglob("*") if path.is_file() and not path.is_symlink())
    programs = [file for file in files if elf.is_elf(file)]
    if not programs:
        raise ValueError(f"{package} holds no program, expected the package of a build")
    return programs


def headers_of(build, programs):
    """Files of the system that the compiler read for what the programs are linked from."""
    targets = [line.split(": ")[0] for line in run("ninja", "-C", build, "-t", "targets", "all").splitlines()]
    wanted = set()
    for program in programs:
        name = os.path.basename(program)
        target = [target for target in targets if os.path.basename(target) == name and "/" in target]
        if len(target) != 1:
            raise ValueError(f"the build in {build} makes '{name}' {len(target)} times, expected once")
        wanted.update(line for line in run("ninja", "-C", build, "-t", "inputs", target[0]).splitlines() if line.endswith(".o"))
    headers, read = set(), set()
    for line in run("ninja", "-C", build, "-t", "deps").splitlines():
        if not line.startswith(" "):
            name, _, rest = line.partition(": #deps ")
            if rest and "(VALID)" in rest and name in wanted:
                read.add(name)
            current = name if rest else None
        elif current in wanted and line.strip().startswith("/usr/"):
            headers.add(os.path.normpath(line.strip()))
    if wanted - read:
        raise ValueError(f"{sorted(wanted - read)[0]}: what the compiler read is not known, expected a complete build in {build}")
    return sorted(headers)


def own_package(document, package, programs, folder, epoch_version):
    fields = {key: run("dpkg-deb", "--field", package, key).strip() for key in ("Package", "Version", "Architecture")}
    if not fields["Version"]:
        raise ValueError(f"{package} states no version")
    identifier = element("Package", fields["Package"])
    document.packages[identifier] = {
        "SPDXID": identifier, "name": fields["Package"], "versionInfo": fields["Version"],
        "packageFileName": os.path.basename(package), "supplier": "Organization: The Patella developers",
        "downloadLocation": "NOASSERTION", "filesAnalyzed": False, "licenseConcluded": "MIT", "licenseDeclared": "MIT",
        "copyrightText": "NOASSERTION", "primaryPackagePurpose": "APPLICATION",
        "checksums": [{"algorithm": "SHA256", "checksumValue": sha256(pathlib.Path(package).read_bytes())}],
        "comment": "Programs: " + ", ".join(os.path.relpath(program, folder) for program in programs)}
    return identifier, fields


def add_libraries(document, root, programs):
    found = elf.libraries(programs)
    packages = owners([path for path, _ in found.values()])
    for name, (path, users) in sorted(found.items()):
        identifier = element("Library", name)
        document.add(identifier, "LIBRARY", description(packages[path]), name=name, packageFileName=os.path.realpath(path),
                     checksums=[{"algorithm": "SHA256", "checksumValue": sha256(pathlib.Path(path).read_bytes())}])
        document.relate(root, "DYNAMIC_LINK", identifier, "needed by " + ", ".join(sorted(users)))


def add_headers(document, root, headers):
    by_package = {}
    for header, package in owners(headers).items():
        by_package.setdefault(package, []).append(header)
    for package, files in sorted(by_package.items()):
        stated, lines = set(), []
        for file in sorted(files):
            data = pathlib.Path(file).read_bytes()
            lines.append(f"{sha256(data)}  {file}\n")
            stated.update(re.findall(rb"SPDX-License-Identifier:[ \t]*([^\r\n*]+)", data))
        identifier = element("Headers", package.replace(":", "-"))
        words = sorted(name.decode(errors="replace").strip() for name in stated)
        document.add(identifier, "SOURCE", description(package),
                     licence_note="The headers in use state: " + "; ".join(words) if words else "",
                     comment=f"{len(files)} headers compiled in. SHA-256 of their list as sha256sum prints it, sorted by path: "
                             + sha256("".join(lines).encode()))
        document.relate(root, "STATIC_LINK", identifier, "code of headers, compiled in")


def add_tools(document, root, build):
    # Not in CMake's cache where a file of the target names it.
    [found] = pathlib.Path(build, "CMakeFiles").glob("*/CMakeCXXCompiler.cmake")
    compiler = re.search(r'^set\(CMAKE_CXX_COMPILER "(.*)"\)$', found.read_text(), re.M).group(1)
    for tool in [compiler, *TOOLS]:
        path = run("which", tool).strip()
        debian = description(owners([path])[path])
        identifier = element("Tool", debian["name"])
        if identifier not in document.packages:
            document.add(identifier, "APPLICATION", debian)
            document.relate(identifier, "BUILD_TOOL_OF", root)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", required=True, help="build folder that the package was made in")
    parser.add_argument("--package", required=True, help="the .deb")
    parser.add_argument("--epoch", required=True, type=int, help="seconds since 1970: when the document says it was created")
    parser.add_argument("--out", required=True, type=pathlib.Path)
    arguments = parser.parse_args()
    document = Document()
    with tempfile.TemporaryDirectory() as folder:
        programs = programs_of(arguments.package, folder)
        root, fields = own_package(document, arguments.package, programs, folder, arguments.epoch)
        document.relate("SPDXRef-DOCUMENT", "DESCRIBES", root)
        add_libraries(document, root, programs)
        add_headers(document, root, headers_of(arguments.build, programs))
        add_tools(document, root, arguments.build)
    name = "{Package}_{Version}_{Architecture}".format(**fields)
    partial = arguments.out.with_name(arguments.out.name + ".new")
    partial.write_text(document.written(name, arguments.epoch, root))
    partial.replace(arguments.out)
    kinds = {"Library": 0, "Headers": 0, "Tool": 0}
    for identifier in document.packages:
        kind = identifier.split("-")[1]
        kinds[kind] = kinds.get(kind, 0) + 1
    print(f"{arguments.out.name}: {kinds['Library']} shared libraries, {kinds['Headers']} packages of headers, {kinds['Tool']} tools")


if __name__ == "__main__":
    try:
        main()
    except (ValueError, OSError) as error:
        sys.exit(f"sbom.py: {error}")
    except subprocess.CalledProcessError as error:
        sys.exit(f"sbom.py: {' '.join(error.cmd[:4])} … ended with {error.returncode}: {error.stderr}")
