#!/usr/bin/env python3
"""Palpate's segmentation against independent programs: InVesalius, SciPy and scikit-image.

  references_test.py --palpate PROGRAM [--scans shapes,ct,mr] [--scan FILE] [--only TEXT]

Each row runs a recipe on a case, makes the same mask in another way from the case's grey values, and
lets `palpate compare` measure both. Exact tools must be equal voxel by voxel; where definitions
differ (how a blur ends, which of two equal voxels a flood takes first) the least Dice of the row is
said in its line. Prints a Markdown table. Scans: the CT of Debian's invesalius-examples (or --scan),
the MR of mricron-data, and shapes made here. Ends with 77 where a package or every scan is absent.
"""

import argparse
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import zlib

try:
    import numpy as np
    from scipy import ndimage
    from skimage import filters, segmentation
except ImportError as missing:
    print(f"SKIPPED: needs Debian's python3-scipy and python3-skimage ({missing}).")
    sys.exit(77)

CT = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3"
MR = "/usr/share/mricron/templates/ch2.nii.gz"
MR_BRAIN = "/usr/share/mricron/templates/ch2bet.nii.gz"
CORNERS = np.ones((3, 3, 3))  # 26 neighbours; SciPy's default are 6
EQUAL = 1.0

# ------------------------------------------------------------------------------ files and cases


def read_mha(path):
    """The header, and the voxels as z, y, x."""
    with open(path, "rb") as file:
        data = file.read()
    head, at = {}, 0
    while "ElementDataFile" not in head:
        end = data.index(b"\n", at)
        key, value = data[at:end].decode().split("=", 1)
        head[key.strip()], at = value.strip(), end + 1
    body = data[at:]
    if head.get("CompressedData") == "True":
        body = zlib.decompress(body)
    kind = {"MET_UCHAR": "u1", "MET_SHORT": "<i2", "MET_FLOAT": "<f4"}[head["ElementType"]]
    return head, np.frombuffer(body, kind).reshape([int(n) for n in head["DimSize"].split()][::-1])


def write_mha(path, array, spacing, origin, direction):
    kind = {"uint8": "MET_UCHAR", "int16": "MET_SHORT"}[array.dtype.name]
    words = lambda numbers: " ".join(repr(float(n)) for n in numbers)
    lines = ["ObjectType = Image", "NDims = 3", "BinaryData = True", "BinaryDataByteOrderMSB = False",
             "CompressedData = False", f"TransformMatrix = {words(direction)}",
             f"Offset = {words(origin)}", f"ElementSpacing = {words(spacing)}",
             "DimSize = " + " ".join(str(n) for n in array.shape[::-1]), f"ElementType = {kind}",
             "ElementDataFile = LOCAL"]
    with open(path, "wb") as file:
        file.write(("\n".join(lines) + "\n").encode() + np.ascontiguousarray(array).tobytes())


class Case:
    """A scan imported by the program; its grey values read by our own few lines."""

    def __init__(self, palpate, name, scan, work):
        self.palpate, self.name, self.work = palpate, name, pathlib.Path(work)
        self.folder = self.work / name.replace(" ", "-")
        said = self.run("import", scan, "--out", self.folder)
        self.spacing, self.origin = np.array(said["spacing_mm"]), np.array(said["origin_mm"])
        self.axes = np.array(said["direction"]).reshape(3, 3).T  # columns are the axes
        self.sampling = self.spacing[::-1]  # of z, y, x
        _, self.grey = read_mha(self.folder / "volume.mha")

    def run(self, *arguments, allowed=(0,)):
        done = subprocess.run([self.palpate, *map(str, arguments), "--json"], capture_output=True,
                              text=True)
        if done.returncode not in allowed:
            raise RuntimeError(f"palpate {' '.join(map(str, arguments))}: {done.stderr.strip()}")
        return json.loads(done.stdout)

    def segment(self, recipe):
        for name in ("labels.mha", "labels.toml", "segment.toml"):
            (self.folder / name).unlink(missing_ok=True)
        (self.work / "recipe.toml").write_text(recipe)
        self.run("segment", self.folder, "--recipe", self.work / "recipe.toml")

    def labelled(self, value=1):
        return read_mha(self.folder / "labels.mha")[1] == value

    def compare(self, label, mask):
        """What `palpate compare` says of the case's label and a mask of ours, or a file."""
        file, more = mask, ()
        if isinstance(mask, np.ndarray):
            file = self.work / "reference.mha"
            write_mha(file, mask.astype(np.uint8), self.spacing, self.origin, self.axes.T.ravel())
        elif isinstance(mask, tuple):
            file, more = mask[0], ("--reference-label", mask[1])
        return self.run("compare", self.folder, "--label", label, "--reference", file, *more)

    def point(self, x, y, z):
        """A voxel's centre in the patient, LPS mm."""
        return self.origin + self.axes @ (self.spacing * [x, y, z])

    def points(self):
        """Every voxel's centre in the patient, LPS mm, as three arrays z, y, x."""
        z, y, x = np.indices(self.grey.shape, dtype=np.float32)
        steps = [s * i for s, i in zip(self.spacing, (x, y, z))]
        return [self.origin[r] + sum(self.axes[r, c] * steps[c] for c in range(3)) for r in range(3)]


