"""The bootstrap on machines that are only pretended: stubs stand for apt-get, dpkg-query, sudo, id, cmake and ctest.

Usage: bootstrap_test.py ROOT"""
import os
import re
import shutil
import stat
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.abspath(sys.argv.pop(1))
# What the script uses of a Debian base system; nothing else is on the pretended machine's PATH.
BASE = ["awk", "basename", "bash", "cat", "chmod", "dirname", "env", "head", "mkdir", "mktemp", "nproc", "rm", "sed", "tail",
        "tee", "touch", "tr", "c++", "cc"]

DPKG_QUERY = """for last; do :; done
grep -qx -- "$last" "$STUBS/installed" && printf installed || exit 1"""
APT_GET = """echo "apt-get $*" >> "$STUBS/log"
echo "Reading package lists..."
case "$*" in *install*) exit "${APT_STATUS:-0}" ;; esac"""
SUDO = """echo "sudo" >> "$STUBS/log"
exec "$@" """
CMAKE = r"""echo "cmake $*" >> "$STUBS/log"
echo "-- talk of cmake"
[ -z "${CMAKE_FAILS:-}" ] || exit 1
for preset; do :; done
case "$*" in
  *--build*) exit 0 ;;
esac
mkdir -p "build/$preset/bin"
cat > "build/$preset/bin/froude" <<'END'
#!/usr/bin/env bash
printf '%s\n' "froude $*" >> "$STUBS/log"
mkdir -p "$STUBS/out folder"
[ -n "${NO_FRAMES:-}" ] || touch "$STUBS/out folder/frame_00000.png" "$STUBS/out folder/frame_00001.png"
echo "a result"
echo "$STUBS/out folder"
exit "${FROUDE_STATUS:-0}"
END
chmod +x "build/$preset/bin/froude" """
CTEST = """echo "ctest $*" >> "$STUBS/log"
echo "100% tests passed, 0 tests failed out of 3"
exit "${CTEST_STATUS:-0}" """


def listed(*needs):
    with open(os.path.join(ROOT, "cmake/packages.txt"), encoding="utf-8") as file:
        rows = [line.split() for line in file if line.strip() and not line.startswith("#")]
    return [row[1] for row in rows if row[0] in needs]


