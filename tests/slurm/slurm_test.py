"""A batch as a job array of a real Slurm, on this machine: munged, slurmctld and slurmd are started here, in a folder of
their own, and ended again. Skipped (77) where they are not installed or this user may not start them.

Usage: slurm_test.py FROUDE"""
import csv
import ctypes
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue", "scancel")
SCENE = """format = 1
duration = {duration}
[domain]
box = [0.0, 0.0, 1.0, 0.8]
[model]
spacing = 0.04
[[fluid.block]]
shape = {{ box = [0.0, 0.0, 0.4, 0.4] }}
[[gauge]]
name = "front"
type = "front"
axis = "x"
every = 0.01
[output]
frames = []
checkpoint = 0.2
"""


def end_with_this_process():
    """No daemon outlives a test that was killed."""
    ctypes.CDLL(None).prctl(1, signal.SIGTERM)  # PR_SET_PDEATHSIG


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Cluster:
    """One node, this machine."""

    def __init__(self, home):
        self.home, self.daemons = home, []
        host = socket.gethostname()
        key = os.path.join(home, "munge.key")
        with open(key, "wb") as file:
            file.write(os.urandom(128))
        os.chmod(key, 0o600)
        os.chmod(home, 0o755)
        munge = os.path.join(home, "munge.socket")
        self.start("munged", "--foreground", "--force", "--key-file", key, "--socket", munge, "--pid-file",
                   os.path.join(home, "munged.pid"), "--log-file", os.path.join(home, "munged.log"), "--seed-file",
                   os.path.join(home, "munged.seed"))
        self.wait(lambda: os.path.exists(munge), "munged")
        for folder in ("state", "spool"):
            os.mkdir(os.path.join(home, folder))
        self.conf = os.path.join(home, "slurm.conf")
        with open(self.conf, "w", encoding="utf-8") as file:
            file.write(f"""ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={munge}
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
StateSaveLocation={home}/state
SlurmdSpoolDir={home}/spool
SlurmctldPidFile={home}/slurmctld.pid
SlurmdPidFile={home}/slurmd.pid
SlurmctldLogFile={home}/slurmctld.log
SlurmdLogFile={home}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1
MpiDefault=none
ReturnToService=2
KillWait=5
NodeName={host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP OverTimeLimit=0
""")
        with open(os.path.join(home, "cgroup.conf"), "w", encoding="utf-8") as file:
            file.write("CgroupPlugin=cgroup/v1\nCgroupAutomount=no\n")
        self.environment = dict(os.environ, SLURM_CONF=self.conf)
        self.start("slurmctld", "-D", "-f", self.conf)
        self.start("slurmd", "-D", "-f", self.conf, "-N", host)
        self.wait(lambda: "idle" in self.run("sinfo", "-h", "-o", "%T").stdout, "the node")

    def start(self, name, *words):
        path = shutil.which(name) or os.path.join("/usr/sbin", name)
        with open(os.path.join(self.home, name + ".out"), "w", encoding="utf-8") as log:
            self.daemons.append(subprocess.Popen([path, *words], stdout=log, stderr=log, stdin=subprocess.DEVNULL,
                                                 preexec_fn=end_with_this_process))

    def run(self, *words, **more):
        return subprocess.run(words, capture_output=True, text=True, check=False, env=self.environment, **more)

    def wait(self, ready, what, seconds=60):
        end = time.monotonic() + seconds
        while not ready():
            if time.monotonic() > end:
                raise TimeoutError(f"{what} does not come up in {seconds} s; see {self.home}")
            time.sleep(0.1)

    def end(self):
        for daemon in reversed(self.daemons):
            daemon.send_signal(signal.SIGTERM)
        for daemon in reversed(self.daemons):
            try:
                daemon.wait(10)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()


