#!/usr/bin/env python3
"""Every row of the shared data's manifest: the outcome that its text and the reference promise.

  manifest_test.py --palpate PROGRAM --data FOLDER [--row TEXT]

A volume must equal its reference (eight corners within 0.001 mm, voxels bit for bit), a repair must
state its displacement, a refusal must give its exact reason, and no output may hold a patient's
name. A row without an expectation fails, so that a new row cannot go untested. Ends with 77 where
the data is not there.
"""

import argparse
import array
import collections
import concurrent.futures
import gzip
import hashlib
import itertools
import json
import math
import pathlib
import re
import statistics
import subprocess
import sys
import tarfile
import tempfile
import time
import zlib

import dicom_header as dicom
import names

CORNER_MM = 0.001
LONGEST_S = 10  # For a damaged file.

# ------------------------------------------------------------------------- what each row promises

ONE_SLICE = "One slice only: it can be looked at, but not felt; a tree needs two slices or more."
NOT_A_VOLUME = "The series cannot become a volume: {}."
NO_SPACING = NOT_A_VOLUME.format("it states no pixel spacing")
NO_NUMBERS = "no such numbers"
NO_IMAGE_HERE = "The DICOM file holds no image, or is damaged."
CUT_SHORT = "A DICOM image could not be decoded: it is damaged or cut short."
NOT_A_BOX = "The series is not a regular box: {}."


def thickness(mm, source="as stated"):
    separator = "," if source == "as stated" else ";"
    return f"The thickness of the one slice is taken as {mm} mm{separator} {source}."


def series(**more):
    """A folder or archive with one volume, equal to its reference."""
    return {"check": check_series, "warnings": [], **more}


def one_slice(mm, stored="<h", lossy=False, **more):
    """A file with one slice; `stored` is how the reference's hash counts its pixels."""
    return {"check": check_slice, "warnings": [thickness(mm), ONE_SLICE], "stored": stored,
            "lossy": lossy, **more}


def refused(message, **more):
    return {"check": check_refusal, "message": message, **more}


def transfer_syntax(stored="<h", lossy=False):
    return one_slice(5, stored, lossy)


def repaired(message, repair, *too_little, **more):
    """Refused as it is and with less than all it needs; a box with `repair`."""
    return {"check": check_repair, "message": message, "repair": repair,
            "too_little": too_little, **more}


SYNTAX = "difficult/transfer_syntax/ct_"
PIXELS = "difficult/pixel_format/"
STRUCTURE = "difficult/file_structure/"
MALFORMED = "difficult/malformed/"
DERIVED = "difficult/derived/"


