#!/usr/bin/env python3
"""Pictures of lumiflow beside those of Mitsuba 3, scene by scene, as a table.

    python3 benches/peers/pictures.py target/release/lumiflow FOLDER... [--out FOLDER] [--spp N]

A FOLDER has scene.xml, as its author wrote it, and scene_mi3.xml, a copy that Mitsuba loads. Both
renderers trace paths with a box filter and one thread, at the size of the copy's film; lumiflow
renders the copy, too: where only scene.xml differs, the copy does, not the renderer. z-scores are of
tiles of luminance, with the variance of both pictures: lumiflow's from its samples, Mitsuba's from
its seeds. The pictures stay in --out. Installs Mitsuba into target/peers by pip.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

from paths import environment

# Runs in Mitsuba's environment: a scene, a name for the pictures, samples a pixel, seeds; prints the
# size of the film and the CPU seconds of rendering once.
PEER = """
import json, sys, time
import drjit as dr
import mitsuba as mi
import numpy as np
scene, name, spp, seeds = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
mi.set_variant("scalar_rgb")
scene = mi.load_file(scene)
dr.set_thread_count(1)
start = time.process_time()
pictures = [mi.render(scene, spp=spp, seed=100 + seed) for seed in range(seeds)]
seconds = (time.process_time() - start) / seeds
# Files are written by a thread of their own.
dr.set_thread_count(2)
pictures = np.array([np.array(picture)[..., :3] for picture in pictures], dtype=np.float64)
mean, variance = pictures.mean(axis=0), pictures.var(axis=0, ddof=1) / seeds
# Lamps have no noise: what their numbers differ by is rounding.
variance += (mean * 2.0**-18) ** 2
for image, end in [(mean, ""), (variance, ".var")]:
    mi.Bitmap(image.astype(np.float32)).write(f"{name}{end}.exr")
size = f"{pictures.shape[2]}x{pictures.shape[1]}"
print(json.dumps({"size": size, "cpu_s": seconds}))
"""

HEAD = """\
| scene | triangles | lumiflow, CPU s | Mitsuba, CPU s | ratio of means | z | beyond 3 | the copy: ratio | z | beyond 3 | warnings |
|---|---|---|---|---|---|---|---|---|---|---|"""


def last_json(command):
    """What a command prints as JSON in its last line."""
    run = subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True)
    return json.loads(run.stdout.splitlines()[-1])


def mitsuba(python, folder, name, given):
    """Renders the copy with Mitsuba, unless that is done; what it says of it."""
    record = Path(f"{name}.json")
    if not record.exists():
        command = [python, "-c", PEER, folder / "scene_mi3.xml", name, given.spp, given.seeds]
        record.write_text(json.dumps(last_json(command)))
    return json.loads(record.read_text())


def compared(scene, peer, name, size, given):
    """Renders a scene with lumiflow and compares it; what the two commands say."""
    picture = f"{given.out}/{name}.exr"
    render = [given.lumiflow, "render", scene, "-i", "path", "--spp", given.spp, "--size", size]
    render += ["--filter", "box", "--float", "--aov", "variance", "-t", 1, "-o", picture]
    render += ["-o", f"{given.out}/{name}.png", "--json", "-q"]
    compare = [given.lumiflow, "compare", picture, f"{peer}.exr", "--variance", picture]
    compare += ["--reference-variance", f"{peer}.var.exr", "--tile", 8, "--json"]
    return last_json(render), last_json(compare)


def scores(found):
    """Columns of a comparison."""
    means, tiles = found["means"]["luminance"], found["tiles"]["luminance"]
    ratio = f"{means['ratio']:.3f} ± {means['standard_error']:.3f}"
    return [ratio, f"{tiles['mean_z2'] ** 0.5:.2f}", f"{100 * tiles['share_beyond_3']:.1f} %"]


def row(python, folder, given):
    """The row of a scene, and what lumiflow warns of in it."""
    peer = given.out / f"{folder.name}-mitsuba"
    about = mitsuba(python, folder, peer, given)
    size = about["size"]
    scene, copy = folder / "scene.xml", folder / "scene_mi3.xml"
    rendered, ours = compared(scene, peer, folder.name, size, given)
    _, of_copy = compared(copy, peer, f"{folder.name}-copy", size, given)
    triangles = last_json([given.lumiflow, "info", scene, "--json"])["triangles"]
    warnings = rendered["warnings"]
    columns = [folder.name, str(triangles)]
    columns += [f"{found['cpu_s']:.1f}" for found in (rendered, about)]
    columns += [*scores(ours), *scores(of_copy), str(len(warnings))]
    return "| " + " | ".join(columns) + " |", warnings


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("lumiflow", help="the program")
    arguments.add_argument("folders", nargs="+", type=Path)
    arguments.add_argument("--out", type=Path, default=Path("target/pictures"))
    arguments.add_argument("--spp", type=int, default=64)
    arguments.add_argument("--seeds", type=int, default=2, help="of Mitsuba, two or more")
    given = arguments.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    python = environment()
    print(HEAD, flush=True)
    for folder in given.folders:
        text, warnings = row(python, folder, given)
        print(text, flush=True)
        for warning in warnings:
            print(f"{folder.name}: {warning}", file=sys.stderr)


if __name__ == "__main__":
    main()
