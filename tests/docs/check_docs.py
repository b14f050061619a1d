#!/usr/bin/env python3
"""Holds the documents to what exists and to a length that can be read.

    check_docs.py ROOT [--build FOLDER] [--not-built PROGRAM...]

It looks at the Markdown files of the top folder, of docs/ and of firmware_app/:

  length    README.md has at most 120 lines
  sentence  no sentence has more than 25 words, and the mean of a document is at most 18; tables, code, headings and
            captions are left out, a piece of inline code is one word
  link      files and headings that links lead to exist
  index     docs/README.md names every page below docs/
  key       docs/configuration.md names every key that the readers of the loop's files ask for
  picture   pictures exist, and each in docs/ is shown somewhere
  command   each command in a code block or in inline code that starts with tools/, tests/, patella, cmake or ctest:
            programs, subcommands and options are those of --help, scripts know their arguments, files exist,
            presets, targets and variables are those of CMake
  manual    each manual in tools/package/man names the options and subcommands of its program's --help, and no others

Without --build programs are not asked for their options. Programs after --not-built need what this machine lacks.
"""

import argparse
import re
import sys
from pathlib import Path

from commands import Commands
from markdown import anchors, command_texts, links, paragraphs, sentences, words

README_LINES = 120
SENTENCE_WORDS = 25
MEAN_WORDS = 18
READERS = ("firmware_app/configuration/*.cpp", "firmware_app/files/*_file.cpp")
KEY = re.compile(r"\.(?:choice|boolean|string|strings|path|integer)\(\s*\"(\w+)\"")
PICTURES = {".svg", ".png", ".jpg"}


class Check:
    def __init__(self, root, commands):
        self.root, self.commands, self.faults = Path(root).resolve(), commands, []
        self.documents = sorted([*self.root.glob("*.md"), *(self.root / "docs").rglob("*.md"),
                                 *(self.root / "firmware_app").rglob("*.md")])
        self.counted = {"sentences": 0, "links": 0, "pictures": 0, "keys": 0, "commands": 0, "manuals": 0}
        self.shown = set()

    def fault(self, kind, path, line, text):
        place = path.relative_to(self.root)
        self.faults.append(f"{place}:{line}: {kind}: {text}" if line else f"{place}: {kind}: {text}")

    def run(self):
        readme = self.root / "README.md"
        if not readme.is_file():
            self.fault("length", readme, 0, "there is none")
        elif (lines := len(readme.read_text().splitlines())) > README_LINES:
            self.fault("length", readme, 0, f"{lines} lines, at most {README_LINES} are allowed")
        for document in self.documents:
            text = document.read_text()
            self.sentences(document, text)
            self.links(document, text)
            self.commands.start_document()
            for line, command in command_texts(text):
                for error in self.commands.errors(command):
                    self.fault("command", document, line, error)
        self.counted["commands"] = self.commands.parsed
        self.index()
        self.keys()
        self.pictures()
        self.manuals()
        return self.faults

    def sentences(self, document, text):
        lengths = []
        for line, paragraph in paragraphs(text):
            for sentence in sentences(paragraph):
                lengths.append(words(sentence))
                if lengths[-1] > SENTENCE_WORDS:
                    self.fault("sentence", document, line,
                               f"{lengths[-1]} words, at most {SENTENCE_WORDS} are allowed: {sentence}")
        self.counted["sentences"] += len(lengths)
        if lengths and (mean := sum(lengths) / len(lengths)) > MEAN_WORDS:
            self.fault("sentence", document, 0, f"{mean:.1f} words in the mean, at most {MEAN_WORDS} are allowed")

    def links(self, document, text):
        for line, target, picture in links(text):
            if "://" in target or target.startswith("mailto:"):
                continue
            self.counted["links"] += 1
            name, _, anchor = target.partition("#")
            path = (document.parent / name).resolve() if name else document
            if not path.exists():
                self.fault("picture" if picture else "link", document, line, f"there is no {target}")
            elif anchor and (path.suffix != ".md" or anchor not in anchors(path.read_text())):
                self.fault("link", document, line, f"{name or document.name} has no heading #{anchor}")
            if picture:
                self.shown.add(path)

    def index(self):
        index = self.root / "docs/README.md"
        if not index.is_file():
            self.fault("index", index, 0, "there is none")
            return
        named = {(index.parent / target.partition("#")[0]).resolve() for _, target, _ in links(index.read_text())}
        for document in self.documents:
            if document.is_relative_to(index.parent) and document not in (index, *named):
                self.fault("index", index, 0, f"does not name {document.relative_to(index.parent)}")

    def keys(self):
        reference = self.root / "docs/configuration.md"
        named = set(re.findall(r"\w+", " ".join(re.findall(r"`([^`]+)`", reference.read_text())))) if reference.is_file() else set()
        for source in sorted(path for pattern in READERS for path in self.root.glob(pattern)):
            for key in sorted(set(KEY.findall(source.read_text()))):
                self.counted["keys"] += 1
                if key not in named:
                    self.fault("key", source, 0, f"docs/configuration.md does not name {key}")

    def pictures(self):
        for picture in sorted((self.root / "docs").rglob("*")):
            if picture.suffix in PICTURES:
                self.counted["pictures"] += 1
                if picture not in self.shown:
                    self.fault("picture", picture, 0, "no document shows it")

    def manuals(self):
        for page in sorted((self.root / "tools/package/man").glob("*.1")):
            self.counted["manuals"] += 1
            for fault in self.commands.manual_errors(page.stem, page.read_text()):
                self.fault("manual", page, 0, fault)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root")
    parser.add_argument("--build", help="folder of a build that holds the programs")
    parser.add_argument("--not-built", nargs="*", default=[], help="programs that cannot be built on this machine")
    arguments = parser.parse_args()
    check = Check(arguments.root, Commands(arguments.root, arguments.build, arguments.not_built))
    faults = check.run()
    print("\n".join(faults), file=sys.stderr)
    print(f"{len(check.documents)} documents: " + ", ".join(f"{count} {name}" for name, count in check.counted.items())
          + f"; {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
