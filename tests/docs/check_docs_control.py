#!/usr/bin/env python3
"""The check of the documents must find each kind of fault by name, and none in good documents.

    check_docs_control.py BUILD     a build that holds the programs patella and patella-rig
"""

import shutil
import sys
import tempfile
from pathlib import Path

from check_docs import Check
from commands import Commands
from markdown import paragraphs, sentences, words

GOOD = """# Good

A sentence ends with a full stop. Another one names `patella check` and 0.5 N·m. See [the index](docs/README.md#pages).

```
tools/script.sh --fast     # a comment
patella run --config firmware_app/config.toml --duration 10 > out.txt && cmake --preset release -DPATELLA_TOOLS=OFF
run="patella run --clock virtual"; $run --seed 1
```
"""
MANUAL = "tools/package/man/patella-rig.1"
LONG = "This sentence has " + "very " * 22 + "many words."
# The file, the addition that spoils it in a good tree, and the fault that the check has to name.
BAD = [
    ("README.md", "\n" * 121, "README.md: length: "),
    ("README.md", LONG, "README.md:11: sentence: 27 words"),
    ("README.md", "- " + LONG, "README.md:11: sentence: 27 words"),
    ("docs/page.md", (LONG.replace("very " * 22, "very " * 17) + " ") * 9, "docs/page.md: sentence: 22.0 words in the mean"),
    ("README.md", "[away](docs/gone.md)", "README.md:11: link: there is no docs/gone.md"),
    ("README.md", "[away](docs/page.md#gone)", "README.md:11: link: docs/page.md has no heading #gone"),
    ("README.md", "![away](docs/gone.png)", "README.md:11: picture: there is no docs/gone.png"),
    ("docs/other.md", "# Other", "docs/README.md: index: does not name other.md"),
    ("docs/unseen.png", "", "docs/unseen.png: picture: no document shows it"),
    ("firmware_app/configuration/reader.cpp", 'table.boolean("gone", true);',
     "firmware_app/configuration/reader.cpp: key: docs/configuration.md does not name gone"),
    ("README.md", "`tools/gone.sh`", "README.md:11: command: there is no tools/gone.sh"),
    ("README.md", "`tools/script.sh --slow`", "command: tools/script.sh does not know --slow"),
    ("README.md", "`patella-gone`", "command: CMake builds no program patella-gone"),
    ("README.md", "`patella walk`", "command: patella has no subcommand walk"),
    ("README.md", "`patella run --walk`", "command: patella run has no option --walk"),
    ("README.md", "`patella run --config firmware_app/gone.toml`", "command: there is no firmware_app/gone.toml"),
    ("README.md", "```\npatella run \\\n  --walk\n```", "command: patella run has no option --walk"),
    ("README.md", "| a | `patella run --walk` |", "command: patella run has no option --walk"),
    ("README.md", "```\ntrue && A=1 patella run --walk\n```", "command: patella run has no option --walk"),
    ("README.md", "`cmake --preset gone`", "command: cmake: there is no preset 'gone'"),
    ("README.md", "`cmake --build --preset release --target gone`", "command: cmake: there is no target 'gone'"),
    ("README.md", "`cmake --build --preset release --gone`", "command: cmake: unknown option --gone"),
    ("README.md", "`cmake --preset release -DPATELLA_GONE=1`", "command: cmake: nothing reads PATELLA_GONE"),
    (MANUAL, "\\-\\-gone", "patella-rig.1: manual: names --gone, which patella-rig does not know"),
]


def good_tree(root):
    for folder in ("docs", "tools/package/man", "firmware_app/configuration"):
        (root / folder).mkdir(parents=True)
    (root / "README.md").write_text(GOOD)
    (root / "docs/README.md").write_text("# Index\n\n## Pages\n\n- [A page](page.md)\n\n![A picture](picture.png)\n")
    (root / "docs/page.md").write_text("# Page\n\n")
    (root / "docs/picture.png").write_text("")
    (root / "firmware_app/config.toml").write_text("")
    (root / "CMakeLists.txt").write_text("option(PATELLA_TOOLS)\nadd_executable(patella main.cpp)\n")
    (root / "CMakePresets.json").write_text(
        '{"configurePresets": [{"name": "release"}], "buildPresets": [{"name": "release"}]}')
    (root / MANUAL).write_text(Path(__file__, "../../..", MANUAL).resolve().read_text())
    script = root / "tools/script.sh"
    script.write_text("case $1 in --fast) ;; esac\n")
    script.chmod(0o755)


def faults(root, build):
    return Check(root, Commands(root, build)).run()


def main():
    build, wrong = sys.argv[1], []
    text = "In 0.5 s, i.e. at once, it stops. Is a *fault* `latched`? See Fig. 3; then\ngo on.\n- one (two).\n| a. B |\n"
    counted = [words(sentence) for _, paragraph in paragraphs(text) for sentence in sentences(paragraph)]
    if counted != [8, 4, 6, 2]:
        wrong.append(f"words of the sentences: {counted}")
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder).resolve() / "tree"
        good_tree(root)
        if found := faults(root, build):
            wrong.append(f"faults in a good tree: {found}")
        for name, addition, expected in BAD:
            shutil.rmtree(root)
            good_tree(root)
            with open(root / name, "a") as file:
                file.write("\n" + addition + "\n")
            found = faults(root, build)
            if len(found) != 1 or expected not in found[0]:
                wrong.append(f"{addition[:60]!r}: expected '{expected}', found {found}")
        page = root / MANUAL
        page.write_text(page.read_text().replace("\\-\\-seed", "").replace("\\-\\-gone", ""))
        if (found := faults(root, build)) != [f"{MANUAL}: manual: does not name --seed"]:
            wrong.append(f"a manual without --seed: {found}")
    print("\n".join(wrong), file=sys.stderr)
    print(f"{len(BAD) + 2} controls, {len(wrong)} faults")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
