#!/usr/bin/env python3
"""The window for ten minutes: both loops in real time, rendering, the built-in hand at work.

  soak.py --palpate PROGRAM --watch LIBRARY --case CASE [--seconds 600]

Fails where a loop allocated or locked, a sample was lost, or energy was generated. Prints the
histograms. Needs a display (or xvfb-run).
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--palpate", required=True)
    parser.add_argument("--watch", required=True, help="the library that counts")
    parser.add_argument("--case", required=True)
    parser.add_argument("--seconds", type=float,
                        default=float(os.environ.get("PALPATE_SOAK_SECONDS", "600")))
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "soak.json"
        done = subprocess.run(
            [options.palpate, "--case", options.case, "--soak", str(options.seconds), "--report",
             str(report)], env={**os.environ, "LD_PRELOAD": options.watch}, capture_output=True,
            text=True, timeout=options.seconds + 120, check=False)
        if done.returncode != 0:
            sys.exit(f"palpate ended with {done.returncode}: {done.stderr.strip()}")
        run = json.loads(report.read_text(encoding="utf-8"))
    # Helper programs of the window report too; the program itself speaks last.
    told = re.findall(r"loop watch: palpate-servo (\d+) allocations (\d+) locks; "
                      r"palpate-step (\d+) allocations (\d+) locks", done.stderr)
    checks = {
        "the loops neither allocate nor lock": bool(told) and set(told[-1]) == {"0"},
        "no sample was lost": run["recorder_drops"] == 0,
        "every tick was made or counted": run["ticks"] + run["ticks_missed"]
                                          >= 1000 * (options.seconds - 2),
        "no energy was generated": run["hand_energy_min_J"] >= -20e-6,
        "the hand was in contact": run["contacts_max"] > 0,
        "frames were drawn": run["frames"] > 5 * options.seconds,
    }
    for name in ("step", "tick", "lateness"):
        print(f"{name}, us:", json.dumps(run[f"{name}_us"]))
        for row in run[f"{name}_histogram"]:
            print(f"  {row['from_us']:>8.0f} to {row['to_us'] or float('inf'):>8.0f}: {row['count']}")
    for key in ("steps", "ticks", "ticks_late", "ticks_missed", "hand_energy_J",
                "hand_energy_min_J", "force_max_N", "frames", "frame_ms", "real_time"):
        print(f"{key}: {run[key]}")
    print("loop watch:", told[-1] if told else "said nothing")
    for what, holds in checks.items():
        print(f"{'ok' if holds else 'FAILED'}: {what}")
    return 0 if all(checks.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
