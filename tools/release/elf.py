"""The shared libraries that programs need, found as the dynamic loader finds them, for this machine's and other processors."""
import os
import re

from debian_package import run

FOLDERS = {
    "Advanced Micro Devices X86-64": ("/lib/x86_64-linux-gnu", "/usr/lib/x86_64-linux-gnu", "/lib64"),
    "AArch64": ("/lib/aarch64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/lib"),
}


def is_elf(path):
    with open(path, "rb") as stream:
        return stream.read(4) == b"\x7fELF"


def needed(path):
    """The names that a file's dynamic section asks for (DT_NEEDED)."""
    return re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "--dynamic", "--wide", path))


def libraries(programs):
    """Every library that any of the programs needs, by itself or through another: name to (file, who needs it).

    Raises ValueError naming the library, and who needs it, where it is not installed or a program brings a path of its own.
    """
    found, waiting = {}, list(programs)
    while waiting:
        file = waiting.pop()
        dynamic = run("readelf", "--file-header", "--dynamic", "--wide", file)
        machine = re.search(r"Machine:\s+(.*)", dynamic).group(1).strip()
        if machine not in FOLDERS:
            raise ValueError(f"{file} is for '{machine}', expected one of {', '.join(FOLDERS)}")
        if re.search(r"\((RPATH|RUNPATH)\)", dynamic):
            raise ValueError(f"{file} brings a search path of its own (RPATH), expected the system's libraries")
        for name in needed(file):
            if name not in found:
                path = next((f"{folder}/{name}" for folder in FOLDERS[machine] if os.path.exists(f"{folder}/{name}")), None)
                if path is None:
                    raise ValueError(f"{name}, which {os.path.basename(file)} needs, is in none of {', '.join(FOLDERS[machine])}")
                found[name] = (path, set())
                waiting.append(path)
            found[name][1].add(os.path.basename(file))
    return found
