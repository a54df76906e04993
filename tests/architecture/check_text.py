#!/usr/bin/env python3
"""Every text file: ends with a newline, no trailing blanks, no tabs in sources, no notes to self, no path of
somebody's machine, no mention of a page (*.md) that is not there."""
import os
import re
import sys

from repository import ROOT, files, report, text

NOTES = re.compile(r"\b(" + "|".join(["TO" + "DO", "FIX" + "ME", "HA" + "CK", "XX" + "X"]) + r")\b")
# Folders in which people and machines keep checkouts; `u` and `user` stand for anybody.
HOMES = ["home/(?!u/|user/)"] + [name + "/" for name in ("Users", "work", "scratch", "mnt", "root")]
MACHINE_PATH = re.compile(r"(?<![\w./$}<~-])/(?:" + "|".join(HOMES) + r")[\w.]")
PAGE = re.compile(r"[\w./-]*\w\.md\b")
# These name pages that they make or look for.
MAKE_PAGES = ("tools/book.py", "tests/architecture/check_text.py", "tests/architecture/check_lists.py")
SOURCES = (".h", ".cpp", ".c", ".glsl", ".comp", ".py", ".sh", ".cmake", "CMakeLists.txt")
DATA = (".csv", ".toml", ".json", ".txt", ".exr", ".png")


def pages_missing(path, line):
    for page in PAGE.findall(line):
        # The project's specification, which is handed to its developers and is not part of the repository (CONTRIBUTING).
        if page.startswith(("facts/", "design/")):
            continue
        if "://" in line and page in line[line.index("://"):].split()[0]:
            continue
        near = os.path.normpath(os.path.join(os.path.dirname(path), page))
        if not any(os.path.exists(os.path.join(ROOT, p.lstrip("/"))) for p in (page, near)):
            yield page


def check(path, content):
    if path.startswith("tests/fuzz/corpus/"):   # bytes for parsers, kept as they are
        return
    if content and not content.endswith("\n"):
        yield f"{path}: no newline at the end"
    if path.endswith(DATA):
        return
    source = path.endswith(SOURCES)
    for number, line in enumerate(content.split("\n"), 1):
        where = f"{path}:{number}"
        if line != line.rstrip() and path != "LICENSE":
            yield f"{where}: blanks at the end of the line"
        if source and "\t" in line:
            yield f"{where}: a tab"
        if NOTES.search(line):
            yield f"{where}: a note to self ({NOTES.search(line).group(0)}): open an issue instead"
        if MACHINE_PATH.search(line):
            yield f"{where}: a path of somebody's machine"
        if path not in MAKE_PAGES:
            for page in pages_missing(path, line):
                yield f"{where}: {page} is not there"


def main():
    problems = []
    for path in files():
        content = text(path)
        if content is not None:
            problems += check(path, content)
    return report(problems)


if __name__ == "__main__":
    sys.exit(main())
