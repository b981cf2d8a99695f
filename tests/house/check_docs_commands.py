"""Every command in a ```sh block of the documents works. Froude's own are run, in a copy of the scenes and shortened; those
that build, test or install are checked against the presets, the sub-commands and the tests that there are.

A comment `# exit N` behind a command of Froude says which exit code is right; without one it is 0.

Usage: check_docs_commands.py ROOT BUILD_FOLDER"""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

from tree import read, report, shell_blocks, tracked_files

SHORT = "0.02"  # simulated seconds: enough to see that a command works
LIMIT = 300  # seconds, after which a command counts as hanging
ENVIRONMENT = re.compile(r"^[A-Z_]+=\S*$")


def shell_lines(text):
    """Pairs of line number and command of all ```sh blocks; a backslash joins lines. Blocks that build the programs in
    tests/consumer/ are left out: the tests there run them whole."""
    for first, block in shell_blocks(text):
        if "tests/consumer/" in block:
            continue
        pending, start = "", 0
        for number, line in enumerate(block.splitlines(), start=first):
            if not line.strip() or line.strip().startswith("#"):
                continue
            start = start if pending else number
            if line.rstrip().endswith("\\"):
                pending += line.rstrip()[:-1] + " "
                continue
            yield start, (pending + line).strip()
            pending = ""


