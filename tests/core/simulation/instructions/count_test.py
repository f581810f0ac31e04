#!/usr/bin/env python3
"""Instructions of a step, as shipped with every effect off and in a build that never had them.

Counted by valgrind's callgrind (it follows every instruction, so that the numbers are exact and the
same on every run) within Simulation::step alone. The two builds must come to the same state.
"""

import re
import shutil
import subprocess
import sys
import tempfile

STEPS = 400
# What effects leave behind where they are off, in a step and whatever it touches (132 were counted):
# a test and a jump, and the loads they need, at each of the some twenty places that go through the
# loose bodies, pairs and islands. Nothing of it is done again for a contact or an impulse.
MOST_FREE = 150
MOST_CONTACT = 0.005  # of the step


def count(program, *arguments):
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(
            ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out",
             "--toggle-collect=palpate::Simulation::step(*", program, *arguments],
            capture_output=True, text=True, check=False)
    found = re.search(r"Collected : (\d+)", run.stderr)
    if run.returncode != 0 or not found:
        sys.exit(f"valgrind did not count: {run.stderr[-2000:]}")
    return int(found.group(1)) / STEPS, run.stdout.strip()


def main():
    shipped, never = sys.argv[1:3]
    if shutil.which("valgrind") is None:
        print("Skipped: instructions are counted by valgrind, which is not installed.")
        sys.exit(77)
    failed = False
    for where in ("free", "contact"):
        a, said_a = count(shipped, where, str(STEPS))
        b, said_b = count(never, where, str(STEPS))
        on, _ = count(shipped, where, str(STEPS), "friction")
        print(f"{where}: {a:.1f} instructions a step with effects off, {b:.1f} where there never "
              f"were any: {a - b:+.1f} ({100 * (a - b) / b:+.2f} %); {on:.1f} with friction on; "
              f"{said_a}")
        if said_a != said_b:
            print(f"FAILED: the builds came to different states: {said_a}; {said_b}")
            failed = True
        most = MOST_FREE if where == "free" else MOST_CONTACT * b
        if a - b > most:
            print(f"FAILED: effects that are off cost more than {most:.0f} instructions")
            failed = True
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
