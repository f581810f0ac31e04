#!/usr/bin/env python3
"""Importing a large CT: palpate against dcm2niix, in turn, on the same folder.

    import_speed.py --palpate PROGRAM [--source FOLDER] [--slices 400] [--runs 7] [--compress TOOL]

Makes a series of SLICES slices of 512 x 512 (pixels of the DICOM files in FOLDER over and over, one
every millimetre; without it, a noisy ellipse), then runs both programs RUNS times, each first in
every other round. Prints wall time (p50, worst), the peak of memory in volumes, and the ratios.
--compress names a program of Debian's dcmtk that compresses a file ("dcmcjpeg", "dcmcrle",
"dcmcjpls"). Both results are compared voxel by voxel before anything is timed.
"""
import argparse
import array
import hashlib
import json
import os
import random
import shutil
import statistics
import struct
import subprocess
import sys
import tempfile
import time

SIDE = 512
VOLUME_BYTES = SIDE * SIDE * 2
ROOT = "1.2.826.0.1.3680043.10.511"


def element(group, number, vr, value):
    if isinstance(value, str):
        value = value.encode() + (b"\0" if vr == "UI" else b" ") * (len(value) % 2)
    long_form = vr in ("OB", "OW", "SQ", "UN")
    head = struct.pack("<HH2s", group, number, vr.encode())
    head += struct.pack("<HI", 0, len(value)) if long_form else struct.pack("<H", len(value))
    return head + value


def short(number):
    return struct.pack("<H", number)


def dicom_file(index, pixels):
    uid = f"{ROOT}.3.{index + 1}"
    meta = (element(2, 1, "OB", b"\0\1") + element(2, 2, "UI", "1.2.840.10008.5.1.4.1.1.2")
            + element(2, 3, "UI", uid) + element(2, 0x10, "UI", "1.2.840.10008.1.2.1")
            + element(2, 0x12, "UI", ROOT))
    body = [
        (8, 8, "CS", "ORIGINAL\\PRIMARY\\AXIAL"), (8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2"),
        (8, 0x18, "UI", uid), (8, 0x60, "CS", "CT"), (8, 0x70, "LO", "Benchmark"),
        (0x10, 0x10, "PN", "Benchmark"), (0x10, 0x20, "LO", "1"), (0x18, 0x50, "DS", "1"),
        (0x20, 0xD, "UI", ROOT + ".1"), (0x20, 0xE, "UI", ROOT + ".2"),
        (0x20, 0x11, "IS", "1"), (0x20, 0x13, "IS", str(index + 1)),
        (0x20, 0x32, "DS", f"-180\\-180\\{index}"), (0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0"),
        (0x20, 0x52, "UI", ROOT + ".4"), (0x28, 2, "US", short(1)),
        (0x28, 4, "CS", "MONOCHROME2"), (0x28, 0x10, "US", short(SIDE)),
        (0x28, 0x11, "US", short(SIDE)), (0x28, 0x30, "DS", "0.703125\\0.703125"),
        (0x28, 0x100, "US", short(16)), (0x28, 0x101, "US", short(12)),
        (0x28, 0x102, "US", short(11)), (0x28, 0x103, "US", short(0)),
        (0x28, 0x1052, "DS", "-1024"), (0x28, 0x1053, "DS", "1"), (0x7FE0, 0x10, "OW", pixels)]
    group2 = element(2, 0, "UL", struct.pack("<I", len(meta))) + meta
    return b"\0" * 128 + b"DICM" + group2 + b"".join(element(*e) for e in body)


def pixels_of(folder):
    """The last 512 x 512 words of each file: pixel data comes last."""
    planes = []
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), "rb") as file:
            data = file.read()
        at = data.rfind(b"\xe0\x7f\x10\x00")
        if at < 0 or len(data) - at < VOLUME_BYTES:
            continue
        words = array.array("H", data[len(data) - VOLUME_BYTES:])
        planes.append(array.array("H", [w & 4095 for w in words]).tobytes())
    if not planes:
        sys.exit(f"import_speed: no plain 512 x 512 images in {folder}.")
    return planes


def ellipse(seed):
    rng = random.Random(seed)
    words = array.array("H", bytes(VOLUME_BYTES))
    for y in range(SIDE):
        for x in range(SIDE):
            inside = ((x - 256) / 200) ** 2 + ((y - 256) / 150) ** 2 < 1
            words[y * SIDE + x] = (1064 if inside else 24) + int(rng.gauss(0, 12)) % 64
    return words.tobytes()


