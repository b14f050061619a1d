"""Commands as documents show them, held against programs, scripts, files and CMake."""

import json
import re
import shlex
import subprocess
from pathlib import Path

PROGRAM = re.compile(r"^patella(-[a-z]+)*$")
ASSIGNMENT = re.compile(r"^([A-Za-z_]\w*)=(.*)$", re.S)
SUBCOMMANDS = re.compile(r"^(?:Subcommands|SUBCOMMANDS):\n((?:.*\n?)*)", re.M)
OPTION = re.compile(r"(?<![\w-])--[a-z][\w-]*")
# Paths below these folders are the project's own; others are the reader's.
OWN_FOLDERS = ("core/", "drivers/", "sim/", "firmware_app/", "tools/", "tests/", "docs/")
SEPARATORS = {"&&", "||", ";", "|", "&", "(", ")", "|&"}
# Arguments that a document leaves out or asks the reader to fill in.
PLACEHOLDER = re.compile(r"^(…|\.\.\.|N|[A-Z][A-Z_]*(\.\.\.)?|\[.*\]|<.*>)$")


class Commands:
    def __init__(self, root, build=None, not_built=()):
        self.root = Path(root).resolve()
        self.build = Path(build).resolve() if build else None
        self.not_built = set(not_built)
        self.parsed = 0
        self.help = {}
        self.start_document()
        # Build folders hold CMake files of their own, and folders that other tests make and remove meanwhile.
        folders = [part for part in self.root.iterdir() if part.is_dir() and part.name != "build"]
        sources = [self.root / "CMakeLists.txt"]
        for folder in folders:
            sources += [*folder.rglob("CMakeLists.txt"), *folder.rglob("*.cmake")]
        self.cmake = "\n".join(path.read_text() for path in sources)
        presets = self.root / "CMakePresets.json"
        self.presets = json.loads(presets.read_text()) if presets.is_file() else {}

    def start_document(self):
        """Variables and files that the commands of one document make are not those of the next."""
        self.variables, self.made = {}, set()

    def errors(self, text):
        """What is wrong with the commands in a line of shell or a piece of inline code."""
        found = []
        for command in self.split(text.strip()):
            found += self.command(command)
        return found

    def split(self, text):
        text = re.sub(r"^\$ ", "", text)
        lexer = shlex.shlex(text, posix=True, punctuation_chars="|&;()")
        lexer.whitespace_split = True
        lexer.commenters = "#"
        try:
            tokens = list(lexer)
        except ValueError:
            return []  # output, prose: an open quotation mark is no command
        commands, current = [], []
        for token in tokens:
            if token in SEPARATORS or set(token) <= set("|&;()"):
                commands.append(current)
                current = []
            else:
                current.append(token)
        return [command for command in [*commands, current] if command]

    def command(self, tokens):
        assigned = None
        while tokens and (assigned := ASSIGNMENT.match(tokens[0])) and not tokens[0].startswith("-"):
            self.variables[assigned.group(1)] = assigned.group(2)
            tokens = tokens[1:]
        if not tokens:
            return self.errors(assigned.group(2)) if assigned else []
        if tokens[0].startswith("$") and tokens[0][1:] in self.variables:
            tokens = [*shlex.split(self.variables[tokens[0][1:]]), *tokens[1:]]
        tokens, written = without_redirection(tokens)
        self.made |= written
        if not tokens:
            return []
        first, arguments = tokens[0], tokens[1:]
        built = re.match(r"^build/\w+/(.*)$", first)
        name = first.rsplit("/", 1)[-1]
        if PROGRAM.match(first) or (built and PROGRAM.match(name)):
            return self.program(first, name, arguments)
        if first.startswith(("tools/", "tests/")):
            return self.own_path(first, arguments)
        if first in ("cmake", "ctest"):
            self.parsed += 1
            return self.cmake_command(first, arguments)
        return []

    def own_path(self, first, arguments):
        """A script with its arguments, or just a file, a folder or a pattern of files."""
        if re.search(r"(^|[/_])[A-Z]{3,}", first):
            return []  # tools/bench/NAME: a name to fill in
        self.parsed += 1
        path = self.root / first
        if re.search(r"[*?\[{]", first):
            return [] if any(any(self.root.glob(one)) for one in alternatives(first)) else [f"nothing matches {first}"]
        if not path.exists():
            return [f"there is no {first}"]
        if not arguments:
            return []
        if not path.is_file() or not path.stat().st_mode & 0o111:
            return [f"{first} is no program, but has arguments: {' '.join(arguments)}"]
        script, found = path.read_text(), []
        for argument in arguments:
            if argument.startswith("-") and argument != "--":
                if not re.search(re.escape(argument.split("=")[0]) + r"(?![\w-])", script):
                    found.append(f"{first} does not know {argument}")
            else:
                found += self.file(argument)
        if first == "tools/board/run.sh":  # its first argument is a scenario
            found += [f"there is no scenario {name}" for name in arguments[:1] if re.match(r"^[a-z_0-9]+$", name)
                      and not (self.root / f"tests/board/qemu/scenarios/{name}.sh").is_file()]
        return found

    def file(self, argument):
        """A file of the project that is an argument, or part of one as in --config=FILE, exists."""
        path = argument.split("=", 1)[-1]
        path = path.split(":", 1)[-1] if path.startswith("replay:") else path
        if path.startswith(OWN_FOLDERS) and path not in self.made and not (self.root / path).exists() and not any(self.root.glob(path)):
            return [f"there is no {path}"]
        return []

    def program(self, first, name, arguments):
        self.parsed += 1
        if not re.search(rf"add_executable\({re.escape(name)}[\s)]", self.cmake):
            return [f"CMake builds no program {name}"]
        found = [error for argument in arguments for error in self.file(argument)]
        if not self.build or name in self.not_built:
            return found
        place = self.built(name)
        if place is None:
            return [*found, f"{name} is not in {self.build}"]
        if first != name and not (self.build / first.split("/", 2)[2]) == place:
            found.append(f"{first} is not where the build has {name}")
        return found + self.arguments(name, place, arguments)

    def built(self, name):
        # A build has each program once, in the folder of its sources.
        for folder in ("firmware_app", "tools"):
            for path in sorted((self.build / folder).rglob(name)):
                if path.is_file() and path.stat().st_mode & 0o111:
                    return path
        return None

    def help_of(self, place, subcommand=()):
        key = (place, *subcommand)
        if key not in self.help:
            result = subprocess.run([place, *subcommand, "--help"], capture_output=True, text=True, timeout=60, check=False)
            self.help[key] = result.stdout if result.returncode == 0 else None
        return self.help[key]

    def arguments(self, name, place, arguments):
        text = self.help_of(place)
        if text is None:
            return [f"{name} --help fails"]
        subcommands = SUBCOMMANDS.search(text)
        if subcommands:
            known = re.findall(r"^  ([a-z]\S*)", subcommands.group(1), re.M)
            if arguments and re.match(r"^[a-z][\w-]*$", arguments[0]):
                if arguments[0] not in known:
                    return [f"{name} has no subcommand {arguments[0]}"]
                name, text = f"{name} {arguments[0]}", self.help_of(place, (arguments[0],)) + options_alone(text)
        return [f"{name} has no option {argument.split('=')[0]}" for argument in arguments
                if re.match(r"^-{1,2}[A-Za-z]", argument)
                and not re.search(rf"(?<![\w-]){re.escape(argument.split('=')[0])}(?![\w-])", text)]

    def manual_errors(self, name, page):
        """Where a manual, in the language of man(7), differs from what the program says of itself."""
        place = self.build and self.built(name)
        if not place or self.help_of(place) is None:
            return [f"{name} --help cannot be asked"] if self.build else []
        text = self.help_of(place)
        subcommands = SUBCOMMANDS.search(text)
        names = re.findall(r"^  ([a-z]\S*)", subcommands.group(1), re.M) if subcommands else []
        # A subcommand that is a program of its own has a manual of its own.
        parts = [self.help_of(place, (one,)) for one in names if not self.built(f"{name}-{one}")]
        helped = set(re.findall(OPTION, "\n".join([options_alone(text), *parts]))) - {"--help"}
        page = page.replace("\\-", "-")
        named = set(re.findall(OPTION, page))
        return [f"does not name the subcommand {one}" for one in names if f"{name} {one}" not in page] \
            + [f"does not name {option}" for option in sorted(helped - named)] \
            + [f"names {option}, which {name} does not know" for option in sorted(named - helped)]

    def cmake_command(self, tool, arguments):
        found = []
        kind = "testPresets" if tool == "ctest" else "buildPresets" if "--build" in arguments else "configurePresets"
        presets = [preset["name"] for preset in self.presets.get(kind, []) if not preset.get("hidden")]
        for index, argument in enumerate(arguments):
            value = arguments[index + 1] if index + 1 < len(arguments) else ""
            if argument == "--preset" and value not in presets and not PLACEHOLDER.match(value):
                found.append(f"{tool}: there is no preset '{value}'")
            elif argument == "--target" and not PLACEHOLDER.match(value) and value not in ("all", "install") and not re.search(
                    rf"(add_executable|add_library|add_custom_target)\({re.escape(value)}[\s)]|NAME {re.escape(value)}\s", self.cmake):
                found.append(f"{tool}: there is no target '{value}'")
            elif (variable := re.match(r"^-D(\w+)", argument)) and not variable.group(1).startswith("CMAKE_"):
                if not re.search(rf"\b{variable.group(1)}\b", self.cmake):
                    found.append(f"{tool}: nothing reads {variable.group(1)}")
            elif argument.startswith("--") and argument not in (
                    "--preset", "--build", "--target", "--install", "--prefix", "--component", "--fresh", "--parallel",
                    "--output-on-failure", "--repeat", "--clean-first"):
                found.append(f"{tool}: unknown option {argument}")
        return found


def options_alone(text):
    """The options of the program itself hold in its subcommands as well, but the names of those are no options."""
    return SUBCOMMANDS.sub("", text)


def without_redirection(tokens):
    """(the command, the files that its output goes to)"""
    kept, written, into = [], set(), None
    for token in tokens:
        operator = re.match(r"^\d?(<|>>?(?:&\d)?)(.*)$", token)
        if into:
            written |= {token} if into == ">" else set()
            into = None
        elif operator and not operator.group(2) and "&" not in operator.group(1):
            into = operator.group(1)[0]
        elif operator:
            written |= {operator.group(2)} if operator.group(1)[0] == ">" else set()
        else:
            kept.append(token)
    return kept, written


def alternatives(pattern):
    """a{b,c}d as [abd, acd]."""
    braces = re.match(r"^(.*?)\{([^{}]*)\}(.*)$", pattern)
    if not braces:
        return [pattern]
    return [one for middle in braces.group(2).split(",") for one in alternatives(braces.group(1) + middle + braces.group(3))]