class SlurmTest(unittest.TestCase):
    """One cluster for all tests."""

    @classmethod
    def setUpClass(cls):
        cls.home = tempfile.mkdtemp(prefix="froude-slurm-")
        cls.cluster = Cluster(cls.home)
        for name, duration in (("short", 0.2), ("long", 200.0)):
            with open(os.path.join(cls.home, name + ".toml"), "w", encoding="utf-8") as file:
                file.write(SCENE.format(duration=duration))

    @classmethod
    def tearDownClass(cls):
        cls.cluster.end()
        shutil.rmtree(cls.home, ignore_errors=True)

    def froude(self, *words):
        return self.cluster.run(FROUDE, *words, cwd=self.home)

    def table(self, folder):
        with open(os.path.join(self.home, folder, "results.csv"), encoding="utf-8", newline="") as file:
            return {row["run"]: row for row in csv.DictReader(file)}

    def hand_in(self, *words):
        outcome = self.froude("batch", *words, "--slurm", "--simd", "sse4")
        self.assertEqual(outcome.returncode, 0, outcome.stderr)
        self.assertIn("tasks", outcome.stdout)
        return outcome.stdout.split()[1].rstrip(":")

    def wait_for_end(self):
        self.cluster.wait(lambda: self.cluster.run("squeue", "-h").stdout.strip() == "", "the end of the jobs", 240)

    def path(self, *names):
        return os.path.join(self.home, *names)

    def test_an_array_gives_the_table_of_a_batch_on_one_machine(self):
        self.hand_in("short.toml", "-o", "array", "--sweep", "model.spacing=0.04,0.05,-1", "--sweep", "seed=1,2")
        self.wait_for_end()
        gathered = self.froude("batch", "--collect", "array")
        self.assertEqual(gathered.returncode, 5, gathered.stderr)  # the spacing of -1 cannot be run
        self.froude("batch", "short.toml", "-o", "here", "--sweep", "model.spacing=0.04,0.05,-1", "--sweep", "seed=1,2",
                    "--simd", "sse4", "--quiet")
        array, here = self.table("array"), self.table("here")
        self.assertEqual(array.keys(), here.keys())
        done = [name for name in here if here[name]["status"] == "done"]
        self.assertEqual(len(done), 4)
        for name in done:
            self.assertEqual(array[name]["state_hash"], here[name]["state_hash"], name)
            self.assertEqual(array[name]["simd"], "sse4", name)

    def test_a_task_that_is_killed_and_queued_again_goes_on_to_the_same_bits(self):
        job = self.hand_in("long.toml", "-o", "killed", "--sweep", "seed=1,2")
        self.cluster.wait(lambda: os.path.exists(self.path("killed", "seed=1", "checkpoint.h5")), "a checkpoint")
        self.assertEqual(self.cluster.run("scontrol", "requeue", job + "_0").returncode, 0)  # kills what runs
        self.wait_for_end()
        self.assertIn("REQUEUE", self.log("killed"))
        self.check_against_here("killed")

    def test_the_signal_before_the_time_limit_saves_and_queues_again(self):
        job = self.hand_in("long.toml", "-o", "limited", "--sweep", "seed=3,4")
        self.cluster.wait(lambda: os.path.exists(self.path("limited", "seed=3", "checkpoint.h5")), "a checkpoint")
        sent = self.cluster.run("scancel", "--batch", "--signal=TERM", job + "_0")  # as Slurm does a minute before the limit
        self.assertEqual(sent.returncode, 0, sent.stderr)
        self.wait_for_end()
        self.assertEqual(self.log("limited").count("limited/seed=3\n"), 2, self.log("limited"))  # stopped, and done
        self.check_against_here("limited")

    def log(self, folder):
        """Of task 0."""
        with open(self.path(folder, "slurm-0.log"), encoding="utf-8") as file:
            return file.read()

    def check_against_here(self, folder):
        seeds = "1,2" if folder == "killed" else "3,4"
        gathered = self.froude("batch", "--collect", folder)
        self.assertEqual(gathered.returncode, 0, gathered.stdout + gathered.stderr + self.log(folder))
        self.froude("batch", "long.toml", "-o", folder + "_here", "--sweep", "seed=" + seeds, "--simd", "sse4", "--quiet")
        array, here = self.table(folder), self.table(folder + "_here")
        self.assertEqual(len(here), 2)
        for name, row in here.items():
            self.assertEqual(array[name]["state_hash"], row["state_hash"], name)
            with open(self.path(folder, name, "gauges.csv"), encoding="utf-8") as first, \
                    open(self.path(folder + "_here", name, "gauges.csv"), encoding="utf-8") as second:
                self.assertEqual(first.read(), second.read(), name)


if __name__ == "__main__":
    missing = [name for name in PROGRAMS if not shutil.which(name) and not os.path.exists("/usr/sbin/" + name)]
    if missing or os.geteuid() != 0:
        print("skipped: " + (f"{', '.join(missing)} not installed" if missing else "only root may start Slurm's daemons"))
        sys.exit(77)
    FROUDE = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
