"""README.md, THIRD_PARTY.md, cmake/packages.txt and the build name the same libraries.

Usage: check_libraries.py ROOT"""
import json
import os
import re
import sys

from tree import read, report

# Libraries that the build finds under another name than the documents use.
BUILD_NAMES = {
    "TBB": "oneTBB", "Eigen3": "Eigen", "hwy": "Highway", "nlohmann_json": "JSON for Modern C++", "tomlplusplus": "toml++",
    "muparser": "muParser", "cairo": "Cairo", "GTest": "GoogleTest", "benchmark": "Google Benchmark",
    "LibXml2": "libxml2", "polyclipping": "Clipper", "box2d": "Box2D", "ccd": "libccd", "ZLIB": "zlib",
}
NOT_LIBRARIES = {"PkgConfig", "Git", "Threads", "Python3"}


def packaged(root):
    """Library names of cmake/packages.txt, each with its package."""
    found = {}
    for line in read(root, "cmake/packages.txt").splitlines():
        fields = line.split("#")[0].split(None, 2)
        if len(fields) == 3 and fields[2].strip() != "-":
            found[fields[2].strip()] = fields[1]
    return found


def table(root, path):
    """First cells of the rows of the table whose first heading is Library, bare of links and emphasis."""
    rows, inside = set(), False
    for line in read(root, path).splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")] if line.startswith("|") else []
        if not cells:
            inside = False
        elif cells[0] == "Library":
            inside = True
        elif inside and not re.fullmatch(r":?-+:?", cells[0]):
            rows.add(re.sub(r"\[([^]]+)\]\([^)]*\)", r"\1", cells[0]).strip("*` "))
    return rows


def built_with(root):
    text = read(root, "cmake/FroudeDependencies.cmake")
    names = re.findall(r"find_package\((\w+)", text) + re.findall(r"pkg_check_modules\((\w+)", text)
    return {BUILD_NAMES.get(name, name) for name in names if name not in NOT_LIBRARIES}


def in_pages(root):
    """Libraries whose code stands in the built pages, by the names that the documents use."""
    path = "src/export/web/package.json"
    if not os.path.exists(os.path.join(root, path)):
        return set()
    names = json.loads(read(root, path))["dependencies"]
    return {{"uplot": "uPlot"}.get(name, name) for name in names}


def main(root):
    complaints = []
    libraries = packaged(root)
    pages = in_pages(root)
    # Run as a process where it is installed, never linked and never installed by the bootstrap.
    processes = {"ffmpeg"}
    for path in ("README.md", "THIRD_PARTY.md"):
        listed = table(root, path)
        complaints += [f"{path}: {name} is missing from the table of libraries" for name in sorted((set(libraries) | pages) - listed)]
        complaints += [f"{path}: {name} is not in cmake/packages.txt"
                       for name in sorted(listed - set(libraries) - processes - pages)]
    licences = read(root, "THIRD_PARTY.md")
    complaints += [f"THIRD_PARTY.md: the package {package} of {name} is not named"
                   for name, package in libraries.items() if package not in licences]
    complaints += [f"cmake/FroudeDependencies.cmake finds {name}, which cmake/packages.txt does not list"
                   for name in sorted(built_with(root) - set(libraries))]
    report("libraries", complaints, len(libraries))


if __name__ == "__main__":
    main(sys.argv[1])
