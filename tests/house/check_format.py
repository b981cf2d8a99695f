"""Every C++ file of the tree is as clang-format 14 writes it.

Usage: check_format.py ROOT"""
import subprocess
import sys

from tree import SKIP, is_cpp, report, tracked_files

VERSION = " 14."  # another version breaks lines elsewhere


def main(root):
    try:
        version = subprocess.run(["clang-format", "--version"], capture_output=True, text=True, check=True).stdout
    except OSError:
        print("clang-format is not installed")
        sys.exit(SKIP)
    if VERSION not in version:
        print(f"clang-format 14 is wanted, this is: {version.strip()}")
        sys.exit(SKIP)
    files = [path for path in tracked_files(root) if is_cpp(path)]
    complaints = []
    for start in range(0, len(files), 50):
        outcome = subprocess.run(["clang-format", "--dry-run", "-Werror", *files[start:start + 50]], cwd=root,
                                 capture_output=True, text=True, check=False)
        complaints += sorted({line.split(":", 1)[0] + ": not as clang-format writes it"
                              for line in outcome.stderr.splitlines() if ": error:" in line})
        if outcome.returncode != 0 and not complaints:
            complaints.append(outcome.stderr)
    report("clang-format (to mend: clang-format -i FILE)", complaints, len(files))


if __name__ == "__main__":
    main(sys.argv[1])
