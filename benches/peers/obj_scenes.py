#!/usr/bin/env python3
"""Writes a scene of many OBJ files, to measure how fast renderers load one.

    obj_scenes.py FOLDER FILES TRIANGLES

FOLDER gets scene.xml (Mitsuba 3) and FILES bumpy balls with normals and texture coordinates, which
have TRIANGLES triangles together, or a few more.
"""

import math
import os
import sys


def ball(number, turns, steps):
    """The text of one OBJ file: 2 · turns · (steps − 1) triangles."""
    lines = [f"# ball {number}", "o ball"]
    for step in range(steps + 1):
        for turn in range(turns + 1):
            theta, phi = math.pi * step / steps, 2 * math.pi * turn / turns
            normal = (math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi))
            radius = 0.4 + 0.03 * math.sin(7 * phi + number) * math.sin(theta) ** 2
            lines.append("v %.6f %.6f %.6f" % tuple(radius * c for c in normal))
            lines.append("vt %.6f %.6f" % (turn / turns, step / steps))
            lines.append("vn %.6f %.6f %.6f" % normal)
    corner = lambda step, turn: "{0}/{0}/{0}".format(step * (turns + 1) + turn + 1)
    for step in range(steps):
        for turn in range(turns):
            a, b = corner(step, turn), corner(step, turn + 1)
            c, d = corner(step + 1, turn), corner(step + 1, turn + 1)
            if step > 0:
                lines.append(f"f {a} {b} {d}")
            if step + 1 < steps:
                lines.append(f"f {a} {d} {c}")
    return "\n".join(lines) + "\n"


def main():
    folder, files, triangles = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    os.makedirs(folder, exist_ok=True)
    steps = math.ceil(math.sqrt(triangles / files / 4)) + 1
    turns = math.ceil(triangles / files / (2 * (steps - 1)))
    columns = math.ceil(math.sqrt(files))
    shapes = []
    for number in range(files):
        name = f"ball{number:04}.obj"
        with open(os.path.join(folder, name), "w") as file:
            file.write(ball(number, turns, steps))
        x, z = number % columns, number // columns
        shapes.append(
            f'<shape type="obj"><string name="filename" value="{name}"/>'
            f'<transform name="to_world"><translate x="{x}" z="{z}"/></transform>'
            '<ref id="clay"/></shape>'
        )
    middle = columns / 2
    with open(os.path.join(folder, "scene.xml"), "w") as file:
        file.write(
            '<scene version="3.0.0">\n<integrator type="path"/>\n<sensor type="perspective">'
            f'<transform name="to_world"><lookat origin="{middle}, {columns}, {-middle}" '
            f'target="{middle}, 0, {middle}" up="0, 1, 0"/></transform>'
            '<film type="hdrfilm"><integer name="width" value="64"/>'
            '<integer name="height" value="48"/></film>'
            '<sampler type="independent"><integer name="sample_count" value="1"/></sampler></sensor>\n'
            '<emitter type="constant"/>\n<bsdf type="diffuse" id="clay"/>\n'
        )
        file.write("\n".join(shapes) + "\n</scene>\n")
    print(f"{files} files of {2 * turns * (steps - 1)} triangles in {folder}")


if __name__ == "__main__":
    main()
