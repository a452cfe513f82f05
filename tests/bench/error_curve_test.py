# SPDX-License-Identifier: MIT
"""Does error_curve.py read a curve right, and does the chart show every point? Curves whose answers are known in closed form."""

import sys
import unittest

from error_chart import chart
from error_curve import Point, envelope, exponent, falling_exponent, time_at


def monte_carlo(slope, seconds):
    """error = 0.1 t^-slope"""
    return [Point(t, 0.1 * t**-slope, f"{t} s") for t in seconds]


class ErrorCurve(unittest.TestCase):
    def test_an_envelope_drops_what_another_beats_in_both(self):
        points = [Point(2, 0.05, "a"), Point(1, 0.1, "b"), Point(3, 0.06, "slower and worse"), Point(4, 0.01, "c")]
        self.assertEqual([p.label for p in envelope(points)], ["b", "a", "c"])

    def test_between_points_a_power_law_is_met_exactly(self):
        found = time_at(monte_carlo(0.5, (1, 100)), 0.1 * 9**-0.5)
        self.assertEqual(found.kind, "measured")
        self.assertAlmostEqual(found.seconds, 9, places=12)  # a power law is a straight line there; only rounding is left

    def test_past_the_end_the_slope_goes_on(self):
        points = monte_carlo(0.4, (1, 10, 100))
        found = time_at(points, 0.1 * 1000**-0.4, falling_exponent(points))
        self.assertEqual(found.kind, "extrapolated")
        self.assertAlmostEqual(found.seconds, 1000, places=6)  # twelve digits of log error, times 1000

    def test_before_the_start_the_fastest_is_an_upper_bound(self):
        self.assertEqual(time_at(monte_carlo(0.5, (2, 4)), 0.09), (2, "at most"))

    def test_without_a_slope_what_is_not_reached_has_no_time(self):
        self.assertIsNone(time_at(monte_carlo(0.5, (1, 2)), 1e-3))
        self.assertIsNone(time_at([], 0.01, 0.5))

    def test_the_slope_is_that_of_the_slower_half(self):
        points = [Point(0.1, 0.5, "start-up"), Point(0.11, 0.2, "start-up"), *monte_carlo(0.3, (1, 2, 4, 8))]
        self.assertAlmostEqual(falling_exponent(points), 0.3, places=12)

    def test_the_exponent_of_a_square_is_two(self):
        self.assertAlmostEqual(exponent([1, 3, 10], [5, 45, 500]), 2, places=12)

    def test_a_chart_has_every_point_and_a_line_for_each_curve(self):
        points = monte_carlo(0.5, (1, 10, 100))
        text = chart("a & b", [("one", points, points), ("two", points[:2], points[:2])])
        self.assertEqual(text.count("<circle"), 5)
        self.assertEqual(text.count('stroke-width="2"'), 2)
        self.assertIn("a &amp; b", text)


if __name__ == "__main__":
    sys.exit(unittest.main())
