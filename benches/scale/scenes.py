#!/usr/bin/env python3
"""Scenes of production size, made anew: the same bytes on every machine.

    python3 benches/scale/scenes.py FOLDER [NAME...]

NAMES: terrain-1m, terrain-5m, terrain-20m (a terrain of so many triangles, one binary PLY file),
instances (a thousand instances of the terrain of a million triangles), meshes (ten thousand OBJ
files), textures (two hundred pictures of 1024 × 1024 texels). Without names, all of them, about
1.6 GB. What is there is kept.
"""

import argparse
import math
import struct
import sys
import zlib
from array import array
from pathlib import Path

# Squares along a side of a terrain; a square is two triangles.
SIDES = {"terrain-1m": 707, "terrain-5m": 1581, "terrain-20m": 3162}
INSTANCES = 1000
MESHES = 10_000
TEXTURES = 200
TEXELS = 1024
NAMES = [*SIDES, "instances", "meshes", "textures"]

HEAD = """<scene version="3.0.0">
  <default name="spp" value="4"/>
  <integrator type="path"><integer name="max_depth" value="6"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="45"/>
    <transform name="to_world"><lookat origin="{origin}" target="{target}" up="0, 0, 1"/></transform>
    <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
    <film type="hdrfilm">
      <integer name="width" value="960"/><integer name="height" value="540"/>
      <rfilter type="box"/>
    </film>
  </sensor>
  <emitter type="constant"><rgb name="radiance" value="0.6, 0.8, 1"/></emitter>
  <emitter type="directional">
    <vector name="direction" x="1" y="0.7" z="-0.8"/><rgb name="irradiance" value="2, 1.8, 1.5"/>
  </emitter>
  <bsdf type="diffuse" id="grey"><rgb name="reflectance" value="0.5, 0.45, 0.4"/></bsdf>
"""


def little(values):
    """The bytes of an array, lowest first."""
    if sys.byteorder == "big":
        values.byteswap()
    return values.tobytes()


def waves(side, turns):
    """Numbers along a side whose products make hills, from coarse to fine."""
    return [
        [math.sin(turn * math.tau * i / side + 0.3 * turn) for i in range(side + 1)]
        for turn in turns
    ]


