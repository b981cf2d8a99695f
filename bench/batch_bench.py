"""Many small runs: one batch, against as many single-thread processes side by side as there are cores, against one process
after the other with all cores. In turn, in one session, by ratio. Also what a checkpoint costs, from the runs' summaries.

Usage: batch_bench.py FROUDE [RUNS [ROUNDS [SIZE]]] [--rows FILE]
SIZE: edge of the block in particles, 71 for 5,041 of them. --rows appends to a file of bench/results; its item is a run."""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

SCENE = """format = 1
duration = 1.0
[domain]
box = [0.0, 0.0, 3.0, 2.0]
[model]
spacing = {spacing}
[[fluid.block]]
shape = {{ box = [0.0, 0.0, 1.0, 1.0] }}
[output]
frames = []
"""


def timed(action):
    begin = time.monotonic()
    action()
    return time.monotonic() - begin


def main(froude, runs, rounds, size, rows):
    doctor = json.loads(subprocess.run([froude, "doctor", "--json"], capture_output=True, check=True).stdout)
    build = doctor.get("build_type") or doctor.get("build", "")
    cores = len(os.sched_getaffinity(0))
    times = {"batch": [], "side by side": [], "one after the other": []}
    with tempfile.TemporaryDirectory() as home:
        scene = os.path.join(home, "s.toml")
        with open(scene, "w", encoding="utf-8") as file:
            file.write(SCENE.format(spacing=1.0 / size))
        for number in range(rounds):
            def folder(name):
                return os.path.join(home, f"{name}{number}")

            def batch():
                seeds = ",".join(str(seed) for seed in range(runs))
                subprocess.run([froude, "batch", scene, "-o", folder("batch"), "--sweep", "seed=" + seeds, "--quiet"],
                               check=True, stdout=subprocess.DEVNULL)

            def side_by_side():
                waiting, at_work = list(range(runs)), []
                while waiting or at_work:
                    while waiting and len(at_work) < cores:
                        seed = waiting.pop()
                        at_work.append(subprocess.Popen(
                            [froude, "run", scene, "-o", folder(f"side{seed}_"), "--set", f"seed={seed}", "--threads", "1",
                             "--quiet"], stdout=subprocess.DEVNULL))
                    os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOWAIT)
                    at_work = [process for process in at_work if process.poll() is None]

            def in_turn():
                for seed in range(runs):
                    subprocess.run([froude, "run", scene, "-o", folder(f"turn{seed}_"), "--set", f"seed={seed}", "--threads",
                                    str(cores), "--quiet"], check=True, stdout=subprocess.DEVNULL)

            times["batch"].append(timed(batch))
            times["side by side"].append(timed(side_by_side))
            times["one after the other"].append(timed(in_turn))
        with open(os.path.join(folder("batch"), "seed=0", "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
    print(f"build {build}, {cores} cores, {runs} runs of {summary['particles']} particles, {rounds} rounds, medians")
    whole = statistics.median(times["batch"])
    for name, seconds in times.items():
        median = statistics.median(seconds)
        print(f"{name:20} {median:8.2f} s   {median / whole:5.2f} x the batch")
    print(f"checkpoint: {summary.get('checkpoint_bytes', 0) / summary['particles']:.0f} bytes and "
          f"{1e9 * summary.get('checkpoint_seconds', 0) / summary['particles']:.0f} ns a particle")


    if rows:
        if build != "Release":
            sys.exit("batch_bench: rows come from the preset bench")
        case = f"{runs} runs of {summary['particles']} particles"
        with open(rows, "a", encoding="utf-8") as file:
            if file.tell() == 0:
                file.write("question,case,cpu,cores,commit,build,simd,threads,dt,ns_median,ns_best,error,runs\n")
            for name, seconds in times.items():
                median, best = (1e9 * value / runs for value in (statistics.median(seconds), min(seconds)))
                file.write(f'batch,"{case}: {name}","{doctor["cpu"]}",{cores},{doctor["git_commit"]},release,{doctor["simd"]},'
                           f"{cores},n/a,{median:.0f},{best:.0f},n/a,{rounds}\n")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(usage="batch_bench.py FROUDE [RUNS [ROUNDS [SIZE]]] [--rows FILE]")
    parser.add_argument("froude")
    parser.add_argument("numbers", nargs="*", type=int)
    parser.add_argument("--rows")
    given = parser.parse_args()
    main(os.path.abspath(given.froude), *given.numbers, *[64, 1, 71][len(given.numbers):], given.rows)