def expectations():
    return {
        "series/ct_head_cranium/": series(),
        "archives/ct_abdomen_spine_lidc.tar.xz": series(),
        "archives/mr_brain_sag_mprage.tar.xz": series(),
        "archives/ct_head_tilt_irregular_ge.tar.xz": repaired(
            NOT_A_BOX.format("its slices are sheared against their normal by 18.5 degrees (gantry "
                             "tilt), up to 48.2 mm; its slices are 1.08 to 7 mm apart (uneven "
                             "spacing or missing slices)"),
            "tilt,spacing", ("tilt", "slice spacing"), ("spacing", "gantry tilt")),
        "volumes/ct_headsq.nrrd": {
            "check": check_volume_file, "tool": "plastimatch_to_nifti", "read": nrrd_voxels,
            "warnings": ["The file does not say how the voxels lie in the patient: the letters R, "
                         "L, A, P, H and F are a guess."]},
        "volumes/mr_ch2bet.nii.gz": {
            "check": check_volume_file, "tool": "nibabel", "read": nifti_voxels, "warnings": []},

        SYNTAX + "implicit_le.dcm": transfer_syntax(),
        SYNTAX + "explicit_le.dcm": transfer_syntax(),
        SYNTAX + "explicit_be.dcm": transfer_syntax(),
        SYNTAX + "deflated.dcm": transfer_syntax(),
        SYNTAX + "rle.dcm": transfer_syntax(),
        SYNTAX + "jpeg_baseline_50.dcm": transfer_syntax("<B", lossy=True),
        SYNTAX + "jpeg_extended_51.dcm": transfer_syntax("<H", lossy=True),
        # Retired, and read all the same: then right, and flagged.
        SYNTAX + "jpeg_spectral_53_retired.dcm": transfer_syntax("<H", lossy=True),
        SYNTAX + "jpeg_progressive_55_retired.dcm": transfer_syntax("<H", lossy=True),
        SYNTAX + "jpeg_lossless_57.dcm": transfer_syntax(),
        SYNTAX + "jpeg_lossless_sv1_70.dcm": transfer_syntax(),
        SYNTAX + "jpegls_lossless_80.dcm": transfer_syntax(),
        SYNTAX + "jpegls_near_81.dcm": transfer_syntax(lossy=True),
        SYNTAX + "j2k_lossless_90.dcm": transfer_syntax(),
        SYNTAX + "j2k_91.dcm": transfer_syntax(lossy=True),

        "difficult/enhanced/ect_2frames_jpeg51_fragmented_no_bot.dcm": {
            # A map of blood flow that the header calls CT.
            "check": check_enhanced, "decoded": True, "lossy": True, "modality": "OT",
            "warning_about": "hounsfield units"},
        "difficult/enhanced/mr_philips_8frames": {
            "check": check_enhanced, "tool": "vtk_dicom", "modality": "MR"},
        # Its functional groups are gone: neither spacing nor position.
        "difficult/enhanced/emri_small.dcm": refused(NO_SPACING),

        "difficult/geometry/ct_irregular_increment": repaired(
            NOT_A_BOX.format("its slices are 5 to 10 mm apart (uneven spacing or missing slices)"),
            "spacing", ("tilt", "slice spacing")),
        "difficult/geometry/mr_two_slices": series(),
        "difficult/geometry/mr_mixed_orientation": {"check": check_several, "skipped": 0},
        "difficult/geometry/mr_oblique_hitachi_4": series(),

        PIXELS + "cr_monochrome1_no_preamble": refused(NO_SPACING),
        # The slices of a volume side by side in one image: as one slice it shows no anatomy.
        PIXELS + "mr_12bitUnsigned_0x0F0F.dcm": one_slice(
            3.2, stored=None, voxels=masked_voxels, warning_about="mosaic"),
        PIXELS + "mlut_18.dcm": refused(NO_SPACING),
        PIXELS + "parametric_map_float.dcm": refused(
            NOT_A_VOLUME.format("its pixels are floating-point numbers (a parametric map)")),
        PIXELS + "liver_nonbyte_aligned_rle.dcm": refused(
            NOT_A_VOLUME.format("its image has one bit per pixel (a segmentation)")),
        # The reference's hash is of the 13 bits without their sign.
        PIXELS + "J2K_pixelrep_mismatch.dcm": one_slice(5, mask=0x1FFF),
        # Doses are no anatomy, and its stored numbers are no doses without their scaling.
        PIXELS + "rtdose_1frame.dcm": refused(re.compile("dose", re.I)),
        PIXELS + "MR_small_padded.dcm": one_slice(0.8),
        PIXELS + "SC_rgb_jpeg_dcmtk.dcm": refused(NOT_A_VOLUME.format("its image is in colour")),
        PIXELS + "rtstruct.dcm": refused(
            NOT_A_VOLUME.format("it holds no image (RTSTRUCT)"),
            field="SOPClassUID", found="RTStructureSetStorage"),
        PIXELS + "CT_small.dcm": one_slice(5),
        PIXELS + "MR_small_implicit.dcm": one_slice(0.8),
        PIXELS + "mr_12bit_packed.dcm": one_slice(
            1, stored=None, voxels=unpacked_voxels,
            warnings=[thickness(1, "none is stated"), ONE_SLICE]),

        # One stray byte before the data set: no reader knows it.
        STRUCTURE + "no_meta.dcm": refused("The file is not a scan that Palpate reads."),
        STRUCTURE + "ExplVR_LitEndNoMeta.dcm": refused(
            NOT_A_VOLUME.format("it holds no image (RTPLAN)")),
        STRUCTURE + "MR_truncated.dcm": refused(CUT_SHORT),
        STRUCTURE + "badVR.dcm": refused(re.compile("dose", re.I)),  # A dose too.
        STRUCTURE + "no_meta_group_length.dcm": refused(NO_IMAGE_HERE),
        STRUCTURE + "UN_sequence.dcm": refused(NO_IMAGE_HERE),
        STRUCTURE + "empty_charset_LEI.dcm": refused(NO_IMAGE_HERE),
        STRUCTURE + "GH178.dcm": refused(CUT_SHORT),
        STRUCTURE + "GH220.dcm": refused(NOT_A_VOLUME.format("it holds no image (no modality)")),

        **{f"difficult/charset/chr{name}.dcm": refused(NO_SPACING)
           for name in ("H31", "Greek", "Russ", "X1", "Fren")},
        "difficult/dicomdir/": {"check": check_dicomdir, "skipped": 1},
        "difficult/fuzz/": {"check": check_fuzz},

        MALFORMED + "rows_cols_65535.dcm": refused(
            NOT_A_VOLUME.format("it states an image of an impossible size "
                                "(65535 x 65535 pixels, 1 frame)"),
            field="Columns, Rows, NumberOfFrames",
            found="65535 x 65535 pixels, 1 frame in 39168 bytes"),
        MALFORMED + "rows_zero.dcm": refused(
            NOT_A_VOLUME.format("its image has no rows or no columns"),
            field="Rows, Columns", found="0, 128"),
        MALFORMED + "spacing_zero.dcm": refused(
            NOT_A_VOLUME.format("its pixel spacing is not a length"),
            field="PixelSpacing", found="0\\0"),
        MALFORMED + "no_position.dcm": refused(
            NOT_A_VOLUME.format("it states no position in the patient"),
            field="ImagePositionPatient", found=NO_NUMBERS),
        MALFORMED + "orientation_zero.dcm": refused(
            NOT_A_VOLUME.format("its orientation is not two perpendicular directions"),
            field="ImageOrientationPatient", found="0\\0\\0\\0\\0\\0"),
        MALFORMED + "pixel_length_4g.dcm": refused(CUT_SHORT, field="PixelData"),
        MALFORMED + "truncated_half.dcm": refused(CUT_SHORT, field="PixelData"),
        MALFORMED + "slope_zero.dcm": refused(
            NOT_A_VOLUME.format("its rescale slope is zero"), field="RescaleSlope", found="0"),

        # Ten files; the copy counts for nothing.
        DERIVED + "duplicate_slices/": refused(NOT_A_VOLUME.format(
            "different images lie at the same place: 05.dcm and "
            "same_position_as_05_other_uid_other_pixels.dcm (9 different images at 8 places)")),
        DERIVED + "missing_slices/": repaired(
            NOT_A_BOX.format("its slices are 0.9 to 2.7 mm apart (uneven spacing or missing "
                             "slices)"), "spacing", ("tilt", "slice spacing")),
        DERIVED + "wrong_instance_numbers/": series(),
        # Left aside: text, PNG, empty, zero and fake files; not the structure set without preamble.
        DERIVED + "mixed_series/": {"check": check_several, "skipped": 7},
        DERIVED + "big_spacing/": series(),
        DERIVED + "scout_in_series/": series(
            warnings=["Left out: 1 other image stack (scouts or other series)."]),
    }


