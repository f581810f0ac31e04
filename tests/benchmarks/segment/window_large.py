#!/usr/bin/env python3
"""The window on a large CT: how long its main thread is held up, and its memory.

  window_large.py --palpate PROGRAM [--source SCAN] [--size 512 512 800] [--case CASE] [--pictures FOLDER]

Makes the case as segment_large.py does (or takes CASE, whose labels are removed), opens it in the
window and drives it by a script: preview and step of several tools, a brush stroke, undo and redo,
edits of the table, and Cancel in the middle of each long tool. Prints of each phase how long work
ran beside the window, the longest frame, what of it was the program's own and what drawing (each
its longest), and the peak of memory in volumes of SIZE at two bytes a voxel. Textures are of that
memory where the processor draws (llvmpipe). Needs python3-numpy and a display; another folder for
the user's files is best: XDG_DATA_HOME=FOLDER.
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

import segment_large

NEXT = "wait 10\nwait-idle\nwait 5\n"


def apply(tool):
    """The preview of a tool as it is set, then the step."""
    return (f"phase {tool}, preview\nclick-item {tool}\n{NEXT}"
            f"phase {tool}, applied\nclick-item Apply {tool}\n{NEXT}")


def cancel(tool, pictures):
    """Without a preview: Cancel while the tool runs."""
    picture = f"screenshot {pictures}/{tool.replace(' ', '-')}.png\n" if pictures else ""
    return (f"phase {tool}, runs\nclick-item {tool}\nwait 5\nclick-item Apply {tool}\n"
            f"wait 10\n{picture}phase {tool}, cancelled\nclick-item Cancel\n{NEXT}")


def script(pictures):
    yield f"phase open\n{NEXT}"
    yield f"phase Threshold, applied\nclick-item Segment tissue\n{NEXT}"
    if pictures:
        yield f"screenshot {pictures}/labelled.png\n"
    yield "phase scroll a slice\nmove 1130 150\n" + "wheel 1\nwait 3\n" * 5 + "wait 5\n"
    yield f"phase no preview\nclick-item Margin\nclick-item Preview\n{NEXT}"
    for tool in ("Margin", "Smooth", "Islands", "Fill holes"):
        yield cancel(tool, pictures)
    yield "phase preview again\nclick-item Preview\nwait 2\n"
    yield "phase turn the 3D view\ndrag 500 300 560 320\nwait 30\n"
    yield apply("Islands")
    yield f"phase brush stroke\nclick-item Paint\nwait 3\ndrag 1130 150 1160 170\n{NEXT}"
    yield f"phase undo\nhold ctrl\nkey z\nlet ctrl\n{NEXT}"
    yield f"phase redo\nhold ctrl\nkey y\nlet ctrl\n{NEXT}"
    yield f"phase hide\nclick-item Hide bone\n{NEXT}"
    yield f"phase show\nclick-item Show bone\n{NEXT}"
    yield "phase edit opened\nclick-item Name, colour, material of bone\nwait 5\n"
    yield f"phase colour\nclick-item Colour 5\n{NEXT}"
    yield ("phase name\nclick-item Name of bone\nwait 2\nhold ctrl\nkey a\nlet ctrl\nwait 2\n"
           f"text skull\nwait 2\nkey enter\n{NEXT}")
    yield f"phase undo of the name\nhold ctrl\nkey z\nlet ctrl\n{NEXT}"
    yield "phase undo, runs\nhold ctrl\nkey z\nlet ctrl\nwait 8\n"
    yield f"phase undo, cancelled\nclick-item Cancel\n{NEXT}"
    yield f"phase close\n{NEXT}quit\n"


def made(palpate, source, size, work):
    said, _, _ = segment_large.run(palpate, "import", source, "--out", work / "source")
    grey = segment_large.voxels_of(work / "source")
    segment_large.write_large(work / "large.mha", grey, size, said["spacing_mm"])
    segment_large.run(palpate, "import", work / "large.mha", "--out", work / "case")
    (work / "large.mha").unlink()
    return work / "case"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--palpate", required=True, type=pathlib.Path)
    parser.add_argument("--source", default=os.environ.get("PALPATE_DEMO_SCAN", segment_large.DEMO))
    parser.add_argument("--size", type=int, nargs=3, default=[512, 512, 800])
    parser.add_argument("--case", type=pathlib.Path)
    parser.add_argument("--pictures", type=pathlib.Path, help="folder for screenshots")
    chosen = parser.parse_args()
    palpate = chosen.palpate.resolve()
    pictures = chosen.pictures.resolve() if chosen.pictures else None
    if pictures:
        pictures.mkdir(parents=True, exist_ok=True)
    mib = 2 * math.prod(chosen.size) / 2 ** 20
    work = pathlib.Path(tempfile.mkdtemp(prefix="palpate-window-large-"))
    try:
        case = chosen.case or made(palpate, chosen.source, chosen.size, work)
        for name in ("labels.mha", "labels.toml", "segment.toml"):
            (case / name).unlink(missing_ok=True)
        (work / "script.txt").write_text("".join(script(pictures)), encoding="utf-8")
        done = subprocess.run([palpate, "--case", case, "--task", "segment", "--ui-script",
                               work / "script.txt", "--frame-report", work / "frames.json"],
                              capture_output=True, text=True, timeout=3600, check=False)
        if done.returncode != 0:
            sys.exit(f"palpate ended with {done.returncode}: {done.stderr.strip()}")
        phases = json.loads((work / "frames.json").read_text(encoding="utf-8"))["phases"]
    finally:
        shutil.rmtree(work, ignore_errors=True)
    print("| phase | work beside it, s | longest frame, ms | ours | drawing | frames over 50 ms "
          "| peak memory, volumes |\n| --- | --- | --- | --- | --- | --- | --- |")
    for p in phases:
        print(f"| {p['name']} | {p['busy_s']:.1f} | {p['frame_ms']:.0f} | {p['ours_ms']:.0f} | "
              f"{p['drawing_ms']:.0f} | {p['frames_over_50_ms']} of {p['frames']} | "
              f"{p['peak_MiB'] / mib:.2f} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
