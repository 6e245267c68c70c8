#!/usr/bin/env python3
"""Paths per CPU second of lumiflow and of Mitsuba 3, in turn on one machine.

    python3 benches/peers/paths.py target/release/lumiflow SCENE.xml... [--rounds N]

Installs Mitsuba into target/peers by pip. Its vectorised variant needs LLVM: on Debian 12
`apt install libllvm19`; DRJIT_LIBLLVM_PATH names another one. One thread each; a round has every
renderer once; the highest rate and the median of the rounds' ratios to lumiflow in the same mode of
Embree are printed. Robust is lumiflow's default and an option of Mitsuba's scenes, fast is Mitsuba's
default and `--accel embree-fast` of lumiflow. The scenes' own film sizes are used, `path` with their
own options.
"""

import argparse
import glob
import json
import os
import statistics
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

MITSUBA = "3.9.1"
ROOT = Path(__file__).resolve().parents[2]

# Runs in Mitsuba's environment: a scene, a variant, samples a pixel, whether Embree is robust; prints
# millions of paths a CPU second. Compilation and loading are left out: the second of two renders counts.
PEER = """
import os, re, sys, time
import drjit as dr
import mitsuba as mi
path, variant, spp, robust = sys.argv[1], sys.argv[2], int(sys.argv[3]), sys.argv[4]
mi.set_variant(variant)
dr.set_thread_count(1)
option = f'<boolean name="embree_use_robust_intersections" value="{robust}"/>'
text, count = re.subn("(<scene[^>]*>)", lambda start: start[0] + option, open(path).read(), count=1)
assert count == 1, "a scene was expected"
mi.file_resolver().append(os.path.dirname(os.path.abspath(path)))
scene = mi.load_string(text)
size = scene.sensors()[0].film().crop_size()
def render(seed):
    start = time.process_time()
    dr.eval(mi.render(scene, spp=spp, seed=seed))
    dr.sync_thread()
    return size[0] * size[1] * spp / (time.process_time() - start) / 1e6
render(0)
print(render(1))
"""


def environment():
    """The Python of an environment that has Mitsuba."""
    place = ROOT / "target" / "peers"
    python = place / "bin" / "python"
    if not python.exists():
        venv.create(place, with_pip=True)
    subprocess.run(
        [python, "-m", "pip", "install", "-q", f"mitsuba=={MITSUBA}", "numpy"], check=True
    )
    return python


def llvm():
    """The library that Mitsuba's vectorised variant compiles with; None where there is none."""
    named = os.environ.get("DRJIT_LIBLLVM_PATH")
    found = sorted(glob.glob("/usr/lib/*/libLLVM.so.19*") + glob.glob("/usr/lib/*/libLLVM-19*"))
    return named or (found[0] if found else None)


def mitsuba(python, variant, spp, robust=False):
    """A function that measures a scene with a variant of Mitsuba."""
    variables = dict(os.environ)
    if library := llvm():
        variables["DRJIT_LIBLLVM_PATH"] = library

    def rate(scene):
        command = [python, "-c", PEER, scene, variant, str(spp), str(robust).lower()]
        run = subprocess.run(command, check=True, capture_output=True, text=True, env=variables)
        return float(run.stdout.split()[-1])

    return rate


def lumiflow(program, spp, accel):
    """A function that measures a scene with lumiflow."""

    def rate(scene):
        with tempfile.TemporaryDirectory() as out:
            picture = os.path.join(out, "out.exr")
            command = [program, "render", scene, "-i", "path", "--spp", str(spp), "-t", "1"]
            command += ["-q", "--json", "-o", picture, "--accel", accel]
            run = subprocess.run(command, check=True, capture_output=True, text=True)
        found = json.loads(run.stdout.strip().splitlines()[-1])
        return found["paths"] / found["cpu_s"] / 1e6

    return rate


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("lumiflow", help="the program")
    arguments.add_argument("scenes", nargs="+", help="Mitsuba scenes")
    arguments.add_argument("--rounds", type=int, default=3)
    given = arguments.parse_args()
    python = environment()
    # By name and mode of Embree.
    renderers = {
        ("lumiflow", "robust"): lumiflow(given.lumiflow, 48, "embree"),
        ("lumiflow", "fast"): lumiflow(given.lumiflow, 48, "embree-fast"),
    }
    variants = {"scalar_rgb": 16, "llvm_ad_rgb": 64}
    if not llvm():
        del variants["llvm_ad_rgb"]
        print("llvm_ad_rgb is left out: LLVM was not found", file=sys.stderr)
    for variant, spp in variants.items():
        name = f"Mitsuba {MITSUBA} {variant}"
        renderers[name, "robust"] = mitsuba(python, variant, spp, robust=True)
        renderers[name, "fast"] = mitsuba(python, variant, spp)
    print("| scene | renderer | Embree | million paths a CPU second | lumiflow's over it |")
    print("|---|---|---|---|---|")
    for scene in given.scenes:
        rounds = [{n: rate(scene) for n, rate in renderers.items()} for _ in range(given.rounds)]
        for name, mode in renderers:
            rates = [found[name, mode] for found in rounds]
            ratio = statistics.median(r["lumiflow", mode] / r[name, mode] for r in rounds)
            row = [Path(scene).parent.name, name, mode, f"{max(rates):.2f}", f"{ratio:.2f}"]
            print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
