"""One arrow: src/base -> fields -> particles -> solver -> the rest of src. A file includes its own folder and those to the
left; what a folder must not know, and which libraries stay behind one door, is listed below.

Usage: check_one_arrow.py ROOT"""
import re
import sys

from tree import is_cpp, lines_of, report, tracked_files

FLOORS = ["base", "fields", "particles", "solver", "program"]

# Inside the solver: pair geometry knows no bodies, and bodies know no particles.
BLIND = {
    "solver/contact/": ["solver/", "particles/"],
    "solver/rigid/": ["particles/", "solver/fluid/", "solver/soft/", "solver/coupling/"],
}
BLIND_EXCEPT = {"solver/contact/": ["solver/contact/"]}

# Libraries that compile slowly: one source file each. Their version headers are small and may be included anywhere.
ONE_DOOR = {
    "toml++": r"toml\+\+/|toml\.hpp",
    "CLI11": r"CLI/",
    "SVG++": r"svgpp/",
    "OpenVDB": r"openvdb/|nanovdb/",
}
# Who may include which library at all; the standard library and Eigen are everybody's.
LIBRARIES = {
    # Loops are src/base's affair; how many threads there are is the program's.
    "tbb": (r"(oneapi/)?tbb/", ["src/base/", "src/run/"]),
    "Highway": (r"hwy/", ["src/base/", "fields/", "particles/", "solver/"]),
    "program": (r"fmt/|nlohmann/|hdf5|H5|cairo|muParser|CLI/|toml\+\+/|svgpp/|libxml/|polyclipping/|clipper|png",
                ["src/"]),
    "OpenVDB": (r"openvdb/|nanovdb/", ["fields/openvdb/"]),
    "POSIX": (r"(unistd|fcntl|sched|pthread|signal|dlfcn|poll|termios)\.h|sys/", ["src/run/"]),
}
STANDARD = re.compile(r"^(c?[a-z_0-9]+|experimental/[a-z_]+)$")
INCLUDE = re.compile(r'^\s*#\s*include\s+([<"])([^>"]+)[>"]')
GUARD = re.compile(r"^\s*#\s*(if|ifdef|ifndef|elif|else|endif)\b(.*)")


def floor_of(path):
    """The floor of a file in the tree, or None: tests, benchmarks and build files stand outside the house."""
    if path.startswith("src/base/"):
        return "base"
    if path.startswith("src/"):
        return "program"
    head = path.split("/", 1)[0]
    return head if head in ("fields", "particles", "solver") else None


def included_path(floor, quoted, name):
    """The path inside the tree that an include names, or None for a library's header."""
    if name.startswith("froude/"):
        inner = name[len("froude/"):]
        return "src/" + inner if inner.startswith("base/") else inner
    if quoted and floor == "program":
        return "src/" + name
    return None


def library_complaints(path, floor, name):
    """What is wrong with including this library's header here."""
    public = path.endswith(".h") and floor != "program"
    if path.endswith("-inl.h"):  # part of a source file that is compiled once for each SIMD target
        public = False
    if STANDARD.match(name) or name.startswith("Eigen/"):
        return []
    if public:
        return [f"a public header includes <{name}>: Eigen, the standard library and Froude's own headers only"]
    found = []
    for library, (pattern, allowed) in LIBRARIES.items():
        if re.match(pattern, name) and not path.startswith(tuple(allowed)):
            found.append(f"<{name}> belongs into {' or '.join(allowed)} only")
    return found


def include_complaints(path, quoted, name):
    floor = floor_of(path)
    target = included_path(floor, quoted, name)
    if target is None:
        if quoted and floor != "program" and not any(re.match(p, name) for p, _ in LIBRARIES.values()):
            return [f'"{name}" is to be written as <froude/...>']
        return library_complaints(path, floor, name)
    if target in ("version.h",):
        return []
    target_floor = floor_of(target)
    if target_floor is None:
        return [f"{name} is on no floor of the house"]
    found = []
    if FLOORS.index(target_floor) > FLOORS.index(floor):
        found.append(f"{floor} includes {name} of {target_floor}, against the arrow {' -> '.join(FLOORS)}")
    for folder, unknown in BLIND.items():
        if path.startswith(folder) and target.startswith(tuple(unknown)) and not target.startswith(
                tuple(BLIND_EXCEPT.get(folder, []))):
            found.append(f"{folder} must not know {name}")
    return found


def main(root):
    complaints, looked_at = [], 0
    doors = {library: set() for library in ONE_DOOR}
    for path in tracked_files(root):
        if not is_cpp(path) or floor_of(path) is None:
            continue
        looked_at += 1
        platform_only = 0  # <immintrin.h> and its like stand inside #if
        for number, line in lines_of(root, path):
            guard = GUARD.match(line)
            if guard:
                platform_only += {"if": 1, "ifdef": 1, "ifndef": 1, "endif": -1}.get(guard.group(1), 0)
            match = INCLUDE.match(line)
            if not match:
                continue
            name = match.group(2)
            for library, pattern in ONE_DOOR.items():
                if re.match(pattern, name) and "version" not in name.lower():
                    doors[library].add(path)
            if platform_only and name.endswith("intrin.h"):
                continue
            complaints += [f"{path}:{number}: {text}" for text in include_complaints(path, match.group(1) == '"', name)]
    for library, users in doors.items():
        if len(users) > 1:
            complaints.append(f"{library} is included in {len(users)} files, one is allowed: {', '.join(sorted(users))}")
    report("one arrow", complaints, looked_at)


if __name__ == "__main__":
    main(sys.argv[1])
