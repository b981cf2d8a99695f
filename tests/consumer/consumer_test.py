"""Froude as others use it: what is built is installed and the folder moved; programs outside the tree then find it by CMake
and by pkg-config, are built and run. The blocks of commands in the documents that name tests/consumer/ are run here.

Usage: consumer_test.py ROOT BUILD_FOLDER [--shared]
With --shared the libraries are built once more, as shared ones, below BUILD_FOLDER."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SHARED = "--shared" in sys.argv
if SHARED:
    sys.argv.remove("--shared")
ROOT = os.path.abspath(sys.argv.pop(1))
BUILD = os.path.abspath(sys.argv.pop(1))
sys.path.insert(0, os.path.join(ROOT, "tests/house"))
from tree import SKIP, read, shell_blocks, tracked_files  # noqa: E402  (the folder is known only now)

HERE = os.path.join(ROOT, "tests/consumer")
STANDARD = re.compile(r"^[a-z_0-9]+$")


def cached(folder, name):
    with open(os.path.join(folder, "CMakeCache.txt"), encoding="utf-8") as file:
        found = re.search(rf"^{name}:[A-Z]+=(.*)$", file.read(), re.M)
    return found.group(1) if found else ""


def run(*words, **more):
    outcome = subprocess.run(words, capture_output=True, text=True, check=False, **more)
    if outcome.returncode != 0:
        raise AssertionError(f"{' '.join(words)}\n{outcome.stdout[-3000:]}{outcome.stderr[-3000:]}")
    return outcome.stdout


def fenced(text, language):
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.M | re.S)


def bare(text):
    return [line.strip() for line in text.splitlines() if line.strip()]


class Consumer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.home = cls.temporary.name
        cls.compiler = cached(BUILD, "CMAKE_CXX_COMPILER")
        build = BUILD
        if SHARED:
            build = os.path.join(BUILD, "shared_libraries")
            run("cmake", "-S", ROOT, "-B", build, "-G", "Ninja", f"-DCMAKE_CXX_COMPILER={cls.compiler}",
                "-DCMAKE_BUILD_TYPE=Release", "-DBUILD_SHARED_LIBS=ON", "-DFROUDE_WERROR=ON")
            run("cmake", "--build", build, "-j", os.environ.get("FROUDE_JOBS", str(len(os.sched_getaffinity(0)))))
        first = os.path.join(cls.home, "somewhere else")
        run("cmake", "--install", build, "--prefix", first)
        # Where the documents put it, and a proof that nothing remembers the place of installation.
        cls.prefix = os.path.join(cls.home, "froude")
        shutil.move(first, cls.prefix)
        cls.environment = dict(os.environ, HOME=cls.home, CXX=cls.compiler)
        cls.environment.pop("PKG_CONFIG_PATH", None)
        if SHARED:
            cls.environment["LD_LIBRARY_PATH"] = os.path.join(cls.prefix, "lib")

    def installed(self, ending):
        found = []
        for folder, _, names in os.walk(self.prefix):
            found += [os.path.join(folder, name) for name in names if name.endswith(ending)]
        self.assertTrue(found, ending)
        return sorted(found)

    def build_and_run(self, name):
        build = os.path.join(self.home, "build " + name)
        run("cmake", "-S", os.path.join(HERE, name), "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.prefix}",
            "-DCMAKE_BUILD_TYPE=Release", env=self.environment)
        run("cmake", "--build", build, env=self.environment)
        return run(os.path.join(build, name), env={**os.environ})

    def test_a_program_on_two_floors_is_found_built_and_run(self):
        self.assertRegex(self.build_and_run("lattice"), r"froude 0\.\d+\.\d+: \d+ particles")

    def test_a_game_on_the_whole_library_is_found_built_and_run(self):
        self.assertRegex(self.build_and_run("game"), r"\d+ hits, \d+ crates broken, .* state [0-9a-f]{16}")

    def ask(self, wanted="", version="0.1"):
        output = run("cmake", "-S", os.path.join(HERE, "asks"), "-B", os.path.join(self.home, "asks"), "-G", "Ninja", "--fresh",
                     f"-DCMAKE_PREFIX_PATH={self.prefix}", f"-DWANTED={wanted}", f"-DVERSION_WANTED={version}",
                     env=self.environment)
        found = re.search(r"found=(\w+) version=(\S*) came=\[(.*)\] why=\[(.*)\]", output)
        return found.group(1) in ("1", "TRUE", "ON"), found.group(3).split(), found.group(4)

    def test_the_package_brings_the_parts_that_were_asked_for(self):
        self.assertEqual(self.ask()[:2], (True, ["base", "fields", "particles", "solver", "froude"]))
        self.assertEqual(self.ask("particles;fields")[:2], (True, ["base", "fields", "particles"]))
        self.assertEqual(self.ask("base")[:2], (True, ["base"]))

    @unittest.skipIf(cached(BUILD, "FROUDE_OPENVDB") == "OFF", "froude::openvdb is not built")
    def test_openvdb_comes_only_when_it_is_asked_for(self):
        self.assertEqual(self.ask("openvdb")[:2], (True, ["base", "fields", "openvdb"]))
        self.assertRegex(self.build_and_run("grids"), r"OpenVDB \d+\.\d+\.\d+: 0\.0300 m from the edge")

    def test_another_minor_version_and_an_unknown_part_are_refused(self):
        self.assertFalse(self.ask(version="0.2")[0])
        self.assertFalse(self.ask(version="0.0.9")[0])
        # Optional for a caller that does not insist; QUIET without REQUIRED asks for it all the same.
        found, _, why = self.ask("fields;gases")
        self.assertFalse(found)
        self.assertIn("gases", why)

    def test_every_installed_header_finds_all_that_it_includes_and_compiles(self):
        include = os.path.join(self.prefix, "include")
        headers = [os.path.relpath(path, include) for path in self.installed(".h")]
        self.assertIn("froude/version.h", headers)
        self.assertIn("froude/solver/world.h", headers)
        for private in ("froude/solver/world_impl.h", "froude/solver/step_context.h", "froude/fields/chord.h"):
            self.assertNotIn(private, headers)
        for header in headers:
            for name in re.findall(r"^\s*#\s*include\s+<([^>]+)>", read(include, header), re.M):
                known = name in headers if name.startswith("froude/") else name.startswith("Eigen/") or STANDARD.match(name)
                self.assertTrue(known, f"{header} includes <{name}>")
        # Each compiles alone in the tree (house.headers_alone) and finds all it includes here: then one look is enough.
        source = os.path.join(self.home, "all.cpp")
        with open(source, "w", encoding="utf-8") as file:
            file.write("".join(f"#include <{header}>\n" for header in headers))
        flags = run("pkg-config", "--cflags", "froude", env=self.pkg_config()).replace("-I/usr/include/eigen3", "").split()
        run(self.compiler, "-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-isystem",
            "/usr/include/eigen3", *flags, source)

    def pkg_config(self):
        return dict(self.environment, PKG_CONFIG_PATH=os.path.join(self.prefix, "lib/pkgconfig"))

    def test_pkg_config_knows_each_part_and_what_it_needs(self):
        for name in ("froude-base", "froude-fields", "froude-particles", "froude-solver", "froude"):
            run("pkg-config", "--exists", "--print-errors", f"{name} >= 0.1", env=self.pkg_config())
        words = run("pkg-config", "--libs", "froude-particles", env=self.pkg_config()).split()
        self.assertNotIn("-lfroude_solver", words)
        own = [word for word in words if word.startswith("-lfroude")]
        self.assertEqual(own, ["-lfroude_particles", "-lfroude_fields", "-lfroude_base"])
        self.assertEqual("-ltbb" in words, not SHARED, "who links a shared library does not link what it is made with")

    def test_nothing_remembers_where_it_was_built_or_installed(self):
        for ending in (".cmake", ".pc", ".h"):
            for path in self.installed(ending):
                text = read("/", path)
                for place in (BUILD, ROOT + "/", "somewhere else"):
                    self.assertNotIn(place, text, path)

    def test_the_commands_of_the_documents_work(self):
        blocks = 0
        for path in tracked_files(ROOT):
            if not path.endswith(".md"):
                continue
            for _, block in shell_blocks(read(ROOT, path)):
                if "tests/consumer/" not in block:
                    continue
                blocks += 1
                with tempfile.TemporaryDirectory() as folder:
                    os.symlink(os.path.join(ROOT, "tests"), os.path.join(folder, "tests"))
                    run("bash", "-euo", "pipefail", "-c", block, cwd=folder, env=self.environment)
        self.assertGreater(blocks, 1)

    def test_what_the_documents_show_stands_in_the_programs(self):
        text = read(ROOT, "docs/library.md")
        for language, ending in (("cpp", "main.cpp"), ("cmake", "CMakeLists.txt")):
            sources = ["\n".join(bare(read(HERE, name + "/" + ending))) for name in ("lattice", "game")]
            shown = fenced(text, language)
            self.assertTrue(shown)
            for block in shown:
                # "…" stands between pieces of one program.
                for piece in re.split(r"^\s*// …\n", block, flags=re.M):
                    wanted = "\n".join(bare(piece))
                    self.assertTrue(any(wanted in source for source in sources), f"in none of the programs:\n{piece}")

    def test_the_program_is_installed_and_runs(self):
        program = os.path.join(self.prefix, "bin/froude")
        if cached(BUILD, "FROUDE_PROGRAM") == "OFF":
            self.skipTest("the program is not built")
        self.assertRegex(run(program, "--version", env={**os.environ}), r"0\.\d+\.\d+")

    @unittest.skipUnless(SHARED, "static libraries hide nothing")
    def test_shared_libraries_show_the_public_interface_and_hide_the_rest(self):
        symbols = run("nm", "-DC", "--defined-only", os.path.join(self.prefix, "lib/libfroude_solver.so"))
        self.assertIn(" froude::World::step(double)", symbols)
        for hidden in ("froude::Pbf::", "froude::Obstacles::", "froude::BodySet::"):
            self.assertNotIn(" " + hidden, symbols)
        self.assertTrue(os.path.exists(os.path.join(self.prefix, "lib/libfroude_solver.so.0.1")))


if __name__ == "__main__":
    if cached(BUILD, "FROUDE_SANITIZE"):
        print("libraries with sanitizers ask their users for the same; nobody installs them")
        sys.exit(SKIP)
    unittest.main()