def make_series(folder, slices, planes, compress):
    os.makedirs(folder)
    for index in range(slices):
        path = os.path.join(folder, f"{index:05d}")
        with open(path, "wb") as file:
            file.write(dicom_file(index, planes[index % len(planes)]))
        if compress:
            subprocess.run([compress, path, path + ".c"], check=True)
            os.replace(path + ".c", path)


def peak_bytes(pid):
    """High-water mark of a running process; ru_maxrss would count this program's own pages."""
    try:
        with open(f"/proc/{pid}/status", encoding="ascii") as status:
            return next((int(l.split()[1]) * 1024 for l in status if l.startswith("VmHWM")), 0)
    except OSError:
        return 0


def run(command):
    """Wall seconds and peak bytes of a command that must succeed."""
    with tempfile.TemporaryFile() as words:
        begin = time.monotonic()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=words)
        peak = 0
        while process.poll() is None:
            peak = max(peak, peak_bytes(process.pid))
            time.sleep(0.005)
        seconds = time.monotonic() - begin
        if process.returncode != 0:
            words.seek(0)
            sys.exit(f"import_speed: {command[0]} failed: {words.read().decode(errors='replace')}")
    return seconds, peak


def nifti_voxels(path, slices):
    """Voxels of a NIfTI whose rows dcm2niix has put upside down, as Palpate orders them."""
    with open(path, "rb") as file:
        data = file.read()
    offset = int(struct.unpack_from("<f", data, 108)[0])
    slope, intercept = struct.unpack_from("<ff", data, 112)
    voxels = array.array("h", data[offset:offset + slices * VOLUME_BYTES])
    out = array.array("h")
    for k in range(slices):
        for y in reversed(range(SIDE)):
            at = (k * SIDE + y) * SIDE
            out.extend(voxels[at:at + SIDE])
    if (slope, intercept) not in ((1.0, 0.0), (0.0, 0.0)):
        out = array.array("h", [int(v * slope + intercept) for v in out])
    return out


def same_voxels(palpate, scan, work, slices):
    out = subprocess.run([palpate, "import", scan, "--out", work + "/checked", "--json"],
                         check=True, capture_output=True, text=True).stdout
    os.makedirs(work + "/nifti-checked")
    subprocess.run(["dcm2niix", "-z", "n", "-b", "n", "-f", "x", "-o", work + "/nifti-checked", scan],
                   check=True, stdout=subprocess.DEVNULL)
    name = next(n for n in os.listdir(work + "/nifti-checked") if n.endswith(".nii"))
    other = nifti_voxels(f"{work}/nifti-checked/{name}", slices)
    return json.loads(out)["voxels_sha256"] == hashlib.sha256(other.tobytes()).hexdigest()


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--palpate", required=True)
    parser.add_argument("--source")
    parser.add_argument("--slices", type=int, default=400)
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--compress")
    chosen = parser.parse_args()
    if shutil.which("dcm2niix") is None:
        sys.exit("import_speed: dcm2niix is missing; install Debian's package dcm2niix.")
    planes = pixels_of(chosen.source) if chosen.source else [ellipse(s) for s in range(4)]
    with tempfile.TemporaryDirectory() as work:
        scan = work + "/scan"
        make_series(scan, chosen.slices, planes, chosen.compress)
        if not same_voxels(chosen.palpate, scan, work, chosen.slices):
            sys.exit("import_speed: the two programs give different voxels.")
        times = {"palpate": [], "dcm2niix": []}
        peaks = {"palpate": 0, "dcm2niix": 0}
        for turn in range(chosen.runs):
            case, nifti = f"{work}/case{turn}", f"{work}/nifti{turn}"
            os.makedirs(nifti)
            commands = [
                ("palpate", [chosen.palpate, "import", scan, "--out", case]),
                ("dcm2niix", ["dcm2niix", "-z", "n", "-f", "x", "-o", nifti, scan])]
            for name, command in commands if turn % 2 == 0 else reversed(commands):
                seconds, peak = run(command)
                times[name].append(seconds)
                peaks[name] = max(peaks[name], peak)
            shutil.rmtree(case)
            shutil.rmtree(nifti)
    volume = chosen.slices * VOLUME_BYTES
    print(f"{chosen.slices} slices of 512 x 512, {volume / 2 ** 20:.0f} MiB, {chosen.runs} runs each; "
          "equal voxels")
    for name, t in times.items():
        print(f"{name:9} p50 {statistics.median(t):6.3f} s  worst {max(t):6.3f} s  "
              f"memory {peaks[name] / volume:5.2f} volumes")
    ratio = statistics.median(a / b for a, b in zip(times["palpate"], times["dcm2niix"]))
    print(f"time of palpate / dcm2niix, median over the rounds: {ratio:.2f}")


if __name__ == "__main__":
    main()
