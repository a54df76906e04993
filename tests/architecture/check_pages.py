#!/usr/bin/env python3
"""README.md, CONTRIBUTING.md and docs/: links and pictures are there; the commands in them exist with the options they are shown with.

Usage: check_pages.py [PATH OF entoptic]      without it, `entoptic` commands are not tried."""
import os
import re
import shlex
import subprocess
import sys

from repository import ROOT, files, report, text

LINK = re.compile(r"\]\(([^)\s]+)\)")
FENCE = re.compile(r"^```(?:sh|bash)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def check_links(path, content):
    for target in LINK.findall(content) + re.findall(r'<img[^>]* src="([^"]+)"', content):
        target = target.split("#")[0]
        if target and "://" not in target and not target.startswith("mailto:"):
            if not os.path.exists(os.path.join(ROOT, os.path.dirname(path), target)):
                yield f"{path}: link to {target}, which is not there"


def commands(content):
    """Command lines of the page's sh blocks, continuation lines joined."""
    for block in FENCE.findall(content):
        for line in block.replace("\\\n", " ").splitlines():
            line = line.strip()
            if line and not line.startswith("#"):
                yield line


def help_of(entoptic, subcommand, cache={}):
    if subcommand not in cache:
        call = [entoptic] + ([subcommand] if subcommand else []) + ["--help"]
        done = subprocess.run(call, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, timeout=60)
        cache[subcommand] = done.stdout.decode(errors="replace") if done.returncode == 0 else None
    return cache[subcommand]


def check_entoptic(where, words, entoptic):
    arguments = words[1:words.index("--")] if "--" in words else words[1:]
    if not arguments or arguments[0].startswith("-"):
        return
    page = help_of(entoptic, arguments[0])
    if page is None:
        yield f"{where}: `entoptic {arguments[0]} --help` failed: no such command?"
        return
    for option in (a.split("=")[0] for a in arguments[1:] if a.startswith("--")):
        if not re.search(re.escape(option) + r"(?![\w-])", page):
            yield f"{where}: `entoptic {arguments[0]}` has no option {option}"


def check_commands(path, content, entoptic):
    for line in commands(content):
        where = f"{path}: `{line}`"
        try:
            words = shlex.split(line, comments=True)
        except ValueError as error:
            yield f"{where}: {error}"
            continue
        while words and re.match(r"^\w+=", words[0]):
            words.pop(0)
        if not words:
            continue
        program = words[0][2:] if words[0].startswith("./") else words[0]
        if program.startswith("tools/") and not os.access(os.path.join(ROOT, program), os.X_OK):
            yield f"{where}: {program} is not there or cannot be run"
        if os.path.basename(program) == "entoptic" and entoptic:
            yield from check_entoptic(where, words, entoptic)


def main():
    entoptic = sys.argv[1] if len(sys.argv) > 1 else None
    problems = []
    for path in files():
        if path.endswith(".md"):
            content = text(path)
            problems += check_links(path, content)
            problems += check_commands(path, content, entoptic)
    for needed in ("tools/demo.sh", "tools/test.sh"):
        if needed not in text("README.md"):
            problems.append(f"README.md: does not name {needed}")
    return report(problems)


if __name__ == "__main__":
    sys.exit(main())
