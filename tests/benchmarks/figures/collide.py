"""Runs palpate, and reads what `palpate collide` writes."""

import csv
import json
import os
import pathlib
import subprocess
from dataclasses import dataclass

POSES_HEADING = "step,r00,r01,r02,tx,r10,r11,r12,ty,r20,r21,r22,tz"
OUT_HEADING = ["step", "contacts", "sum_depth_mm", "tests", "time_us"]


class RunFailed(Exception):
    """The program is not there or did not do what it was asked for; the text says what to do."""


@dataclass(frozen=True)
class Step:
    step: int
    contacts: int
    sum_depth_mm: float
    tests: int
    time_us: float


@dataclass(frozen=True)
class Run:
    steps: list
    report: dict  # the program's JSON
    command: list  # without folders
    contact_list: bytes  # empty where it was not asked for


def write_poses(path, rotation, translations_mm):
    """Steps 0, 1, ... of a tool that keeps its rotation (three rows)."""
    lines = [POSES_HEADING]
    for step, t in enumerate(translations_mm):
        numbers = [repr(float(v)) for row, shift in zip(rotation, t) for v in (*row, shift)]
        lines.append(",".join([str(step), *numbers]))
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


class Palpate:
    """The program, and a folder for what it reads and writes."""

    def __init__(self, program, folder, leaf, timeout_s):
        self.program = pathlib.Path(program)
        self.folder = folder
        self.leaf = leaf
        self.timeout_s = timeout_s
        if not self.program.is_file():
            raise RunFailed(f"There is no program at {self.program}. Build it "
                            "(cmake --build --preset release --target palpate) "
                            "or say with --palpate where it is.")
        if not os.access(self.program, os.X_OK):
            raise RunFailed(f"{self.program} cannot be executed; give the palpate program.")

    def collide(self, world, body, poses, *arguments, repeats=1, with_contacts=False):
        """`world`, `body`, `poses`: files in the folder. Raises RunFailed."""
        out, contacts = self.folder / "out.csv", self.folder / "contacts.csv"
        for stale in (out, contacts):
            stale.unlink(missing_ok=True)
        command = ["collide", "--world", world, "--body", body, "--poses", poses, "--out", out.name,
                   "--leaf", self.leaf, *arguments, "--repeats", str(repeats), "--json"]
        if with_contacts:
            command += ["--contacts", contacts.name]
        report = self.command(command, "surface_voxels")
        return Run(read_out(out, self._count_poses(poses)), report, ["palpate", *command],
                   contacts.read_bytes() if with_contacts else b"")

    def _count_poses(self, poses):
        with open(self.folder / poses, encoding="ascii") as lines:
            return sum(1 for _ in lines) - 1

    def command(self, command, field):
        """Runs any command; its JSON report, which must have `field`. Raises RunFailed."""
        shown = "palpate " + " ".join(command)
        try:
            done = subprocess.run([str(self.program.resolve()), *command], cwd=self.folder,
                                  capture_output=True, text=True, encoding="utf-8",
                                  errors="replace", timeout=self.timeout_s, check=False)
        except subprocess.TimeoutExpired:
            raise RunFailed(f"'{shown}' took longer than {self.timeout_s} s; "
                            "see --timeout.") from None
        except OSError as error:
            raise RunFailed(f"{self.program} does not start: {error.strerror}.") from None
        if done.returncode != 0:
            lines = done.stderr.strip().splitlines() or ["It said nothing."]
            raise RunFailed(f"'{shown}' ended with {done.returncode}: {lines[-1]}")
        try:
            report = json.loads(done.stdout)
        except json.JSONDecodeError:
            report = None
        if not isinstance(report, dict) or field not in report:
            raise RunFailed(f"'{shown}' printed no report in JSON: {done.stdout[:200]!r}")
        return report


def read_out(path, poses):
    """The steps of `collide --out`; refuses another heading and a row too many or too few."""
    try:
        with open(path, newline="", encoding="ascii") as file:
            rows = list(csv.reader(file))
    except OSError as error:
        raise RunFailed(f"palpate wrote no {path.name}: {error.strerror}.") from None
    if not rows or rows[0] != OUT_HEADING:
        raise RunFailed(f"{path.name} begins with {rows[:1]}, not with {','.join(OUT_HEADING)}.")
    try:
        steps = [Step(int(s), int(c), float(d), int(t), float(us)) for s, c, d, t, us in rows[1:]]
    except ValueError as error:
        raise RunFailed(f"{path.name} holds what is not a number: {error}.") from None
    if [s.step for s in steps] != list(range(poses)):
        raise RunFailed(f"{path.name} has {len(steps)} rows for {poses} poses, "
                        "or has them in another order.")
    return steps
