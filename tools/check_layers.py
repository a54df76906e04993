#!/usr/bin/env python3
"""Checks who includes whom: tools/layers.txt for the rooms, tools/outside_headers.txt for headers from outside.

Fails on
  - an include of a room that layers.txt does not allow, and a quoted include that does not name a room;
  - a cycle between rooms in layers.txt, and a cycle between files;
  - an include of a file that is not there (generated shader headers count when their shader is there);
  - a room linked in CMake (entoptic_room(... ROOMS ...)) that layers.txt does not allow;
  - an outside header (Vulkan, OpenXR ...) in a folder that outside_headers.txt does not name.

Usage: check_layers.py [ROOT]      prints file:line: problem, ends with 1 if there is any.
"""
import fnmatch
import os
import re
import sys

SOURCES = (".h", ".hpp", ".c", ".cpp", ".glsl", ".comp", ".vert", ".frag")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def read_layers(path):
    """{room: set of rooms it may include}, in the order of the file."""
    layers = {}
    with open(path, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            line = line.split("#")[0].strip()
            if not line:
                continue
            room, colon, allowed = line.partition(":")
            if not colon or room.strip() in layers:
                raise SystemExit(f"{path}:{number}: expected `room: rooms`, each room once")
            layers[room.strip()] = set(allowed.split())
    for room, allowed in layers.items():
        unknown = allowed - layers.keys()
        if unknown:
            raise SystemExit(f"{path}: {room} names unknown rooms: {' '.join(sorted(unknown))}")
    return layers


def read_outside(path):
    """[(header pattern, [allowed path patterns])]; the first pattern that fits a header decides."""
    rules = []
    with open(path, encoding="utf-8") as file:
        for line in file:
            line = line.split("#")[0].strip()
            if line:
                header, _, allowed = line.partition(":")
                rules.append((header.strip(), allowed.split()))
    return rules


def find_cycle(edges):
    """A list of nodes that form a cycle, or None. edges: {node: iterable of nodes}."""
    state = {}
    for start in edges:
        if start in state:
            continue
        path, iterators = [start], [iter(sorted(edges.get(start, ())))]
        state[start] = "open"
        while path:
            following = next(iterators[-1], None)
            if following is None:
                state[path.pop()] = "done"
                iterators.pop()
            elif state.get(following) == "open":
                return path[path.index(following):] + [following]
            elif following not in state and following in edges:
                state[following] = "open"
                path.append(following)
                iterators.append(iter(sorted(edges[following])))
    return None


def source_files(root, rooms):
    for room in rooms:
        for folder, folders, files in os.walk(os.path.join(root, room)):
            folders[:] = sorted(f for f in folders if not f.startswith("."))
            for name in sorted(files):
                if name.endswith(SOURCES):
                    yield os.path.relpath(os.path.join(folder, name), root).replace(os.sep, "/")


def resolve(root, target):
    """Path from the root of an included header, 'generated' for one made in the build tree, None when it is not there."""
    for path in (target, "include/" + target):
        if os.path.exists(os.path.join(root, path)):
            return path
    if target.endswith(".h") and os.path.exists(os.path.join(root, target[:-2])):
        return "generated"
    return None


def check(root):
    problems = []
    layers = read_layers(os.path.join(root, "tools/layers.txt"))
    outside = read_outside(os.path.join(root, "tools/outside_headers.txt"))
    cycle = find_cycle(layers)
    if cycle:
        problems.append(f"tools/layers.txt: rooms form a cycle: {' -> '.join(cycle)}")

    graph = {}
    for path in source_files(root, layers):
        room = path.split("/")[0]
        graph[path] = set()
        with open(os.path.join(root, path), encoding="utf-8") as file:
            lines = file.read().splitlines()
        for number, line in enumerate(lines, 1):
            match = INCLUDE.match(line)
            if not match:
                continue
            quoted, target = match.group(1) == '"', match.group(2)
            where = f"{path}:{number}"
            first = target.split("/")[0]
            if first == "entoptic":     # the public headers, found through include/
                first = "include"
            if "/" in target and first in layers:
                if first != room and first not in layers[room]:
                    problems.append(f"{where}: {room}/ may not include {first}/ (tools/layers.txt)")
                found = resolve(root, target)
                if found is None:
                    problems.append(f"{where}: \"{target}\" is not there")
                elif found != "generated":
                    graph[path].add(found)
            elif quoted:
                problems.append(f"{where}: \"{target}\" does not name a room; write the path from the repository's root")
            for pattern, allowed in outside:
                if fnmatch.fnmatch(target, pattern):
                    if not any(fnmatch.fnmatch(path, a) for a in allowed):
                        problems.append(f"{where}: <{target}> does not belong here (tools/outside_headers.txt)")
                    break
    cycle = find_cycle(graph)
    if cycle:
        problems.append(f"files include each other: {' -> '.join(cycle)}")

    for room, allowed in layers.items():
        lists = os.path.join(root, room, "CMakeLists.txt")
        if os.path.exists(lists):
            with open(lists, encoding="utf-8") as file:
                text = file.read()
            for name, rooms in re.findall(r"entoptic_room\(\s*(\w+)\s+ROOMS\s+([a-z_ \n]*)", text):
                for other in rooms.split():
                    if other not in layers.get(name, set()):
                        problems.append(f"{room}/CMakeLists.txt: {name} may not link {other} (tools/layers.txt)")
    return problems


def main():
    root = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(__file__), ".."))
    problems = check(root)
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
