# SPDX-License-Identifier: MIT
"""How did many bakes go? Gathers the reports of --report into one.

    python3 report_merge.py [--expect NAMES.txt] [-o ALL.json] REPORT.json ...

Prints a table and writes every asset with its error, time, memory and size, and the sums. NAMES.txt lists, one a line, the
outputs that there should be: one without a report has failed. Exit status 1: some asset failed, or a report cannot be read.
"""

import argparse
import json
import os
import sys


def asset_of(path):
    """What one report says, in a line's worth of numbers."""
    with open(path) as f:
        report = json.load(f)
    return {
        "output": report["output"]["path"],
        "input": report["input"]["path"],
        "converged": report["solver"]["converged"],
        "error": report["error"]["estimate"],
        "seconds": report["time"]["total_s"],
        "peak_bytes": report["memory"]["peak_bytes"],
        "bytes": report["output"]["bytes"],
        "elements": report["scene"]["elements"],
        "not_baked": len(report["scene"].get("not_baked", [])),
        "report": path,
    }


def read_all(paths):
    """Assets, and the faults of reports that are none."""
    assets, faults = [], []
    for path in sorted(paths):
        try:
            assets.append(asset_of(path))
        except (OSError, ValueError, KeyError, TypeError) as e:
            faults.append(f"{path}: no report of hemibake: {e if isinstance(e, OSError) else type(e).__name__}")
    return assets, faults


def missing(expected, assets):
    there = {os.path.basename(asset["output"]) for asset in assets}
    return [name for name in expected if os.path.basename(name) not in there]


def totals(assets, failed):
    return {
        "assets": len(assets),
        "failed": len(failed),
        "not_converged": sum(not asset["converged"] for asset in assets),
        "seconds": sum(asset["seconds"] for asset in assets),
        "bytes": sum(asset["bytes"] for asset in assets),
        "largest_error": max((asset["error"] for asset in assets), default=None),
        "largest_peak_bytes": max((asset["peak_bytes"] for asset in assets), default=None),
    }


def show(assets, failed, total):
    for asset in assets:
        state = "" if asset["converged"] else "  not converged"
        print(f"{asset['output']}  error {100 * asset['error']:.1f} %  {asset['seconds']:.2f} s  "
              f"{asset['peak_bytes'] / 2**20:.0f} MiB  {asset['bytes'] / 1e3:.1f} kB{state}")
    for name in failed:
        print(f"{name}  FAILED")
    print(f"{total['assets']} baked, {total['failed']} failed, {total['seconds']:.2f} s of work")


def main():
    arguments = argparse.ArgumentParser(description="Gathers the reports of many bakes into one.")
    arguments.add_argument("reports", nargs="*", metavar="REPORT.json")
    arguments.add_argument("--expect", metavar="NAMES.txt", help="outputs that there should be, one a line")
    arguments.add_argument("-o", metavar="ALL.json", dest="out", help="where the whole goes")
    given = arguments.parse_args()
    assets, faults = read_all(given.reports)
    expected = open(given.expect).read().splitlines() if given.expect else []
    failed = missing(expected, assets)
    total = totals(assets, failed)
    show(assets, failed, total)
    for fault in faults:
        print(f"report_merge.py: {fault}", file=sys.stderr)
    if given.out:
        with open(given.out, "w") as f:
            json.dump({"total": total, "failed": failed, "assets": assets}, f, indent=1)
    sys.exit(1 if failed or faults else 0)


main()
