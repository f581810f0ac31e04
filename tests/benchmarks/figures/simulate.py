"""A case of two voxel bodies for `palpate simulate`, and what a run of it writes."""

import csv
import math
from dataclasses import dataclass

from collide import RunFailed

STEPS_HEADING = ["step", "step_ms", "parts", "contacts", "body_contacts", "depth_mm", "tests", "impulses",
                 "time_us", "stiffness_N_per_m"]
BODIES_HEADING = ["step", "body", "x_mm", "y_mm", "z_mm", "qw", "qx", "qy", "qz"]

BONE, TOOL = 1, 2  # the labels of the volume

SCENE = """format = 1
name = ""
labels = ["bone"]
instrument = "ball-burr"
device = "touch-x"

[device_pose]
origin_mm = [0, 0, 1000]
rotation_wxyz = [1, 0, 0, 0]

[[body]]
label = "tool"
separate = false

[surroundings]
gravity_m_per_s2 = [{gravity}]
drag_per_s = {drag!r}

[setting]
leaf = "{leaf}"
"""


@dataclass(frozen=True)
class SimulatedStep:
    step: int
    distance_mm: float  # of the centre of mass from the origin
    contacts: int
    tests: int
    impulses: int
    time_us: float


class Simulator:
    """Makes cases in the program's folder and runs them."""

    def __init__(self, palpate, leaf):
        self.palpate, self.leaf = palpate, leaf

    def case(self, name, volume):
        """A case of `volume` (NRRD) whose values BONE and TOOL are labels of these names."""
        self.palpate.command(["import", volume, "--out", name, "--json"], "dims")
        for label, value in (("bone", BONE), ("tool", TOOL)):
            self.palpate.command(["segment", name, "--threshold", str(value), str(value),
                                  "--label", label, "--json"], "labels")
        return name

    def run(self, case, towards, speed_mm_s, drag, seconds):
        """The tool falls along `towards` (a unit vector) at an end speed of speed_mm_s.

        The instrument stands a metre away, out of it. Raises RunFailed.
        """
        pull = speed_mm_s / 1000.0 * drag
        text = SCENE.format(gravity=", ".join(repr(pull * t) for t in towards), drag=float(drag),
                            leaf=self.leaf)
        folder = self.palpate.folder
        (folder / case / "scene.toml").write_text(text, encoding="ascii")
        (folder / "hand.csv").write_text("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,buttons\n"
                                         "0,0,0,0,1,0,0,0,0\n", encoding="ascii")
        command = ["simulate", case, "--seconds", repr(seconds), "--hand", "hand.csv",
                   "--steps", "steps.csv", "--bodies", "bodies.csv", "--json"]
        report = self.palpate.command(command, "steps")
        steps = read_rows(folder / "steps.csv", STEPS_HEADING)
        places = read_rows(folder / "bodies.csv", BODIES_HEADING)
        if len(steps) != len(places):
            raise RunFailed(f"{len(steps)} steps, but {len(places)} places of the tool.")
        found = [SimulatedStep(i, math.hypot(*(float(p[a]) for a in ("x_mm", "y_mm", "z_mm"))),
                               int(s["body_contacts"]), int(s["tests"]), int(s["impulses"]),
                               float(s["time_us"])) for i, (s, p) in enumerate(zip(steps, places))]
        return found, report, ["palpate", *command]


def read_rows(path, heading):
    """The rows by column; refuses another heading."""
    try:
        with open(path, newline="", encoding="ascii") as file:
            reader = csv.DictReader(file)
            rows = list(reader)
    except OSError as error:
        raise RunFailed(f"palpate wrote no {path.name}: {error.strerror}.") from None
    if reader.fieldnames != heading:
        raise RunFailed(f"{path.name} begins with {reader.fieldnames}, not {','.join(heading)}.")
    return rows
