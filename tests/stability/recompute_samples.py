#!/usr/bin/env python3
"""Recomputes what a run promised from `palpate simulate --samples FILE.csv` alone.

Energy at the device's port E = -sum F[k-1].(x[k] - x[k-1]), torque likewise, never below -20 uJ;
the force rises and turns by at most 1 N a millisecond; peak and continuous limits hold, the latter
after a second above it. Shares nothing with the program. Exit 1 and a line for each promise broken.
"""
import argparse
import csv
import math
import sys

# Force N and torque Nm: nine tenths of the device's own limits, 6 N at most.
LIMITS = {"touch": (2.97, 0.792, 0.0), "touch-x": (6.0, 1.575, 0.0),
          "premium-6dof": (6.0, 1.26, 0.1692)}
COLUMNS = "t_s x_m y_m z_m qw qx qy qz vx vy vz fx_N fy_N fz_N tx_Nm ty_Nm tz_Nm".split()


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def turn(p, q):
    """Rotation vector from unit quaternion p to q, both (w, x, y, z), for small turns."""
    return [2 * (-q[0] * p[1] + q[1] * p[0] - q[2] * p[3] + q[3] * p[2]),
            2 * (-q[0] * p[2] + q[1] * p[3] + q[2] * p[0] - q[3] * p[1]),
            2 * (-q[0] * p[3] - q[1] * p[2] + q[2] * p[1] + q[3] * p[0])]


def recompute(rows):
    energy = lowest = rise = force = torque = 0.0
    for a, b in zip(rows, rows[1:]):
        f, g = a[11:14], b[11:14]
        energy -= dot(f, [y - x for x, y in zip(a[1:4], b[1:4])])
        energy -= dot(a[14:17], turn(a[4:8], b[4:8]))
        lowest = min(lowest, energy)
        m, n = math.hypot(*f), math.hypot(*g)
        kept = n / m if n < m else 1.0  # the magnitude may fall at once
        change = math.hypot(*[y - kept * x for x, y in zip(f, g)])
        rise = max(rise, change / (1e3 * (b[0] - a[0])))
        force, torque = max(force, n), max(torque, math.hypot(*b[14:17]))
    return lowest, rise, force, torque


def longest_above(rows, limit):
    longest = since = 0.0
    start = None
    for r in rows:
        above = math.hypot(*r[11:14]) > limit
        start = (r[0] if start is None else start) if above else None
        since = r[0] - start if above else 0.0
        longest = max(longest, since)
    return longest


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--device", choices=LIMITS, default="touch-x")
    options = parser.parse_args()
    peak, continuous, most_torque = LIMITS[options.device]
    with open(options.file, newline="", encoding="utf-8") as stream:
        rows = [[float(r[c]) for c in COLUMNS] for r in csv.DictReader(stream)]
    numbers = len(rows) > 1 and all(math.isfinite(x) for r in rows for x in r)
    if not numbers or any(b[0] <= a[0] for a, b in zip(rows, rows[1:])):
        sys.exit(f"{options.file}: no samples, or not all are numbers in order of time")
    lowest, rise, force, torque = recompute(rows)
    printed = 1e-5  # the file's last digit
    promises = [("lowest energy, uJ", 1e6 * lowest, lowest >= -20e-6),
                ("rise, N a ms", rise, rise <= 1 + printed),
                ("force, N", force, force <= peak + printed),
                ("torque, Nm", torque, torque <= most_torque + printed),
                ("above the continuous limit, s", longest_above(rows, continuous + printed),
                 longest_above(rows, continuous + printed) <= 1.0)]
    for what, value, holds in promises:
        print(f"{what}: {value:.6g}{'' if holds else '  BROKEN'}")
    return 0 if all(holds for _, _, holds in promises) else 1


if __name__ == "__main__":
    sys.exit(main())
