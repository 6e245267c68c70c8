#!/usr/bin/env python3
"""Paths per CPU second of lumiflow and of Mitsuba 3, in turn on one machine.

    python3 benches/peers/paths.py target/release/lumiflow SCENE.xml... [--rounds N]

Installs Mitsuba into target/peers by pip. Its vectorised variant needs LLVM: on Debian 12
`apt install libllvm19`; DRJIT_LIBLLVM_PATH names another one. One thread each; a round has every
renderer once; the highest rate and the median of the rounds' ratios to the first renderer are
printed. The scenes' own film sizes are used, `path` with their own options.
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

# Runs in Mitsuba's environment: a scene, a variant, samples a pixel; prints millions of paths a CPU
# second. Compilation and loading are left out: the second of two renders counts.
PEER = """
import sys, time
import drjit as dr
import mitsuba as mi
path, variant, spp = sys.argv[1], sys.argv[2], int(sys.argv[3])
mi.set_variant(variant)
dr.set_thread_count(1)
scene = mi.load_file(path)
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


def mitsuba(python, variant, spp):
    """A function that measures a scene with a variant of Mitsuba."""
    variables = dict(os.environ)
    if library := llvm():
        variables["DRJIT_LIBLLVM_PATH"] = library

    def rate(scene):
        command = [python, "-c", PEER, scene, variant, str(spp)]
        run = subprocess.run(command, check=True, capture_output=True, text=True, env=variables)
        return float(run.stdout.split()[-1])

    return rate


def lumiflow(program, spp):
    """A function that measures a scene with lumiflow."""

    def rate(scene):
        with tempfile.TemporaryDirectory() as out:
            picture = os.path.join(out, "out.exr")
            command = [program, "render", scene, "-i", "path", "--spp", str(spp), "-t", "1"]
            command += ["-q", "--json", "-o", picture]
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
    renderers = {
        "lumiflow": lumiflow(given.lumiflow, 48),
        f"Mitsuba {MITSUBA} scalar_rgb": mitsuba(python, "scalar_rgb", 16),
    }
    if llvm():
        renderers[f"Mitsuba {MITSUBA} llvm_ad_rgb"] = mitsuba(python, "llvm_ad_rgb", 64)
    else:
        print("llvm_ad_rgb is left out: LLVM was not found", file=sys.stderr)
    print("| scene | renderer | million paths a CPU second | ratio to lumiflow |")
    print("|---|---|---|---|")
    for scene in given.scenes:
        rounds = [{n: rate(scene) for n, rate in renderers.items()} for _ in range(given.rounds)]
        for name in renderers:
            rates = [found[name] for found in rounds]
            ratio = statistics.median(found[name] / found["lumiflow"] for found in rounds)
            print(f"| {Path(scene).parent.name} | {name} | {max(rates):.2f} | {ratio:.2f} |")


if __name__ == "__main__":
    main()