class Judge:
    """Runs or checks commands of one document after each other, in one temporary folder."""

    def __init__(self, root, build):
        self.root, self.build = root, build
        self.presets = {preset["name"] for preset in json.loads(read(root, "CMakePresets.json"))["configurePresets"]
                        if not preset.get("hidden")}
        self.froude = os.path.join(build, "bin", "froude")

    def in_folder(self, folder):
        """Makes a folder look like the root of a tree with every preset built."""
        self.folder = folder
        for name in ("scenes", "docs", "bench"):
            if os.path.isdir(os.path.join(self.root, name)):
                shutil.copytree(os.path.join(self.root, name), os.path.join(folder, name))
        for preset in self.presets:
            os.makedirs(os.path.join(folder, "build", preset, "bin"))
            os.symlink(self.froude, os.path.join(folder, "build", preset, "bin", "froude"))

    def complaint(self, line):
        """None where the command works, else what is wrong with it."""
        expected = re.search(r"#\s*exit (\d+)", line)
        try:
            words = shlex.split(line, comments=True)
        except ValueError as error:
            return f"not a command: {error}"
        for part in self.split(words):
            wrong = self.judge(part, int(expected.group(1)) if expected else 0)
            if wrong:
                return wrong
        return None

    @staticmethod
    def split(words):
        """The commands of a line joined by && or ;."""
        part = []
        for word in words:
            if word in ("&&", ";"):
                yield part
                part = []
            else:
                part.append(word)
        if part:
            yield part

    def judge(self, words, expected):
        while words and (ENVIRONMENT.match(words[0]) or words[0] in ("sudo", "env")):
            words = words[1:]
        if not words:
            return "nothing to run"
        program = os.path.basename(words[0])
        known = {"bootstrap": self.bootstrap, "run": self.ci, "cmake": self.cmake, "ctest": self.ctest,
                 "git": lambda w: None, "cd": lambda w: None, "apt-get": self.apt, "npm": self.npm, "clang-format": lambda w: None}
        if program == "froude":
            return self.run_froude(words, expected)
        if program == "python3":
            return self.execute([sys.executable] + words[1:], expected)
        if program == "node":
            return self.missing(words[1:2])
        if program in known:
            return known[program](words)
        if program in ("validation", "dam_curve"):
            return self.run_validation(program, words, expected)
        if program.endswith("_bench"):
            return self.missing([f"bench/{program}.cpp"] + [word for word in words[1:] if word.endswith(".toml")])
        return f"the check does not know how to judge '{words[0]}'"

    def npm(self, words):
        """`npm --prefix FOLDER ci` or `run SCRIPT`, where FOLDER has a package with that script."""
        if words[1:2] != ["--prefix"] or len(words) < 4:
            return "npm wants --prefix FOLDER and a command"
        package = read(self.root, os.path.join(words[2], "package.json"))
        scripts = json.loads(package)["scripts"]
        if words[3:] == ["ci"] or (words[3] == "run" and words[4:5] and words[4] in scripts):
            return None
        return f"{words[2]} has no script for {' '.join(words[3:])}"

    def run_froude(self, words, expected):
        if not os.path.exists(self.froude):
            return f"there is no {self.froude}"
        words = [self.froude] + words[1:]
        if len(words) > 1 and words[1] in ("run", "resume") and "--until" not in words and "--help" not in words:
            words += ["--until", SHORT]
        return self.execute(words, expected)

    def run_validation(self, program, words, expected):
        """Its words are right, and there are such cases and methods: `--list` says so without running any."""
        built = os.path.join(self.build, "bin", program)
        if not os.path.exists(built):
            return f"there is no {built}"
        return self.execute([built] + words[1:] + ["--list"], expected) if program == "validation" else None

    def execute(self, words, expected):
        try:
            outcome = subprocess.run(words, cwd=self.folder, capture_output=True, text=True, timeout=LIMIT, check=False)
        except subprocess.TimeoutExpired:
            return f"still running after {LIMIT} s"
        if outcome.returncode != expected:
            return f"exit {outcome.returncode}, {expected} is right: {outcome.stderr.strip()[-400:]}"
        return None

    def bootstrap(self, words):
        text = subprocess.run([os.path.join(self.root, "bootstrap"), "help"], capture_output=True, text=True,
                              check=True).stdout
        commands = re.findall(r"^  ([a-z]+) ", text, re.M)
        if len(words) < 2 or words[1] not in commands:
            return f"bootstrap knows {', '.join(commands)}"
        scenes = [word for word in words[2:] if word.endswith(".toml")]
        return self.missing(scenes)

    def missing(self, paths):
        gone = [path for path in paths if not os.path.exists(os.path.join(self.root, path))]
        return f"there is no {gone[0]}" if gone else None

    def ci(self, words):
        return self.missing([words[0]])

    def cmake(self, words):
        named = [words[i + 1] for i, word in enumerate(words[:-1]) if word == "--preset"]
        wrong = [name for name in named if name not in self.presets]
        if wrong:
            return f"there is no preset {wrong[0]}"
        return None if named or "--install" in words else "a cmake command without a preset"

    def ctest(self, words):
        folders = [words[i + 1] for i, word in enumerate(words[:-1]) if word == "--test-dir"]
        if not folders or os.path.basename(folders[0]) not in self.presets:
            return "--test-dir is to name build/PRESET"
        filters = []
        for i, word in enumerate(words[:-1]):
            if word in ("-L", "-R", "-LE", "-E"):
                filters += [word, words[i + 1]]
        listing = subprocess.run(["ctest", "--test-dir", self.build, "-N", *filters], capture_output=True, text=True,
                                 check=False).stdout
        return None if re.search(r"Total Tests: [1-9]", listing) else f"no test answers to {' '.join(filters)}"

    def apt(self, words):
        listed = read(self.root, "cmake/packages.txt") + read(self.root, "THIRD_PARTY.md")
        unknown = [word for word in words[2:] if not word.startswith("-") and word not in listed]
        return f"{unknown[0]} is not in cmake/packages.txt" if unknown else None


def main(root, build):
    judge = Judge(root, build)
    complaints, looked_at = [], 0
    for path in tracked_files(root):
        if not path.endswith(".md"):
            continue
        with tempfile.TemporaryDirectory() as folder:
            judge.in_folder(folder)
            for number, line in shell_lines(read(root, path)):
                looked_at += 1
                wrong = judge.complaint(line)
                if wrong:
                    complaints.append(f"{path}:{number}: {line}\n    {wrong}")
    report("commands in the documents", complaints, looked_at)


if __name__ == "__main__":
    main(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]))