# ---------------------------------------------------------------------------------- small geometry


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def along(start, *steps):
    """The point at `start` plus each (amount, direction)."""
    return [start[i] + sum(amount * direction[i] for amount, direction in steps) for i in range(3)]


def corners(origin, axes, spacing, dims):
    reach = [spacing[i] * (dims[i] - 1) for i in range(3)]
    return [along(origin, *((on * reach[i], axes[i]) for i, on in enumerate(bits)))
            for bits in itertools.product((0, 1), repeat=3)]


def axes_of(flat):
    return [flat[0:3], flat[3:6], flat[6:9]]


def corners_told(told):
    return corners(told["origin_mm"], axes_of(told["direction"]), told["spacing_mm"], told["dims"])


def corners_of_headers(g):
    """From the reference's headers: the last origin, not a spacing, ends the stack."""
    first, last = g["origin_lps"], g["last_origin_lps"]
    found = []
    for x, y, z in itertools.product((0, 1), repeat=3):
        found.append(along(last if z else first,
                           (x * g["spacing_xy"][0] * (g["dims"][0] - 1), g["row_direction"]),
                           (y * g["spacing_xy"][1] * (g["dims"][1] - 1), g["column_direction"])))
    return found


def corners_of_tool(box):
    return corners(box["origin_lps"], box["direction_lps_columns"], box["spacing"], box["dims"])


def distance_of_boxes(a, b):
    """Farthest corner of one box from its nearest of the other: tools flip rows and slices."""
    return max(min(math.dist(p, q) for q in b) for p in a)


class Stack:
    """The slices of one orientation as their headers state them, sorted along the normal."""

    def __init__(self, slices):
        first = slices[0]
        turned = dicom.numbers(first, dicom.ORIENTATION)
        self.row, self.column = unit(turned[:3]), unit(turned[3:])
        self.normal = unit(cross(self.row, self.column))
        unique = {s.get((8, 0x18), id(s)): s for s in slices}.values()  # By SOP instance.
        self.slices = sorted(unique, key=lambda s: dot(position(s), self.normal))
        spacing = dicom.numbers(first, dicom.PIXEL_SPACING)
        self.spacing = [spacing[1], spacing[0]]
        self.dims = [dicom.integer(first, dicom.COLUMNS), dicom.integer(first, dicom.ROWS),
                     len(self.slices)]

    def places(self):
        return [position(s) for s in self.slices]

    def heights(self):
        return [dot(p, self.normal) for p in self.places()]

    def step(self):
        return statistics.median(b - a for a, b in itertools.pairwise(self.heights()))

    def corners(self):
        return corners_of_headers({
            "origin_lps": self.places()[0], "last_origin_lps": self.places()[-1],
            "spacing_xy": self.spacing, "dims": self.dims, "row_direction": self.row,
            "column_direction": self.column})

    def displacement(self, step):
        """How far a slice lies from where a stack of even steps along the normal puts it."""
        places = self.places()
        return max(math.dist(p, along(places[0], (i * step, self.normal)))
                   for i, p in enumerate(places))


def unit(v):
    length = math.sqrt(dot(v, v))
    return [x / length for x in v]


def position(elements):
    return dicom.numbers(elements, dicom.POSITION)


def headers_of(path):
    """The DICOM data sets of a file, folder or archive."""
    if path.name.endswith(".tar.xz"):
        with tarfile.open(path) as archive:
            contents = [archive.extractfile(m).read() for m in archive if m.isfile()]
    else:
        files = [path] if path.is_file() else sorted(p for p in path.rglob("*") if p.is_file())
        contents = [p.read_bytes() for p in files]
    return [e for e in map(dicom.read, contents) if dicom.SERIES_UID in e]


def stacks_of(headers):
    """Stacks by series and orientation, of what has a position."""
    groups = collections.defaultdict(list)
    for e in headers:
        if position(e) and dicom.PIXEL_DATA in e:
            turned = tuple(round(v, 4) for v in dicom.numbers(e, dicom.ORIENTATION))
            groups[dicom.text(e, dicom.SERIES_UID), turned].append(e)
    return {key: Stack(found) for key, found in groups.items()}


# ------------------------------------------------------------------------------------ voxel values

def little(numbers_):
    if sys.byteorder == "big":
        numbers_ = numbers_[:]
        numbers_.byteswap()
    return numbers_.tobytes()


def from_little(kind, data):
    values = array.array(kind)
    values.frombytes(data)
    if sys.byteorder == "big":
        values.byteswap()
    return values


def sha(data):
    return hashlib.sha256(data).hexdigest()


