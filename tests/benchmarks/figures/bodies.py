"""Two voxel bodies at any resolution, written as label volumes (NRRD, LPS, millimetres).

A body is a list of ellipsoids painted one after the other into a cube of n x n x n voxels that is
centred on the origin: solid ones add, hollow ones take away. A row of voxels meets an ellipsoid in
one interval, found in closed form, so that 256 voxels a side take seconds without any library. A
voxel is solid where its centre is inside; so every resolution samples the same shape.
"""

import gzip
import math
import random
from collections import Counter
from dataclasses import dataclass

BONE_SIDE_MM = 100.0
TOOL_SIDE_MM = 64.0


@dataclass(frozen=True)
class Ellipsoid:
    centre: tuple  # mm
    radii: tuple  # mm, along the cube's axes
    solid: bool = True


def ball(centre, radius, solid=True):
    return Ellipsoid(tuple(centre), (radius, radius, radius), solid)


def sweep(start, end, radius_start, radius_end, sag=(0.0, 0.0, 0.0)):
    """Balls along a parabola from start to end; `sag` is how far its middle leaves the chord."""
    length = math.dist(start, end)
    count = max(2, math.ceil(length / (0.25 * min(radius_start, radius_end))))
    balls = []
    for i in range(count + 1):
        u = i / count
        bow = 4 * u * (1 - u)
        centre = [a + u * (b - a) + bow * s for a, b, s in zip(start, end, sag)]
        balls.append(ball(centre, radius_start + u * (radius_end - radius_start)))
    return balls


def bone():
    """The upper end of a thigh bone, roughly: head, neck, trochanter, bowed shaft, bumps."""
    head, knee = (18.0, 0.0, 26.0), (-9.0, 0.0, 2.0)
    parts = [ball(head, 20.0), Ellipsoid((-16.0, 2.0, 12.0), (13.0, 12.0, 18.0))]
    parts += sweep(head, knee, 12.0, 13.0)
    parts += sweep(knee, (-4.0, 2.0, -36.0), 13.0, 11.0, sag=(2.0, -2.0, 0.0))
    generator = random.Random(1)  # the same bumps at every resolution and in every run
    smooth = list(parts)
    for _ in range(120):
        part = generator.choice(smooth)
        direction = uniform_direction(generator)
        centre = [c + 0.97 * r * d for c, r, d in zip(part.centre, part.radii, direction)]
        radius = generator.uniform(1.0, 2.5)
        if max(abs(c) for c in centre) + radius < 0.48 * BONE_SIDE_MM:
            parts.append(ball(centre, radius))
    return parts


def tool():
    """A spoon: a cup with a wall of 2 mm that opens sideways, and a bowed handle."""
    cup, out, wall = (0.0, 0.0, -16.0), 14.0, 2.0
    opening = (0.857, 0.0, -0.514)  # unit
    far = 60.0  # so large a ball cuts nearly straight
    cut = [c + (far + 3.0) * d for c, d in zip(cup, opening)]
    parts = [ball(cup, out), ball(cup, out - wall, solid=False), ball(cut, far, solid=False)]
    return parts + sweep((0.0, 0.0, -1.0), (8.0, 0.0, 26.0), 3.0, 4.0, sag=(-7.0, 0.0, 0.0))


def moved(parts, rotation, shift):
    """The parts turned about the origin, then shifted. Balls only: others would lose their axes."""
    assert all(len(set(part.radii)) == 1 for part in parts)
    return [Ellipsoid(tuple(sum(r * c for r, c in zip(row, part.centre)) + t
                            for row, t in zip(rotation, shift)), part.radii, part.solid)
            for part in parts]


def uniform_direction(generator):
    """Uniform on the unit sphere: height and longitude are independent and uniform (Archimedes)."""
    z = generator.uniform(-1.0, 1.0)
    angle = generator.uniform(0.0, 2.0 * math.pi)
    across = math.sqrt(1.0 - z * z)
    return (across * math.cos(angle), across * math.sin(angle), z)


def paint(parts, side_mm, n):
    """The labels, x fastest, then y, then z: 1 is solid."""
    labels = bytearray(n * n * n)
    spacing = side_mm / n
    first = (0.5 - 0.5 * n) * spacing  # centre of voxel 0

    def indices(low, high):
        """The voxels whose centres lie in [low, high]."""
        return (max(0, math.ceil((low - first) / spacing)),
                min(n - 1, math.floor((high - first) / spacing)))

    for part in parts:
        (cx, cy, cz), (rx, ry, rz) = part.centre, part.radii
        value = b"\x01" if part.solid else b"\x00"
        k0, k1 = indices(cz - rz, cz + rz)
        for k in range(k0, k1 + 1):
            left_z = 1.0 - ((first + k * spacing - cz) / rz) ** 2
            if left_z <= 0.0:
                continue
            reach = ry * math.sqrt(left_z)
            j0, j1 = indices(cy - reach, cy + reach)
            for j in range(j0, j1 + 1):
                left = left_z - ((first + j * spacing - cy) / ry) ** 2
                if left <= 0.0:
                    continue
                half = rx * math.sqrt(left)
                i0, i1 = indices(cx - half, cx + half)
                if i0 <= i1:
                    row = (k * n + j) * n
                    labels[row + i0:row + i1 + 1] = value * (i1 - i0 + 1)
    return labels


def solid_voxels(labels, n, surface_only):
    """Addresses (i, j, k); of the surface: those with an empty neighbour across a face."""
    steps = (1, -1, n, -n, n * n, -n * n)  # the bodies leave the cube's border empty
    return {(at % n, at // n % n, at // (n * n)) for at in range(n * n * n)
            if labels[at] and not (surface_only and all(labels[at + s] for s in steps))}


def one_child_nodes(voxels):
    """Nodes of the octree over these voxels, and those among them that have one child."""
    nodes = alone = 0
    while len(voxels) > 1:
        children = Counter((i >> 1, j >> 1, k >> 1) for i, j, k in voxels)
        nodes += len(children)
        alone += sum(1 for count in children.values() if count == 1)
        voxels = children.keys()
    return nodes, alone


def write_nrrd(path, labels, side_mm, n):
    """Labels of a cube centred on the origin; the origin in the header is the first centre."""
    spacing = side_mm / n
    first = (0.5 - 0.5 * n) * spacing
    header = "\n".join([
        "NRRD0004", "type: uint8", "dimension: 3", "space: left-posterior-superior",
        f"sizes: {n} {n} {n}",
        f"space directions: ({spacing!r},0,0) (0,{spacing!r},0) (0,0,{spacing!r})",
        "kinds: domain domain domain", "encoding: gzip",
        f"space origin: ({first!r},{first!r},{first!r})", "", ""])
    path.write_bytes(header.encode("ascii") + gzip.compress(bytes(labels), 1, mtime=0))
