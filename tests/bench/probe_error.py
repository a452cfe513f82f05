# SPDX-License-Identifier: MIT
"""How far is a baked mesh from path-traced probes, computed apart from hemibake? The same definition in another program: every
probe takes the triangle it lies on, front to front, radiance is interpolated there, and the error is relative [Baum89, eq. 12].
speed_error.py compares this with `hemibake compare`, so that no tool is its own judge.

    python3 tests/bench/probe_error.py BAKED.glb PROBES.hprb      a bake with _RADIOSITY, without Draco
"""

import struct
import sys

import numpy

from radiance_glb import read_radiance

# Probes are floats: how far one may lie off its triangle, of the size of the scene, and how far its normal may turn.
OFF_PLANE, FACING = 2e-5, 0.5


def read_probes(path):
    with open(path, "rb") as f:
        content = f.read()
    magic, count = struct.unpack_from("<4sI", content)
    if magic != b"HPRB":
        raise ValueError(f"{path}: no probe file")
    return numpy.frombuffer(content, "<f4", 10 * count, 8).reshape(count, 10).astype(float)


def place(point, normal, corners, normals, doubled_areas, tolerance):
    """The triangle a probe lies on and its barycentric coordinates; None if there is none."""
    height = numpy.abs(numpy.einsum("tk,tk->t", point - corners[:, 0], normals))
    near = numpy.flatnonzero((height <= tolerance) & (normals @ normal > FACING))
    if not len(near):
        return None
    weights = numpy.empty((len(near), 3))
    for k in range(3):
        a, b = corners[near, (k + 1) % 3], corners[near, (k + 2) % 3]
        weights[:, k] = numpy.einsum("tk,tk->t", numpy.cross(b - a, point - a), normals[near]) / doubled_areas[near]
    best = weights.min(axis=1).argmax()
    return (near[best], weights[best]) if weights[best].min() > -1e-3 else None


def probe_error(baked, probes_path):
    """Relative error and how many probes found no triangle."""
    corners, radiance = read_radiance(baked)
    probes = read_probes(probes_path)
    normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled_areas = numpy.linalg.norm(normals, axis=1)
    solid = doubled_areas > 0
    corners, radiance, normals, doubled_areas = corners[solid], radiance[solid], normals[solid], doubled_areas[solid]
    normals /= doubled_areas[:, None]
    tolerance = OFF_PLANE * numpy.ptp(corners, axis=(0, 1)).max()
    difference = truth = 0.0
    lost = 0
    for probe in probes:
        found = place(probe[:3], probe[3:6], corners, normals, doubled_areas, tolerance)
        if found is None:
            lost += 1
            continue
        triangle, weights = found
        difference += ((weights @ radiance[triangle] - probe[6:9]) ** 2).sum()
        truth += (probe[6:9] ** 2).sum()
    return (difference / truth) ** 0.5, lost


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    print("relative error {:.5f}; {} probes on no triangle".format(*probe_error(*sys.argv[1:])))