def rescaled(elements):
    """A native 16-bit little-endian slice as int16, by its own slope and intercept."""
    signed = dicom.integer(elements, (0x28, 0x103)) == 1
    slope = (dicom.numbers(elements, dicom.SLOPE) or [1.0])[0]
    intercept = (dicom.numbers(elements, dicom.INTERCEPT) or [0.0])[0]
    stored = from_little("h" if signed else "H", elements[dicom.PIXEL_DATA])
    return array.array("h", (int(v * slope + intercept) for v in stored))


def masked_voxels(elements):
    """12 bits in 16: what is set above them does not count."""
    return array.array("h", (v & 0xFFF for v in from_little("H", elements[dicom.PIXEL_DATA])))


def unpacked_voxels(elements):
    """Two 12-bit pixels in three bytes, low bits first."""
    packed, found = elements[dicom.PIXEL_DATA], array.array("h")
    for a, b, c in zip(packed[0::3], packed[1::3], packed[2::3]):
        found.extend((a | (b & 15) << 8, b >> 4 | c << 4))
    return found


def nrrd_voxels(data):
    head, _, body = data.partition(b"\n\n")
    fields = dict(re.findall(r"^([\w ]+): ?(.*)$", head.decode("ascii"), re.M))
    body = gzip.decompress(body) if fields["encoding"] in ("gzip", "gz") else body
    kinds = {"short": "h", "int16": "h", "signed short": "h", "ushort": "H"}
    values = from_little(kinds[fields["type"]], body)
    if fields.get("endian") == "big":
        values.byteswap()
    return values


def nifti_voxels(data):
    data = gzip.decompress(data)
    at = int(from_little("f", data[108:112])[0])
    kinds = {2: "B", 4: "h"}
    return from_little(kinds[from_little("h", data[70:72])[0]], data[at:])


class Case:
    """What an import wrote, read without the program."""

    def __init__(self, folder):
        head, _, body = (folder / "volume.mha").read_bytes().partition(b"ElementDataFile = LOCAL\n")
        self.fields = dict(re.findall(r"^(\w+) = (.*)$", head.decode("ascii"), re.M))
        body = zlib.decompress(body) if self.fields["CompressedData"] == "True" else body
        self.voxels = from_little({"MET_SHORT": "h", "MET_FLOAT": "f"}[self.fields["ElementType"]],
                                  body)
        self.sha256 = sha(body)
        self.counts = collections.Counter(self.voxels)  # Of each value.
        self.toml = (folder / "case.toml").read_text(encoding="utf-8")

    def numbers(self, field):
        return [float(v) for v in self.fields[field].split()]

    def slice(self, k):
        count = int(self.numbers("DimSize")[0] * self.numbers("DimSize")[1])
        return self.voxels[k * count:(k + 1) * count]


# --------------------------------------------------------------------------------------- the checks