# --------------------------------------------------------------------- the same by other programs


def between(case, low, high):
    return (case.grey >= low) & (case.grey <= high)


def parts(mask, keep):
    """The 26-connected parts whose number of voxels `keep` (of all numbers) chooses."""
    labels, _ = ndimage.label(mask, CORNERS)
    chosen = keep(np.bincount(labels.ravel())[1:])
    return np.concatenate([[False], chosen])[labels]


def largest(count):
    def keep(sizes):
        chosen = np.zeros(len(sizes), bool)
        chosen[np.argsort(-sizes, kind="stable")[:count]] = True
        return chosen
    return keep


def near(case, mask, mm):
    """Within mm of the mask, centre to centre: an exact distance in double precision."""
    if not mask.any():
        return mask  # SciPy would measure from nowhere
    return ndimage.distance_transform_edt(~mask, sampling=case.sampling) <= mm * (1 + 1e-9)


def dilated(case, mask, mm):
    return near(case, mask, mm)


def eroded(case, mask, mm):
    return ~near(case, ~mask, mm)


def opened(case, mask, mm):
    return dilated(case, eroded(case, mask, mm), mm)


def closed(case, mask, mm):
    return eroded(case, dilated(case, mask, mm), mm)


def filled(case, mask, most_mm3=math.inf):
    """SciPy fills what 6-connected background does not reach; the larger of these stay."""
    holes, count = ndimage.label(ndimage.binary_fill_holes(mask) & ~mask)
    sizes = np.bincount(holes.ravel(), minlength=count + 1) * case.spacing.prod()
    small = sizes <= most_mm3
    small[0] = False
    return mask | small[holes]


def blurred(case, mask, mm):
    """The kernel cut at the scan's edge is scaled to one, as VTK does."""
    blur = lambda a: ndimage.gaussian_filter(a, mm / case.sampling, mode="constant", truncate=3.0)
    return blur(mask.astype(np.float32)) > 0.5 * blur(np.ones(mask.shape, np.float32))


def long_parts(case, mask, mm):
    """The 26-connected parts whose box, voxels whole, has a diagonal of mm or more."""
    labels, _ = ndimage.label(mask, CORNERS)
    sides = [[s.stop - s.start for s in box] * case.sampling for box in ndimage.find_objects(labels)]
    return np.array([False] + [np.linalg.norm(side) >= mm for side in sides])[labels]


def thin(case, mask, mm):
    """What smoothing keeps (smooth.cpp): no ball fits, beside what is a ball's radius from any."""
    radius = max(mm, case.spacing.max())
    balls = opened(case, mask, radius)
    middle = mask & ~dilated(case, balls, radius)
    return long_parts(case, mask & ~balls & dilated(case, middle, 2 * radius), 6 * mm)


def grown(mask, voxel):
    labels, _ = ndimage.label(mask, CORNERS)
    x, y, z = voxel
    return labels == labels[z, y, x]


