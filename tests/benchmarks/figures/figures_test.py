#!/usr/bin/env python3
"""figures.py --quick against the built program: its files, and what they have to say.

  figures_test.py --palpate build/release/app/palpate
"""

import csv
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml
from collections import defaultdict

SCRIPT = pathlib.Path(__file__).resolve().with_name("figures.py")
SVG = "{http://www.w3.org/2000/svg}"
PALPATE = pathlib.Path("palpate")  # replaced by --palpate
# What makes a curve in each CSV; the rest of a row belongs to the step.
CURVES = {
    "figure3": ("world_side", "tool_side", "method"),
    "figure3_both": ("world_side", "tool_side", "method"),
    "figure4": ("scene_side",),
    "figure5": ("tree", "spheres", "one_child_skip"),
    "figure6": ("method", "trajectory"),
}
# Of these the contacts have to be equal, curve by curve.
SAME_CONTACTS = {
    "figure3": ("world_side", "tool_side"),
    "figure3_both": ("world_side", "tool_side"),
    "figure5": ("tree",),
    "figure6": ("trajectory",),
}


def draw(out, palpate, *more):
    return subprocess.run([sys.executable, str(SCRIPT), "--quick", "--out", str(out), "--palpate",
                           str(palpate), *more], capture_output=True, text=True, encoding="utf-8",
                          timeout=240, check=False)


def curves_of(path, keys):
    """The rows of each curve, in the file's order."""
    curves = defaultdict(list)
    with open(path, newline="", encoding="ascii") as file:
        for row in csv.DictReader(file):
            curves[tuple(row[k] for k in keys)].append(row)
    return curves


def contacts(curve):
    return [(row["step"], row["contacts"], row["sum_depth_mm"]) for row in curve]