class Row:
    """One row of the manifest at work: runs the program and collects what is wrong."""

    def __init__(self, options, shared, name, expected):
        self.program, self.data = options.palpate, options.data
        self.key, self.expected = name.rstrip("/"), expected
        self.path = self.data / self.key
        self.reference, self.names = shared
        self.wrong = []

    def expect(self, holds, what):
        if not holds:
            self.wrong.append(what)
        return holds

    def equal(self, found, wanted, what):
        return self.expect(found == wanted, f"{what} is {found!r}, expected {wanted!r}")

    def run(self, *arguments):
        start = time.monotonic()
        try:
            done = subprocess.run([self.program, *map(str, arguments), "--json"],
                                  capture_output=True, timeout=60, check=False)
        except subprocess.TimeoutExpired:
            self.wrong.append(f"{arguments[0]} hangs")
            return None, {}, 60
        named = self.names.found_in(done.stdout) or self.names.found_in(done.stderr)
        self.expect(not named, f"{arguments[0]} tells the patient's {named}")
        try:
            told = json.loads(done.stdout)
        except ValueError:
            self.wrong.append(f"{arguments[0]} ended with {done.returncode}, stdout is no JSON")
            told = {}
        return done, told, time.monotonic() - start

    def series(self, path=None):
        done, told, _ = self.run("series", path or self.path)
        self.expect(done and done.returncode in (0, 3), f"series ended with {done}")
        self.expect(done and b"DICOMDIR" not in done.stderr, "series misses files of the DICOMDIR")
        return told

    def refuse(self, *more, path=None):
        """Imports what must be refused; the error's fields."""
        with tempfile.TemporaryDirectory() as folder:
            case = pathlib.Path(folder) / "case"
            done, told, _ = self.run("import", path or self.path, "--out", case, *more)
            if done is None or not self.equal(done.returncode, 3, "exit of the import"):
                return {}
            self.equal(list(pathlib.Path(folder).iterdir()), [], "what a refused import left")
        error = told.get("error", {})
        self.equal(set(error), {"kind", "message", "file", "field", "found", "expected", "advice"},
                   "the error's keys")
        self.equal(error.get("kind"), "input-refused", "the error's kind")
        self.equal(error.get("file"), str(path or self.path), "the error's file")
        last = done.stderr.decode("utf-8").strip().splitlines()[-1]
        for part in ("message", "advice"):
            self.expect(error.get(part) and error[part].rstrip(".") in last,
                        f"the last line of stderr lacks the {part}")
        return error

    def accept(self, *more, path=None):
        """Imports what must be accepted; what was told, and the case."""
        with tempfile.TemporaryDirectory() as folder:
            case = pathlib.Path(folder) / "case"
            done, told, _ = self.run("import", path or self.path, "--out", case, *more)
            if done is None or not self.equal(done.returncode, 0, "exit of the import"):
                self.wrong.append(str(told.get("error", {}).get("message")))
                return None, None
            written = Case(case)
            for file, named in self.names.found_below(case):
                self.wrong.append(f"{file.name} holds the patient's {named}")
        self.case_is_what_was_told(written, told)
        return told, written

    def case_is_what_was_told(self, case, told):
        self.equal(case.sha256, told["voxels_sha256"], "hash of the case's voxels")
        self.equal([int(v) for v in case.numbers("DimSize")], told["dims"], "size in the case")
        self.equal({"MET_SHORT": "int16", "MET_FLOAT": "float32"}[case.fields["ElementType"]],
                   told["voxel_type"], "voxel type")
        for field, key in (("ElementSpacing", "spacing_mm"), ("Offset", "origin_mm"),
                           ("TransformMatrix", "direction")):
            off = max(abs(a - b) for a, b in zip(case.numbers(field), told[key]))
            self.expect(off < 1e-6, f"{key} in the case differs by {off}")
        self.equal([min(case.counts), max(case.counts)], told["value_range"], "range of values")

    def corners_within(self, found, wanted, what="corners"):
        off = max(math.dist(a, b) for a, b in zip(found, wanted))
        self.expect(off <= CORNER_MM, f"{what} are off by {off:.6f} mm")

    def warnings_are(self, told):
        """The expected ones and, where an image was compressed with loss, a word about that."""
        about_loss = [w for w in told["warnings"] if "with loss" in w]
        others = [w for w in told["warnings"] if w not in about_loss]
        self.equal(bool(about_loss), self.expected.get("lossy", False), "a warning about loss")
        about = self.expected.get("warning_about")
        if about:
            spoken = [w for w in others if about in w.lower()]
            self.expect(spoken, f"no warning about {about}")
            others = [w for w in others if w not in spoken]
        self.equal(others, self.expected.get("warnings", []), "warnings")

    def lossy_is_noted(self, case):
        lossy = str(self.expected.get("lossy", False)).lower()
        self.expect(f"\nlossy = {lossy}\n" in case.toml, f"the case does not say lossy = {lossy}")

    def values_are(self, case, wanted):
        counts = case.counts
        found = {"min": min(counts), "max": max(counts), "voxels": len(case.voxels),
                 "mean": sum(v * n for v, n in counts.items()) / len(case.voxels),
                 "count_ge_300": sum(n for v, n in counts.items() if v >= 300),
                 "count_ge_-200_lt_300": sum(n for v, n in counts.items() if -200 <= v < 300)}
        for name in found.keys() & (wanted or {}).keys():
            # Float voxels and the reference's six digits differ in the last ones.
            near = math.isclose(found[name], wanted[name], rel_tol=1e-6, abs_tol=1e-5)
            self.expect(near, f"{name} is {found[name]}, expected {wanted[name]}")


def same_geometry(a, b):
    return all(a[key] == b[key] for key in ("dims", "spacing_mm", "origin_mm", "direction"))


def importable(told):
    return [s for s in told.get("series", []) if s["importable"]]


def series_promises(row, told, imported):
    """`series` lists what was imported, with the very same geometry."""
    row.expect(any(same_geometry(s, imported) for s in importable(told)),
               "series lists no importable volume with the import's geometry")
    for s in told.get("series", []):
        row.equal(s["importable"], s["reason"] is None, "a reason beside importable")


def series_refuses(row, told, error):
    """`series` says what the import says: nothing to import, for the same reason."""
    if "error" in told:
        row.equal(told["error"]["message"], error.get("message"), "the message of series")
        return
    row.equal([s["uid"] for s in importable(told)], [], "what series calls importable")
    reasons = [re.sub(r"; imports with --repair .*", "", s["reason"] or "")
               for s in told.get("series", [])]
    row.expect(any(reason and reason in error.get("message", "") for reason in reasons),
               f"series gives other reasons: {reasons}")


def check_series(row):
    told, case = row.accept()
    if not told:
        return
    wanted = row.reference["series"][row.key]["series"][0]
    row.equal(told["modality"], wanted["Modality"], "modality")
    row.equal(told["dims"], wanted["geometry_from_headers"]["dims"], "dims")
    row.corners_within(corners_told(told), corners_of_headers(wanted["geometry_from_headers"]))
    row.equal(told["voxels_sha256"],
              wanted["sha256_int16_le_rescaled_x_fastest_z_along_normal"], "voxels_sha256")
    row.values_are(case, wanted["rescaled_values"])
    probes = wanted["probe_voxels_ijk"]
    n = told["dims"]
    row.equal([case.voxels[i + n[0] * (j + n[1] * k)] for i, j, k, _ in probes],
              [p[3] for p in probes], "probed voxels")
    row.equal(told["repairs"], [], "repairs")
    row.warnings_are(told)
    row.lossy_is_noted(case)
    series_promises(row, row.series(), told)


def check_volume_file(row):
    told, case = row.accept()
    if not told:
        return
    box = row.reference["files"][row.key][row.expected["tool"]]
    row.equal(told["dims"], box["dims"], "dims")
    row.corners_within(corners_told(told), corners_of_tool(box))
    row.values_are(case, box["values"])
    wanted = array.array("h", row.expected["read"](row.path.read_bytes()))
    row.equal(told["voxels_sha256"], sha(little(wanted)), "voxels_sha256")
    row.warnings_are(told)
    series_promises(row, row.series(), told)


