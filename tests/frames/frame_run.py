#!/usr/bin/env python3
"""Runs an OpenXR application under the built `entoptic run` and checks what came of it.

  frame_run.py [options] -- APPLICATION ARGUMENTS...

The application must end by itself with exit code 0 after --frames frames; the report must be complete and count them; no effect may have
failed; and neither layer nor runtime may have printed a message. Standard input stays open: hello_xr takes any byte, and its end, as
the wish to quit. Nothing outside a temporary folder is read or written: configuration, runtime folder and dumps are there.
Without --repeat once; with --repeat 2 the dumps of all runs must be the same to the bit."""
import argparse
import hashlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile

import png

MESSAGE = re.compile(r"VUID-|SYNC-HAZARD|UNASSIGNED-|Validation (Error|Warning)|VALID_(ERROR|USAGE|WARN)|"
                     r"AddressSanitizer|runtime error:|LeakSanitizer")
# What the validation layer says of itself: on a new machine, that it has no cache of shaders yet.
REMARK = re.compile(r"Validation Information: \[ UNASSIGNED-cache-file-error \]")
REPORT_KEYS = ("version", "device", "hmd", "clock", "application", "frames", "timing_ms", "effects", "photometry", "state", "errors")


class Failure(Exception):
    pass


def expect(condition, message):
    if not condition:
        raise Failure(message)


def environment(arguments, folder):
    env = dict(os.environ)
    for name in list(env):
        if name.startswith(("ENTOPTIC_", "XR_")) and name != "ENTOPTIC_LOG":
            del env[name]
    for name in ("runtime", "config", "state"):
        os.makedirs(os.path.join(folder, name), mode=0o700)
    env["XDG_RUNTIME_DIR"] = os.path.join(folder, "runtime")
    env["XDG_CONFIG_HOME"] = os.path.join(folder, "config")
    env["XDG_STATE_HOME"] = os.path.join(folder, "state")
    if arguments.core_validation:
        env["XR_ENABLE_API_LAYERS"] = "XR_APILAYER_LUNARG_core_validation"
        env["XR_CORE_VALIDATION_EXPORT_TYPE"] = "text"
    if arguments.api_dump:
        env["XR_ENABLE_API_LAYERS"] = "XR_APILAYER_LUNARG_api_dump"
        env["XR_API_DUMP_EXPORT_TYPE"] = "text"
        env["XR_API_DUMP_FILE_NAME"] = os.path.join(folder, "calls.txt")
    if arguments.vulkan_validation:
        env["VK_INSTANCE_LAYERS"] = "VK_LAYER_KHRONOS_validation"
        env["VK_LAYER_ENABLES"] = "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT"
    return env


def sanitizer_preload(sanitize):
    """A sanitized runtime inside an application that is not needs the sanitizer's library loaded first."""
    if not sanitize:
        return []
    name = "libtsan.so" if "thread" in sanitize else "libasan.so"
    path = subprocess.run(["g++", f"-print-file-name={name}"], stdout=subprocess.PIPE, check=True).stdout.decode().strip()
    return ["env", f"LD_PRELOAD={os.path.realpath(path)}"]


def run_once(arguments, folder):
    env = environment(arguments, folder)
    for profile in arguments.profile:
        applications = os.path.join(env["XDG_CONFIG_HOME"], "entoptic", "applications")
        os.makedirs(applications, exist_ok=True)
        shutil.copy(profile, applications)
    report_path = os.path.join(folder, "report.json")
    dumps = os.path.join(folder, "dumps")
    call = [arguments.entoptic, "run", "--hmd", "virtual", "--clock", arguments.clock, "--panel", arguments.panel,
            "--frames", str(arguments.frames), "--report", report_path]
    for option in ("luminance", "preset", "script"):
        if getattr(arguments, option):
            call += ["--" + option, getattr(arguments, option)]
    for setting in arguments.set:
        call += ["--set", setting]
    if arguments.dump_stages:
        call += ["--dump", dumps, "--dump-stages", arguments.dump_stages, "--dump-every", str(arguments.dump_every)]
    call += ["--"] + sanitizer_preload(arguments.sanitize) + arguments.application

    print("$", " ".join(call), flush=True)
    reading, writing = os.pipe()
    try:
        with open(os.path.join(folder, "output.txt"), "wb") as output:
            run = subprocess.Popen(call, env=env, stdin=reading, stdout=output, stderr=subprocess.STDOUT, start_new_session=True)
            code = run.wait(arguments.timeout)
    except subprocess.TimeoutExpired:
        os.killpg(run.pid, signal.SIGKILL)   # the application too
        run.wait()
        tell_output(folder)
        raise Failure(f"still running after {arguments.timeout} s") from None
    finally:
        os.close(reading)
        os.close(writing)
    try:
        check_run(arguments, code, read_output(folder), report_path)
        if arguments.api_dump:
            with open(os.path.join(folder, "calls.txt"), encoding="utf-8", errors="replace") as file:
                dumped = sum("xrEndFrame" in line and "XrResult" in line for line in file)
            expect(dumped >= arguments.frames, f"the layer dumped {dumped} calls of xrEndFrame")
    except Failure:
        tell_output(folder)
        raise
    return dumps


def read_output(folder):
    with open(os.path.join(folder, "output.txt"), encoding="utf-8", errors="replace") as file:
        return file.read()