def in_polygon(corners, u, v):
    """Even-odd by the winding of angles, another way than counting crossings."""
    total = np.zeros(u.shape)
    for (au, av), (bu, bv) in zip(corners, corners[1:] + corners[:1]):
        ax, ay, bx, by = au - u, av - v, bu - u, bv - v
        total += np.arctan2(ax * by - ay * bx, ax * bx + ay * by)
    return np.round(total / (2 * np.pi)).astype(int) % 2 == 1


def stroke(case, path, radius):
    """Within the radius of a polyline."""
    where = case.points()
    inside = np.zeros(case.grey.shape, bool)
    for a, b in zip(path, path[1:]):
        along = b - a
        share = sum((w - s) * d for w, s, d in zip(where, a, along)) / float(along @ along)
        share = np.clip(share, 0, 1)
        inside |= sum((w - s - share * d) ** 2 for w, s, d in zip(where, a, along)) <= radius ** 2
    return inside


def flooded(case, mask, by, seeds):
    """Bright before dark or smooth before steep, from one seed each: the number of the seed."""
    if by == "brightness":
        level = -case.grey.astype(np.float64)
    else:
        level = np.sqrt(sum(g ** 2 for g in np.gradient(case.grey.astype(float), *case.sampling)))
    markers = np.zeros(mask.shape, np.int32)
    for number, (x, y, z) in enumerate(seeds, 1):
        markers[z, y, x] = number
        level[z, y, x] = -np.inf  # a seed is no barrier, whatever its own value
    return segmentation.watershed(level, markers, CORNERS, mask=parts(mask, largest(1)))


# ------------------------------------------------------------------------------------ what is run


def step(**keys):
    def text(value):
        if isinstance(value, bool):
            return str(value).lower()
        if isinstance(value, (list, tuple, np.ndarray)):
            return "[" + ", ".join(text(v) for v in value) + "]"
        return json.dumps(value) if isinstance(value, str) else repr(float(value))
    return "[[step]]\n" + "".join(f"{k} = {text(v)}\n" for k, v in keys.items())


class Rows:
    """Runs rows and keeps what was measured."""

    def __init__(self, only):
        self.only, self.lines, self.wrong = only, [], []

    def row(self, case, tool, other, recipe, label, reference, least=EQUAL, worst_mm=None):
        """`reference()` gives the mask, or a file; `least`: the Dice that must be reached."""
        if self.only not in f"{case.name} {tool}":
            return
        try:
            if recipe is not None:
                case.segment(recipe)
            found = case.compare(label, reference())
        except RuntimeError as error:
            self.wrong.append(f"{case.name}, {tool}: {error}")
            return
        surface = found["surface_mm"] or dict.fromkeys(("mean", "p95", "worst"), math.inf)
        good = found["dice"] >= least and (worst_mm is None or surface["worst"] <= worst_mm)
        if not good:
            self.wrong.append(f"{case.name}, {tool}: Dice {found['dice']:.6f} (least {least}), worst "
                              f"{surface['worst']:.3f} mm, voxels {found['voxels']}")
        self.lines.append(f"| {case.name} | {tool} | {other} | {found['voxels'][0]:,} | "
                          f"{found['dice']:.6f} | {surface['mean']:.4f} / {surface['p95']:.3f} / "
                          f"{surface['worst']:.3f} |")
        print(self.lines[-1], "" if good else "  <-- FAILED", flush=True)


def measure_row(rows, case, a, b):
    """`compare` itself: a label against another mask, surfaces and distances by SciPy."""
    if rows.only not in f"{case.name} compare":
        return
    found = case.compare("bone", b)
    surface = [m & ~ndimage.binary_erosion(m) for m in (a, b)]
    ways = [ndimage.distance_transform_edt(~surface[1 - i], sampling=case.sampling)[surface[i]]
            for i in (0, 1)]
    names = ("mean", "median", "p95", "worst")
    numbers = lambda d: (d.mean(), np.median(d), np.percentile(d, 95), d.max())
    both = np.concatenate(ways)
    expected = [2 * (a & b).sum() / (a.sum() + b.sum()), both.mean(), np.median(both),
                max(np.percentile(w, 95) for w in ways), max(w.max() for w in ways)]
    measured = [found["dice"], *(found["surface_mm"][n] for n in names)]
    for way, key in zip(ways, ("to_reference", "from_reference")):
        expected += numbers(way)
        measured += [found["surface_mm"][key][n] for n in names]
    off = max(abs(e - m) for e, m in zip(expected, measured))
    print(f"compare on {case.name}: thirteen numbers equal SciPy's within {off:.1e}")
    if off > 1e-5:  # distances are kept in single precision
        rows.wrong.append(f"{case.name}, compare: {off} from SciPy's distances")


