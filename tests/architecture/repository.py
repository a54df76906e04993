"""The files of the repository, for the checks of this folder."""
import os
import subprocess

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))


def files():
    """Paths from the root of everything that is, or would be, tracked; without git, of everything outside build folders."""
    try:
        listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z", "--cached", "--others", "--exclude-standard"], check=True,
                                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout.decode()
        paths = {path for path in listed.split("\0") if path and os.path.isfile(os.path.join(ROOT, path))}
        if paths:
            return sorted(paths)
    except (OSError, subprocess.CalledProcessError):
        pass
    paths = []
    for folder, folders, names in os.walk(ROOT):
        folders[:] = [f for f in folders if not f.startswith(".git") and f != "build" and f != "__pycache__"]
        paths += [os.path.relpath(os.path.join(folder, name), ROOT) for name in names]
    return sorted(paths)


def text(path):
    """The file's text, or None when it is not text."""
    with open(os.path.join(ROOT, path), "rb") as file:
        data = file.read()
    if b"\0" in data:
        return None
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return None


def report(problems):
    for problem in problems:
        print(problem)
    return 1 if problems else 0
