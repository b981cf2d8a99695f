"""A run to be read, and a Python that has the module that reads it."""
import os
import subprocess
import sys
import tempfile

SKIP = 77


def with_module(module):
    """Goes on in Debian's own Python where the present one has no such module; ends the test as skipped where neither has."""
    try:
        __import__(module)
        return
    except ImportError:
        pass
    debian = "/usr/bin/python3"
    known = os.path.exists(debian) and subprocess.run([debian, "-c", f"import {module}"], capture_output=True).returncode == 0
    if known and "FROUDE_READER" not in os.environ:
        os.execve(debian, [debian, "-B"] + sys.argv, {**os.environ, "FROUDE_READER": "1"})
    print(f"skipped: Python has no module {module}")
    sys.exit(SKIP)


def run_scene(program, root, folder):
    """Water, a soft body and bodies: the folder of a short run with frames at 0, 0.05 and 0.1 s in two segments."""
    scene = os.path.join(root, "scenes", "soft_and_fluid.toml")
    words = [program, "run", scene, "-o", folder, "--frames", "h5", "--set", "model.spacing=0.05", "--until", "0.06", "--quiet"]
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    subprocess.run([program, "resume", folder, "--until", "0.11", "--quiet"], check=True, stdout=subprocess.DEVNULL)
    return folder


def in_temporary_folder(test):
    """Calls test(program, root, folder of a run); an assertion that fails fails the test."""
    with tempfile.TemporaryDirectory() as folder:
        test(sys.argv[1], sys.argv[2], run_scene(sys.argv[1], sys.argv[2], os.path.join(folder, "run")))