class QuickRun(unittest.TestCase):
    """One run, looked at from several sides."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="palpate-figures-test-")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.out = pathlib.Path(cls.folder.name) / "not" / "there" / "yet"
        cls.run_ = draw(cls.out, PALPATE)
        if cls.run_.returncode != 0:
            raise AssertionError(f"figures.py ended with {cls.run_.returncode}:\n{cls.run_.stderr}")
        cls.curves = {f: curves_of(cls.out / f"{f}.csv", keys) for f, keys in CURVES.items()}

    def test_every_figure_has_its_files_and_nothing_else_is_left(self):
        expected = {f"{f}.{kind}" for f in CURVES for kind in ("csv", "svg")} | {"runs.json"}
        self.assertEqual({p.name for p in self.out.iterdir()}, expected)

    def test_every_curve_has_one_row_a_step(self):
        counts = {"figure3": 4, "figure3_both": 4, "figure4": 2, "figure5": 12, "figure6": 12}
        for figure, count in counts.items():
            self.assertEqual(len(self.curves[figure]), count, figure)
            for key, curve in self.curves[figure].items():
                self.assertGreater(len(curve), 10)
                self.assertEqual([int(r["step"]) for r in curve], list(range(len(curve))),
                                 (figure, key))

    def test_methods_and_options_find_the_same_contacts_at_every_step(self):
        for figure, same in SAME_CONTACTS.items():
            groups = defaultdict(list)
            for curve in self.curves[figure].values():
                groups[tuple(curve[0][k] for k in same)].append(contacts(curve))
            for key, group in groups.items():
                self.assertGreaterEqual(len(group), 2)
                for other in group[1:]:
                    self.assertEqual(other, group[0], (figure, key))

    def test_contacts_grow_as_the_bodies_approach(self):
        for figure in ("figure3", "figure3_both", "figure5"):
            for key, curve in self.curves[figure].items():
                if key[0] == "surface":  # what sinks below the surface's voxels loses contact
                    continue
                distances = [float(r["distance_mm"]) for r in curve]
                self.assertEqual(distances, sorted(distances, reverse=True))
                counts = [int(r["contacts"]) for r in curve]
                self.assertEqual(counts[0], 0, (figure, key))
                quarter = len(counts) // 4
                means = [sum(counts[i * quarter:(i + 1) * quarter]) / quarter for i in range(4)]
                self.assertLess(means[1], means[2], (figure, key))
                self.assertLess(means[2], means[3], (figure, key))

    def test_the_response_stops_the_tool_and_it_settles(self):
        for key, curve in self.curves["figure4"].items():
            distances = [float(r["distance_mm"]) for r in curve]
            counts = [int(r["contacts"]) for r in curve]
            self.assertAlmostEqual(distances[0], 50.0, delta=4.0, msg=key)  # its centre of mass
            self.assertEqual(counts[0], 0, key)
            first = next(i for i, c in enumerate(counts) if c > 0)
            # Free, it comes at 50 mm/s, less what the first 10 ms took to get there; a touch that the
            # first impulse ends within its step shows up to a fraction of a voxel later.
            self.assertAlmostEqual(distances[0] - distances[first], 0.05 * (first - 10),
                                   delta=192.0 / int(key[0]) / 3.0, msg=key)
            # Without a response it would be 10 mm nearer by the end (Figure 3's approach).
            free = distances[0] - 0.05 * (len(curve) - 10)
            self.assertGreater(distances[-1], free + 5.0, key)
            rest = distances[-len(distances) // 10:]
            self.assertLess(max(rest) - min(rest), 1.5, key)
            self.assertGreater(max(counts[-len(counts) // 10:]), 0, key)  # one voxel comes and goes
            self.assertTrue(all(int(r["impulses"]) <= 400 for r in curve), key)

    def test_random_approaches_start_apart_and_end_in_contact(self):
        lengths = set()
        for key, curve in self.curves["figure6"].items():
            self.assertEqual(int(curve[0]["contacts"]), 0, key)
            self.assertGreater(int(curve[-1]["contacts"]), 0, key)
            radii = [float(r["radius_mm"]) for r in curve]
            self.assertEqual({round(a - b, 3) for a, b in zip(radii, radii[1:])}, {2.0}, key)
            lengths.add(len(curve))
        self.assertGreater(len(lengths), 1, "the directions are not all one")

    def test_options_change_the_tests(self):
        tests = {key: sum(int(r["tests"]) for r in curve)
                 for key, curve in self.curves["figure5"].items()}
        for tree in ("solid", "surface"):
            full, tight = tests[tree, "full spheres", "off"], tests[tree, "tight spheres", "off"]
            self.assertLess(tight, full)
            self.assertNotEqual(tests[tree, "full spheres", "on"], full)

    def test_pictures_are_well_formed_and_within_their_frame(self):
        for figure in CURVES:
            root = xml.parse(self.out / f"{figure}.svg").getroot()
            self.assertEqual(root.tag, SVG + "svg")
            self.assertTrue(root.findtext(SVG + "title"))
            width, height = float(root.get("width")), float(root.get("height"))
            paths = [p.get("d") for p in root.iter(SVG + "path")]
            self.assertGreater(len(paths), 4, figure)
            for path in paths:
                self.assertNotRegex(path, "nan|inf", figure)
                for x, y in re.findall(r"(-?[\d.]+) (-?[\d.]+)", path):
                    self.assertTrue(0 <= float(x) <= width and 0 <= float(y) <= height, figure)

    def test_words_in_pictures_stand_clear_of_each_other(self):
        for figure in CURVES:
            root = xml.parse(self.out / f"{figure}.svg").getroot()
            boxes = [self.box(text) for text in root.iter(SVG + "text")]
            for i, (words, x0, y0, x1, y1) in enumerate(boxes):
                self.assertTrue(0 <= x0 and x1 <= float(root.get("width")), (figure, words))
                for other, u0, v0, u1, v1 in boxes[:i]:
                    self.assertFalse(x0 < u1 and u0 < x1 and y0 < v1 and v0 < y1,
                                     (figure, words, other))

    @staticmethod
    def box(text):
        """Estimated: Inter and DejaVu Sans take 0.55 to 0.6 of their size a letter on average."""
        size = float(text.get("font-size"))
        x, y, long = float(text.get("x")), float(text.get("y")), 0.55 * size * len(text.text)
        back = {"start": 0.0, "middle": 0.5, "end": 1.0}[text.get("text-anchor")] * long
        if text.get("transform"):  # upwards
            return text.text, x - 0.8 * size, y + back - long, x + 0.2 * size, y + back
        return text.text, x - back, y - 0.8 * size, x - back + long, y + 0.2 * size

    def test_the_tables_are_markdown(self):
        for figure in ("Figure 3", "Figure 4", "Figure 5", "Figure 6"):
            self.assertIn(f"### {figure}", self.run_.stdout)
        for block in re.findall(r"(?:^\|.*\n)+", self.run_.stdout, re.MULTILINE):
            self.assertEqual(len({line.count("|") for line in block.splitlines()}), 1, block)
        self.assertIn("seed 2008", self.run_.stdout)


class Refusals(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="palpate-figures-test-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def stand_in(self, body):
        """A program in palpate's place."""
        path = self.folder / "stand_in"
        path.write_text(f"#!{sys.executable}\nimport os, pathlib, subprocess, sys\n{body}",
                        encoding="utf-8")
        os.chmod(path, 0o700)
        return path

    def refused(self, run, code, words):
        self.assertEqual(run.returncode, code, run.stderr)
        self.assertIn(words, run.stderr.strip().splitlines()[-1])
        self.assertNotIn("Traceback", run.stderr)

    def test_a_missing_program_is_named_with_what_to_do(self):
        run = draw(self.folder / "out", self.folder / "nowhere")
        self.refused(run, 4, "nowhere. Build it")

    def test_what_the_program_complains_of_is_passed_on(self):
        run = draw(self.folder / "out", self.stand_in("sys.exit('The world is flat.')\n"))
        self.refused(run, 4, "ended with 1: The world is flat.")

    def test_a_program_that_prints_no_json_is_refused(self):
        run = draw(self.folder / "out", self.stand_in("print('hello')\n"))
        self.refused(run, 4, "printed no report in JSON")

    def test_a_row_too_few_is_refused(self):
        run = draw(self.folder / "out", self.stand_in(
            "pathlib.Path('out.csv').write_text('step,contacts,sum_depth_mm,tests,time_us\\n"
            "0,0,0,1,0.5\\n')\nprint('{\"surface_voxels\": 1}')\n"))
        self.refused(run, 4, "1 rows for 33 poses")

    def test_a_method_that_finds_other_contacts_is_caught(self):
        # The true program, except that the paper's traversal loses a contact of the last step.
        run = draw(self.folder / "out", self.stand_in(
            f"done = subprocess.run([{str(PALPATE)!r}, *sys.argv[1:]])\n"
            "if 'paper' in sys.argv:\n"
            "    rows = pathlib.Path('out.csv').read_text().splitlines()\n"
            "    last = rows[-1].split(',')\n"
            "    last[1] = str(int(last[1]) - 1)\n"
            "    pathlib.Path('out.csv').write_text('\\n'.join([*rows[:-1], ','.join(last)]))\n"
            "sys.exit(done.returncode)\n"), "--only", "3")
        self.refused(run, 1, "The contacts differ. figure 3, bone 16^3")

    def test_numbers_that_make_no_sense_are_refused(self):
        self.refused(draw(self.folder / "out", PALPATE, "--trajectories", "0"), 2, "give 1 or more")


if __name__ == "__main__":
    if "--palpate" in sys.argv:
        at = sys.argv.index("--palpate")
        PALPATE = pathlib.Path(sys.argv[at + 1]).resolve()
        del sys.argv[at:at + 2]
    unittest.main(verbosity=2)