def stored_again(voxels, elements, kind, mask):
    """The voxels with slope and intercept undone, as a decoder's bytes."""
    slope, intercept = elements.get("RescaleSlope", 1.0), elements.get("RescaleIntercept", 0.0)
    found = (round((v - intercept) / slope) for v in voxels)
    if mask:
        return array.array("H", (v & mask for v in found))
    return array.array(kind, found)


def check_slice(row):
    told, case = row.accept()
    if not told:
        return
    wanted = row.reference["files"][row.key]
    header = wanted["header"]
    row.equal(told["modality"], header["Modality"], "modality")
    row.equal(told["dims"], [header["Columns"], header["Rows"], 1], "dims")
    turned = header["ImageOrientationPatient"]
    axes = [unit(turned[:3]), unit(turned[3:])]
    axes.append(cross(*axes))
    spacing = [header["PixelSpacing"][1], header["PixelSpacing"][0], 1.0]
    row.corners_within(corners_told(told),
                       corners(header["ImagePositionPatient"], axes, spacing, told["dims"]))
    row.expect(abs(told["spacing_mm"][2] - header.get("SliceThickness", 1.0)) < 1e-6, "thickness")
    if "voxels" in row.expected:
        own = row.expected["voxels"](dicom.read(row.path.read_bytes()))
        row.equal(told["voxels_sha256"], sha(little(own)), "voxels_sha256")
    else:
        again = stored_again(case.voxels, header, row.expected["stored"][-1],
                             row.expected.get("mask"))
        row.equal(sha(little(again)), wanted["decoded_pixel_sha256"]["gdcm"], "stored pixels' hash")
        row.values_are(case, wanted.get("hu_pydicom") or wanted.get("stored_values_pydicom"))
    row.warnings_are(told)
    row.lossy_is_noted(case)
    series_promises(row, row.series(), told)


def frames_of(elements):
    """One header per frame, from the functional groups."""
    shared = elements[0x5200, 0x9229][0]
    found = []
    for group in elements[0x5200, 0x9230]:
        frame = {tag: elements[tag] for tag in (dicom.ROWS, dicom.COLUMNS, (0x28, 0x103))}
        for tag, items in (*shared.items(), *group.items()):
            if isinstance(items, list) and items and tag[0] % 2 == 0:  # No private ones.
                frame.update(items[0])
        found.append(frame)
    return found


def check_enhanced(row):
    """Each frame has its own place and rescaling; along the normal they need not be in order."""
    told, case = row.accept()
    if not told:
        return
    file = row.path if row.path.is_file() else next(row.path.iterdir())
    elements = dicom.read(file.read_bytes())
    frames = frames_of(elements)
    stack = Stack(frames)
    row.equal(told["modality"], row.expected["modality"], "modality")
    row.equal(told["dims"], stack.dims, "dims")
    row.corners_within(corners_told(told), stack.corners())
    stored = []
    for frame in frames:  # In the file's order, as decoders give them.
        place = next(k for k, s in enumerate(stack.slices) if s is frame)
        scale = {"RescaleSlope": dicom.numbers(frame, dicom.SLOPE)[0],
                 "RescaleIntercept": dicom.numbers(frame, dicom.INTERCEPT)[0]}
        stored.append(little(stored_again(case.slice(place), scale, "H", None)))
    if row.expected.get("decoded"):
        wanted = row.reference["files"][row.key]["decoded_pixel_sha256"]["gdcm"]
    else:
        wanted = sha(elements[dicom.PIXEL_DATA])
    row.equal(sha(b"".join(stored)), wanted, "stored pixels' hash")
    if "tool" in row.expected:
        box = row.reference["series"][row.key][row.expected["tool"]]["outputs"][0]
        off = distance_of_boxes(corners_told(told), corners_of_tool(box))
        row.expect(off <= CORNER_MM, f"corners are off by {off:.6f} mm from another reader's")
        row.values_are(case, box["values"])
    row.warnings_are(told)
    row.lossy_is_noted(case)
    series_promises(row, row.series(), told)


def check_refusal(row):
    error = row.refuse()
    wanted = row.expected["message"]
    message = error.get("message", "")
    if isinstance(wanted, str):
        row.equal(message, wanted, "the message")
    else:
        row.expect(wanted.search(message), f"the message {message!r} lacks {wanted.pattern!r}")
    for part in ("field", "found"):
        if part in row.expected:
            row.equal(error.get(part), row.expected[part], f"the {part}")
    series_refuses(row, row.series(), error)


def check_repair(row):
    error = row.refuse()
    row.equal(error.get("message"), row.expected["message"], "the message")
    row.expect(f"--repair {row.expected['repair']} " in error.get("advice", ""),
               "the advice does not name the repair")
    series_refuses(row, row.series(), error)
    for repair, field in row.expected["too_little"]:
        row.equal(row.refuse("--repair", repair).get("field"), field,
                  f"what --repair {repair} leaves")
    told, case = row.accept("--repair", row.expected["repair"])
    if told:
        (stack,) = stacks_of(headers_of(row.path)).values()
        reason = row.expected["message"].partition(": ")[2].rstrip(".")
        repair_is_stated(row, told, case, stack, reason)
        grid_holds_the_stack(row, told, stack)
        anatomy_stays(row, told, case, stack)


