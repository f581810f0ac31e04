#!/usr/bin/env python3
"""Draws Figures 3 to 6 of the paper again, from `palpate collide` and `palpate simulate`.

  figures.py --out DIR               full size, minutes
  figures.py --out DIR --quick       small bodies, seconds; what CTest runs
  figures.py --out DIR --only 5      one figure

For each figure DIR receives a CSV (one row a step and curve) and an SVG, and runs.json says what
was run and on what. Standard output is Markdown: the tables for README.md. Progress and complaints
go to standard error. In Figures 3, 5 and 6 brute force over every point is the oracle: each method
and option has to find the same contacts at each step.

Exit: 0 done; 1 two methods found different contacts; 2 usage; 4 palpate is missing or failed, or a
file could not be written; 5 cancelled. Needs Python 3.9 and nothing else.
"""

import argparse
import csv
import json
import math
import pathlib
import platform
import random
import subprocess
import sys
import tempfile
from dataclasses import dataclass

sys.dont_write_bytecode = True  # the source folder stays as it is

import bodies  # noqa: E402
import chart  # noqa: E402
from collide import Palpate, RunFailed, write_poses  # noqa: E402
from simulate import BONE, TOOL, Simulator  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
HAPTIC_STEP_US = 1000.0  # the paper's "typical haptic simulation timestep"
ABOUT_1000 = (800, 1250)  # the paper's "around 1000" contacts, a quarter either way

# The paper's tree is an octree; the default is the program's own, options and all.
PAPER = ("paper", ("--method", "paper", "--branching", "8"))
DEFAULT = ("default", ())
BRUTE = ("brute", ("--method", "brute"))
METHOD_TEXT = {"paper": "as in the paper (octree)", "default": "default method",
               "brute": "every point"}
METHOD_DASH = {"paper": "", "default": "7 4"}

# The tool keeps its rotation on a trajectory, as in the paper. Turned out of the world's axes, so
# that no row of its voxels lies along a row of the world's.
TURNED_ABOUT, TURNED_BY_DEG = (0.48, 0.6, 0.64), 65.0
# Figures 3 and 5: from the front, onto the neck of the bone.
APPROACH_FROM = (0.28, -0.96, 0.0)

ORDERED = ["#E39B0B", "#D5602B", "#B03A6E", "#6A3D9A", "#1F2F78"]  # light to dark: coarse to fine
BLUE, VERMILLION, GREEN = "#0072B2", "#D55E00", "#009E73"


class ContactsDiffer(Exception):
    """The oracle: an option or a method that changes the contacts is broken."""


@dataclass(frozen=True)
class Size:
    worlds: tuple  # voxels a side, Figure 3
    tool: int  # voxels a side where it is fixed
    fixed: int  # the world's, Figures 5 and 6
    steps: int  # of the approach
    trajectories: int  # Figure 6
    speed_mm: float  # a step, Figure 6
    repeats: int
    scenes: tuple  # voxels a side of the scene of Figure 4
    seconds: float  # of it


FULL = Size((16, 32, 64, 128, 256), 128, 128, 161, 64, 0.5, 25,
            (32, 64, 128, 256), 1.2)
QUICK = Size((16, 64), 64, 64, 33, 6, 2.0, 1, (32, 64), 0.8)

START_MM, END_MM = 52.0, 16.0  # of the approach: centres apart; they first touch at about 30
# Figure 4: a cube that holds both bodies, and how the tool comes: the pull of 5 m/s^2 that makes this
# speed against the drag goes on pressing it against the bone.
SCENE_SIDE_MM, SPEED_MM_S, DRAG_PER_S = 192.0, 50.0, 100.0
# Figure 6. The bodies' farthest points are 52 and 32 mm from their centres, so that at the start
# they are apart in every direction.
RANDOM_START_MM, RANDOM_DEPTH_MM = 90.0, 10.0
SEARCH_STEP_MM = 2.0


def turn(axis, angle):
    """Rodrigues: the rotation by `angle` about `axis`, three rows."""
    length = math.hypot(*axis)
    x, y, z = (a / length for a in axis)
    c, s = math.cos(angle), math.sin(angle)
    v = 1.0 - c
    return ((c + x * x * v, x * y * v - z * s, x * z * v + y * s),
            (y * x * v + z * s, c + y * y * v, y * z * v - x * s),
            (z * x * v - y * s, z * y * v + x * s, c + z * z * v))


