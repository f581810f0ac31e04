#!/usr/bin/env python3
"""The one-minute story: a DICOM head is opened in the window, its bone is segmented without islands
and headrest, the mandible is named apart from the skull, and both are touched.

  one_minute_test.py --palpate PROGRAM --data FOLDER [--keep FOLDER]

Drives the window as a user does, by clicks and keys (a gesture is a click, a drag, or a text typed
with its Return), and prints how many there were and how long it took. Then looks at the case with
no eye of Palpate's: the labels' voxels against the scan's values. Ends with 77 (skipped) where the
data or a display is absent.
"""

import argparse
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import zlib

SKIPPED = 77
# A head of 256 x 256 x 108, cut below the mouth: of the mandible it has both rami. The right one's
# condyle is in the coronal slice through the middle, the left ramus is in sight in 3D. Pixels of a
# window of 1280 x 800.
SCAN = "series/ct_head_cranium"
SKULL, RIGHT, LEFT = (1148, 318), (1098, 455), (742, 660)
STORY = f"""
wait-idle
wait 3
click-item Library
wait 3
click-item Path of the scan
text {{scan}}
key enter
wait-idle
wait 5
click-item Largest part only
click-item Segment tissue
wait-idle
wait 5
click-item Split
wait 2
click {SKULL[0]} {SKULL[1]}
click-item Name of part 2
text mandible
wait 2
click {RIGHT[0]} {RIGHT[1]}
wait 2
click {LEFT[0]} {LEFT[1]}
wait 2
click-item Apply Split
wait-idle
wait 5
{{picture_split}}
click-item Touch it
wait-idle
wait 60
{{picture_touch}}
quit
"""


def mha(path):
    """Sizes, little-endian voxels and type of a MetaImage with its data inside."""
    raw = path.read_bytes()
    head, _, body = raw.partition(b"ElementDataFile = LOCAL\n")
    keys = dict(line.split(" = ", 1) for line in head.decode("ascii").splitlines())
    if keys.get("CompressedData") == "True":
        body = zlib.decompress(body)
    return [int(n) for n in keys["DimSize"].split()], body, keys["ElementType"]


def parts(voxels, dims, wanted):
    """Sizes of the 26-connected parts of the voxels in `wanted` (a set of indices)."""
    nx, ny, _ = dims
    steps = [dx + nx * (dy + ny * dz) for dx in (-1, 0, 1) for dy in (-1, 0, 1)
             for dz in (-1, 0, 1) if (dx, dy, dz) != (0, 0, 0)]
    left, sizes = set(wanted), []
    while left:
        front, size = [left.pop()], 0
        while front:
            size += 1
            here = front.pop()
            for step in steps:
                if here + step in left:
                    left.remove(here + step)
                    front.append(here + step)
        sizes.append(size)
    return sorted(sizes, reverse=True)


def check(what, holds, found):
    print(f"{'ok' if holds else 'FAILED'}: {what} ({found})")
    return holds


def look_at(case):
    dims, grey, kind = mha(case / "volume.mha")
    assert kind == "MET_SHORT", kind
    values = struct.unpack(f"<{len(grey) // 2}h", grey)
    label_dims, labels, _ = mha(case / "labels.mha")
    table = (case / "labels.toml").read_text(encoding="utf-8")
    value_of = dict(zip(re.findall(r"name = ['\"](.+?)['\"]", table),
                        map(int, re.findall(r"value = (\d+)", table))))
    good = check("the labels are named", set(value_of) == {"bone", "mandible"}, sorted(value_of))
    if not good:
        return False
    bone = {i for i, v in enumerate(labels) if v == value_of["bone"]}
    mandible = {i for i, v in enumerate(labels) if v == value_of["mandible"]}
    in_range = {i for i, v in enumerate(values) if 226 <= v <= 3071}
    both = bone | mandible
    good &= check("same grid", dims == label_dims, label_dims)
    good &= check("only bone's values", both <= in_range, len(both - in_range))
    whole = parts(labels, dims, in_range)
    good &= check("the largest part of the scan's bone, no island, no headrest",
                  len(both) == whole[0], f"{len(both)} voxels, the scan's parts {whole[:3]}")
    pieces = parts(labels, dims, mandible)
    ml = len(mandible) * 0.9570312 ** 2 * 1.5 / 1000.0
    good &= check("two rami of the mandible", len(pieces) == 2 and min(pieces) > 1000, pieces)
    good &= check("of a mandible's size", 5 < ml < 40, f"{ml:.1f} ml")
    # The rami hang down: nothing of them is near the vertex, most of the skull is above them.
    slices = sorted(i // (dims[0] * dims[1]) for i in mandible)
    good &= check("below the skull base", slices[-1] < dims[2] // 2, f"slices {slices[0]} to {slices[-1]}")
    return good


def rebuilt(palpate, case, again):
    """The recipe that the window kept makes the same labels from the scan alone."""
    shutil.copytree(case, again, ignore=shutil.ignore_patterns("labels.*", "*.cache", "segment.toml"))
    subprocess.run([palpate, "segment", str(again), "--recipe", str(case / "segment.toml")],
                   capture_output=True, timeout=120, check=True)
    return check("rebuilt from its recipe, equal to the last voxel",
                 mha(again / "labels.mha") == mha(case / "labels.mha"), "segment.toml")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--palpate", required=True)
    parser.add_argument("--data", required=True)
    parser.add_argument("--keep", help="folder for screenshots")
    options = parser.parse_args()
    scan = pathlib.Path(options.data).resolve() / SCAN
    if not scan.is_dir():
        print(f"skipped: {SCAN} is not in {options.data}")
        return SKIPPED
    if not os.environ.get("DISPLAY"):
        print("skipped: there is no display (DISPLAY is not set)")
        return SKIPPED
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        shots = pathlib.Path(options.keep) if options.keep else folder
        story = STORY.format(scan=scan, picture_split=f"screenshot {shots}/one_minute_split.png",
                             picture_touch=f"screenshot {shots}/one_minute_touch.png")
        (folder / "story.txt").write_text(story, encoding="utf-8")
        gestures = len(re.findall(r"^(click|click-item|drag|text) ", story, re.M)) \
            - len(re.findall(r"^click-item (Path of the scan|Name of part 2)$", story, re.M))
        began = time.monotonic()
        done = subprocess.run(
            [options.palpate, "--demo-hand", "--ui-script",
             str(folder / "story.txt"), "--width", "1280", "--height", "800"],
            env={**os.environ, "XDG_DATA_HOME": str(folder / "home")}, capture_output=True,
            text=True, timeout=300, check=False)
        took = time.monotonic() - began
        if done.returncode != 0:
            sys.exit(f"palpate ended with {done.returncode}: {done.stderr.strip()}")
        cases = [c.parent for c in (folder / "home").rglob("case.toml")
                 if (c.parent / "labels.toml").exists() and "ct_head" not in c.parent.name]
        cases = [c for c in cases if "mandible" in (c / "labels.toml").read_text(encoding="utf-8")]
        print(f"{gestures} gestures, {took:.1f} s with the program's start and end")
        good = check("one case", len(cases) == 1, [c.name for c in cases])
        good &= check("at most a dozen gestures", gestures <= 12, gestures)
        if good:
            good &= look_at(cases[0])
            good &= rebuilt(options.palpate, cases[0], folder / "again")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
