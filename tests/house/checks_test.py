"""Each check of the house can fail: small trees with one fault each, and one without.

Usage: checks_test.py ROOT"""
import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.abspath(sys.argv.pop(1))
HERE = os.path.join(ROOT, "tests/house")


class Checks(unittest.TestCase):
    def outcome(self, check, files, *words):
        """Exit status and output of a check on a tree of these files."""
        with tempfile.TemporaryDirectory() as tree:
            for path, text in files.items():
                os.makedirs(os.path.join(tree, os.path.dirname(path)), exist_ok=True)
                with open(os.path.join(tree, path), "w", encoding="utf-8") as file:
                    file.write(text)
            outcome = subprocess.run([sys.executable, "-B", os.path.join(HERE, check), tree, *words],
                                     capture_output=True, text=True, check=False)
            return outcome.returncode, outcome.stdout + outcome.stderr

    def assert_passes(self, check, files, *words):
        status, output = self.outcome(check, files, *words)
        self.assertEqual(status, 0, output)

    def assert_complains(self, check, files, about, *words):
        status, output = self.outcome(check, files, *words)
        self.assertEqual(status, 1, output)
        self.assertIn(about, output)

    def test_the_arrow_may_be_followed(self):
        self.assert_passes("check_one_arrow.py", {
            "solver/world.h": "#include <Eigen/Core>\n#include <vector>\n#include <froude/base/types.h>\n",
            "solver/rigid/body.h": "#include <froude/solver/contact/sat.h>\n#include <froude/fields/polygon.h>\n",
            "solver/world.cpp": "#include <froude/version.h>\n#include <hwy/highway.h>\n",
            "src/run/run.cpp": '#include "scene/scene.h"\n#include <unistd.h>\n#include <froude/solver/world.h>\n',
            "src/base/parallel.cpp": "#include <tbb/parallel_for.h>\n#if defined(X)\n#include <immintrin.h>\n#endif\n",
            "tests/x_test.cpp": '#include "anything.h"\n'})

    def test_the_arrow_may_not_be_turned_round(self):
        for path, include, about in (
                ("src/base/types.h", "<froude/fields/polygon.h>", "against the arrow"),
                ("fields/polygon.cpp", "<froude/particles/pool.h>", "against the arrow"),
                ("particles/pool.h", "<froude/solver/world.h>", "against the arrow"),
                ("solver/world.cpp", '"scene/scene.h"', "<froude/...>"),
                ("solver/contact/sat.h", "<froude/solver/rigid/body.h>", "must not know"),
                ("solver/contact/sat.h", "<froude/particles/pool.h>", "must not know"),
                ("solver/rigid/body.cpp", "<froude/particles/pool.h>", "must not know"),
                ("solver/world.h", "<tbb/parallel_for.h>", "public header"),
                ("solver/world.h", "<fmt/core.h>", "public header"),
                ("solver/world.cpp", "<tbb/parallel_for.h>", "belongs into src/base/"),
                ("fields/polygon.cpp", "<fmt/core.h>", "belongs into src/"),
                ("fields/polygon.cpp", "<unistd.h>", "belongs into src/run/"),
                ("src/scene/scene.cpp", "<openvdb/openvdb.h>", "belongs into"),
                ("fields/openvdb/level_set.h", "<openvdb/openvdb.h>", "public header"),
                ("fields/polygon.cpp", "<openvdb/openvdb.h>", "belongs into fields/openvdb/")):
            self.assert_complains("check_one_arrow.py", {path: f"#include {include}\n"}, about)

    def test_a_slow_library_has_one_door(self):
        include = "#include <toml++/toml.h>\n"
        self.assert_passes("check_one_arrow.py", {"src/scene/a.cpp": include})
        self.assert_complains("check_one_arrow.py", {"src/scene/a.cpp": include, "src/scene/b.cpp": include}, "toml++ is")

    def test_foreign_words_are_found(self):
        self.assert_passes("check_words.py", {"a.md": "the root/of all; https://x.org/home/page; \"$HOME/work/x\"\n"})
        for text in ("// TO" "DO: later", "see /ho" "me/me/x.txt", "as iss" "ue #12 asks", "in this sess" "ion"):
            self.assert_complains("check_words.py", {"a.cpp": text + "\n"}, "a.cpp:1:")

    def test_a_file_that_outgrew_one_room_is_found(self):
        self.assert_passes("check_words.py", {"a.cpp": "\n" * 600, "a.csv": "\n" * 601})
        self.assert_complains("check_words.py", {"a.cpp": "\n" * 601}, "601 lines")

    def libraries(self, **changed):
        row = "| Library | what |\n|---|---|\n| [fmt](https://fmt.dev) | libfmt-dev |\n"
        files = {"README.md": row, "THIRD_PARTY.md": row, "cmake/packages.txt": "run libfmt-dev fmt\nrun cmake -\n",
                 "cmake/FroudeDependencies.cmake": "find_package(fmt 9 REQUIRED)\n"}
        files.update({path.replace("__", "/").replace("_md", ".md").replace("_txt", ".txt"): text
                      for path, text in changed.items()})
        return files

    def test_documents_and_build_name_the_same_libraries(self):
        check = "check_libraries.py"
        self.assert_passes(check, self.libraries())
        self.assert_complains(check, self.libraries(README_md="no table\n"), "README.md: fmt is missing")
        self.assert_complains(check, self.libraries(cmake__packages_txt="run libhwy-dev Highway\n"), "Highway is missing")
        extra = self.libraries()
        extra["cmake/FroudeDependencies.cmake"] += "pkg_check_modules(hwy REQUIRED libhwy)\n"
        self.assert_complains(check, extra, "finds Highway")

    def test_unformatted_code_is_found(self):
        style = {".clang-format": "BasedOnStyle: Google\n"}
        status, _ = self.outcome("check_format.py", {**style, "a.cpp": "int x = 1;\n"})
        if status == 77:
            self.skipTest("no clang-format 14")
        self.assert_complains("check_format.py", {**style, "a.cpp": "int   x=1 ;\n"}, "a.cpp")

    def test_a_command_in_a_document_that_does_not_work_is_found(self):
        presets = '{"configurePresets": [{"name": "release"}, {"name": "base", "hidden": true}]}'
        script = "#!/bin/sh\necho '  run [X]   words'\n"
        stub = ('#!/bin/sh\ncase "$*" in *--bad*) exit 2 ;; "run "*"--until 0.02"|"check "*) exit 0 ;; *) exit 9 ;; esac\n')
        for line, wrong in (
                ("froude run x.toml", None), ("build/release/bin/froude check x.toml --bad   # exit 2", None),
                ("./build/release/bin/froude run \\\n  x.toml", None), ("cmake --preset release && froude check x", None),
                ("./bootstrap run", None), ("froude check --bad", "exit 2, 0 is right"),
                ("froude check x  # exit 2", "exit 0, 2 is right"), ("froude fly", "exit 9"),
                ("./bootstrap fly", "bootstrap knows run"), ("./bootstrap run scenes/gone.toml", "there is no scenes/gone"),
                ("cmake --preset base", "there is no preset base"), ("make", "does not know how to judge")):
            with tempfile.TemporaryDirectory() as tree:
                os.makedirs(os.path.join(tree, "build/bin"))
                for path, text in (("CMakePresets.json", presets), ("bootstrap", script), ("build/bin/froude", stub),
                                   (".gitignore", "build\n"), ("README.md", f"text\n```sh\n{line}\n```\n")):
                    with open(os.path.join(tree, path), "w", encoding="utf-8") as file:
                        file.write(text)
                    os.chmod(os.path.join(tree, path), 0o755)
                outcome = subprocess.run([sys.executable, "-B", os.path.join(HERE, "check_docs_commands.py"), tree,
                                          os.path.join(tree, "build")], capture_output=True, text=True, check=False)
                self.assertEqual(outcome.returncode, 0 if wrong is None else 1, line + outcome.stdout + outcome.stderr)
                self.assertIn(wrong or "0 complaints", outcome.stdout)


if __name__ == "__main__":
    unittest.main()
