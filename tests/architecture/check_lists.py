#!/usr/bin/env python3
"""perception/models.list and drivers/drivers.list: every row has its whole group of files, every group of files has its row, and every
parameter of a model is described on the model's page."""
import os
import re
import sys

from repository import ROOT, report

MODEL_FILES = ("{model}_params.h", "{model}_math.glsl", "{model}.cpp", "{model}_reference.cpp", "{model}_test.cpp", "{model}_bench.cpp",
               "{model}.md", "{slot}.h")
DRIVER_FILES = ("{driver}_device.h", "{driver}_device.cpp", "{driver}_test.cpp", "{driver}.md")
PARAMETER = re.compile(r'^\s*\{"(\w+)",\s*"[^"]*",\s*[-\d.]', re.MULTILINE)
SHARED_PARAMETER = re.compile(r"\bParameterInfo (\w+)[{(]")   # of a slot's models, in a header of its folder


def rows(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        for line in file:
            line = line.split("#")[0].split()
            if line:
                yield line


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def parameters_of(folder, model):
    """Names in the model's list: its own, and those of the slot's headers that it names."""
    source = read(f"{folder}/{model}.cpp")
    headers = "".join(read(f"{folder}/{name}") for name in sorted(os.listdir(os.path.join(ROOT, folder))) if name.endswith(".h"))
    shared = [name for name in SHARED_PARAMETER.findall(headers) if re.search(rf"\b{name}\b", source)]
    return PARAMETER.findall(source) + shared


def check_models():
    listed, slots = set(), []
    for row in rows("perception/models.list"):
        if len(row) != 2:
            yield f"perception/models.list: expected `slot model`, not `{' '.join(row)}`"
            continue
        slot, model = row
        if (slot, model) in listed:
            yield f"perception/models.list: {slot} {model} is there twice"
        # Rows are the pipeline's order; mesopic models act on scene light or on display light, so that slot stands on both sides of tone.
        if slot in slots and slots[-1] != slot and not (slot == "mesopic" and slots[-1] == "tone"):
            yield f"perception/models.list: the rows of slot {slot} must stand together, they are the pipeline's order"
        listed.add((slot, model))
        slots.append(slot)
        folder = f"perception/{slot}"
        missing = [f.format(slot=slot, model=model) for f in MODEL_FILES]
        missing = [f for f in missing if not os.path.exists(os.path.join(ROOT, folder, f))]
        for file in missing:
            yield f"perception/models.list: {slot} {model}: {folder}/{file} is missing"
        if f"{model}.cpp" not in missing and f"{model}.md" not in missing:
            page = read(f"{folder}/{model}.md")
            for parameter in parameters_of(folder, model):
                if not re.search(rf"\b{parameter}\b", page):
                    yield f"{folder}/{model}.md: parameter {parameter} is not described"
    for slot in sorted(os.listdir(os.path.join(ROOT, "perception"))):
        folder = os.path.join(ROOT, "perception", slot)
        if os.path.isdir(folder):
            for name in sorted(os.listdir(folder)):
                model = name[:-len("_params.h")]
                if name.endswith("_params.h") and (slot, model) not in listed:
                    yield f"perception/{slot}/{name}: there is no row `{slot} {model}` in perception/models.list"


def check_drivers():
    listed = set()
    for row in rows("drivers/drivers.list"):
        driver = row[0]
        if len(row) != 1 or driver in listed:
            yield f"drivers/drivers.list: expected each folder once, one a line, not `{' '.join(row)}`"
        listed.add(driver)
        for file in DRIVER_FILES:
            path = f"drivers/{driver}/{file.format(driver=driver)}"
            if not os.path.exists(os.path.join(ROOT, path)):
                yield f"drivers/drivers.list: {driver}: {path} is missing"
    for name in sorted(os.listdir(os.path.join(ROOT, "drivers"))):
        if os.path.exists(os.path.join(ROOT, "drivers", name, f"{name}_device.cpp")) and name not in listed:
            yield f"drivers/{name}: not in drivers/drivers.list"


if __name__ == "__main__":
    sys.exit(report(list(check_models()) + list(check_drivers())))
