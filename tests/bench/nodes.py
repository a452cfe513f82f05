# SPDX-License-Identifier: MIT
"""What would a scene cost that no one machine bakes? A model, with constants measured here, of processes that share a bake by MPI
(-DHEMIBAKE_MPI=ON): seconds and memory of a node for 10^7, 10^8 and 10^9 receivers on 1 to 1,000 nodes.

    python3 tests/bench/nodes.py [SCENE.glb] [--hemibake build/release/bin/hemibake]

Measured, from bakes of a scene at two sizes of element on one thread, and on two: seconds and bytes a receiver (a sample), of what is shared (rows:
casting, gathering, parts of elements) and of what each process does and keeps for itself (mesh, light of all elements, colours), and which part of the latter threads share.
Assumed,
and printed: cores and memory of a node, and the network. Nothing of it is a measurement of 1,000 nodes.
"""

import argparse
import json
import math
import os
import subprocess
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SHARED = os.path.join(os.path.dirname(ROOT), "shared", "scenes", "living-room.glb")

CORES, NODE_BYTES = 64, 512 * 2**30        # of a node
LATENCY_S, BYTES_A_SECOND = 5e-6, 10e9      # of a message, and of what a node takes in
SAMPLES_OF_AN_ELEMENT, BYTES_OF_AN_ELEMENT = 3.5, 24  # one vector of three bands an iteration
ITERATIONS = 15
BYTES_GIVEN_ONCE = 24 + 24 + 8 + 48 + 24    # a sample: direct light, irradiance, row sum, sky, halves

NODES, RECEIVERS = (1, 10, 100, 1000), (10**7, 10**8, 10**9)


def bake(hemibake, scene, size, threads, folder):
    report = os.path.join(folder, "report.json")
    subprocess.run([hemibake, "bake", scene, "-o", os.path.join(folder, "out.glb"), "--method", "rows", "--quality", "draft",
                    "--element-size", str(size), "--threads", str(threads), "--environment", "1,1,1", "--report", report, "--quiet"],
                   check=False, stdout=subprocess.DEVNULL)
    with open(report, encoding="utf-8") as f:
        told = json.load(f)
    shared = told["time"]["solve_s"] + told["time"]["refine_s"]
    return told["scene"]["samples"], shared, told["time"]["total_s"] - shared, told["memory"]["peak_bytes"]


def constants(hemibake, scene):
    """(seconds shared, seconds of each on one thread and on many, bytes shared, bytes of each), a sample."""
    with tempfile.TemporaryDirectory() as folder:
        few, many = (bake(hemibake, scene, size, 1, folder) for size in (0.1, 0.05))
        twice = bake(hemibake, scene, 0.05, 2, folder)
    samples = many[0] - few[0]
    seconds = [(many[i] - few[i]) / samples for i in (1, 2)]
    memory = (many[3] - few[3]) / samples
    # A row's rays take 8 bytes each; draft casts at least 8 of a sample, and about as many adaptive ones.
    rays = 8 * 16
    threaded = min(max(2.0 * (1.0 - twice[2] / many[2]), 0.0), 1.0)
    return seconds[0], (1.0 - threaded) * seconds[1], threaded * seconds[1], rays, max(memory - rays, 0.0)


def cost(receivers, nodes, c):
    shared_s, alone_s, threaded_s, shared_bytes, own_bytes = c
    elements = receivers / SAMPLES_OF_AN_ELEMENT
    work = receivers * (shared_s / (nodes * CORES) + threaded_s / CORES + alone_s)
    given = ITERATIONS * elements * BYTES_OF_AN_ELEMENT + receivers * BYTES_GIVEN_ONCE
    exchange = 0.0 if nodes == 1 else given / BYTES_A_SECOND + (ITERATIONS + 5) * LATENCY_S * nodes * math.ceil(math.log2(nodes))
    return work + exchange, exchange, receivers * (shared_bytes / nodes + own_bytes)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("scene", nargs="?", default=SHARED)
    parser.add_argument("--hemibake", default=os.path.join(ROOT, "build/release/bin/hemibake"))
    asked = parser.parse_args()
    c = constants(asked.hemibake, asked.scene)
    print(f"measured: {1e6 * c[0]:.1f} us of one core and {c[3]:.0f} B a receiver are shared; {1e6 * (c[1] + c[2]):.1f} us and {c[4]:.0f} B are each "
          f"process's own, {1e6 * c[1]:.1f} us of them on one thread alone")
    print(f"assumed: {CORES} cores and {NODE_BYTES >> 30} GiB a node, all of them used; {BYTES_A_SECOND / 1e9:.0f} GB/s, "
          f"{1e6 * LATENCY_S:.0f} us a message; {ITERATIONS} iterations")
    print()
    print("| receivers | nodes | seconds | of them exchange | GiB a node |")
    print("|---:|---:|---:|---:|---:|")
    for receivers in RECEIVERS:
        for nodes in NODES:
            seconds, exchange, memory = cost(receivers, nodes, c)
            fits = "" if memory <= NODE_BYTES else ", more than there are"
            print(f"| 10^{round(math.log10(receivers))} | {nodes:,} | {seconds:,.1f} | {exchange:,.1f} | {memory / 2**30:,.0f}{fits} |")


if __name__ == "__main__":
    main()