ROTATION = turn(TURNED_ABOUT, math.radians(TURNED_BY_DEG))


def say(text):
    print(text, file=sys.stderr, flush=True)


def quantile(values, share):
    """The smallest value that this share of all does not exceed, as `palpate collide` has it."""
    ordered = sorted(values)
    return ordered[max(1, math.ceil(share * len(ordered))) - 1]


def median(values):
    return quantile(values, 0.5)


class Bench:
    """The program, the bodies made so far, and the list of what was run."""

    def __init__(self, palpate, size, options):
        self.palpate, self.size = palpate, size
        self.repeats = options.repeats or size.repeats
        self.passes = f"median of {self.repeats} passes" if self.repeats > 1 else "one pass"
        self.quick = options.quick
        self.seed = options.seed
        self.trajectories = options.trajectories or size.trajectories
        self.runs = []
        self._made = set()

    def volume(self, kind, n):
        """The name of the label volume of the bone or the tool at n voxels a side."""
        name = f"{kind}_{n}.nrrd"
        if name not in self._made:
            say(f"making {name}")
            side = bodies.BONE_SIDE_MM if kind == "bone" else bodies.TOOL_SIDE_MM
            labels = bodies.paint(bodies.bone() if kind == "bone" else bodies.tool(), side, n)
            bodies.write_nrrd(self.palpate.folder / name, labels, side, n)
            self._made.add(name)
        return name

    def poses(self, name, centres_mm):
        write_poses(self.palpate.folder / name, ROTATION, centres_mm)
        return name

    def collide(self, figure, world, tool, poses, methods, lists, tree=()):
        """The runs by name, with `tree` among the arguments of each.

        Brute force first and once: the oracle of all the others.
        """
        found, reference = {}, None
        for name, arguments in (BRUTE, *methods):
            label = f"bone {world}^3, tool {tool}^3, {' '.join((*tree, *arguments)) or name}"
            say(f"figure {figure}: {label}")
            run = self.palpate.collide(
                self.volume("bone", world), self.volume("tool", tool), poses, *tree, *arguments,
                repeats=1 if name == BRUTE[0] else self.repeats, with_contacts=lists)
            reference = reference or run
            compare(reference, run, f"figure {figure}, {label}")
            self.runs.append({"figure": figure, "command": run.command, "report": run.report})
            found[name] = run
        return found


def compare(reference, run, where):
    """Raises where `run` found other contacts than brute force."""
    for expected, step in zip(reference.steps, run.steps):
        if (step.contacts, step.sum_depth_mm) != (expected.contacts, expected.sum_depth_mm):
            raise ContactsDiffer(
                f"{where}: step {step.step} has {step.contacts} contacts of {step.sum_depth_mm} mm "
                f"in all, but brute force finds {expected.contacts} of {expected.sum_depth_mm} mm.")
    if run.contact_list != reference.contact_list:
        raise ContactsDiffer(f"{where}: the contact list is not that of brute force.")


def approach(size):
    """Distances of the centres, step by step, and the tool's centres."""
    count = size.steps
    distances = [START_MM + i / (count - 1) * (END_MM - START_MM) for i in range(count)]
    length = math.hypot(*APPROACH_FROM)
    return distances, [[d * a / length for a in APPROACH_FROM] for d in distances]


def write_csv(path, heading, rows):
    with open(path, "w", newline="", encoding="ascii") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(heading)
        writer.writerows(rows)


