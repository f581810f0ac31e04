#!/usr/bin/env python3
"""Instructions of a step at every setting that a sweep changes by itself.

    instructions.py SETTINGS_COUNTED CASE OUT.csv

SETTINGS_COUNTED is the program of that name (target `settings_counted`). Counted by valgrind's
callgrind within Simulation::step alone, on the thread that steps: the mean over an approach and four
slides, the same at every run of the same build. Valgrind has no AVX-512: what is counted is the program's AVX2 path.
"""

import csv
import os
import pathlib
import re
import subprocess
import sys
import tempfile


def dumps(folder):
    """Instructions by setting."""
    counted = {}
    for file in pathlib.Path(folder).iterdir():
        text = file.read_text(encoding="utf-8")
        name = re.search(r"^desc: Trigger: Client Request: (.+)$", text, re.MULTILINE)
        total = re.search(r"^(?:totals|summary): (\d+)", text, re.MULTILINE)
        if name and total:
            counted[name.group(1)] = counted.get(name.group(1), 0) + int(total.group(1))
    return counted


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    program, case, out = sys.argv[1:]
    data = str(pathlib.Path(__file__).resolve().parents[3])  # datasets and shaders
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", "--collect-atstart=no",
             "--toggle-collect=palpate::Simulation::step(*", program, case],
            capture_output=True, text=True, check=False, env={**os.environ, "PALPATE_DATA_DIR": data})
        if run.returncode != 0:
            sys.exit(f"{program}: {run.stderr[-2000:]}")
        counted = dumps(folder)
    rows = []
    for line in run.stdout.splitlines():
        name, steps = line.rsplit(" ", 1)
        if not counted.get(name):
            sys.exit(f"nothing was counted for {name}: is the symbol of Simulation::step gone?")
        rows.append((name, int(steps), counted[name] / int(steps)))
    own = rows[0][2]
    with open(out, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["name", "steps", "instructions_a_step", "of_default"])
        for name, steps, mean in rows:
            writer.writerow([name, steps, f"{mean:.1f}", f"{mean / own:.3f}"])
            print(f"{name:24} {mean:12.0f} {mean / own:8.2f}")


if __name__ == "__main__":
    main()
