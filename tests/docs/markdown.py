"""What the check of the documents needs to know of Markdown: prose, links, headings, commands."""

import re

FENCE = re.compile(r"^\s*(```|~~~)\s*([\w-]*)")
LIST_ITEM = re.compile(r"^\s*([-*+]|\d+\.)\s+")
IMAGE = re.compile(r"!\[([^\]]*)\]\(([^)\s]+)\)")
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s]+)\)")
INLINE_CODE = re.compile(r"`([^`\n]+)`")
# A full stop after these, or after a single letter, ends no sentence.
ABBREVIATION = re.compile(r"(?:\b(?:e\.g|i\.e|etc|vs|cf|approx|Eq|Eqs|Fig|exp|no|Dr|resp)|\b[A-Z])\.$")
SENTENCE_END = re.compile(r"[.!?][)\"'”*]*(?=\s+[\"'“(*\[]*[A-Z0-9§])")


def split_fences(text):
    """(lines outside of fences with their numbers from 1, [(language, first line number, lines)])."""
    outside, blocks, block, mark = [], [], None, None
    for number, line in enumerate(text.splitlines(), 1):
        fence = FENCE.match(line)
        if block is None and fence:
            block, mark = (fence.group(2), number + 1, []), fence.group(1)
        elif block is not None and line.strip() == mark:
            blocks.append(block)
            block = None
            outside.append((number, ""))  # a fence ends a paragraph
        elif block is not None:
            block[2].append(line)
        else:
            outside.append((number, line))
    return outside, blocks


def paragraphs(text):
    """(line number, text) of each paragraph and list item; without headings, tables, code, pictures and formulas."""
    current, start = [], 0
    for number, line in [*split_fences(text)[0], (0, "")]:
        stripped = line.strip()
        item = LIST_ITEM.match(line)
        formula = line.startswith("    ") and not current
        if not stripped or item or formula or stripped.startswith(("#", "|", "<!--", "![")):
            if current:
                yield start, " ".join(current)
            current = []
        if not stripped or formula or stripped.startswith(("#", "|", "<!--", "![")):
            continue
        if not current:
            start = number
        current.append(LIST_ITEM.sub("", line).strip() if item else stripped)


def plain(paragraph):
    """Without markup; a piece of inline code is one word."""
    text = IMAGE.sub("", paragraph)
    text = INLINE_CODE.sub("Code", text)
    text = LINK.sub(r"\1", text)
    return re.sub(r"\*\*|(?<!\w)[*_]|[*_](?!\w)", "", text)


def sentences(paragraph):
    """A sentence ends at . ! ? before a capital, a digit or an opening bracket; colons and semicolons end none."""
    text, start = plain(paragraph), 0
    for end in SENTENCE_END.finditer(text):
        if not ABBREVIATION.search(text[start : end.end()].rstrip(")\"'”*")):
            yield text[start : end.end()].strip()
            start = end.end()
    if text[start:].strip():
        yield text[start:].strip()


def words(sentence):
    return sum(1 for word in sentence.split() if re.search(r"\w", word))


def anchors(text):
    """The anchors of the headings, as forges make them."""
    found, count = set(), {}
    for _, line in split_fences(text)[0]:
        heading = re.match(r"^#+\s+(.*?)\s*#*$", line)
        if not heading:
            continue
        title = LINK.sub(r"\1", heading.group(1)).replace("`", "").replace("*", "")
        slug = re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")
        found.add(slug if slug not in count else f"{slug}-{count[slug]}")
        count[slug] = count.get(slug, 0) + 1
    return found


def links(text):
    """(line number, target, is a picture) of all links outside of code."""
    for number, line in split_fences(text)[0]:
        bare = INLINE_CODE.sub("", line) if "](" not in line else line
        for picture in IMAGE.finditer(bare):
            yield number, picture.group(2), True
        for link in LINK.finditer(IMAGE.sub("", bare)):
            yield number, link.group(2), False


def command_texts(text):
    """(line number, text) of what may be a command: lines of shell blocks, joined where they go on, and inline code."""
    outside, blocks = split_fences(text)
    for language, first, lines in blocks:
        if language not in ("", "sh", "bash", "shell", "console"):
            continue
        held, start = "", first
        for number, line in enumerate(lines, first):
            if not held:
                start = number
            held += line
            if held.rstrip().endswith("\\"):
                held = held.rstrip()[:-1] + " "
                continue
            yield start, held
            held = ""
    for start, block in inline_blocks(outside):
        for code in INLINE_CODE.finditer(block):
            yield start, code.group(1)


def inline_blocks(lines):
    """Inline code may go on in the next line: paragraphs as they stand, table rows by themselves."""
    held, start = [], 0
    for number, line in [*lines, (0, "")]:
        if not line.strip() or line.lstrip().startswith("|"):
            if held:
                yield start, " ".join(held)
            held = []
        if line.lstrip().startswith("|"):
            yield number, line
        elif line.strip():
            start = start if held else number
            held.append(line.strip())
