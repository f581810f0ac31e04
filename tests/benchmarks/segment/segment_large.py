#!/usr/bin/env python3
"""Every segmentation tool on a large CT: wall time and peak memory of the whole command.

  segment_large.py --palpate PROGRAM [--source SCAN] [--size 512 512 800] [--only TEXT] [--most 3]

Makes a CT of that size from SCAN (anything that palpate imports; without it Debian's demo head):
voxels are repeated in each slice until it is wide enough, slices go up and down again. Each tool is
one step of a recipe of its own, on the same labels: bone by 226 HU and up, metal and enamel above
1500. Prints a Markdown table; memory is in volumes of SIZE at two bytes a voxel. Ends with 1 where a
tool needs more than MOST volumes, which is what Palpate promises. Needs python3-numpy.
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
import time

try:
    import numpy as np
except ImportError:
    sys.exit("segment_large: needs Debian's python3-numpy.")

DEMO = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3"


def peak_bytes(pid):
    """High-water mark of a running process; ru_maxrss would count this program's own pages."""
    try:
        with open(f"/proc/{pid}/status", encoding="ascii") as status:
            return next((int(l.split()[1]) * 1024 for l in status if l.startswith("VmHWM")), 0)
    except OSError:
        return 0


def run(*command):
    """What the command says (JSON), wall seconds and peak bytes."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as words:
        begin = time.monotonic()
        process = subprocess.Popen([*map(str, command), "--json"], stdout=out, stderr=words)
        peak = 0
        while process.poll() is None:
            peak = max(peak, peak_bytes(process.pid))
            time.sleep(0.002)
        seconds = time.monotonic() - begin
        if process.returncode != 0:
            words.seek(0)
            raise RuntimeError(words.read().decode(errors="replace").strip().splitlines()[-1])
        out.seek(0)
        return json.load(out), seconds, peak


def voxels_of(case):
    """The grey values of a case as z, y, x: they are the last bytes of volume.mha, stored plain."""
    data = np.memmap(case / "volume.mha", "u1", "r")
    head = bytes(data[:4096]).split(b"ElementDataFile", 1)[0].decode()
    dims = next(l for l in head.splitlines() if l.startswith("DimSize")).split("=")[1].split()
    shape = [int(n) for n in dims][::-1]
    if "MET_SHORT" not in head:
        sys.exit("segment_large: the source has other values than int16.")
    return np.frombuffer(data[data.size - 2 * math.prod(shape):], "<i2").reshape(shape)


def write_large(path, grey, size, spacing):
    """Slice by slice, so that this program stays small."""
    nx, ny, nz = size
    repeat = [max(1, math.ceil(side / have)) for side, have in zip((ny, nx), grey.shape[1:])]
    lines = ["ObjectType = Image", "NDims = 3", "BinaryData = True", "BinaryDataByteOrderMSB = False",
             "CompressedData = False", "TransformMatrix = 1 0 0 0 1 0 0 0 1", "Offset = 0 0 0",
             f"ElementSpacing = {spacing[0] / repeat[1]} {spacing[1] / repeat[0]} {spacing[2]}",
             f"DimSize = {nx} {ny} {nz}", "ElementType = MET_SHORT", "ElementDataFile = LOCAL"]
    with open(path, "wb") as file:
        file.write(("\n".join(lines) + "\n").encode())
        for k in range(nz):
            turn = k % (2 * len(grey))
            plane = grey[min(turn, 2 * len(grey) - 1 - turn)]
            plane = plane.repeat(repeat[0], 0).repeat(repeat[1], 1)[:ny, :nx]
            if plane.shape != (ny, nx):
                sys.exit("segment_large: the source's slices are larger than the size asked for.")
            file.write(np.ascontiguousarray(plane).tobytes())
    return np.array([spacing[0] / repeat[1], spacing[1] / repeat[0], spacing[2]])


def step(**keys):
    def text(value):
        if isinstance(value, bool):
            return str(value).lower()
        if isinstance(value, (list, tuple, np.ndarray)):
            return "[" + ", ".join(text(v) for v in value) + "]"
        return json.dumps(value) if isinstance(value, str) else repr(value)
    return "[[step]]\n" + "".join(f"{k} = {text(v)}\n" for k, v in keys.items())


def steps(size_mm, seeds):
    """Name and recipe of every tool. Positions are fractions of the scan."""
    at = lambda *share: [float(s * f) for s, f in zip(size_mm, share)]
    bone = lambda tool, **keys: step(tool=tool, label="bone", **keys)
    yield "threshold, preset ct-bone", step(preset="ct-bone")
    yield "threshold, all there is", step(threshold=[-32768, 32767], label="bone")
    yield "threshold, largest, 10 mm³", step(preset="ct-bone", largest=True, min_mm3=10.0)
    yield "threshold, soft tissue, largest", step(threshold=[-200, 225], label="soft", largest=True)
    yield "grow from a seed", bone("grow", seeds=seeds[:1], threshold=[226.0, 3071.0])
    yield "grow within 40 mm", bone("grow", seeds=seeds[:1], threshold=[-500.0, 3071.0],
                                    reach_mm=40.0)
    yield "islands, largest", bone("islands", keep="largest")
    yield "islands, 100 mm³", bone("islands", keep="at-least", min_mm3=100.0)
    yield "fill holes", bone("fill-holes")
    for operation, mm in (("dilate", 2.0), ("erode", 1.0), ("open", 1.0), ("close", 2.0)):
        yield f"margin, {operation} {mm:g} mm", bone("margin", operation=operation, mm=mm)
    yield "margin, dilate 20 mm", bone("margin", operation="dilate", mm=20.0)
    yield "smooth 1 mm", bone("smooth", mm=1.0)
    yield "smooth 1 mm, keep_thin off", bone("smooth", mm=1.0, keep_thin=False)
    yield "smooth 5 mm", bone("smooth", mm=5.0)
    yield "box", bone("box", low=at(0.2, 0.2, 0.2), high=at(0.8, 0.8, 0.8))
    yield "box, all labels", bone("box", low=at(0.2, 0.2, 0.2), high=at(0.8, 0.8, 0.8),
                                  keep_inside=True, all_labels=True)
    circle = [[at(0.5, 0, 0)[0] + 50 * math.cos(a / 50), at(0, 0, 0.5)[2] + 50 * math.sin(a / 50)]
              for a in range(314)]
    yield "scissors, 314 corners", bone("scissors", outline=circle,
                                        view=[1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    path = [at(0.3 + 0.004 * i, 0.4, 0.3 + 0.004 * i) for i in range(100)]
    yield "brush, 100 points, 5 mm", bone("brush", path=path, radius_mm=5.0)
    parts = "".join(f"[[step.seeds]]\nlabel = \"part{i}\"\npoints = [{seed}]\n"
                    for i, seed in enumerate(seeds))
    for by in ("brightness", "edges"):
        yield f"split by {by}", bone("split", by=by) + parts
    for operation in ("add", "subtract", "intersect"):
        yield f"combine, {operation}, grown 3 mm", bone("combine", operation=operation,
                                                       other="dense", grown_mm=3.0)
    yield "remove", bone("remove")


def brightest(grey, size, spacing):
    """Two far bone voxels of the large scan, mm: bright, since floods give nothing to dark seeds."""
    nx, ny, _ = size
    repeat = [math.ceil(nx / grey.shape[2]), math.ceil(ny / grey.shape[1])]
    seeds = []
    for k in (len(grey) // 3, 2 * len(grey) // 3):
        y, x = np.unravel_index(np.where(grey[k] <= 1500, grey[k], -2000).argmax(), grey[k].shape)
        seeds.append([float(s * v) for s, v in zip(spacing, (x * repeat[0], y * repeat[1], k))])
    return seeds


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--palpate", required=True, type=pathlib.Path)
    parser.add_argument("--source", default=os.environ.get("PALPATE_DEMO_SCAN", DEMO))
    parser.add_argument("--size", type=int, nargs=3, default=[512, 512, 800])
    parser.add_argument("--only", default="", help="tools whose name holds this text")
    parser.add_argument("--most", type=float, default=3.0, help="volumes that a tool may need")
    chosen = parser.parse_args()
    palpate, size = chosen.palpate.resolve(), chosen.size
    volume = 2 * math.prod(size)
    failed = []
    work = pathlib.Path(tempfile.mkdtemp(prefix="palpate-segment-large-"))
    try:
        said, _, _ = run(palpate, "import", chosen.source, "--out", work / "source")
        grey = voxels_of(work / "source")
        spacing = write_large(work / "large.mha", grey, size, said["spacing_mm"])
        seeds = brightest(grey, size, spacing)
        print(f"{' x '.join(map(str, size))} voxels of {' x '.join(f'{s:.3f}' for s in spacing)} mm, "
              f"{volume / 2 ** 20:.0f} MiB\n")
        print("| tool | wall time, s | peak memory, volumes | voxels of the label after it |")
        print("| --- | --- | --- | --- |")

        def report(name, seconds, peak, note):
            over = peak > chosen.most * volume
            if over:
                failed.append(f"{name}: {peak / volume:.2f} volumes")
            print(f"| {name} | {seconds:.1f} | {peak / volume:.2f}{' (!)' if over else ''} | {note} |",
                  flush=True)
        _, seconds, peak = run(palpate, "import", work / "large.mha", "--out", work / "case")
        report("(import)", seconds, peak, "")
        (work / "large.mha").unlink()
        recipe, case = work / "recipe.toml", work / "case"
        recipe.write_text(step(preset="ct-bone") + step(threshold=[1501, 32767], label="dense"))
        run(palpate, "segment", case, "--recipe", recipe)
        for name in ("labels.mha", "labels.toml"):
            shutil.copy(case / name, work / name)
        for name, text in steps(np.array(size) * spacing, seeds):
            if chosen.only not in name:
                continue
            for file in ("labels.mha", "labels.toml"):
                shutil.copy(work / file, case / file)
            (case / "segment.toml").unlink(missing_ok=True)
            recipe.write_text(text)
            try:
                said, seconds, peak = run(palpate, "segment", case, "--recipe", recipe)
            except RuntimeError as error:
                failed.append(f"{name}: {error}")
                print(f"| {name} | refused | | {error} |", flush=True)
                continue
            row = next((r for r in said["labels"] if r["name"] == "bone"), {"voxels": 0})
            report(name, seconds, peak, f"{row['voxels']:,}")
        if chosen.only in "(compare)":
            for file in ("labels.mha", "labels.toml"):
                shutil.copy(work / file, case / file)
            _, seconds, peak = run(palpate, "compare", case, "--label", "bone", "--reference",
                                   work / "labels.mha", "--reference-label", 1)
            report("(compare)", seconds, peak, "")
    finally:
        shutil.rmtree(work, ignore_errors=True)
    for what in failed:
        print(f"FAILED: {what}")
    print(f"at most {chosen.most:g} volumes: {'no' if failed else 'yes'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