class Bootstrap(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.tree = os.path.join(self.temporary.name, "a tree")
        self.stubs = os.path.join(self.temporary.name, "stubs")
        os.makedirs(os.path.join(self.tree, "cmake"))
        os.makedirs(os.path.join(self.stubs, "bin"))
        shutil.copy(os.path.join(ROOT, "bootstrap"), self.tree)
        shutil.copy(os.path.join(ROOT, "cmake/packages.txt"), os.path.join(self.tree, "cmake"))
        for name in BASE + ["grep"]:
            os.symlink(shutil.which(name), os.path.join(self.stubs, "bin", name))
        self.stub("dpkg-query", DPKG_QUERY)
        self.stub("apt-get", APT_GET)
        self.stub("sudo", SUDO)
        self.stub("cmake", CMAKE)
        self.stub("ctest", CTEST)
        self.user(1000)
        self.installed(listed("run", "test", "bench"))

    def stub(self, name, text):
        path = os.path.join(self.stubs, "bin", name)
        with open(path, "w", encoding="utf-8") as file:
            file.write("#!/usr/bin/env bash\n" + text + "\n")
        os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)

    def remove(self, name):
        os.remove(os.path.join(self.stubs, "bin", name))

    def user(self, number):
        self.stub("id", f"echo {number}")

    def installed(self, names):
        with open(os.path.join(self.stubs, "installed"), "w", encoding="utf-8") as file:
            file.write("\n".join(names) + "\n")

    def bootstrap(self, *words, cwd=None, **environment):
        """Runs the script; what the stubs were asked is in self.log afterwards."""
        open(os.path.join(self.stubs, "log"), "w", encoding="utf-8").close()
        environment.update(PATH=os.path.join(self.stubs, "bin"), STUBS=self.stubs, HOME=self.stubs)
        outcome = subprocess.run([os.path.join(self.tree, "bootstrap"), *words], cwd=cwd or self.tree, env=environment,
                                 capture_output=True, text=True, check=False)
        with open(os.path.join(self.stubs, "log"), encoding="utf-8") as file:
            self.log = file.read().splitlines()
        return outcome

    def asked(self, word):
        return [line for line in self.log if line.startswith(word)]

    def test_with_everything_installed_neither_root_nor_network_is_touched(self):
        for command in ("run", "test"):
            outcome = self.bootstrap(command)
            self.assertEqual(outcome.returncode, 0, outcome.stderr)
            self.assertEqual(self.asked("apt-get") + self.asked("sudo"), [])

    def test_run_installs_exactly_what_is_missing_with_sudo(self):
        self.installed([name for name in listed("run") if name not in ("ninja-build", "libfmt-dev")])
        outcome = self.bootstrap("run")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.assertEqual(self.log[0], "sudo")
        self.assertIn(" update", self.log[1])
        self.assertTrue(self.log[3].endswith("install -y --no-install-recommends ninja-build libfmt-dev"), self.log)

    def test_root_needs_no_sudo(self):
        self.user(0)
        self.remove("sudo")
        self.installed([])
        outcome = self.bootstrap("run")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.assertTrue(self.log[1].endswith(" ".join(listed("run"))), self.log)

    def test_only_test_asks_for_the_test_tools(self):
        self.user(0)
        self.installed(listed("run"))
        self.bootstrap("run")
        self.assertEqual(self.asked("apt-get"), [])
        self.bootstrap("test")
        self.assertTrue(self.asked("apt-get")[-1].endswith(" ".join(listed("test"))), self.log)

    def test_without_root_and_sudo_it_prints_the_command_to_run(self):
        self.remove("sudo")
        self.installed([name for name in listed("run") if name != "libtbb-dev"])
        outcome = self.bootstrap("run")
        self.assertEqual(outcome.returncode, 1)
        self.assertIn("apt-get update && apt-get install -y --no-install-recommends libtbb-dev\n", outcome.stderr)
        self.assertEqual(self.log, [])

    def test_a_failing_installation_prints_the_command_too(self):
        self.installed([])
        outcome = self.bootstrap("run", APT_STATUS="100")
        self.assertEqual(outcome.returncode, 1)
        self.assertIn("apt-get install -y --no-install-recommends cmake", outcome.stderr)
        self.assertEqual(self.asked("cmake"), [])

    def test_another_system_is_told_what_to_install(self):
        self.remove("dpkg-query")
        outcome = self.bootstrap("run")
        self.assertEqual(outcome.returncode, 1)
        self.assertIn("libeigen3-dev", outcome.stderr)
        self.assertIn("cmake --preset release", outcome.stderr)

    def test_a_missing_compiler_is_installed(self):
        self.user(0)
        self.remove("c++")
        outcome = self.bootstrap("run")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.assertTrue(self.asked("apt-get")[-1].endswith("recommends g++"), self.log)

    def test_a_word_that_ends_in_toml_replaces_the_scene_and_all_words_go_on(self):
        self.bootstrap("run")
        self.assertEqual(self.asked("froude"), ["froude run scenes/dam_break.toml"])
        self.bootstrap("run", "-o", "my out", "--threads", "1")
        self.assertEqual(self.asked("froude"), ["froude run scenes/dam_break.toml -o my out --threads 1"])
        self.bootstrap("run", "scenes/x.toml", "-o", "out")
        self.assertEqual(self.asked("froude"), ["froude run scenes/x.toml -o out"])

    def test_it_may_be_called_from_another_folder(self):
        outcome = self.bootstrap("run", cwd=self.temporary.name)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.assertEqual(self.asked("froude"), [f"froude run {self.tree}/scenes/dam_break.toml"])

    def test_its_last_lines_say_where_the_pictures_are(self):
        outcome = self.bootstrap("run")
        folder = os.path.join(self.stubs, "out folder")
        self.assertEqual(outcome.stdout.splitlines(),
                         ["a result", folder, f"2 pictures: {folder}/frame_00000.png to frame_00001.png",
                          f"The pictures are in: {folder}"])

    def test_a_run_without_pictures_does_not_promise_any(self):
        outcome = self.bootstrap("run", NO_FRAMES="1")
        self.assertRegex(outcome.stdout.splitlines()[-1], "^No pictures were asked for.*out folder$")

    def test_the_exit_code_of_froude_is_passed_on(self):
        self.assertEqual(self.bootstrap("run", FROUDE_STATUS="3").returncode, 3)

    def test_test_passes_words_to_ctest_and_ends_with_its_summary(self):
        outcome = self.bootstrap("test", "-R", "fields")
        self.assertRegex(self.log[-1], r"^ctest --test-dir .*/a tree/build/check -j \d+ --output-on-failure -R fields$")
        self.assertEqual(outcome.stdout, "100% tests passed, 0 tests failed out of 3\n")
        self.assertEqual(self.bootstrap("test", CTEST_STATUS="8").returncode, 8)

    def test_a_build_that_fails_says_so_and_runs_nothing(self):
        outcome = self.bootstrap("run", CMAKE_FAILS="1")
        self.assertEqual(outcome.returncode, 1)
        self.assertIn("configuring preset release failed", outcome.stderr)
        self.assertEqual(self.asked("froude"), [])

    def cache(self, generator="Ninja", home=None, compiler=None):
        folder = os.path.join(self.tree, "build/release")
        os.makedirs(folder, exist_ok=True)
        with open(os.path.join(folder, "CMakeCache.txt"), "w", encoding="utf-8") as file:
            file.write(f"CMAKE_GENERATOR:INTERNAL={generator}\nCMAKE_HOME_DIRECTORY:INTERNAL={home or self.tree}\n"
                       f"CMAKE_CXX_COMPILER:FILEPATH={compiler or shutil.which('c++')}\n")

    def test_a_warm_build_folder_is_gone_on_with(self):
        self.cache()
        self.bootstrap("run")
        self.assertEqual(self.asked("cmake")[0], "cmake --preset release")

    def test_a_folder_of_another_generator_place_or_compiler_is_started_anew(self):
        for foreign in ({"generator": "Unix Makefiles"}, {"home": "/elsewhere"}, {"compiler": "/usr/bin/gone-c++"}):
            self.cache(**foreign)
            self.bootstrap("run")
            self.assertEqual(self.asked("cmake")[0], "cmake --fresh --preset release", foreign)

    def test_the_number_of_jobs_may_be_given_and_never_exceeds_the_cores(self):
        self.bootstrap("run", FROUDE_JOBS="7")
        self.assertIn("-j 7", self.asked("cmake")[-1])
        self.bootstrap("run")
        jobs = int(re.search(r"-j (\d+)", self.asked("cmake")[-1]).group(1))
        self.assertTrue(1 <= jobs <= len(os.sched_getaffinity(0)))
        self.bootstrap("run", SLURM_CPUS_PER_TASK="1")
        self.assertIn("-j 1", self.asked("cmake")[-1])

    def test_an_unknown_command_is_refused_with_the_help(self):
        outcome = self.bootstrap("fly")
        self.assertEqual(outcome.returncode, 1)
        self.assertIn("./bootstrap COMMAND", outcome.stderr)
        self.assertEqual(self.bootstrap("help").returncode, 0)


if __name__ == "__main__":
    unittest.main()