def seeds_in(case, mask):
    """The brightest voxel of the largest part on the left, and on the right, as x, y, z."""
    inside = np.where(parts(mask, largest(1)), case.grey.astype(np.float64), -np.inf)
    half = case.grey.shape[2] // 2
    seeds = []
    for side, first in ((inside[:, :, :half], 0), (inside[:, :, half:], half)):
        z, y, x = np.unravel_index(side.argmax(), side.shape)
        seeds.append((int(x) + first, int(y), int(z)))
    return seeds


def mask_rows(rows, case, low, high, split=True):
    """Every tool on the mask of a range."""
    bone = between(case, low, high)
    seed, other_seed = seeds_in(case, bone)
    base = step(threshold=[low, high], label="bone")
    voxel = case.spacing.prod()

    def tool(name, other, make, least=EQUAL, **keys):
        rows.row(case, name, other, base + step(label="bone", **keys), "bone", make, least)

    rows.row(case, "threshold", "numpy", base, "bone", lambda: bone)
    measure_row(rows, case, bone, closed(case, bone, 2.5))
    rows.row(case, "threshold, `largest`", "scipy label",
             step(threshold=[low, high], label="bone", largest=True), "bone",
             lambda: parts(bone, largest(1)))
    rows.row(case, "threshold, `min_mm3` 20", "scipy label",
             step(threshold=[low, high], label="bone", min_mm3=20), "bone",
             lambda: parts(bone, lambda n: n * voxel >= 20))
    three = base + "[[step]]\ntool = \"islands\"\nlabel = \"bone\"\nkeep = \"largest\"\ncount = 3\n"
    rows.row(case, "islands, 3 largest", "scipy label", three, "bone",
             lambda: parts(bone, largest(3)))
    tool("islands, 100 mm³ or more", "scipy label", lambda: parts(bone, lambda n: n * voxel >= 100),
         tool="islands", keep="at-least", min_mm3=100)
    tool("islands, picked", "scipy label", lambda: grown(bone, seed), tool="islands", keep="picked",
         picks=[case.point(*seed)])
    tool("islands, not picked", "scipy label", lambda: bone & ~grown(bone, seed), tool="islands",
         keep="not-picked", picks=[case.point(*seed)])
    tool("fill holes", "scipy binary_fill_holes", lambda: filled(case, bone), tool="fill-holes")
    tool("fill holes up to 30 mm³", "scipy label", lambda: filled(case, bone, 30),
         tool="fill-holes", max_mm3=30)
    for operation, mm, other in (("dilate", 2.3, dilated), ("erode", 1.1, eroded),
                                 ("open", 1.2, opened), ("close", 3.1, closed),
                                 ("dilate", 12.0, dilated)):
        tool(f"margin, {operation} {mm} mm", "scipy distance_transform_edt",
             lambda other=other, mm=mm: other(case, bone, mm), tool="margin", operation=operation,
             mm=mm)
    tool("smooth 1 mm, `keep_thin` off", "scipy gaussian_filter", lambda: blurred(case, bone, 1.0),
         0.995, tool="smooth", mm=1.0, keep_thin=False)
    tool("smooth 1 mm", "scipy gaussian_filter, distances, label",
         lambda: blurred(case, bone, 1.0) | thin(case, bone, 1.0), 0.995, tool="smooth", mm=1.0)
    rows.row(case, "grow from a seed", "scipy label",
             step(tool="grow", label="bone", seeds=[case.point(*seed)], threshold=[low, high]), "bone",
             lambda: grown(bone, seed))
    size = np.array(case.grey.shape[::-1])
    corners = np.array([case.point(*(size * s)) for s in (0.3, 0.65)])
    low_mm, high_mm = corners.min(0), corners.max(0)

    def in_box():
        return np.all([(w >= a) & (w <= b) for w, a, b in zip(case.points(), low_mm, high_mm)], 0)
    tool("box", "numpy", lambda: bone & ~in_box(), tool="box", low=low_mm, high=high_mm)
    tool("box, `keep_inside`", "numpy", lambda: bone & in_box(), tool="box", low=low_mm,
         high=high_mm, keep_inside=True)
    # A star, seen along the patient's y axis.
    middle = case.point(*(size / 2))
    star = [(middle[0] + r * math.cos(a), middle[2] + r * math.sin(a))
            for r, a in zip([60.1, 23.3] * 5, np.arange(10) * math.pi / 5 + 0.1)]

    def in_star():
        where = case.points()
        return in_polygon(star, where[0].astype(float), where[2].astype(float))
    tool("scissors, a star", "winding of angles", lambda: bone & ~in_star(), 0.99999, tool="scissors",
         view=[1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], outline=star)
    path = [case.point(*(size * s)) for s in ([0.3, 0.4, 0.5], [0.6, 0.5, 0.4], [0.6, 0.7, 0.6])]
    tool("brush, 4.7 mm", "numpy", lambda: bone | stroke(case, path, 4.7), 0.99999, tool="brush",
         path=path, radius_mm=4.7)
    tool("brush, erase", "numpy", lambda: bone & ~stroke(case, path, 4.7), 0.99999, tool="brush",
         path=path, radius_mm=4.7, erase=True)
    other = step(threshold=[high + 1, 32000], label="dense") if case.grey.max() > high else ""
    if other:
        dense = case.grey > high
        for operation, make in (("add", lambda: bone | dilated(case, dense, 2.0)),
                                ("subtract", lambda: bone & ~dilated(case, dense, 2.0)),
                                ("intersect", lambda: bone & dilated(case, dense, 2.0))):
            rows.row(case, f"combine, {operation}, grown 2 mm", "scipy distance_transform_edt",
                     base + other + step(tool="combine", label="bone", operation=operation,
                                         other="dense", grown_mm=2.0), "bone", make)
    for by in ("brightness", "edges") if split else ():
        flood = flooded(case, bone, by, (seed, other_seed))
        recipe = (base + f"[[step]]\ntool = \"split\"\nlabel = \"bone\"\nby = \"{by}\"\n"
                  + "".join(f"[[step.seeds]]\nlabel = \"{name}\"\n"
                            f"points = [{[float(c) for c in case.point(*at)]}]\n"
                            for name, at in (("one", seed), ("two", other_seed))))
        rows.row(case, f"split by {by}, one part", "skimage watershed", recipe, "one",
                 lambda: flood == 1, 0.95)
        rows.row(case, f"split by {by}, other part", "skimage watershed", None, "two",
                 lambda: flood == 2, 0.95)


