#!/usr/bin/env python3
"""How much faster two threads (or more) are than one, integrator by integrator.

    python3 benches/threads.py target/release/lumiflow SCENE.xml [--threads N] [--rounds N]
        [--seconds S] [--integrators path,erpt,...]

A round renders the same samples with one thread and with N; the samples are as many as one thread
makes in about S CPU seconds. Printed are the medians over the rounds, with the lowest and highest:
the ratio of wall times, the processors used (CPU time by wall time) and what the same work costs in
CPU time with N threads beside one. Nothing else should run on the machine.
"""

import argparse
import json
import statistics
import subprocess
import tempfile
from pathlib import Path

INTEGRATORS = "path,ptracer,bdpt,erpt,pmc-er,mlt,pssmlt,mmlt"


def render(program, scene, integrator, spp, threads, folder):
    """Renders once; returns the JSON line."""
    command = [program, "render", scene, "-i", integrator, "--spp", str(spp)]
    command += ["-t", str(threads), "-q", "--json", "-o", str(Path(folder) / "picture.exr")]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return json.loads(done.stdout.strip().splitlines()[-1])


def samples_for(seconds, program, scene, integrator, folder):
    """Samples a pixel that take one thread about so many CPU seconds."""
    first = render(program, scene, integrator, 2, 1, folder)
    return max(2, round(2 * seconds / first["cpu_s"]))


def spread(values):
    return f"{statistics.median(values):.2f} ({min(values):.2f} … {max(values):.2f})"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("scene")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=5)
    parser.add_argument("--integrators", default=INTEGRATORS)
    options = parser.parse_args()
    print("| integrator | samples | times as fast | processors used | CPU time beside one thread's |")
    print("|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for integrator in options.integrators.split(","):
            work = (options.program, options.scene, integrator)
            spp = samples_for(options.seconds, *work, folder)
            wall, used, cost = [], [], []
            for _ in range(options.rounds):
                one = render(*work, spp, 1, folder)
                many = render(*work, spp, options.threads, folder)
                wall.append(one["wall_s"] / many["wall_s"])
                used.append(many["cpu_s"] / many["wall_s"])
                cost.append(many["cpu_s"] / one["cpu_s"])
            print(f"| {integrator} | {spp} | {spread(wall)} | {spread(used)} | {spread(cost)} |", flush=True)


if __name__ == "__main__":
    main()
