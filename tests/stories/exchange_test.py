#!/usr/bin/env python3
"""A DICOM segmentation of a case, read by others: pydicom and dicom3tools' dciodvfy.

  exchange_test.py --palpate PROGRAM [--seed N]

Writes an oblique CT of odd sizes by pydicom, imports and segments it, exports the labels and compares
the file's geometry, frames, pixels, codes and colours with the case's own label volume; then takes
the file back into the case. No name of the patient may be in what is exported, though the case keeps
it. Ends with 77 where pydicom is not there.
"""

import argparse
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import zlib

try:
    import pydicom
except ImportError:
    # Debian's package belongs to Debian's interpreter, which need not be the first in the path.
    if sys.executable != "/usr/bin/python3" and os.path.exists("/usr/bin/python3"):
        os.execv("/usr/bin/python3", ["/usr/bin/python3", "-B", *sys.argv])
    print("skipped: python3-pydicom is not installed")
    sys.exit(77)

from pydicom.dataset import FileDataset, FileMetaDataset
from pydicom.sr._concepts_dict import concepts
from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid

COLUMNS, ROWS, SLICES = 7, 5, 9
SPACING = (0.859375, 0.71, 1.3)  # Along row, along column, between slices; mm.
ORIGIN = (-81.237, 112.5, 63.0417)
BONE, NERVE = "bone", "Nervus facialis dexter"
SECRETS = (b"quince", b"medlar")
# One voxel of the case in the file and in memory is one place: what DICOM's 16 digits leave.
SAME_MM = 1e-6