def ct_rows(rows, case, scan):
    for number, preset in ((1, step(preset="ct-bone")),
                           (2, step(threshold=[-142, 2986], label="bone"))):
        rows.row(case, f"threshold of its mask {number}", "InVesalius 3", preset, "bone",
                 lambda number=number: (scan, number))
    mask_rows(rows, case, 226, 1500)


def mr_rows(rows, case):
    # Ours leaves the brightest thousandth out. scikit-image counts whole numbers one by one, too.
    grey = np.minimum(case.grey, np.quantile(case.grey, 0.999, method="lower"))
    rows.row(case, "preset mr-tissue", "skimage threshold_otsu", step(preset="mr-tissue"), "tissue",
             lambda: grey > filters.threshold_otsu(grey))
    rows.row(case, "preset mr-brain", "skimage threshold_multiotsu", step(preset="mr-brain"), "brain",
             lambda: grey > filters.threshold_multiotsu(grey, 3)[1])
    if os.path.exists(MR_BRAIN):
        head = Case(case.palpate, "brain", MR_BRAIN, case.work)
        # A start, not a result (imaging/README.md): the number is what is known of it.
        rows.row(case, "preset mr-brain, largest", "MRIcron's ch2bet",
                 step(preset="mr-brain", largest=True), "brain", lambda: head.grey > 0, 0.5)
    mask_rows(rows, case, 94, 220)