def repair_is_stated(row, told, case, stack, reason):
    if not row.equal(len(told["repairs"]), 1, "the number of repairs"):
        return
    stated = re.search(r"Largest displacement of a slice: ([\d.]+) mm\.", told["repairs"][0])
    if row.expect(stated, "no displacement in the repair"):
        wanted = stack.displacement(told["spacing_mm"][2])
        row.expect(abs(float(stated[1]) - wanted) <= 0.00501,
                   f"displacement {stated[1]} mm, expected {wanted:.3f}")
    row.expect(reason in told["repairs"][0], "the repair does not say what was uneven")
    row.expect(told["repairs"][0] in case.toml, "the case does not say what was repaired")


def index_of(told, point):
    away = [p - o for p, o in zip(point, told["origin_mm"])]
    return [dot(away, axis) / step
            for axis, step in zip(axes_of(told["direction"]), told["spacing_mm"])]


def grid_holds_the_stack(row, told, stack):
    """Same axes and pixels, even steps of about the usual distance, nothing cut off."""
    row.expect(max(math.dist(a, b) for a, b in zip(axes_of(told["direction"]),
                                                   (stack.row, stack.column, stack.normal)))
               < 1e-5, "the repaired axes differ from the slices'")
    row.expect(math.dist(told["spacing_mm"][:2], stack.spacing) < 1e-6,
               "the repaired pixels differ from the slices'")
    span, step = stack.heights()[-1] - stack.heights()[0], told["spacing_mm"][2]
    row.expect(abs(step / stack.step() - 1) < 0.05, f"steps of {step} mm for {stack.step()} mm")
    row.expect(abs((told["dims"][2] - 1) * step - span) < CORNER_MM,
               "the steps do not end at the last slice")
    for corner in stack.corners():
        for i, n in zip(index_of(told, corner), told["dims"]):
            row.expect(-0.5 <= i <= n - 0.5, f"a corner lies outside, at {i:.2f} of {n}")