def rotation(yaw, pitch, roll):
    """Columns are the axes: a right-handed frame, oblique to the patient."""
    cy, sy, cp, sp, cr, sr = (f(a) for a in (yaw, pitch, roll) for f in (math.cos, math.sin))
    return ((cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
            (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
            (-sp, cp * sr, cp * cr))


AXES = rotation(0.4, -1.1, 2.3)


def place(i, j, k):
    return [ORIGIN[r] + sum(AXES[r][a] * SPACING[a] * n for a, n in enumerate((i, j, k)))
            for r in range(3)]


def decimal(value):
    return f"{value:.12g}"[:16]


def write_slice(file, values, k, series, study):
    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = CTImageStorage
    meta.MediaStorageSOPInstanceUID = generate_uid()
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    image = FileDataset(str(file), {}, file_meta=meta, preamble=b"\0" * 128)
    image.SOPClassUID = CTImageStorage
    image.SOPInstanceUID = meta.MediaStorageSOPInstanceUID
    image.SeriesInstanceUID, image.StudyInstanceUID = series, study
    image.Modality = "CT"
    image.PatientName, image.PatientID = "quince^medlar", "medlar-4711"
    image.InstanceNumber = str(k + 1)
    image.ImagePositionPatient = [decimal(c) for c in place(0, 0, k)]
    image.ImageOrientationPatient = [decimal(AXES[r][a]) for a in (0, 1) for r in range(3)]
    image.PixelSpacing = [str(SPACING[1]), str(SPACING[0])]
    image.SliceThickness = str(SPACING[2])
    image.Rows, image.Columns = ROWS, COLUMNS
    image.SamplesPerPixel, image.PhotometricInterpretation = 1, "MONOCHROME2"
    image.BitsAllocated, image.BitsStored, image.HighBit = 16, 16, 15
    image.PixelRepresentation = 1
    image.RescaleSlope, image.RescaleIntercept = "1", "0"
    image.PixelData = b"".join(v.to_bytes(2, "little", signed=True) for v in values)
    image.is_little_endian, image.is_implicit_VR = True, False
    image.save_as(str(file), write_like_original=False)


def write_series(folder, seed):
    choice = random.Random(seed)
    series, study = generate_uid(), generate_uid()
    folder.mkdir()
    for k in range(SLICES):
        # The fifth slice holds nothing, so that a frame is left out; a block that is thick enough to
        # have a surface is bone.
        values = [-1000 if k == 4 else 700 if k < 4 and i % COLUMNS < 4 else
                  choice.choice((-1000, 40, 700)) for i in range(ROWS * COLUMNS)]
        write_slice(folder / f"{k}.dcm", values, k, series, study)


def palpate(program, *arguments):
    done = subprocess.run([program, *map(str, arguments), "--json"], capture_output=True, text=True,
                          timeout=120)
    if done.returncode != 0:
        sys.exit(f"palpate {' '.join(map(str, arguments))}: {done.returncode}\n{done.stderr}")
    return json.loads(done.stdout)


def read_labels(file):
    """labels.mha of a case: voxels, and the patient position (mm) of a voxel."""
    head, _, data = file.read_bytes().partition(b"ElementDataFile = LOCAL\n")
    fields = dict(line.split(" = ", 1) for line in head.decode().splitlines() if " = " in line)
    numbers = {name: [float(v) for v in fields[name].split()]
               for name in ("TransformMatrix", "Offset", "ElementSpacing", "DimSize")}
    voxels = zlib.decompress(data)
    assert numbers["DimSize"] == [COLUMNS, ROWS, SLICES], numbers["DimSize"]

    def position(i, j, k):
        return [numbers["Offset"][r] + sum(numbers["TransformMatrix"][3 * a + r] *
                                           numbers["ElementSpacing"][a] * n
                                           for a, n in enumerate((i, j, k))) for r in range(3)]
    return voxels, position


def segment_values(labels_toml):
    """Names and values of labels.toml, which is of one form."""
    rows, name, value = {}, None, None
    for line in labels_toml.read_text(encoding="utf-8").splitlines():
        key, _, text = line.partition(" = ")
        if key.strip() == "name":
            name = text.strip().strip("'\"")
        if key.strip() == "value":
            value = int(text)
        if name is not None and value is not None:
            rows[name], name, value = value, None, None
    return rows


def bit(pixels, n):
    return pixels[n // 8] >> (n % 8) & 1


def compare(seg, case, wrong):
    voxels, position = read_labels(case / "labels.mha")
    values = segment_values(case / "labels.toml")
    names = {s.SegmentNumber: s.SegmentLabel for s in seg.SegmentSequence}
    if set(names.values()) != set(values):
        wrong.append(f"segments {names} for labels {values}")
        return
    shared = seg.SharedFunctionalGroupsSequence[0]
    row, column = (shared.PlaneOrientationSequence[0].ImageOrientationPatient[a:a + 3]
                   for a in (0, 3))
    down, along = shared.PixelMeasuresSequence[0].PixelSpacing
    seen = set()
    for n, frame in enumerate(seg.PerFrameFunctionalGroupsSequence):
        corner = frame.PlanePositionSequence[0].ImagePositionPatient
        number = frame.SegmentIdentificationSequence[0].ReferencedSegmentNumber
        k = min(range(SLICES), key=lambda z: math.dist(position(0, 0, z), corner))
        seen.add((number, k))
        if list(frame.FrameContentSequence[0].DimensionIndexValues)[0] != number:
            wrong.append(f"frame {n}: the first index is not the segment")
        for j in range(ROWS):
            for i in range(COLUMNS):
                centre = [corner[r] + row[r] * along * i + column[r] * down * j for r in range(3)]
                if math.dist(centre, position(i, j, k)) > SAME_MM:
                    wrong.append(f"frame {n}: pixel {i},{j} is not where the voxel is")
                    return
                expected = voxels[(k * ROWS + j) * COLUMNS + i] == values[names[number]]
                if bit(seg.PixelData, (n * ROWS + j) * COLUMNS + i) != expected:
                    wrong.append(f"frame {n}: pixel {i},{j} differs from the label")
                    return
    needed = {(number, z) for number, name in names.items() for z in range(SLICES)
              if values[name] in voxels[z * ROWS * COLUMNS:(z + 1) * ROWS * COLUMNS]}
    if seen != needed:
        wrong.append(f"frames {sorted(seen)}, needed {sorted(needed)}")
    if seg.NumberOfFrames != len(seg.PerFrameFunctionalGroupsSequence):
        wrong.append("NumberOfFrames is not the number of frames")


def look_at_header(seg, wrong):
    expected = {"Modality": "SEG", "SegmentationType": "BINARY", "BitsAllocated": 1,
                "Rows": ROWS, "Columns": COLUMNS, "PatientIdentityRemoved": "YES"}
    for name, value in expected.items():
        if seg.get(name) != value:
            wrong.append(f"{name} is {seg.get(name)}, not {value}")
    if not str(seg.PatientName).startswith("Case-") or str(seg.PatientName) != seg.PatientID:
        wrong.append("the patient is not called by the pseudonym alone")
    known = {code for rows in concepts["SCT"].values() for code in rows}
    for segment in seg.SegmentSequence:
        if segment.SegmentAlgorithmType != "SEMIAUTOMATIC":
            wrong.append("the algorithm type is not SEMIAUTOMATIC")
        if len(segment.RecommendedDisplayCIELabValue) != 3:
            wrong.append("no colour")
        for code in (segment.SegmentedPropertyCategoryCodeSequence[0],
                     segment.SegmentedPropertyTypeCodeSequence[0]):
            if code.CodingSchemeDesignator != "SCT" or code.CodeValue not in known:
                wrong.append(f"{code.CodeValue} ({code.CodeMeaning}) is no code that pydicom knows")
    types = {s.SegmentLabel: s.SegmentedPropertyTypeCodeSequence[0].CodeMeaning
             for s in seg.SegmentSequence}
    if types != {BONE: "Bone", NERVE: "Tissue"}:
        wrong.append(f"types {types}")


def check_foreign(program, folder, wrong):
    """A liver by dcmqi, of pydicom's own test files, into a case of the grid that it states."""
    source = pathlib.Path(pydicom.__file__).parent / "data/test_files/liver_1frame.dcm"
    if not source.exists():
        print("pydicom's liver_1frame.dcm is not there: no segmentation of another program")
        return
    seg = pydicom.dcmread(str(source))
    # The file is one frame of three, though it still describes them all.
    frame = seg.PerFrameFunctionalGroupsSequence[0]
    seg.NumberOfFrames = 1
    seg.PerFrameFunctionalGroupsSequence = [frame]
    seg.save_as(str(folder / "liver.dcm"))
    shared = seg.SharedFunctionalGroupsSequence[0]
    cosines = [float(c) for c in shared.PlaneOrientationSequence[0].ImageOrientationPatient]
    measures = shared.PixelMeasuresSequence[0]
    down, along = map(float, measures.PixelSpacing)
    row, column = cosines[:3], cosines[3:]
    normal = [row[1] * column[2] - row[2] * column[1], row[2] * column[0] - row[0] * column[2],
              row[0] * column[1] - row[1] * column[0]]
    corner = [float(c) for c in frame.PlanePositionSequence[0].ImagePositionPatient]
    thick = 2.5
    axes = [[c * along for c in row], [c * down for c in column], [c * thick for c in normal]]
    origin = [corner[r] - axes[2][r] for r in range(3)]  # the frame is the second slice of three
    vector = "({!r},{!r},{!r})".format
    head = (f"NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\n"
            f"sizes: {seg.Columns} {seg.Rows} 3\n"
            f"space directions: {' '.join(vector(*axis) for axis in axes)}\n"
            f"kinds: domain domain domain\nendian: little\nencoding: raw\n"
            f"space origin: {vector(*origin)}\n\n")
    size = seg.Columns * seg.Rows
    (folder / "liver.nrrd").write_bytes(head.encode() + bytes(2 * 3 * size))
    palpate(program, "import", folder / "liver.nrrd", "--out", folder / "liver")
    found = palpate(program, "segment", folder / "liver", "--from", folder / "liver.dcm")
    expected = bytes(size) + bytes(bit(seg.PixelData, n) for n in range(size)) + bytes(size)
    data = (folder / "liver/labels.mha").read_bytes().partition(b"ElementDataFile = LOCAL\n")[2]
    if zlib.decompress(data) != expected or found["labels"][0]["name"] != "Liver":
        wrong.append("dcmqi's segmentation came in as something else")
    print(f"dcmqi's liver: {sum(expected)} voxels")


def check_by_dciodvfy(file, wrong):
    try:
        done = subprocess.run(["dciodvfy", str(file)], capture_output=True, text=True, timeout=60)
    except FileNotFoundError:
        print("dicom3tools is not installed: not looked at by dciodvfy")
        return
    lines = (done.stdout + done.stderr).splitlines()
    wrong += [f"dciodvfy: {line}" for line in lines if line.startswith("Error")]
    print(f"dciodvfy: {sum(line.startswith('Warning') for line in lines)} warnings")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--palpate", required=True)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print(f"seed {options.seed}, pydicom {pydicom.__version__}")
    wrong = []
    with tempfile.TemporaryDirectory(prefix="palpate-exchange-") as name:
        folder = pathlib.Path(name)
        case, file = folder / "case", folder / "labels.dcm"
        write_series(folder / "ct", options.seed)
        palpate(options.palpate, "import", folder / "ct", "--out", case, "--keep-names")
        palpate(options.palpate, "segment", case, "--threshold", 300, 2000, "--label", BONE)
        palpate(options.palpate, "segment", case, "--threshold", 0, 100, "--label", NERVE)
        palpate(options.palpate, "export", case, "--out", file)
        seg = pydicom.dcmread(str(file))
        look_at_header(seg, wrong)
        compare(seg, case, wrong)
        check_by_dciodvfy(file, wrong)
        before = read_labels(case / "labels.mha")[0]
        palpate(options.palpate, "segment", case, "--from", file)
        if read_labels(case / "labels.mha")[0] != before:
            wrong.append("taken back, the labels are others")
        for ending in ("mha", "nrrd", "seg.nrrd"):
            palpate(options.palpate, "export", case, "--out", folder / f"labels.{ending}")
        for ending in ("stl", "ply", "obj"):
            palpate(options.palpate, "export", case, "--label", BONE,
                    "--out", folder / f"labels.{ending}")
        check_foreign(options.palpate, folder, wrong)
        for exported in folder.glob("labels.*"):
            if any(secret in exported.read_bytes() for secret in SECRETS):
                wrong.append(f"a name of the patient is in {exported.name}")
    print("\n".join(wrong) if wrong else "all as it should be")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