def terrain(file, side):
    """Hills on the unit square as a PLY file with 2 · side² triangles, without normals."""
    along, across = waves(side, (2, 7, 31, 113)), waves(side, (3, 5, 29, 127))
    sizes = (0.05, 0.02, 0.006, 0.002)
    with open(file, "wb") as ply:
        ply.write(
            f"ply\nformat binary_little_endian 1.0\nelement vertex {(side + 1) ** 2}\n"
            "property float x\nproperty float y\nproperty float z\n"
            f"element face {2 * side * side}\nproperty list uchar int vertex_indices\n"
            "end_header\n".encode()
        )
        xs = [i / side for i in range(side + 1)]
        for j in range(side + 1):
            a, b, c, d = (size * wave[j] for size, wave in zip(sizes, across))
            row = array("f", bytes(12 * (side + 1)))
            row[0::3] = array("f", xs)
            row[1::3] = array("f", [j / side]) * (side + 1)
            row[2::3] = array("f", [a * p + b * q + c * r + d * s for p, q, r, s in zip(*along)])
            ply.write(little(row))
        # A row of squares: 3 and three indices for each triangle, which only grow from row to row.
        for j in range(side):
            low = range(j * (side + 1), j * (side + 1) + side)
            up = range((j + 1) * (side + 1), (j + 1) * (side + 1) + side)
            corners = [low, range(low[1], low[-1] + 2), range(up[1], up[-1] + 2)]
            corners += [low, range(up[1], up[-1] + 2), up]
            row = bytearray(26 * side)
            for place, corner in enumerate(corners):
                start = 1 + 13 * (place // 3) + 4 * (place % 3)
                indices = little(array("i", corner))
                for byte in range(4):
                    row[start + byte :: 26] = indices[byte::4]
            row[0::13] = b"\x03" * (2 * side)
            ply.write(row)


def terrain_scene(folder, name):
    """A terrain seen from above its edge."""
    terrain(folder / f"{name}.ply", SIDES[name])
    head = HEAD.format(origin="0.5, -0.45, 0.45", target="0.5, 0.45, 0")
    shape = f'<shape type="ply"><string name="filename" value="{name}.ply"/><ref id="grey"/></shape>'
    (folder / f"{name}.xml").write_text(f"{head}  {shape}\n</scene>\n")


def instances(folder):
    """The terrain of a million triangles, a thousand times."""
    if not (folder / "terrain-1m.ply").exists():
        terrain(folder / "terrain-1m.ply", SIDES["terrain-1m"])
    rows = [HEAD.format(origin="16, -8, 9", target="16, 14, 0")]
    rows.append(
        '<shape type="shapegroup" id="hills"><shape type="ply">'
        '<string name="filename" value="terrain-1m.ply"/><ref id="grey"/></shape></shape>'
    )
    for i in range(INSTANCES):
        x, y = i % 32, i // 32
        rows.append(
            f'<shape type="instance"><ref id="hills"/><transform name="to_world">'
            f'<rotate z="1" angle="{90 * (i % 4)}"/><translate x="{x}" y="{y}" z="{i % 7 / 20}"/>'
            "</transform></shape>"
        )
    (folder / "instances.xml").write_text("\n".join([*rows, "</scene>", ""]))


def pebble(number, rings=16):
    """A round stone as the text of an OBJ file with normals and texture coordinates."""
    lines, sectors = [], 2 * rings
    for i in range(rings + 1):
        polar = math.pi * i / rings
        for j in range(sectors + 1):
            azimuth = math.tau * j / sectors
            n = (
                math.sin(polar) * math.cos(azimuth),
                math.sin(polar) * math.sin(azimuth),
                math.cos(polar),
            )
            r = 1 + 0.1 * math.sin(2 * polar + number) * math.sin(2 * azimuth) * math.sin(polar)
            lines.append("v %.6f %.6f %.6f" % tuple(r * c for c in n))
            lines.append("vt %.6f %.6f" % (j / sectors, i / rings))
            lines.append("vn %.6f %.6f %.6f" % n)
    for i in range(rings):
        for j in range(sectors):
            a = i * (sectors + 1) + j + 1
            b = a + sectors + 1
            corners = [a, b, b + 1, a + 1]
            lines.append("f " + " ".join(f"{c}/{c}/{c}" for c in corners))
    return "\n".join([*lines, ""])


def meshes(folder):
    """Ten thousand stones of 1024 triangles, a file each."""
    (folder / "pebbles").mkdir(exist_ok=True)
    texts = [pebble(number).encode() for number in range(64)]
    rows = [HEAD.format(origin="150, -90, 110", target="150, 120, 0")]
    for i in range(MESHES):
        (folder / "pebbles" / f"{i}.obj").write_bytes(texts[i % len(texts)])
        rows.append(
            f'<shape type="obj"><string name="filename" value="pebbles/{i}.obj"/>'
            f'<transform name="to_world"><rotate z="1" angle="{i * 37 % 360}"/>'
            f'<translate x="{i % 100 * 3}" y="{i // 100 * 3}"/></transform><ref id="grey"/></shape>'
        )
    (folder / "meshes.xml").write_text("\n".join([*rows, "</scene>", ""]))


def picture(file, number):
    """A pattern of its own for each number, as PNG."""
    rows = bytearray()
    red = bytes((x * (number + 1) // 4) & 255 for x in range(TEXELS))
    for y in range(TEXELS):
        row = bytearray(3 * TEXELS)
        row[0::3] = red
        row[1::3] = bytes([(y * 3 + number) & 255]) * TEXELS
        row[2::3] = bytes(x ^ (y & 255) for x in range(256)) * (TEXELS // 256)
        rows += b"\x00" + row

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    size = struct.pack(">IIBBBBB", TEXELS, TEXELS, 8, 2, 0, 0, 0)
    file.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", size)
        + chunk(b"IDAT", zlib.compress(bytes(rows), 1))
        + chunk(b"IEND", b"")
    )


def textures(folder):
    """Two hundred tiles, each with a picture of its own."""
    (folder / "pictures").mkdir(exist_ok=True)
    rows = [HEAD.format(origin="10, -6, 12", target="10, 8, 0")]
    for i in range(TEXTURES):
        picture(folder / "pictures" / f"{i}.png", i)
        rows.append(
            f'<shape type="rectangle"><transform name="to_world"><scale value="0.48"/>'
            f'<translate x="{i % 20}" y="{i // 20}"/></transform><bsdf type="diffuse">'
            f'<texture type="bitmap" name="reflectance"><string name="filename" '
            f'value="pictures/{i}.png"/></texture></bsdf></shape>'
        )
    (folder / "textures.xml").write_text("\n".join([*rows, "</scene>", ""]))


def make(folder, name):
    """Makes a scene unless it is there; returns its file."""
    scene = folder / f"{name}.xml"
    if not scene.exists():
        folder.mkdir(parents=True, exist_ok=True)
        if name in SIDES:
            terrain_scene(folder, name)
        else:
            {"instances": instances, "meshes": meshes, "textures": textures}[name](folder)
    return scene


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(NAMES))
    arguments = parser.parse_args()
    unknown = [name for name in arguments.names if name not in NAMES]
    if unknown:
        parser.error(f"unknown scene {unknown[0]}; there are {', '.join(NAMES)}")
    for name in arguments.names or NAMES:
        print(make(arguments.folder, name), flush=True)


if __name__ == "__main__":
    main()
