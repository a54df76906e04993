#!/usr/bin/env python3
"""Ends an application at every call of its frame loop, and checks what is left of it.

  ended_application.py --entoptic ENTOPTIC --library LIBRARY [--sanitize S] [--end killed|exits] -- APPLICATION ARGUMENTS...

`entoptic run` has to return in time with the application's own end (137 for SIGKILL, 3 for exit(3)) and say so; nothing may be left in the runtime
folder; no second fault may hide behind the first (a crash in a destructor, a message of a sanitizer). After all of them the application runs
to its end as if nothing had been. SIGKILL comes from xrBeginSession on. exit() comes after some frames: a software driver that is still compiling
the application's own first draws while the process exits may crash by itself, with or without this runtime."""
import argparse
import json
import os
import re
import signal
import subprocess
import sys
import tempfile

from frame_run import Failure, MESSAGE, expect, sanitizer_preload

ENDED = re.compile(r"ending \((\w+)\) at call (\d+), (\w+)")
EXIT_CODE = {"killed": 137, "exits": 3}
AFTER = {"killed": 0, "exits": 4}    # frames before the first end
FRAMES = {"killed": 2, "exits": 1}   # frames that are visited, call by call
MOST_CALLS = 400    # an application that never ends a frame is a failure, not an endless test


class Folder:
    """The folders of one user, who runs the application again and again."""

    def __init__(self, path):
        self.path = path
        self.report = os.path.join(path, "report.json")
        for name in ("runtime", "config", "state"):
            os.makedirs(os.path.join(path, name), mode=0o700)

    def environment(self, **more):
        env = {k: v for k, v in os.environ.items() if not k.startswith(("ENTOPTIC_", "XR_"))}
        env.update(XDG_RUNTIME_DIR=os.path.join(self.path, "runtime"), XDG_CONFIG_HOME=os.path.join(self.path, "config"),
                   XDG_STATE_HOME=os.path.join(self.path, "state"), **more)
        return env

    def left(self):
        return sorted(os.path.join(base, name) for base, _, names in os.walk(os.path.join(self.path, "runtime")) for name in names)


def run(arguments, folder, call, frames):
    """Exit code and output of one run that ends at call number `call` (0: by itself)."""
    preload = sanitizer_preload(arguments.sanitize) or ["env", "LD_PRELOAD="]
    preload[-1] += " " + arguments.library if preload[-1] != "LD_PRELOAD=" else arguments.library
    command = [arguments.entoptic, "run", "--hmd", "virtual", "--clock", "lockstep", "--panel", "64x72", "--preset", arguments.preset,
               "--frames", str(frames), "--report", folder.report, "--"] + preload + arguments.application
    with tempfile.TemporaryFile() as said:
        # Its input stays open: hello_xr takes the end of it as the wish to quit.
        process = subprocess.Popen(command, env=folder.environment(ENTOPTIC_TEST_CALL=str(call), ENTOPTIC_TEST_END=arguments.end,
                                                                      ENTOPTIC_TEST_AFTER=str(AFTER[arguments.end])),
                                   stdin=subprocess.PIPE, stdout=said, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            code = process.wait(arguments.patience)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)   # the application too
            raise Failure(f"entoptic run does not return after the end at call {call}") from None
        finally:
            process.stdin.close()
        said.seek(0)
        return code, said.read().decode(errors="replace")


def check_end(arguments, folder, call):
    """Ends the application at the call; the call's name."""
    code, output = run(arguments, folder, call, 1000)
    ended = ENDED.search(output)
    expect(ended, f"call {call} was never made; exit code {code}:\n{output[-2000:]}")
    name = ended.group(3)
    expect(code == EXIT_CODE[arguments.end], f"ended at {name} (call {call}): exit code {code}, not {EXIT_CODE[arguments.end]}:\n{output[-3000:]}")
    messages = [line for line in output.splitlines() if MESSAGE.search(line)]
    expect(not messages, f"ended at {name} (call {call}): {messages[:1]}")
    expect(not folder.left(), f"ended at {name} (call {call}): left in the runtime folder: {folder.left()}")
    with open(folder.report, encoding="utf-8") as file:
        report = json.load(file)
    expect("displayed" in report["frames"], f"ended at {name} (call {call}): the report does not count frames: {report}")
    if arguments.end == "killed":
        expect("ended by signal 9" in output, f"ended at {name} (call {call}): the user is not told:\n{output[-2000:]}")
        expect("ended before its report" in report["errors"][-1], f"ended at {name} (call {call}): the report does not say so: {report['errors']}")
    else:
        expect(not report["errors"], f"ended at {name} (call {call}): {report['errors']}")
    status = subprocess.run([arguments.entoptic, "status"], env=folder.environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    expect(status.returncode == 0 and b"entoptic-run" not in status.stdout, f"entoptic status after the end at {name}: {status.stdout.decode()}")
    return name


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--entoptic", required=True)
    parser.add_argument("--library", required=True, help="the built ending_calls library")
    parser.add_argument("--end", choices=sorted(EXIT_CODE), default="killed")
    parser.add_argument("--preset", default="off")
    parser.add_argument("--sanitize", default="")
    parser.add_argument("--patience", type=float, default=60)
    parser.add_argument("application", nargs="+")
    arguments = parser.parse_args()
    try:
        with tempfile.TemporaryDirectory(prefix="entoptic-ended-") as path:
            folder = Folder(path)
            names = []
            with open(folder.report, "w", encoding="utf-8") as file:
                json.dump({"frames": {}, "errors": []}, file)   # of an earlier run: must not pass for this one's
            while names.count("xrEndFrame") < FRAMES[arguments.end]:
                expect(len(names) < MOST_CALLS, f"too few frames in {MOST_CALLS} calls: {names[:40]}")
                names.append(check_end(arguments, folder, len(names) + 1))
            print(f"{len(names)} ends ({arguments.end}):", ", ".join(names))
            code, output = run(arguments, folder, 0, 3)
            expect(code == 0, f"afterwards the application does not run: exit code {code}:\n{output[-3000:]}")
    except Failure as failure:
        print("FAILED:", failure)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
