"""Checks that what the documents refer to is there.

usage: links_test.py [ROOT]

Two kinds of references are followed. The first kind is the relative links of all Markdown files: each must name a file or
a folder, and an anchor behind `#` must be the anchor of a heading of that file. The second kind is citations: a source or
another Markdown file that says `rules.md, NAME` must name one of the rules of core/rules.md, without its number, and one
that says `experiments.md, NAME` must name one of the headings of core/experiments.md.
Links to other servers are not followed.

Exit code: 0 - all are there; 1 - the broken ones are listed.
"""

import os
import re
import sys
import tempfile
import urllib.parse

SKIPPED_FOLDERS = {"build", "node_modules", "__pycache__"}
SOURCE_ENDINGS = (".h", ".cpp", ".ts", ".mjs", ".py", ".sh", ".txt", ".yaml")
# The cited documents, what may be cited in them, and how a heading is told from others.
CITED = {"core/rules.md": ("rule", re.compile(r"\d+\.\s+(.*)")), "core/experiments.md": ("experiment", re.compile(r"(.*)"))}

INLINE_LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\]\([^)]*\))*\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
INNER_LINK = re.compile(r"\[[^\[\]]*\]\(\s*<?([^)\s>]+)>?[^)]*\)")
NAMED_LINK = re.compile(r"^\s{0,3}\[[^\]]+\]:\s+<?(\S+?)>?(?:\s|$)", re.MULTILINE)
HTML_LINK = re.compile(r"<(?:a|img)\b[^>]*\b(?:href|src)=\"([^\"]+)\"")
HEADING = re.compile(r"^#{1,6}\s+(.*?)\s*#*\s*$")
FENCE = re.compile(r"^\s*(```|~~~)")
CODE_SPAN = re.compile(r"(`+)(.+?)\1")
# A name begins with a capital letter and ends before the end of the sentence or the list.
CITATION = re.compile(r"\b(rules|experiments)\.md, (?!NAME\b)([A-Z][a-z-]+(?: [a-z-]+)*)")


def files(root, endings):
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(f for f in folders if f not in SKIPPED_FOLDERS and not f.startswith("."))
        for name in sorted(names):
            if name.endswith(endings):
                yield os.path.relpath(os.path.join(folder, name), root)


def read(root, path):
    with open(os.path.join(root, path), encoding="utf-8") as file:
        return file.read()


def without_code_blocks(text):
    """The text with the lines of fenced blocks empty, so that line numbers stay."""
    lines, fence = [], None
    for line in text.split("\n"):
        mark = FENCE.match(line)
        if fence is None and mark:
            fence = mark.group(1)
            lines.append("")
        elif fence is not None:
            if mark and mark.group(1) == fence:
                fence = None
            lines.append("")
        else:
            lines.append(line)
    return "\n".join(lines)


def headings(text):
    return [match.group(1) for match in map(HEADING.match, without_code_blocks(text).split("\n")) if match]


def anchors(text):
    """The anchors of the headings, as GitHub makes them: a heading that is there twice gets a number."""
    found = set()
    for heading in headings(text):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", CODE_SPAN.sub(r"\2", heading))
        anchor = re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")
        candidate, count = anchor, 0
        while candidate in found:
            count += 1
            candidate = f"{anchor}-{count}"
        found.add(candidate)
    return found


def links(text):
    """The line number and the target of each link that is not in code."""
    plain = CODE_SPAN.sub(lambda match: " " * len(match.group(0)), without_code_blocks(text))
    seen = set()
    for pattern in (INLINE_LINK, INNER_LINK, NAMED_LINK, HTML_LINK):
        for match in pattern.finditer(plain):
            if match.start(1) in seen:
                continue
            seen.add(match.start(1))
            yield plain.count("\n", 0, match.start(1)) + 1, match.group(1)


def link_faults(root):
    for path in files(root, (".md",)):
        for number, target in links(read(root, path)):
            if re.match(r"[a-zA-Z][a-zA-Z0-9+.\-]*:|//", target):
                continue
            name, _, anchor = urllib.parse.unquote(target).partition("#")
            there = os.path.normpath(os.path.join(os.path.dirname(path), name)) if name else path
            if there.startswith("..") or name.startswith("/"):
                yield f"{path}:{number}: {target} leaves the repository"
            elif not os.path.exists(os.path.join(root, there)):
                yield f"{path}:{number}: there is no {there}"
            elif anchor and not (there.endswith(".md") and anchor in anchors(read(root, there))):
                yield f"{path}:{number}: {there} has no heading for #{anchor}"


def names_to_cite(root):
    """For each cited document that there is: its path, what may be cited in it, and the names of these."""
    for document, (kind, form) in CITED.items():
        if os.path.exists(os.path.join(root, document)):
            found = [form.match(heading) for heading in headings(read(root, document))]
            yield os.path.basename(document), (document, kind, {match.group(1) for match in found if match})


def citation_faults(root):
    cited = dict(names_to_cite(root))
    for path in files(root, SOURCE_ENDINGS + (".md",)):
        if path == "tests/tools/links_test.py":
            continue
        text = read(root, path)
        # A citation may go on in the next line of a comment.
        joined = re.sub(r"\n\s*(?://+|#)\s*", " ", text)
        for match in CITATION.finditer(joined):
            name = f"{match.group(1)}.md"
            if name not in cited:
                continue
            document, kind, names = cited[name]
            if path != document and match.group(2) not in names:
                yield f"{path}: {document} has no {kind} \"{match.group(2)}\""


def find_faults(root):
    return list(link_faults(root)) + list(citation_faults(root))


def check_itself():
    """The test finds what is broken in a small repository, and nothing else."""
    documents = {
        "a.md": "# One `two`: three\n# One two three\n[b](b/c.md#x-y) [a](#one-two-three-1) [o](http://x/y) [f](b)\n"
                "[no](no.md) [no](b/c.md#no) `[code](no.md)`\n```\n[code](no.md)\n```\n[![no](no.svg)](a.md)\n[r]: no.txt\n",
        "b/c.md": "## x y\n[up](../a.md#one-two-three) [out](../../a.md)\n<img src=\"no.png\">\n",
        "core/rules.md": "## 1. Owned things\n",
        "core/experiments.md": "## Tried things\n### Fast ones\n",
        "core/x.h": "/// Source: rules.md, Owned\n/// things; rules.md, No such rule.\n"
                    "// See experiments.md, Fast\n// ones. See experiments.md, Slow ones.\n",
    }
    expected = ["a.md:4: there is no no.md", "a.md:4: b/c.md has no heading for #no", "a.md:8: there is no no.svg",
                "a.md:9: there is no no.txt", "b/c.md:2: ../../a.md leaves the repository",
                "b/c.md:3: there is no b/no.png", "core/x.h: core/rules.md has no rule \"No such rule\"",
                "core/x.h: core/experiments.md has no experiment \"Slow ones\""]
    with tempfile.TemporaryDirectory() as root:
        for path, text in documents.items():
            os.makedirs(os.path.dirname(os.path.join(root, path)), exist_ok=True)
            with open(os.path.join(root, path), "w", encoding="utf-8") as file:
                file.write(text)
        found = find_faults(root)
    if sorted(found) != sorted(expected):
        raise AssertionError(f"the test does not find what is broken: {found}")


def main():
    check_itself()
    here = os.path.dirname(os.path.abspath(__file__))
    faults = find_faults(os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else os.path.dirname(os.path.dirname(here)))
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