def anatomy_stays(row, told, case, stack):
    """The source's voxels are found again where their headers put them."""
    sampled = {0, len(stack.slices) // 2, len(stack.slices) - 1}
    pairs, exact = [], 0
    for k, source in enumerate(stack.slices):
        at = index_of(told, position(source))
        if all(abs(i - round(i)) < 1e-3 for i in at) and at[1] < 0.5:
            exact += 1
            row.expect(case.slice(round(at[2])) == rescaled(source), f"slice {k} was changed")
        elif k in sampled:
            pairs += sampled_pairs(told, case, stack, source)
    if pairs:
        likeness = correlation(pairs)
        row.expect(likeness > 0.95, f"the repaired volume is like the slices by {likeness:.3f}")
    row.expect(exact or pairs, "no slice was compared")


def sampled_pairs(told, case, stack, source, stride=8):
    values, n = rescaled(source), told["dims"]
    found = []
    for y in range(0, stack.dims[1], stride):
        for x in range(0, stack.dims[0], stride):
            point = along(position(source), (x * stack.spacing[0], stack.row),
                          (y * stack.spacing[1], stack.column))
            i, j, k = index_of(told, point)
            low = min(max(math.floor(k), 0), n[2] - 2)
            part = min(max(k - low, 0.0), 1.0)
            at = round(i) + n[0] * (round(j) + n[1] * low)
            between = (1 - part) * case.voxels[at] + part * case.voxels[at + n[0] * n[1]]
            found.append((values[x + y * stack.dims[0]], between))
    return found


def correlation(pairs):
    a, b = zip(*pairs)
    mean_a, mean_b = statistics.fmean(a), statistics.fmean(b)
    together = sum((x - mean_a) * (y - mean_b) for x, y in pairs)
    return together / math.sqrt(sum((x - mean_a) ** 2 for x in a) * sum((y - mean_b) ** 2 for y in b))


def check_several(row, path=None):
    """Refused with the list; by its UID each volume comes as its headers state it."""
    path = path or row.path
    told = row.series(path)
    row.equal(told.get("skipped_files"), row.expected["skipped"], "skipped_files")
    error = row.refuse(path=path)
    row.equal(error.get("message"), "There are several volumes in there.", "the message")
    named = re.findall(r"(\S+) \((\w+), (\d+) slices?\)", error.get("found") or "")
    row.equal({uid for uid, _, _ in named},
              {s["uid"] for s in told["series"] if s["importable"] or s["repair"]},
              "what the refusal names")
    stacks = stacks_of(headers_of(row.path))
    row.expect({s["SeriesInstanceUID"] for s in row.reference["series"][row.key]["series"]}
               <= {s["uid"].partition("#")[0] for s in told["series"]}, "a series is not listed")
    # Every stack of images is listed: importable, or with its reason.
    row.equal(sum(1 for s in told["series"] if s["importable"] or "apart" in s["reason"]),
              len(stacks), "the number of volumes listed")
    for entry in told["series"]:
        check_one_of_several(row, path, entry, stacks)
    for uid, parts in itertools.groupby(sorted(s["uid"] for s in told["series"]),
                                        lambda uid: uid.partition("#")[0]):
        # A bare UID that no stack has to itself is a choice of its parts.
        parts = set(parts)
        if uid not in parts:
            found = row.refuse("--series", uid, path=path).get("found") or ""
            row.expect(parts <= set(re.findall(r"(\S+) \(", found)),
                       f"{uid} is refused with {found!r} for {parts}")
    for entry in told["series"]:
        if not any(uid == entry["uid"].partition("#")[0] for uid, _ in stacks):
            refused_ = row.refuse("--series", entry["uid"], path=path)
            row.expect(entry["reason"] in refused_.get("message", ""),
                       f"{entry['uid']} is refused with {refused_.get('message')!r}")


def check_one_of_several(row, path, entry, stacks):
    if not entry["importable"]:
        row.expect(entry["reason"], f"{entry['uid']}: no reason")
        return
    imported, case = row.accept("--series", entry["uid"], path=path)
    if not imported:
        return
    row.expect(same_geometry(entry, imported), f"{entry['uid']}: series and import differ")
    row.equal(entry["modality"], imported["modality"], f"{entry['uid']}: modality")
    found = [s for (uid, _), s in stacks.items() if uid == entry["uid"].partition("#")[0]
             and max(map(math.dist, s.corners(), corners_told(imported))) <= CORNER_MM]
    if row.equal(len(found), 1, f"{entry['uid']}: stacks with these corners"):
        source = b"".join(little(rescaled(s)) for s in found[0].slices)
        row.equal(case.sha256, sha(source), f"{entry['uid']}: voxels_sha256")


def check_dicomdir(row):
    check_several(row)
    # Through its DICOMDIR the same is found.
    by_folder, by_index = row.series(), row.series(row.path / "DICOMDIR")
    row.equal(sorted(s["uid"] for s in by_index.get("series", [])),
              sorted(s["uid"] for s in by_folder.get("series", [])), "series by DICOMDIR")
    wanted = next(s for s in row.reference["series"][row.key]["series"] if s["files"] == 5)
    told, _ = row.accept("--series", wanted["SeriesInstanceUID"], path=row.path / "DICOMDIR")
    if told:
        row.corners_within(corners_told(told), corners_of_headers(wanted["geometry_from_headers"]))
        row.equal(told["voxels_sha256"],
                  wanted["sha256_int16_le_rescaled_x_fastest_z_along_normal"], "voxels_sha256")
    scattered = next(s for s in by_folder["series"] if "apart" in (s["reason"] or ""))
    stack = next(s for (uid, _), s in stacks_of(headers_of(row.path)).items()
                 if uid == scattered["uid"])
    row.expect("uneven" in row.refuse("--series", scattered["uid"]).get("message", ""),
               "uneven slices are not refused as such")
    told, case = row.accept("--series", scattered["uid"], "--repair", "spacing")
    if told:
        repair_is_stated(row, told, case, stack, scattered["reason"].partition("; imports")[0])
        grid_holds_the_stack(row, told, stack)
        anatomy_stays(row, told, case, stack)


def check_fuzz(row):
    """Anything but a crash, a hang or nonsense."""
    files = sorted(p for p in row.path.iterdir() if p.is_file())
    row.equal(sorted(str(p.relative_to(row.data)) for p in files),
              sorted(row.reference["fuzz"]), "the damaged files")
    with tempfile.TemporaryDirectory() as folder:
        for number, file in enumerate(files):
            case = pathlib.Path(folder) / str(number)
            for arguments in (["series", file], ["import", file, "--out", case]):
                done, told, seconds = row.run(*arguments)
                what = f"{arguments[0]} of {file.name}"
                row.expect(done and done.returncode in (0, 3), f"{what} ended with {done}")
                row.expect(seconds < LONGEST_S, f"{what} took {seconds:.1f} s")
                if done and done.returncode == 3:
                    row.expect(told.get("error", {}).get("message"), f"{what}: no message")
                    row.expect(not case.exists(), f"{what} left a case behind")
        for file, named in row.names.found_below(pathlib.Path(folder)):
            row.wrong.append(f"{file.parent.name}/{file.name} holds the patient's {named}")


# ------------------------------------------------------------------------------------------ the run

def rows_of(manifest):
    return re.findall(r"^\| `([^`]+)` \|", manifest, re.M)


def check_row(options, shared, name, expected):
    """What is wrong with one row."""
    if expected is None:
        return ["the row has no expectation"]
    row = Row(options, shared, name, expected)
    try:
        expected["check"](row)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        row.wrong.append(f"the answer is not what was expected: {error!r}")
    return row.wrong


def report(name, wrong):
    """Prints a row's outcome; whether it is as it should be."""
    for what in wrong:
        print(f"FAILED: {name}: {what}")
    if not wrong:
        print(f"ok: {name}")
    return not wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--palpate", required=True)
    parser.add_argument("--data", required=True, type=pathlib.Path)
    parser.add_argument("--row", default="", help="only rows that hold this text")
    options = parser.parse_args()
    manifest = options.data / "MANIFEST.md"
    if not manifest.exists():
        print(f"SKIPPED: needs the shared test data, which is not in {options.data}")
        return 77
    reference = json.loads((options.data / "reference.json").read_text(encoding="utf-8"))
    shared = reference, names.Names(options.data)
    expected = expectations()
    rows = rows_of(manifest.read_text(encoding="utf-8"))
    gone = sorted(set(expected) - set(rows))
    selected = [name for name in rows if options.row in name]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        outcomes = list(pool.map(
            lambda name: check_row(options, shared, name, expected.get(name)), selected))
    good = [report(name, wrong) for name, wrong in zip(selected, outcomes)]
    for name in gone:
        print(f"FAILED: {name}: expected, but not in the manifest")
    print(f"{len(good)} rows, {good.count(False)} failed")
    return 1 if gone or not good or not all(good) else 0


if __name__ == "__main__":
    sys.exit(main())
