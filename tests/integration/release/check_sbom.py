#!/usr/bin/env python3
"""Holds a bill of materials against SPDX 2.3, against the package it is of, and against what the loader of this machine finds.

    check_sbom.py FILE.spdx.json PACKAGE.deb
"""
import hashlib
import json
import pathlib
import re
import subprocess
import sys
import tempfile

PURPOSES = {"APPLICATION", "LIBRARY", "SOURCE"}
RELATIONSHIPS = {"DESCRIBES", "DYNAMIC_LINK", "STATIC_LINK", "BUILD_TOOL_OF"}
# Header-only parts of the product, and what only its tests and the workplace's programs use.
EXPECTED_HEADERS = {"libeigen3-dev", "libcli11-dev", "nlohmann-json3-dev", "libspdlog-dev", "libtomlplusplus-dev"}
FOREIGN_HEADERS = {"doctest-dev", "libceres-dev", "libtorch-dev", "libfftw3-dev"}


def complaints_of_form(document):
    """What SPDX 2.3 asks of the fields in use."""
    for field in "SPDXID", "spdxVersion", "dataLicense", "name", "documentNamespace", "creationInfo":
        if field not in document:
            yield f"the document lacks {field}"
    if document.get("spdxVersion") != "SPDX-2.3" or document.get("dataLicense") != "CC0-1.0":
        yield "the document is not SPDX-2.3 under CC0-1.0"
    identifiers = [package["SPDXID"] for package in document["packages"]]
    if len(set(identifiers)) != len(identifiers):
        yield "an identifier occurs twice"
    texts = {info["licenseId"] for info in document["hasExtractedLicensingInfos"] if info["extractedText"].strip()}
    used = set()
    for package in document["packages"]:
        name = package["name"]
        if not re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", package["SPDXID"]):
            yield f"{name}: identifier {package['SPDXID']}"
        for field in "versionInfo", "supplier", "downloadLocation", "licenseConcluded", "licenseDeclared", "copyrightText":
            if not package.get(field):
                yield f"{name} lacks {field}"
        if package["primaryPackagePurpose"] not in PURPOSES:
            yield f"{name}: purpose {package['primaryPackagePurpose']}"
        used |= set(re.findall(r"LicenseRef-[A-Za-z0-9.-]+", package["licenseDeclared"]))
    if used != texts:
        yield f"licences named and given as text differ in {sorted(used ^ texts)}"
    for relation in document["relationships"]:
        if relation["relationshipType"] not in RELATIONSHIPS:
            yield f"relationship {relation['relationshipType']}"
        for end in relation["spdxElementId"], relation["relatedSpdxElement"]:
            if end not in identifiers and end != "SPDXRef-DOCUMENT":
                yield f"a relationship names {end}, which is not there"
    unrelated = set(identifiers) - {relation[end] for relation in document["relationships"]
                                    for end in ("spdxElementId", "relatedSpdxElement")}
    if unrelated:
        yield f"nothing relates to {sorted(unrelated)}"


def loaded_libraries(package):
    """Library to file, as ldd shows it for every program of a package; of the C library's loader the name alone."""
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["dpkg-deb", "--extract", package, folder], check=True)
        programs = sorted(pathlib.Path(folder, "usr/bin").iterdir())
        for program in programs:
            for line in subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout.splitlines():
                fields = line.split()
                if fields[0].startswith("linux-vdso"):
                    continue  # the kernel's, which no package brings
                path = fields[2] if "=>" in fields else fields[0]
                found[pathlib.Path(fields[0]).name] = path
    return found


def complaints_of_content(document, package):
    packages = {entry["SPDXID"]: entry for entry in document["packages"]}
    libraries = {packages[relation["relatedSpdxElement"]]["name"]: packages[relation["relatedSpdxElement"]]
                 for relation in document["relationships"] if relation["relationshipType"] == "DYNAMIC_LINK"}
    loaded = loaded_libraries(package)
    for name in sorted(loaded.keys() - libraries.keys()):
        yield f"ldd shows {name}, which the bill of materials lacks"
    for name in sorted(libraries.keys() - loaded.keys()):
        yield f"the bill of materials names {name}, which ldd does not show"
    for name in sorted(libraries.keys() & loaded.keys()):
        digest = hashlib.sha256(pathlib.Path(loaded[name]).read_bytes()).hexdigest()
        if digest != libraries[name]["checksums"][0]["checksumValue"]:
            yield f"{name} has another SHA-256 than the bill of materials says"
    headers = {packages[relation["relatedSpdxElement"]]["name"]
               for relation in document["relationships"] if relation["relationshipType"] == "STATIC_LINK"}
    for name in sorted(EXPECTED_HEADERS - headers):
        yield f"headers of {name} are compiled in, and the bill of materials lacks it"
    for name in sorted(FOREIGN_HEADERS & headers):
        yield f"the bill of materials names {name}, which no program of the rig uses"
    own = [entry for entry in document["packages"] if entry.get("packageFileName") == pathlib.Path(package).name]
    if len(own) != 1 or own[0]["checksums"][0]["checksumValue"] != hashlib.sha256(pathlib.Path(package).read_bytes()).hexdigest():
        yield f"the bill of materials is of another {pathlib.Path(package).name}"


def main():
    document = json.loads(pathlib.Path(sys.argv[1]).read_text())
    complaints = [*complaints_of_form(document), *complaints_of_content(document, sys.argv[2])]
    for complaint in complaints:
        print(complaint)
    sys.exit(1 if complaints else 0)


if __name__ == "__main__":
    main()
