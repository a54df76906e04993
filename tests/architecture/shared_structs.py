#!/usr/bin/env python3
"""Structs that C++ and GLSL share must have the same offsets in both.

shared_structs.py write BASE HEADERS...      writes BASE.comp and BASE.cpp, which name every member of every shared struct
shared_structs.py compare BASE.comp GLSLANG PROGRAM ROOT
                                             compares what glslang says of BASE.comp with what the program made of BASE.cpp prints

A shared header is one that includes shaders/shared_types.h and is readable by both (it has `#ifdef __cplusplus`, no `#pragma once`)."""
import os
import re
import subprocess
import sys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
STRUCT = re.compile(r"^struct (\w+) \{\n(.*?)^\};", re.MULTILINE | re.DOTALL)


def structs_of(path):
    """[(namespace, struct, [member])]"""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    if "shaders/shared_types.h" not in text or "#ifdef __cplusplus" not in text or "#pragma once" in text:
        return []
    namespace = re.search(r"^namespace ([\w:]+) \{", text, re.MULTILINE)
    found = []
    for name, body in STRUCT.findall(text):
        members = []
        for declaration in re.sub(r"//[^\n]*", "", body).split(";"):
            words = declaration.split(None, 1)
            if len(words) == 2:
                members += [m.split("[")[0].strip() for m in words[1].split(",")]
        found.append((namespace.group(1) if namespace else "", name, members))
    return found


def write(base, headers):
    shader = ["#version 450", "#extension GL_GOOGLE_include_directive : require", "#extension GL_EXT_scalar_block_layout : require"]
    program = ["#include <cstddef>", "#include <cstdio>"]
    blocks, lines = [], []
    for header in sorted(headers):
        found = structs_of(header)
        if not found:
            continue
        include = f'#include "{os.path.relpath(header, ROOT)}"'
        shader.append(include)
        program.append(include)
        for namespace, name, members in found:
            index = len(blocks)
            # The offset of what follows a struct is its size.
            blocks.append(f"layout(scalar, binding = {index}) buffer Block{index} {{ {name} {name}_begin; uint {name}_end; }};")
            full = f"{namespace}::{name}" if namespace else name
            lines.append(f'    std::printf("{name} %zu\\n", sizeof({full}));')
            lines += [f'    std::printf("{name}.{member} %zu\\n", offsetof({full}, {member}));' for member in members]
    shader += ["layout(local_size_x = 1) in;"] + blocks + ["void main() {}", ""]
    program += ["int main() {"] + lines + ["    return 0;", "}", ""]
    for suffix, text in ((".comp", shader), (".cpp", program)):
        with open(base + suffix, "w", encoding="utf-8") as file:
            file.write("\n".join(text))


def compare(shader, glslang, program, root):
    spirv = subprocess.run([glslang, "-H", "--target-env", "vulkan1.2", f"-I{root}", "-o", os.devnull, shader], stdout=subprocess.PIPE,
                           stderr=subprocess.STDOUT)
    text = spirv.stdout.decode()
    if spirv.returncode != 0:
        print(text)
        return 1
    members, offsets = {}, {}
    for identifier, struct, index, member in re.findall(r'MemberName (\d+)\((\w+)\) (\d+)\s+"(\w+)"', text):
        members[identifier, index] = re.sub("_end$", "", member) if struct.startswith("Block") else f"{struct}.{member}"
    for identifier, index, offset in re.findall(r"MemberDecorate (\d+)\(\w+\) (\d+) Offset (\d+)", text):
        offsets[members[identifier, index]] = int(offset)
    wrong, compared = 0, 0
    for line in subprocess.run([program], stdout=subprocess.PIPE, check=True).stdout.decode().splitlines():
        name, value = line.split()
        compared += 1
        if offsets.get(name) != int(value):
            wrong += 1
            what = "is at byte" if "." in name else "has size"
            print(f"{name} {what} {value} in C++ but {offsets.get(name, 'unknown')} in GLSL")
    print(f"{compared} sizes and offsets compared, {wrong} differ")
    return 1 if wrong or not compared else 0


if __name__ == "__main__":
    if sys.argv[1] == "write":
        write(sys.argv[2], sys.argv[3:])
    else:
        sys.exit(compare(*sys.argv[2:6]))
