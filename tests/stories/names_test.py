#!/usr/bin/env python3
"""No name or identifier of the shared data's patients in anything that any command says or writes.

  names_test.py --palpate PROGRAM --data FOLDER

The chain from the scan to the replayed session, on what imports and has a name; then that names are
kept where asked for, in every character set of the data. Ends with 77 where the data is not there.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import dicom_header as dicom
import names

# A scan, how it is imported, and the values that stand for bone in it.
CHAINS = (
    ("difficult/derived/wrong_instance_numbers", (), ("--threshold", "300", "2000")),
    ("difficult/geometry/mr_oblique_hitachi_4", (), ("--threshold", "300", "2000")),
    ("difficult/geometry/ct_irregular_increment", ("--repair", "spacing"),
     ("--threshold", "-800", "2000")),
    ("difficult/dicomdir", ("--series", "1.3.6.1.4.1.5962.1.1.0.0.0.1194734704.16302.0.6"),
     ("--threshold", "-100", "2000")),
)
# One slice only: no tree, and a refusal to look at.
ONE_SLICE = "difficult/pixel_format/J2K_pixelrep_mismatch.dcm"
CHARSETS = ("H31", "Greek", "Russ", "X1", "Fren")
SHELL = """ply
format ascii 1.0
element vertex 1
property float x
property float y
property float z
property float nx
property float ny
property float nz
end_header
0 0 0 0 0 1
"""
POSES = "step,r00,r01,r02,tx,r10,r11,r12,ty,r20,r21,r22,tz\n0,1,0,0,-70,0,1,0,-140,0,0,1,0\n"


class Watch:
    """Runs commands and looks for names in what they say and in every file they write."""

    def __init__(self, program, folder, known):
        self.program, self.folder, self.names = program, folder, known
        self.wrong = []
        # What the program keeps for itself is looked through too.
        homes = ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME",
                 "TMPDIR")
        (folder / "home").mkdir()
        self.environment = {**os.environ, **{home: str(folder / "home") for home in homes}}

    def run(self, *arguments, ends=0):
        done = subprocess.run([self.program, *map(str, arguments)], cwd=self.folder,
                              env=self.environment, capture_output=True, timeout=120, check=False)
        if done.returncode != ends:
            self.wrong.append(f"{arguments[0]} ended with {done.returncode}, expected {ends}: "
                              f"{done.stderr.decode('utf-8', 'replace').strip()[-300:]}")
        for stream in ("stdout", "stderr"):
            found = self.names.found_in(getattr(done, stream))
            if found:
                self.wrong.append(f"{arguments[0]}: {stream} names {found}")
        return done

    def look_through_files(self):
        for path, found in self.names.found_below(self.folder):
            self.wrong.append(f"{path.relative_to(self.folder)} holds {found}")


def chain(watch, number, scan, options, bone):
    """From the scan to the replayed session; words for people too, not only JSON."""
    case, session = f"case{number}", f"session{number}"
    watch.run("series", scan)
    watch.run("import", scan, "--out", case, *options, "--verbose")
    watch.run("segment", case, *bone, "--label", "bone", "--json")
    for ending in ("dcm", "mha", "nrrd", "seg.nrrd", "stl", "ply", "obj"):
        watch.run("export", case, "--out", f"labels{number}.{ending}")
    watch.run("segment", case, "--from", f"labels{number}.dcm")
    watch.run("tree", case, "--label", "bone", "--json")
    watch.run("simulate", case, "--seconds", "0.2", "--record", session, "--samples",
              f"{session}.csv", "--steps", f"{session}.steps.csv", "--explain", "--json")
    watch.run("replay", session, "--json")


def other_commands(watch, data, case):
    """Refusals, and the commands that are no part of the chain."""
    watch.run("series", data)
    watch.run("import", data / "difficult/dicomdir", "--out", "several", ends=3)
    watch.run("import", data / ONE_SLICE, "--out", "slice")
    watch.run("segment", "slice", "--threshold", "200", "2000", "--label", "bone")
    watch.run("tree", "slice", "--label", "bone", ends=3)
    (watch.folder / "shell.ply").write_text(SHELL, encoding="ascii")
    (watch.folder / "poses.csv").write_text(POSES, encoding="ascii")
    watch.run("collide", "--world", f"{case}/labels.mha", "--shell", "shell.ply", "--poses",
              "poses.csv", "--out", "contacts.csv", "--json")
    watch.run("tradeoff", case, "--quick", "--out", "tradeoff", "--json")
    watch.run("devices", "--json")
    watch.run("doctor", "--seconds", "0.1", "--json")


def element(tag, vr, value):
    value += b" " * (len(value) % 2)
    return b"".join((tag[0].to_bytes(2, "little"), tag[1].to_bytes(2, "little"), vr,
                     len(value).to_bytes(2, "little"), value))


def renamed(scan, charset, name):
    """The bytes of an explicit little-endian scan with another patient's name."""
    old = dicom.read(scan)
    for tag, vr, value in ((dicom.CHARSET, b"CS", charset), (dicom.PATIENT_NAME, b"PN", name)):
        before = element(tag, vr, old[tag])
        if scan.count(before) != 1:
            raise ValueError(f"{tag} is not there once")
        scan = scan.replace(before, element(tag, vr, value))
    return scan


def kept_names(watch, data):
    """Asked for, a name is in the case, whatever its character set; in no log even then."""
    reference = json.loads((data / "reference.json").read_text(encoding="utf-8"))["files"]
    scan = (data / "difficult/pixel_format/CT_small.dcm").read_bytes()
    for charset in CHARSETS:
        source = f"difficult/charset/chr{charset}.dcm"
        found = dicom.read((data / source).read_bytes())
        with tempfile.TemporaryDirectory() as outside:
            file, case = pathlib.Path(outside) / "scan.dcm", pathlib.Path(outside) / "case"
            file.write_bytes(renamed(scan, found[dicom.CHARSET], found[dicom.PATIENT_NAME]))
            watch.run("import", file, "--out", f"nameless-{charset}")
            watch.run("import", file, "--out", case, "--keep-names")
            toml = (case / "case.toml").read_text(encoding="utf-8")
        wanted = reference[source]["patient_name_utf8"]
        if wanted not in toml:
            watch.wrong.append(f"--keep-names does not keep {wanted}: {toml.splitlines()[:8]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--palpate", required=True, type=pathlib.Path)
    parser.add_argument("--data", required=True, type=pathlib.Path)
    options = parser.parse_args()
    if not (options.data / "reference.json").exists():
        print(f"SKIPPED: needs the shared test data, which is not in {options.data}")
        return 77
    known = names.Names(options.data)
    with tempfile.TemporaryDirectory() as folder:
        watch = Watch(options.palpate.resolve(), pathlib.Path(folder), known)
        for number, (scan, how, bone) in enumerate(CHAINS):
            chain(watch, number, options.data.resolve() / scan, how, bone)
        other_commands(watch, options.data.resolve(), f"case{len(CHAINS) - 1}")
        kept_names(watch, options.data)
        watch.look_through_files()
        files = sum(1 for path in pathlib.Path(folder).rglob("*") if path.is_file())
    for what in watch.wrong:
        print(f"FAILED: {what}")
    print(f"{len(known.words)} names and identifiers looked for, in {files} files and all output")
    return 1 if watch.wrong or not known.words else 0


if __name__ == "__main__":
    sys.exit(main())