def tell_output(folder):
    output = read_output(folder)
    print(output if len(output) < 20000 else output[:8000] + "\n[...]\n" + output[-8000:])


def check_run(arguments, code, output, report_path):
    expect(code == 0, f"exit code {code}")
    messages = [line for line in output.splitlines() if MESSAGE.search(line) and not REMARK.search(line)]
    expect(not messages, f"{len(messages)} messages of validation layers or sanitizers, the first: {messages[:1]}")
    if arguments.core_validation:
        expect("Core Validation output type" in output, "the core validation layer was not there")
    expect(os.path.exists(report_path), "there is no report")
    with open(report_path, encoding="utf-8") as file:
        report = json.load(file)
    missing = [key for key in REPORT_KEYS if key not in report]
    expect(not missing, f"the report lacks {missing}")
    frames = report["frames"]
    print("frames:", json.dumps(frames))
    expect(frames["displayed"] >= arguments.frames, f"{frames['displayed']} frames displayed, not {arguments.frames}")
    if arguments.clock == "lockstep":
        expect(frames["displayed"] <= arguments.frames + 4, f"{frames['displayed']} frames displayed, wanted {arguments.frames}")
        expect(frames["missed"] == 0 and frames["reused"] == 0, "in lockstep every frame is shown exactly once")
    expect(not report["errors"], f"errors in the report: {report['errors']}")
    for name, effect in report["effects"].items():
        expect(not effect.get("failed"), f"effect {name} failed: {effect}")
    if arguments.expect_luminance:
        scale = report["photometry"]["scale"]
        expect(abs(scale - arguments.expect_luminance) <= 1e-5 * arguments.expect_luminance, f"luminance scale {scale}")
    if arguments.expect_effects == "none":
        shown = [name for name, effect in report["effects"].items() if effect.get("recorded")]
        expect(not shown, f"recorded although the preset is off: {shown}")


def check_pictures(arguments, folder):
    """Mean code of each dumped panel picture of the left eye: within limits, and without jumps from frame to frame."""
    names = sorted(name for name in os.listdir(folder) if name.endswith("_left_panel.png"))[arguments.settle:]
    expect(len(names) >= 2, f"no pictures of the panel: {sorted(os.listdir(folder))[:5]}")
    means = [png.mean(os.path.join(folder, name)) for name in names]
    print(f"mean code: {min(means):.2f} to {max(means):.2f} in {len(means)} pictures")
    if arguments.steady is not None:
        # An application's first frame has no layers yet (shouldRender is false): black, and the picture appears after it.
        first = next((i for i, mean in enumerate(means) if mean > 0), 0)
        means, names = means[first:], names[first:]
        jump, name = max((abs(b - a), name) for a, b, name in zip(means, means[1:], names[1:]))
        print(f"largest jump: {jump:.3f} codes at {name}")
        expect(jump <= arguments.steady, f"the picture jumps by {jump:.3f} codes at {name}, allowed {arguments.steady}")
    if arguments.mean_codes:
        low, high = (float(x) for x in arguments.mean_codes.split(":"))
        expect(low <= min(means) and max(means) <= high, f"mean codes {min(means):.2f} to {max(means):.2f}, expected within {low} to {high}")


def digests(folder):
    found = {}
    for base, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(base, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, folder)] = hashlib.sha256(file.read()).hexdigest()
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--entoptic", required=True)
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("--panel", default="96x106")
    parser.add_argument("--clock", default="lockstep")
    parser.add_argument("--luminance")
    parser.add_argument("--expect-luminance", type=float)
    parser.add_argument("--preset")
    parser.add_argument("--script")
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--profile", action="append", default=[], help="application profile to use")
    parser.add_argument("--dump-stages", help="also dump these stages; there must be pictures then")
    parser.add_argument("--dump-every", type=int, default=10)
    parser.add_argument("--settle", type=int, default=0, metavar="N", help="judge no pictures before the N-th: adaptation settles")
    parser.add_argument("--steady", type=float, metavar="CODES", help="largest jump of the panel's mean code between dumped pictures")
    parser.add_argument("--mean-codes", metavar="LOW:HIGH", help="range of the panel's mean code")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--expect-effects", choices=["none"])
    parser.add_argument("--core-validation", action="store_true")
    parser.add_argument("--api-dump", action="store_true", help="under LunarG's layer that writes down every call")
    parser.add_argument("--vulkan-validation", action="store_true", default=os.environ.get("ENTOPTIC_TEST_VALIDATION") == "1")
    parser.add_argument("--sanitize", default="")
    parser.add_argument("--timeout", type=float, default=280)
    parser.add_argument("application", nargs="+")
    arguments = parser.parse_args()

    first = None
    try:
        for number in range(arguments.repeat):
            with tempfile.TemporaryDirectory(prefix="entoptic-frames-") as folder:
                dumps = run_once(arguments, folder)
                if arguments.dump_stages:
                    found = digests(dumps)
                    expect(found, "nothing was dumped")
                    if first is None:
                        first = found
                    differing = sorted(name for name in set(first) | set(found) if first.get(name) != found.get(name))
                    expect(not differing, f"run {number + 1} differs from run 1 in {len(differing)} of {len(first)} files: {differing[:5]}")
                    print(f"run {number + 1}: {len(found)} pictures")
                    if arguments.steady is not None or arguments.mean_codes:
                        check_pictures(arguments, dumps)
    except Failure as failure:
        print("FAILED:", failure)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
