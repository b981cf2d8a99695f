"""Words and sizes that do not belong into the tree: promises of later work, absolute paths of somebody's machine, talk about
how the work was organised, and files that outgrew one room.

Usage: check_words.py ROOT"""
import re
import sys

from tree import lines_of, report, tracked_files

# Put together from halves, so that this file passes its own check.
FOREIGN = [
    (re.compile(r"\b(TO" r"DO|FIX" r"ME|X" r"XX)\b"), "a promise of later work"),
    (re.compile(r"(?<![\w.$}/])/(home|Users|root|work|farm)/[\w.]"), "an absolute path of somebody's machine"),
    (re.compile(r"\.lib" r"rary\b"), "a path of a workplace"),
    (re.compile(r"\b(this|previous|another|an earlier) sess" r"ion\b", re.I), "talk about how the work was organised"),
    (re.compile(r"\b(issue|ticket) #?\d+\b", re.I), "a number that a reader cannot look up"),
]
SOURCES = (".h", ".cpp", ".py", ".cmake", ".js", ".sh")
LONGEST = 600
BUILT = ("src/export/web/dist/",)


def main(root):
    complaints, looked_at = [], 0
    for path in tracked_files(root):
        if path.startswith(BUILT):
            continue
        lines = lines_of(root, path)
        looked_at += 1
        for number, line in lines:
            for pattern, reason in FOREIGN:
                match = pattern.search(line)
                if match:
                    complaints.append(f"{path}:{number}: '{match.group(0)}': {reason}")
        if path.endswith(SOURCES) and len(lines) > LONGEST:
            complaints.append(f"{path}: {len(lines)} lines, {LONGEST} at most: is it one room with one use?")
    report("foreign words", complaints, looked_at)


if __name__ == "__main__":
    main(sys.argv[1])
