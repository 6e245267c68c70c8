#!/usr/bin/env python3
"""What scenes of production size cost lumiflow: time to load and build, memory, rays a second.

    python3 benches/scale/scale.py target/release/lumiflow FOLDER [--rounds N] [--spp N] [-o NAME]
        [--scenes NAME...]

FOLDER holds the scenes of scenes.py and is filled where they are missing. Each scene is rendered
N times (3), `path` at 960 × 540 pixels; times are medians, memory the largest. Prints a table in
Markdown; with -o, NAME.svg becomes a plot of it, NAME.json holds every run's numbers.

The columns: `load` is all until the scene stands, `build` the part of it that is Embree's search
structure; `first pixel` is when the first path begins. `tree` is what Embree holds by its own memory
monitor, `with buffers` that and the positions and indices that it reads from ours; `scene` is all
that lumiflow holds of the scene, `resident` the whole process after loading, `peak` its largest
while loading; all a triangle that is stored. `rays/s` is millions a second of processor time.
"""

import argparse
import json
import math
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import scenes

MIB = 1 << 20


def run(program, scene, spp, place):
    """One render's JSON line, with what the scene holds."""
    command = [program, "render", scene, "--spp", str(spp), "-q", "--json", "-o", place / "a.exr"]
    line = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    return {"scene": scene.stem, **{key: line[key] for key in line if key != "outputs"}}


def contents(program, scene):
    """What a scene holds."""
    command = [program, "info", scene, "--json"]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def row(info, runs):
    """The figures of a scene."""
    middle = lambda of: statistics.median(of(run) for run in runs)
    largest = lambda name: max(run["memory"][name] for run in runs)
    with_buffers = largest("tree") + largest("buffers")
    return {
        "triangles": info["triangles"],
        "shown": info["triangles"] if not info["instances"] else info["instanced_triangles"],
        "load": middle(lambda run: run["load_s"]),
        "build": middle(lambda run: run["build_s"]),
        "first": middle(lambda run: run["load_s"] + run["prepare_s"]),
        "tree": largest("tree"),
        "with_buffers": with_buffers,
        "scene": with_buffers + largest("surfaces"),
        "pictures": largest("pictures"),
        "resident": largest("loaded"),
        "peak": largest("load_peak"),
        "rays": middle(lambda run: run["rays"] / run["cpu_s"]) / 1e6,
    }


def table(rows):
    """The figures as Markdown."""
    head = ["scene", "triangles", "shown", "load s", "build s", "first pixel s", "tree B"]
    head += ["with buffers B", "scene B", "ratio", "resident B", "ratio", "peak B", "Mrays/s"]
    lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
    for name, r in rows.items():
        # Pictures are no triangles; a scene that is all pictures is given in MiB.
        by = r["triangles"] if r["triangles"] > 10_000 else None
        each = lambda of: f"{r[of] / by:.1f}" if by else f"{r[of] / MIB:.0f} MiB"
        bare = r["resident"] - r["pictures"]
        ratio = lambda value: f"{value / r['with_buffers']:.2f}" if by else "–"
        cells = [name, f"{r['triangles']:,}", f"{r['shown']:,}"]
        cells += [f"{r['load']:.2f}", f"{r['build']:.2f}", f"{r['first']:.2f}"]
        cells += [each("tree"), each("with_buffers"), each("scene"), ratio(r["scene"])]
        cells += [each("resident"), ratio(bare), each("peak"), f"{r['rays']:.2f}"]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def nice(step):
    """The next of 1, 2, 2.5, 5 and their tenfolds."""
    tenfold = 10 ** math.floor(math.log10(step))
    return next(n * tenfold for n in (1, 2, 2.5, 5, 10) if n * tenfold >= step)


def plot(rows):
    """Three panels over the number of triangles of the terrains, as SVG."""
    names = [name for name in rows if name in scenes.SIDES]
    xs = [rows[name]["triangles"] / 1e6 for name in names]
    column = lambda of: [of(rows[name]) for name in names]
    each = lambda of: column(lambda r: r[of] / r["triangles"])
    panels = [
        ("seconds", [("first pixel", column(lambda r: r["first"])),
                     ("Embree's build", column(lambda r: r["build"]))]),
        ("bytes a triangle", [("peak", each("peak")), ("resident", each("resident")),
                              ("Embree with buffers", each("with_buffers"))]),
        ("million rays a CPU second", [("path", column(lambda r: r["rays"]))]),
    ]
    colours = ["#1b6ca8", "#c8553d", "#5b8c5a"]
    width, height, left, right, top, bottom = 340, 260, 50, 15, 30, 45
    parts = []
    for index, (title, curves) in enumerate(panels):
        step = nice(max(value for _, values in curves for value in values) / 4)
        most = 4.4 * step
        place = lambda x, y: (
            index * width + left + x / max(xs) * (width - left - right),
            height - bottom - y / most * (height - top - bottom),
        )
        for y in (step * line for line in range(5)):
            (x0, at), (x1, _) = place(0, y), place(max(xs), y)
            parts.append(f'<path d="M{x0:.1f} {at:.1f}H{x1:.1f}" stroke="#ddd"/>')
            label = f"{y:g}"
            parts.append(f'<text x="{x0 - 5:.1f}" y="{at + 4:.1f}" text-anchor="end">{label}</text>')
        for x in xs:
            at = place(x, 0)
            parts.append(f'<text x="{at[0]:.1f}" y="{at[1] + 15:.1f}" text-anchor="middle">{x:.0f}</text>')
        middle = place(max(xs) / 2, 0)
        parts.append(f'<text x="{middle[0]:.1f}" y="{height - 10}" text-anchor="middle">million triangles</text>')
        parts.append(f'<text x="{index * width + left}" y="18" font-weight="bold">{title}</text>')
        for number, (name, values) in enumerate(curves):
            points = [place(x, y) for x, y in zip(xs, values)]
            line = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
            colour = colours[number]
            parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
            parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in points]
            x, y = points[-1]
            y += 18 if number == 2 else -8
            parts.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="end" fill="{colour}">{name}</text>')
    size = f'width="{3 * width}" height="{height}" viewBox="0 0 {3 * width} {height}"'
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" font-size="11">',
        '<rect width="100%" height="100%" fill="#fff"/>', *parts, "</svg>", "",
    ])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--spp", type=int, default=4)
    parser.add_argument("--scenes", nargs="+", choices=scenes.NAMES, default=scenes.NAMES)
    parser.add_argument("-o", dest="output", type=Path)
    arguments = parser.parse_args()
    program = arguments.program.resolve()
    files = {name: scenes.make(arguments.folder, name) for name in arguments.scenes}
    runs = {name: [] for name in files}
    with tempfile.TemporaryDirectory() as place:
        for turn in range(arguments.rounds):
            for name, scene in files.items():
                print(f"round {turn + 1}: {name}", file=sys.stderr, flush=True)
                runs[name].append(run(program, scene, arguments.spp, Path(place)))
    rows = {name: row(contents(program, files[name]), runs[name]) for name in files}
    print(table(rows))
    if arguments.output:
        arguments.output.with_suffix(".svg").write_text(plot(rows))
        arguments.output.with_suffix(".json").write_text(json.dumps(runs, indent=1) + "\n")


if __name__ == "__main__":
    main()