def shape_rows(rows, palpate, work):
    """Shapes in an oblique scan of 0.6 x 0.8 x 1.1 mm whose masks are formulas."""
    spacing, turn = np.array([0.6, 0.8, 1.1]), math.radians(20)
    axes = np.array([[math.cos(turn), -math.sin(turn), 0], [math.sin(turn), math.cos(turn), 0],
                     [0, 0, 1]])
    z, y, x = np.indices((70, 90, 110))
    apart = lambda cx, cy, cz: np.sqrt(((x - cx) * 0.6) ** 2 + ((y - cy) * 0.8) ** 2
                                       + ((z - cz) * 1.1) ** 2)
    ball = apart(54, 45, 35)
    grey = np.full(ball.shape, -1000, np.int16)
    grey[ball <= 15] = 1000
    grey[ball <= 6] = 0  # a hollow ball
    grey[apart(8, 8, 6) <= 2.5] = 700
    file = pathlib.Path(work) / "shapes.mha"
    write_mha(file, grey, spacing, [-20, 10, 5], axes.T.ravel())
    case = Case(palpate, "shapes", file, work)
    base = step(threshold=[500, 2000], label="bone", largest=True)
    shell = (ball <= 15) & (ball > 6)
    diagonal = float(np.linalg.norm(spacing))  # a counted ball ends within a voxel of the true one

    def row(title, formula, least, worst_mm=None, **keys):
        recipe = base + (step(label="bone", **keys) if keys else "")
        rows.row(case, title, "formula", recipe, "bone", lambda: formula, least, worst_mm)
    row("a hollow ball, largest", shell, EQUAL)
    row("fill holes", ball <= 15, EQUAL, tool="fill-holes")
    # Margins count from voxel centres, up to a voxel beside the formula's surface: of a shell of few
    # voxels that is much of its volume, so that the distance is what is asked of them.
    row("margin, dilate 4 mm", (ball <= 19) & (ball > 2), 0.9, diagonal, tool="margin",
        operation="dilate", mm=4.0)
    row("margin, erode 2 mm", (ball <= 13) & (ball > 8), 0.9, diagonal, tool="margin",
        operation="erode", mm=2.0)
    row("margin, close 7 mm (the hollow goes)", ball <= 15, 0.99, diagonal, tool="margin",
        operation="close", mm=7.0)
    row("smooth 1 mm", shell, 0.97, diagonal, tool="smooth", mm=1.0)
    mask_rows(rows, case, 500, 2000, split=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--palpate", required=True, type=pathlib.Path)
    parser.add_argument("--scan", default=os.environ.get("PALPATE_DEMO_SCAN", CT))
    parser.add_argument("--scans", default="shapes,ct,mr")
    parser.add_argument("--only", default="", help="rows whose scan and tool hold this text")
    chosen = parser.parse_args()
    palpate = chosen.palpate.resolve()
    rows = Rows(chosen.only)
    print("| scan | tool | reference | voxels | Dice | surfaces apart, mm: mean / 95 % / worst |")
    print("| --- | --- | --- | --- | --- | --- |")
    work = tempfile.mkdtemp(prefix="palpate-references-")
    scans = {"ct": ("CT head", chosen.scan, lambda case: ct_rows(rows, case, chosen.scan)),
             "mr": ("MR head", MR, lambda case: mr_rows(rows, case))}
    try:
        for which in chosen.scans.split(","):
            if which == "shapes":
                shape_rows(rows, palpate, work)
                continue
            name, scan, run = scans[which]
            if os.path.exists(scan):
                run(Case(palpate, name, scan, work))
            else:
                print(f"SKIPPED: {name} needs {scan}, which is not here.")
    finally:
        shutil.rmtree(work, ignore_errors=True)
    for what in rows.wrong:
        print(f"FAILED: {what}")
    print(f"{len(rows.lines)} rows, {len(rows.wrong)} failed")
    if rows.wrong:
        return 1
    return 0 if rows.lines else 77


if __name__ == "__main__":
    sys.exit(main())
