# SPDX-License-Identifier: MIT
"""What does a set of (seconds, error) points say? Its lower envelope, the time at a given error, and how the error falls.

    the envelope     points that no other beats in both seconds and error
    time at error e  where the line between neighbours of the envelope crosses e, both axes logarithmic
    beyond its end   error = c t^-p, p fitted to the slower half of the envelope; at best p = 1/2, since the noise of a Monte
                     Carlo method falls as the root of its samples, and what vertices cannot hold comes on top
"""

import collections
import math

Point = collections.namedtuple("Point", "seconds error label")
Crossing = collections.namedtuple("Crossing", "seconds kind")  # kind: "measured", "at most" or "extrapolated"

MONTE_CARLO_SLOPE = 0.5


def envelope(points):
    """Fastest first."""
    best = []
    for p in sorted(points, key=lambda p: (p.seconds, p.error)):
        if not best or p.error < best[-1].error:
            best.append(p)
    return best


def falling_exponent(points):
    """Least squares of log error on log seconds over the slower half of an envelope, negated; three points at least."""
    half = points[-max(3, (len(points) + 1) // 2):]
    return -exponent([p.seconds for p in half], [p.error for p in half])


def exponent(x, y):
    """Slope of the least-squares line of log y on log x; nan for a single x."""
    x, y = [math.log(v) for v in x], [math.log(v) for v in y]
    middle_x, middle_y = sum(x) / len(x), sum(y) / len(y)
    spread = sum((v - middle_x) ** 2 for v in x)
    return sum((a - middle_x) * (b - middle_y) for a, b in zip(x, y)) / spread if spread > 0 else math.nan


def time_at(points, error, slope=None):
    """When an envelope reaches an error; None where it does not and no slope says when it would."""
    for before, after in zip([None] + points, points):
        if after.error > error:
            continue
        if before is None:
            return Crossing(after.seconds, "at most")
        share = math.log(before.error / error) / math.log(before.error / after.error)
        return Crossing(before.seconds * (after.seconds / before.seconds) ** share, "measured")
    if not slope or not slope > 0 or not points:
        return None
    last = points[-1]
    return Crossing(last.seconds * (last.error / error) ** (1 / slope), "extrapolated")
