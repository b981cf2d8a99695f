"""clang-tidy's small set passes: on the ground floor always, on every file with FROUDE_LONG=1.

Usage: check_tidy.py ROOT BUILD_FOLDER"""
import concurrent.futures
import json
import os
import subprocess
import sys

from tree import SKIP, report


def compiled_files(root, build):
    """C++ files of the tree that the build compiles, relative to the root."""
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        paths = {os.path.relpath(os.path.realpath(entry["file"]), os.path.realpath(root)) for entry in json.load(file)}
    outside = ("..", os.path.relpath(os.path.realpath(build), os.path.realpath(root)))
    return sorted(path for path in paths if not path.startswith(outside))


def tidy(root, build, path):
    """Complaints about one file."""
    # The warnings are the compiler's own affair; the wide loops are compiled once for each target by the real build.
    outcome = subprocess.run(["clang-tidy", "--quiet", "-p", build, "--extra-arg=-w", path], cwd=root,
                             capture_output=True, text=True, check=False)
    complaints = [line for line in outcome.stdout.splitlines() if " error: " in line or " warning: " in line]
    if outcome.returncode != 0 and not complaints:
        complaints = [f"{path}: {outcome.stdout}{outcome.stderr}"]
    return complaints


def main(root, build):
    try:
        subprocess.run(["clang-tidy", "--version"], capture_output=True, check=True)
    except OSError:
        print("clang-tidy is not installed")
        sys.exit(SKIP)
    files = compiled_files(root, build)
    if os.environ.get("FROUDE_LONG") != "1":
        files = [path for path in files if path.startswith("src/base/")]
    with concurrent.futures.ThreadPoolExecutor(max(1, len(os.sched_getaffinity(0)))) as pool:
        outcomes = list(pool.map(lambda path: tidy(root, build, path), files))
    report("clang-tidy", sorted({line for lines in outcomes for line in lines}), len(files))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
