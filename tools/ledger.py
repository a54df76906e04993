#!/usr/bin/env python3
"""The accuracy ledger: bench/ledger/accuracy.csv holds the error of every effect and setting on every device it was measured on.

Tests that measure an error print a line `LEDGER,effect,setting,metric,value` to standard output (commas inside a text have a blank
after them). This tool runs them and compares.

  tools/ledger.py --device NAME PROGRAM...            fails when a number got worse by more than a tenth
  tools/ledger.py --device NAME --update PROGRAM...   also writes better and new numbers into the ledger (worse ones too with --accept-worse)
  tools/ledger.py --device-program PATH ...           a program that prints the device's name, instead of --device
  tools/ledger.py --log FOLDER ...                    build folder whose ctest run, in progress or the last, has run programs already:
                                                      their lines are taken from there

Less is better, but for metrics whose name begins with `psnr` or ends in `_db`. Numbers for a device without rows are listed only."""
import argparse
import csv
import math
import os
import re
import subprocess
import sys

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), ".."))
LEDGER = os.path.join(ROOT, "bench", "ledger", "accuracy.csv")
HEADER = ["effect", "setting", "metric", "value", "device", "commit"]
TOLERANCE = 0.1
# Below this an error is rounding of a number that is zero in theory.
NEGLIGIBLE = 1e-15


def read_ledger(path):
    """{(effect, setting, metric, device): row}"""
    rows = {}
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        if reader.fieldnames != HEADER:
            raise SystemExit(f"{path}: the header must be {','.join(HEADER)}")
        for row in reader:
            key = (row["effect"], row["setting"], row["metric"], row["device"])
            if key in rows:
                raise SystemExit(f"{path}: two rows for {','.join(key)}")
            float(row["value"])
            rows[key] = row
    return rows


def write_ledger(path, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, HEADER, lineterminator="\n")
        writer.writeheader()
        for key in sorted(rows):
            writer.writerow(rows[key])


def measurements(output):
    """[(effect, setting, metric, value)] of the LEDGER lines in a program's output."""
    found = []
    for line in output.splitlines():
        if line.startswith("LEDGER,"):
            cells = re.split(r",(?! )", line)   # a comma before a blank belongs to the text
            if len(cells) != 5:
                raise SystemExit(f"not LEDGER,effect,setting,metric,value: {line}")
            found.append((cells[1], cells[2], cells[3], float(cells[4])))
    return found


def larger_is_better(metric):
    return metric.startswith("psnr") or metric.endswith("_db")


def is_worse(metric, value, before):
    if not math.isfinite(value):
        return True
    if larger_is_better(metric):
        return value < before - TOLERANCE * abs(before)
    return value > before + TOLERANCE * abs(before) and value > NEGLIGIBLE


def is_better(metric, value, before):
    return math.isfinite(value) and (value > before if larger_is_better(metric) else value < before)


def commit_name():
    def git(*arguments):
        return subprocess.run(["git", "-C", ROOT, *arguments], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout.decode().strip()
    try:
        return (git("rev-parse", "--short=12", "HEAD") or "none") + ("+" if git("status", "--porcelain") else "")
    except OSError:
        return "none"


def run(program):
    done = subprocess.run([program], cwd=ROOT, stdout=subprocess.PIPE, stdin=subprocess.DEVNULL)
    output = done.stdout.decode(errors="replace")
    if done.returncode != 0:
        print(output[-8000:])
        raise SystemExit(f"{program} failed with exit code {done.returncode}; the ledger takes no numbers of failing tests")
    return output


def logged(folder):
    """{test name: output} of the tests that ctest has passed in this build folder: of the run in progress, else of the last."""
    for name in ("LastTest.log.tmp", "LastTest.log"):
        path = os.path.join(folder, "Testing", "Temporary", name)
        if os.path.exists(path):
            with open(path, encoding="utf-8", errors="replace") as file:
                text = file.read()
            break
    else:
        return {}
    outputs = {}
    for section in re.split(r"^\d+/\d+ Testing: ", text, flags=re.MULTILINE)[1:]:
        test, _, output = section.partition("\n")
        if "Test Passed." in output:
            outputs[test.strip()] = output
    return outputs


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device")
    parser.add_argument("--device-program")
    parser.add_argument("--ledger", default=LEDGER)
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--accept-worse", action="store_true")
    parser.add_argument("--log", metavar="FOLDER")
    parser.add_argument("programs", nargs="*")
    arguments = parser.parse_args()

    device = arguments.device or (run(arguments.device_program).strip() if arguments.device_program else "")
    if not device:
        parser.error("say which device with --device or --device-program")
    rows = read_ledger(arguments.ledger)
    commit = commit_name()
    worse, better, new, same, seen = [], [], [], 0, set()
    known = logged(arguments.log) if arguments.log else {}
    for program in arguments.programs:
        output = known.get(os.path.basename(program)) or run(program)
        for effect, setting, metric, value in measurements(output):
            key = (effect, setting, metric, device)
            if key in seen:
                raise SystemExit(f"{program}: {','.join(key)} was measured twice")
            seen.add(key)
            row = {"effect": effect, "setting": setting, "metric": metric, "value": f"{value:.6g}", "device": device, "commit": commit}
            text = f"{effect} {setting} {metric}: {value:.6g}"
            if key not in rows:
                new.append(text)
                rows[key] = row
                continue
            before = float(rows[key]["value"])
            if is_worse(metric, value, before):
                worse.append(f"{text}, was {before:.6g} at {rows[key]['commit']}")
                if arguments.accept_worse:
                    rows[key] = row
            elif is_better(metric, float(row["value"]), before):
                better.append(f"{text}, was {before:.6g}")
                rows[key] = row
            else:
                same += 1
    unmeasured = [key for key in rows if key[3] == device and key not in seen]

    print(f"device: {device}")
    for title, lines in (("worse", worse), ("better", better), ("new", new), ("in the ledger but not measured", map(", ".join, unmeasured))):
        for line in lines:
            print(f"{title}: {line}")
    print(f"{len(worse)} worse, {len(better)} better, {len(new)} new, {same} as before, {len(unmeasured)} not measured")
    if arguments.update:
        write_ledger(arguments.ledger, rows)
    return 1 if (worse and not arguments.accept_worse) or unmeasured else 0


if __name__ == "__main__":
    sys.exit(main())
