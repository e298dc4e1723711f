#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lines that the tests run, of each folder: coverage.py SUMMARY, which gcovr --json-summary wrote.

Exit status 1 if fewer of all lines are run than FLOOR_PERCENT says.
"""

import json
import sys

# A little below the measured 97.2, because counts of threads may be lost. Raise it when the coverage
# has risen.
FLOOR_PERCENT = 97.0


def percent(covered, lines):
    return 100 * covered / lines if lines else 100.0


def main(summary):
    with open(summary, encoding="utf-8") as stream:
        files = json.load(stream)["files"]
    if not files:
        sys.exit("coverage: no line of any file was counted")
    folders = {}
    for entry in files:
        of = folders.setdefault(entry["filename"].split("/")[0], [0, 0, 0])
        of[0] += 1
        of[1] += entry["line_total"]
        of[2] += entry["line_covered"]
    print(f"{'folder':<14}{'files':>8}{'lines':>10}{'run':>10}{'%':>8}")
    for name, (count, lines, covered) in sorted(folders.items()):
        print(f"{name:<14}{count:>8}{lines:>10}{covered:>10}{percent(covered, lines):>8.1f}")
    count, lines, covered = (sum(of[i] for of in folders.values()) for i in range(3))
    share = percent(covered, lines)
    print(f"{'all':<14}{count:>8}{lines:>10}{covered:>10}{share:>8.1f}")
    if share < FLOOR_PERCENT:
        print(f"coverage: {share:.1f} % of the lines are run, expected at least {FLOOR_PERCENT} %")
        return 1
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
