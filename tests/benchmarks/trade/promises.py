#!/usr/bin/env python3
"""What quick sweeps promise of other motions, and what these have.

    promises.py PALPATE OUT.csv CASE...

For seeds 1, 3 ... 39 of each case: the setting that `palpate tradeoff CASE --quick --choose` picks, what
it promises, and what the same setting has over the motions of the next seed. Eight minutes for two cases;
times want a quiet machine.
"""

import csv
import json
import pathlib
import subprocess
import sys

SEEDS = range(1, 41, 2)
WITHIN = 1.1  # a promise holds within a tenth


def chosen(program, case, seed):
    run = subprocess.run([program, "tradeoff", case, "--quick", "--choose", "--seed", str(seed), "--json"],
                         capture_output=True, text=True, check=True)
    return json.loads(run.stdout)["chosen"]


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    program, out, *cases = sys.argv[1:]
    parts = ("force_N", "depth_mm", "step_us")
    with open(out, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["case", "seed", "setting"] + [f"{p}_{w}" for p in parts for w in ("promised", "found")])
        for case in cases:
            ratios = {part: [] for part in parts}
            for seed in SEEDS:
                point = chosen(program, case, seed)
                promise, checked = point["promise"], point["checked"]
                pairs = [(promise["force_error_p95_N"], checked["force_error_p95_N"]),
                         (promise["depth_error_p95_mm"], checked["depth_error_p95_mm"]),
                         (promise["step_p999_us"], checked["step_us"]["p999"])]
                writer.writerow([pathlib.Path(case).name, seed, point["name"]]
                                + [f"{value:.4f}" for pair in pairs for value in pair])
                for part, (promised, found) in zip(parts, pairs):
                    ratios[part].append(found / promised)
            for part, values in ratios.items():
                print(f"{case}: {part} held {sum(v <= WITHIN for v in values)} of {len(values)}, "
                      f"at worst {max(values):.2f} of the promise")


if __name__ == "__main__":
    main()
