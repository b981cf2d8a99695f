"""What the checks of the house share: the files of the tree, and how a check reports."""
import os
import subprocess
import sys

SKIP = 77  # the exit status that CTest counts as "did not run"


def tracked_files(root):
    """Paths of all files of the tree, relative to its root, sorted: those git knows or would add, or, where there is no
    git, those found outside the folders that builds and runs write."""
    try:
        listing = subprocess.run(
            ["git", "-c", "safe.directory=*", "-C", root, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            check=True, capture_output=True).stdout.decode()
        paths = [path for path in listing.split("\0") if path]
    except (OSError, subprocess.CalledProcessError):
        paths = []
        for folder, below, names in os.walk(root):
            below[:] = [name for name in below if name not in (".git", "build", "out", "__pycache__")]
            paths += [os.path.relpath(os.path.join(folder, name), root) for name in names]
    return sorted(path for path in set(paths) if os.path.isfile(os.path.join(root, path)))


def read(root, path):
    """The text of a file, or None where it is not text."""
    with open(os.path.join(root, path), "rb") as file:
        data = file.read()
    if b"\0" in data:
        return None
    return data.decode("utf-8", errors="replace")


def lines_of(root, path):
    """Pairs of line number (from 1) and line; nothing for a file that is not text."""
    text = read(root, path)
    return [] if text is None else list(enumerate(text.splitlines(), start=1))


def shell_blocks(text):
    """Pairs of the number of the first line and the text of all ```sh blocks of a document."""
    inside, block, start = False, [], 0
    for number, line in enumerate(text.splitlines(), start=1):
        if line.strip().startswith("```"):
            if inside:
                yield start, "\n".join(block)
            inside, block, start = line.strip() == "```sh", [], number + 1
        elif inside:
            block.append(line)


def is_cpp(path):
    return path.endswith((".h", ".cpp"))


def report(what, complaints, looked_at):
    """Prints the complaints and ends the program: 0 without any, else 1. A check that looked at nothing fails too."""
    for complaint in complaints:
        print(complaint)
    if looked_at == 0:
        print(f"{what}: found nothing to look at")
        sys.exit(1)
    print(f"{what}: {looked_at} looked at, {len(complaints)} complaints")
    sys.exit(1 if complaints else 0)
