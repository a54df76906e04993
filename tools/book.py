#!/usr/bin/env python3
"""Collects the pages that stand beside the code into one book: tools/book.py [FOLDER, default build/book] writes FOLDER/book.md and the
pictures it shows. Chapters: architecture, the models in pipeline order, the devices, our OpenXR extensions, the decisions."""
import os
import re
import shutil
import sys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), ".."))
LINK = re.compile(r"(!?\[[^\]]*\])\(([^)\s#]+)(#[^)\s]*)?\)")


def rows(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return [line.split() for line in (raw.split("#")[0].strip() for raw in file) if line]


def pages_in(folder):
    return [f"{folder}/{name}" for name in sorted(os.listdir(os.path.join(ROOT, folder))) if name.endswith(".md")]


def chapters():
    yield "How it is built", ["docs/architecture.md", "docs/sources.md"]
    slots = rows("perception/models.list")
    yield "Models of perception", ["docs/luidolt2020_corrections.md"] + [f"perception/{slot}/{model}.md" for slot, model in slots] + ["perception/foveation/visual_polar.md"]
    yield "Devices", [f"drivers/{driver}/{driver}.md" for driver, in rows("drivers/drivers.list")]
    yield "OpenXR extensions", pages_in("docs/extensions")
    yield "Decisions", pages_in("docs/decisions")


def anchor(path):
    return re.sub(r"\W+", "-", path)


def chapter_text(path, included, folder):
    """The page one heading level down, with links to other pages of the book turned inward and its pictures copied."""
    def turn(match):
        text, target, fragment = match.group(1), match.group(2), match.group(3) or ""
        if "://" in target:
            return match.group(0)
        target = os.path.normpath(os.path.join(os.path.dirname(path), target)).replace(os.sep, "/")
        if target in included:
            return f"{text}(#{anchor(target)})"
        if text.startswith("!"):
            name = target.replace("/", "_")
            shutil.copy(os.path.join(ROOT, target), os.path.join(folder, name))
            return f"{text}({name})"
        return f"{text}({os.path.relpath(os.path.join(ROOT, target), folder)}{fragment})"

    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        lines, code = [], False
        for line in file.read().splitlines():
            if line.startswith("```"):
                code = not code
            if not code:
                line = LINK.sub(turn, "#" + line if line.startswith("#") else line)
            lines.append(line)
    return f'<a id="{anchor(path)}"></a>\n\n' + "\n".join(lines) + "\n"


def main():
    folder = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else os.path.join(ROOT, "build", "book"))
    os.makedirs(folder, exist_ok=True)
    contents = list(chapters())
    included = {path for _, paths in contents for path in paths}
    parts = ["# Entoptic\n"]
    for title, paths in contents:
        parts.append(f"# {title}\n")
        parts += [chapter_text(path, included, folder) for path in paths]
    book = os.path.join(folder, "book.md")
    with open(book, "w", encoding="utf-8") as file:
        file.write("\n".join(parts))
    print(book)


if __name__ == "__main__":
    main()