def table(heading, rows):
    lines = ["| " + " | ".join(heading) + " |", "|" + " --- |" * len(heading)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def micro(value):
    """A time in us or a count, in three figures or as a whole number."""
    return chart.number(float(f"{value:.3g}") if value < 1000 else round(value))


def at_about_1000(steps, of):
    chosen = [of(s) for s in steps if ABOUT_1000[0] <= s.contacts <= ABOUT_1000[1]]
    return micro(median(chosen)) if chosen else "-"


def figure_3(bench, out, note, both):
    """Resolution: of the world alone, as the paper's text has it, or of both bodies."""
    size = bench.size
    distances, centres = approach(size)
    poses = bench.poses("approach.csv", centres)
    rows, summary = [], []
    by_size = {}
    for n in size.worlds:
        tool = n if both else size.tool
        runs = bench.collide("3", n, tool, poses, (DEFAULT, PAPER), lists=bench.quick)
        by_size[n] = runs
        points = runs[BRUTE[0]].steps[0].tests  # brute force tests each point once
        for name in (PAPER[0], DEFAULT[0]):
            steps = runs[name].steps
            rows += [(n, tool, name, s.step, f"{d:.4f}", s.contacts, s.sum_depth_mm, s.tests,
                      s.time_us) for s, d in zip(steps, distances)]
            in_time = [s.contacts for s in steps if s.time_us < HAPTIC_STEP_US]
            summary.append((f"{n}³", f"{runs[name].report['surface_voxels']:,}", f"{points:,}",
                            METHOD_TEXT[name], f"{max(s.contacts for s in steps):,}",
                            at_about_1000(steps, lambda s: s.time_us),
                            at_about_1000(steps, lambda s: s.tests),
                            micro(max(s.time_us for s in steps)),
                            f"{max(in_time, default=0):,}"))
    name = "figure3_both" if both else "figure3"
    write_csv(out / f"{name}.csv",
              ["world_side", "tool_side", "method", "step", "distance_mm", "contacts",
               "sum_depth_mm", "tests", "time_us"], rows)

    def curves(of, methods):
        return [chart.Curve([(s.step, of(s)) for s in by_size[n][m].steps], ORDERED[i],
                            METHOD_DASH[m]) for i, n in enumerate(size.worlds) for m in methods]

    def values(of):
        return [of(s) for runs in by_size.values() for m in METHOD_DASH for s in runs[m].steps]

    step = chart.Axis("step", 0, size.steps - 1)
    tool_text = "as many voxels as the bone" if both else f"{size.tool}³ voxels"
    panels = [
        chart.Panel("Distance of the centres", step, chart.linear_axis("distance (mm)", distances),
                    [chart.Curve(list(enumerate(distances)), chart.INK)]),
        chart.Panel("Contacts", step, chart.linear_axis("contacts", values(lambda s: s.contacts)),
                    curves(lambda s: s.contacts, [PAPER[0]])),
        chart.Panel("Time per step", step,
                    chart.log_axis("time (µs)", values(lambda s: s.time_us)),
                    curves(lambda s: s.time_us, METHOD_DASH), level=(HAPTIC_STEP_US, "1 ms")),
        chart.Panel("Tests per step", step,
                    chart.log_axis("sphere and leaf tests", values(lambda s: s.tests)),
                    curves(lambda s: s.tests, METHOD_DASH))]
    legend = [chart.LegendEntry(f"{'both' if both else 'bone'} {n}³", ORDERED[i])
              for i, n in enumerate(size.worlds)]
    legend += [chart.LegendEntry(METHOD_TEXT[m], chart.INK, METHOD_DASH[m]) for m in METHOD_DASH]
    title = "Figure 3: an approach at several resolutions" + (" of both bodies" if both else "")
    (out / f"{name}.svg").write_text(chart.svg(
        title, [f"Bone, 100 mm; tool, 64 mm, {tool_text}; no collision response. "
                f"Time: {bench.passes}. Both methods find the same contacts.",
                note], legend, panels), encoding="utf-8")
    print(f"\n### {title}\n")
    print(table(["bone", "its surface voxels", "tool's points", "method", "most contacts",
                 "time at about 1,000 contacts (µs)", "tests there", "longest step (µs)",
                 "most contacts in under 1 ms"], summary))


def scene_volume(bench, n):
    """Bone and tool in one cube, the tool where Figure 3's approach begins."""
    name = f"scene_{n}.nrrd"
    say(f"making {name}")
    labels = bodies.paint(bodies.bone(), SCENE_SIDE_MM, n)
    length = math.hypot(*APPROACH_FROM)
    place = [START_MM * a / length for a in APPROACH_FROM]
    tool = bodies.paint(bodies.moved(bodies.tool(), ROTATION, place), SCENE_SIDE_MM, n)
    for at, solid in enumerate(tool):
        if solid:
            labels[at] = TOOL
    assert BONE == 1
    bodies.write_nrrd(bench.palpate.folder / name, labels, SCENE_SIDE_MM, n)
    return name


def figure_4(bench, out, note):
    """Resolution, with collision response: the tool comes, is stopped and settles."""
    size = bench.size
    simulator = Simulator(bench.palpate, bench.palpate.leaf)
    length = math.hypot(*APPROACH_FROM)
    towards = [-a / length for a in APPROACH_FROM]
    found, rows, summary = {}, [], []
    for n in size.scenes:
        case = simulator.case(f"case_{n}", scene_volume(bench, n))
        say(f"figure 4: both bodies in {n}^3, with response")
        steps, report, command = simulator.run(case, towards, SPEED_MM_S, DRAG_PER_S, size.seconds)
        bench.runs.append({"figure": "4", "command": command, "report": report})
        found[n] = steps
        rows += [(n, s.step, f"{s.distance_mm:.4f}", s.contacts, s.tests, s.impulses, s.time_us)
                 for s in steps]
        touching = [s for s in steps if s.contacts > 0]
        if not touching:
            raise RunFailed(f"The tool never met the bone at {n}^3.")
        rest = steps[-len(steps) // 10:]
        summary.append((f"{n}³", f"{SCENE_SIDE_MM / n:.2f}", f"{max(s.contacts for s in steps):,}",
                        micro(median([s.contacts for s in rest])),
                        f"{rest[-1].distance_mm:.2f}",
                        f"{max(s.distance_mm for s in rest) - min(s.distance_mm for s in rest):.3f}",
                        micro(median([s.time_us for s in touching])),
                        micro(quantile([s.time_us for s in touching], 0.99)),
                        micro(max(s.time_us for s in touching)),
                        micro(median([s.tests for s in touching]))))
    write_csv(out / "figure4.csv",
              ["scene_side", "step", "distance_mm", "contacts", "tests", "impulses", "time_us"], rows)

    step = chart.Axis("step (1 ms)", 0, len(found[size.scenes[0]]) - 1)

    def panel(title, axis, of, level=None):
        curves = [chart.Curve([(s.step, of(s)) for s in found[n]], ORDERED[i])
                  for i, n in enumerate(size.scenes)]
        return chart.Panel(title, step, axis([of(s) for n in size.scenes for s in found[n]]),
                           curves, level=level)

    panels = [
        panel("Distance of the centres", lambda v: chart.linear_axis("distance (mm)", v),
              lambda s: s.distance_mm),
        panel("Contacts", lambda v: chart.linear_axis("contacts", v), lambda s: s.contacts),
        panel("Time per step", lambda v: chart.log_axis("time (µs)", v),
              lambda s: max(0.1, s.time_us), level=(HAPTIC_STEP_US, "1 ms")),
        panel("Tests per step", lambda v: chart.log_axis("sphere and leaf tests", v),
              lambda s: max(1, s.tests))]
    title = "Figure 4: an approach at several resolutions, with collision response"
    (out / "figure4.svg").write_text(chart.svg(
        title, [f"palpate simulate; bone and tool in a cube of {SCENE_SIDE_MM:.0f} mm; the tool, a "
                f"loose body, comes at {SPEED_MM_S:.0f} mm/s and is pressed on. Whole steps, once.",
                note], [chart.LegendEntry(f"both in {n}³", ORDERED[i])
                        for i, n in enumerate(size.scenes)], panels), encoding="utf-8")
    print(f"\n### {title}\n")
    print(table(["scene", "voxel (mm)", "most contacts", "contacts at rest",
                 "centres apart at rest (mm)", "motion in the last tenth (mm)",
                 "step in contact p50 (µs)", "p99", "longest", "tests p50"], summary))


# Spheres: tight_spheres, side_offset, colour, width: a later curve lies inside an earlier one, so
# that all are seen where they coincide.
SPHERES = {"full spheres": ("off", "off", VERMILLION, 2.0),
           "side offset": ("off", "on", "#56B4E9", 5.0),
           "tight spheres": ("on", "off", "#00664B", 1.6)}
SKIPS = {"every child tested": ("off", "5 4"), "one-child skip": ("on", "")}
TREES = {"solid": (), "surface": ("--option", "surface_only=on")}
TREE_TEXT = {"solid": "all voxels", "surface": "surface voxels only"}
PLAIN = ("full spheres", "every child tested")


def options_of(spheres, skip):
    tight, side = SPHERES[spheres][:2]
    return ("--option", f"tight_spheres={tight}", "--option", f"side_offset={side}",
            "--option", f"one_child_skip={SKIPS[skip][0]}")


def figure_5(bench, out, note):
    """The paper's options, on and off, at one size; on trees of all and of surface voxels."""
    size = bench.size
    distances, centres = approach(size)
    poses = bench.poses("approach.csv", centres)
    combinations = [(spheres, skip) for skip in SKIPS for spheres in SPHERES]
    methods = [(c, (*PAPER[1], *options_of(*c))) for c in combinations]
    runs = {tree: bench.collide("5", size.fixed, size.tool, poses, (DEFAULT, *methods), lists=True,
                                tree=TREES[tree]) for tree in TREES}
    write_csv(out / "figure5.csv",
              ["tree", "spheres", "one_child_skip", "step", "distance_mm", "contacts",
               "sum_depth_mm", "tests", "time_us"],
              [(tree, spheres, SKIPS[skip][0], s.step, f"{d:.4f}", s.contacts, s.sum_depth_mm,
                s.tests, s.time_us) for tree in TREES for spheres, skip in combinations
               for s, d in zip(runs[tree][spheres, skip].steps, distances)])

    step = chart.Axis("step", 0, size.steps - 1)

    def curve(combination, points):
        *_, colour, width = SPHERES[combination[0]]
        return chart.Curve(points, colour, SKIPS[combination[1]][1], width)

    def panel(title, axis, of):
        drawn = [curve(c, [(s.step, of(s)) for s in runs["solid"][c].steps]) for c in combinations]
        return chart.Panel(title, step, chart.linear_axis(axis, heights(drawn)), drawn)

    def share_panel(tree):
        plain = runs[tree][PLAIN].steps
        near = [i for i, s in enumerate(plain) if s.tests >= 100]  # a share of few says little
        drawn = [curve(c, [(i, 100 * runs[tree][c].steps[i].tests / plain[i].tests) for i in near])
                 for c in combinations]
        return chart.Panel(f"Tests, of those without options, {TREE_TEXT[tree]}", step,
                           chart.Axis("share (%)", max(0, min(heights(drawn)) - 5),
                                      max(heights(drawn)) + 5), drawn)

    def heights(drawn):
        return [y for c in drawn for _, y in c.points] or [0.0, 100.0]

    title = "Figure 5: what the paper's options save"
    (out / "figure5.svg").write_text(chart.svg(
        title, [f"The paper's traversal of an octree; bone {size.fixed}³, tool {size.tool}³, the "
                f"approach of Figure 3. Time: {bench.passes}. "
                "Every combination finds the same contacts.", note],
        [chart.LegendEntry(", ".join(c), look.colour, look.dash, look.width)
         for c in combinations for look in [curve(c, [])]],
        [panel(f"Time per step, {TREE_TEXT['solid']}", "time (µs)", lambda s: s.time_us),
         panel(f"Tests per step, {TREE_TEXT['solid']}", "sphere and leaf tests", lambda s: s.tests),
         share_panel("solid"), share_panel("surface")]), encoding="utf-8")

    def row(tree, name, steps):
        plain = runs[tree][PLAIN].steps
        touching = [i for i, s in enumerate(plain) if s.contacts > 0]
        return (TREE_TEXT[tree], name, at_about_1000(steps, lambda s: s.tests),
                at_about_1000(steps, lambda s: s.time_us),
                share(touching, steps, plain, lambda s: s.tests),
                share(touching, steps, plain, lambda s: s.time_us),
                micro(max(s.time_us for s in steps)))

    def share(at, steps, plain, of):
        whole = sum(of(plain[i]) for i in at)
        return f"{100 * sum(of(steps[i]) for i in at) / whole:.1f} %" if whole else "-"

    print(f"\n### {title}\n")
    print(table(["tree", "the paper's traversal with", "tests at about 1,000 contacts",
                 "time there (µs)", "all tests in contact", "all time in contact",
                 "longest step (µs)"],
                [row(tree, name, runs[tree][key].steps) for tree in TREES
                 for key, name in [*((c, ", ".join(c)) for c in combinations),
                                   (DEFAULT[0], "*the default method instead*")]]))
    labels = bodies.paint(bodies.bone(), bodies.BONE_SIDE_MM, size.fixed)
    print("\nNodes of the bone's octree that have one child:", "; ".join(
        f"{TREE_TEXT[tree]}, {alone:,} of {nodes:,} ({100 * alone / nodes:.1f} %)"
        for tree in TREES for nodes, alone in [bodies.one_child_nodes(
            bodies.solid_voxels(labels, size.fixed, tree == "surface"))]) + ".")


def random_approaches(bench):
    """Trajectories towards the world's centre: for each its radii, step by step.

    Where the bodies first touch is searched in steps of 2 mm by the program itself; a trajectory
    ends 10 mm deeper than that.
    """
    size = bench.size
    generator = random.Random(bench.seed)
    directions = [bodies.uniform_direction(generator) for _ in range(bench.trajectories)]
    radii = [RANDOM_START_MM - i * SEARCH_STEP_MM
             for i in range(int(RANDOM_START_MM / SEARCH_STEP_MM) + 1)]
    poses = bench.poses("search.csv", [[r * a for a in d] for d in directions for r in radii])
    found = bench.palpate.collide(bench.volume("bone", size.fixed), bench.volume("tool", size.tool),
                                  poses).steps
    paths = []
    for t, direction in enumerate(directions):
        touching = [r for r, s in zip(radii, found[t * len(radii):]) if s.contacts > 0]
        if not touching:
            raise RunFailed(f"Trajectory {t} reaches the bone's centre without a contact.")
        travel = RANDOM_START_MM - max(0.0, touching[0] - RANDOM_DEPTH_MM)
        steps = int(travel / size.speed_mm) + 1
        paths.append((direction, [RANDOM_START_MM - i * size.speed_mm for i in range(steps)]))
    return paths


# Half decades of contacts.
BIN_EDGES = (0, 1, 3, 10, 30, 100, 300, 1000, 3000, 10000, 30000, 100000)


def bins_of(steps):
    """(lowest, highest, steps) of each half decade that has steps."""
    for low, high in zip(BIN_EDGES, BIN_EDGES[1:]):
        chosen = [s for s in steps if low <= s.contacts < high]
        if chosen:
            yield low, high - 1, chosen


def figure_6(bench, out, note):
    """Random approaches: time against contacts."""
    size = bench.size
    paths = random_approaches(bench)
    centres = [[r * a for a in direction] for direction, radii in paths for r in radii]
    poses = bench.poses("random.csv", centres)
    runs = bench.collide("6", size.fixed, size.tool, poses, (DEFAULT, PAPER), lists=bench.quick)
    where = [(t, i, r) for t, (_, radii) in enumerate(paths) for i, r in enumerate(radii)]
    write_csv(out / "figure6.csv",
              ["method", "trajectory", "step", "radius_mm", "contacts", "sum_depth_mm", "tests",
               "time_us"],
              [(m, t, i, f"{r:.4f}", s.contacts, s.sum_depth_mm, s.tests, s.time_us)
               for m in METHOD_DASH for (t, i, r), s in zip(where, runs[m].steps)])

    nothing = 0.4  # where "none" stands on an axis of logarithms
    every = [s for m in METHOD_DASH for s in runs[m].steps]
    most = max(s.contacts for s in every)
    across = chart.Axis("contacts", 0.25, max(10.0, 1.3 * most), log=True,
                        extra_ticks={nothing: "none"})
    up = chart.log_axis("time (µs)", [s.time_us for s in every])

    def place(contacts):
        return float(contacts) if contacts else nothing

    shown = ((0.5, BLUE, "p50"), (0.99, GREEN, "p99"), (1.0, VERMILLION, "longest"))
    panels, summary = [], []
    for m in METHOD_DASH:
        steps = runs[m].steps
        groups = list(bins_of(steps))
        panels.append(chart.Panel(
            METHOD_TEXT[m][0].upper() + METHOD_TEXT[m][1:], across, up,
            [chart.Curve([(place(median([s.contacts for s in g])),
                           quantile([s.time_us for s in g], share)) for low, _, g in groups
                          if (low > 0) == touching], colour, marks=True)
             for share, colour, _ in reversed(shown) for touching in (False, True)],
            [chart.Dots([(place(s.contacts), s.time_us) for s in steps], chart.QUIET)],
            level=(HAPTIC_STEP_US, "1 ms")))
        groups.append((1, most, [s for s in steps if s.contacts]))
        for low, high, g in groups:
            times = [s.time_us for s in g]
            label = f"{low:,}" if low == high else f"{low:,} to {high:,}"
            summary.append((METHOD_TEXT[m], "any" if (low, high) == (1, most) else label,
                            f"{len(g):,}", *(micro(quantile(times, share)) for share, *_ in shown),
                            micro(median([s.tests for s in g]))))
    title = "Figure 6: random approaches"
    (out / "figure6.svg").write_text(chart.svg(
        title, [f"{len(paths)} straight approaches from all sides (seed {bench.seed}), "
                f"{size.speed_mm} mm a step from {RANDOM_START_MM:.0f} mm to "
                f"{RANDOM_DEPTH_MM:.0f} mm deep; bone {size.fixed}³, tool {size.tool}³. "
                f"{len(centres):,} steps, each {bench.passes}.", note],
        [chart.LegendEntry("a step", chart.QUIET, dot=True),
         *(chart.LegendEntry(f"{text}, by half decade of contacts", colour)
           for _, colour, text in shown)], panels), encoding="utf-8")
    print(f"\n### {title}\n")
    print(f"{len(paths)} trajectories, seed {bench.seed}, {len(centres):,} steps.\n")
    print(table(["method", "contacts", "steps", "p50 (µs)", "p99 (µs)", "longest (µs)",
                 "tests, median"], summary))


def machine():
    try:
        with open("/proc/cpuinfo", encoding="utf-8", errors="replace") as lines:
            for line in lines:
                if line.startswith("model name"):
                    return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.machine() or "unknown processor"


def commit():
    try:
        done = subprocess.run(["git", "-C", str(HERE), "describe", "--always", "--dirty"],
                              capture_output=True, text=True, timeout=10, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"
    return done.stdout.strip() or "unknown"


def parse(arguments):
    parser = argparse.ArgumentParser(
        description="Draws Figures 3 to 6 of the paper again, from palpate's output.")
    parser.add_argument("--palpate", type=pathlib.Path,
                        default=HERE.parents[2] / "build" / "release" / "app" / "palpate",
                        help="the program; default: the release build's")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for CSV and SVG")
    parser.add_argument("--quick", action="store_true", help="small bodies, few trajectories")
    parser.add_argument("--only", choices=["3", "4", "5", "6"], nargs="+",
                        default=["3", "4", "5", "6"],
                        help="these figures")
    parser.add_argument("--leaf", choices=["voxel", "distance"], default="voxel",
                        help="leaf model; the paper's contacts are voxels")
    parser.add_argument("--seed", type=int, default=2008, help="of Figure 6's directions")
    parser.add_argument("--trajectories", type=int, help="of Figure 6")
    parser.add_argument("--repeats", type=int, help="passes; a step's time is their median")
    parser.add_argument("--timeout", type=float, default=600.0, metavar="S",
                        help="for one run of palpate")
    parser.add_argument("--keep", action="store_true",
                        help="keep volumes and poses in DIR/work, to repeat runs.json by hand")
    options = parser.parse_args(arguments)
    for name in ("trajectories", "repeats"):
        value = getattr(options, name)
        if value is not None and value < 1:
            parser.error(f"--{name} is {value}; give 1 or more.")
    if options.timeout <= 0:
        parser.error(f"--timeout is {options.timeout}; give seconds above 0.")
    return options


def draw(options, folder):
    palpate = Palpate(options.palpate, folder, options.leaf, options.timeout)
    bench = Bench(palpate, QUICK if options.quick else FULL, options)
    note = f"{machine()}; commit {commit()}; {options.leaf} leaves."
    print(note + (" A quick run: sizes too small to say anything of the paper."
                  if options.quick else ""))
    if "3" in options.only:
        figure_3(bench, options.out, note, both=False)
        figure_3(bench, options.out, note, both=True)
    if "4" in options.only:
        figure_4(bench, options.out, note)
    if "5" in options.only:
        figure_5(bench, options.out, note)
    if "6" in options.only:
        figure_6(bench, options.out, note)
    (options.out / "runs.json").write_text(json.dumps(
        {"machine": machine(), "commit": commit(), "seed": options.seed, "quick": options.quick,
         "runs": bench.runs}, indent=1) + "\n", encoding="utf-8")


def main(arguments=None):
    options = parse(arguments)
    try:
        options.out.mkdir(parents=True, exist_ok=True)
        if options.keep:
            work = options.out / "work"
            work.mkdir(exist_ok=True)
            draw(options, work)
        else:
            with tempfile.TemporaryDirectory(prefix="palpate-figures-") as work:
                draw(options, pathlib.Path(work))
    except ContactsDiffer as error:
        say(f"The contacts differ. {error}")
        return 1
    except RunFailed as error:
        say(str(error))
        return 4
    except OSError as error:
        say(f"A file could not be written: {error.filename}: {error.strerror}.")
        return 4
    except KeyboardInterrupt:
        say("Cancelled; the figures that were not reached are missing or old.")
        return 5
    return 0


if __name__ == "__main__":
    sys.exit(main())
