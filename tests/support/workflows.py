#!/usr/bin/env python3
"""Every command of the project's that a workflow names must exist, with the argument that it is given.

    workflows.py [ROOT]
"""
import os
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2])
called = {}
for workflow in sorted((root / ".github/workflows").glob("*.yml")):
    called[workflow.name] = re.findall(r"^\s*- (?:run: )?(tools/\S+)(?: (--\S+))?$", workflow.read_text(), re.M)
    for script, option in called[workflow.name]:
        file = root / script
        if not os.access(file, os.X_OK):
            sys.exit(f"{workflow.name}: {script} is no program")
        if option and not re.search(rf"^\s*{option}\)", file.read_text(), re.M):
            sys.exit(f"{workflow.name}: {script} knows no {option}")
for name, command in ("quick.yml", ("tools/test.sh", "--quick")), ("nightly.yml", ("tools/test.sh", "")):
    if command not in called.get(name, []):
        sys.exit(f"{name} does not run {' '.join(command).strip()}")
print(f"{sum(map(len, called.values()))} commands of {len(called)} workflows exist")
