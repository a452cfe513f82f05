# SPDX-License-Identifier: MIT
"""How do errors against seconds look? An SVG of two logarithmic axes: every point, and a line along each envelope."""

import html
import math

WIDTH, HEIGHT = 760, 480
LEFT, RIGHT, TOP, BOTTOM = 70, 20, 40, 60
COLORS = ("#c8451b", "#20639b", "#3c8c3c", "#7a4f9a")


def ticks(low, high):
    """1, 2 and 5 times powers of ten."""
    steps = range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 1)
    return [m * 10.0**k for k in steps for m in (1, 2, 5) if low <= m * 10.0**k <= high]


class Axis:
    def __init__(self, values, begin, end):
        self.low, self.high, self.begin, self.end = min(values) / 1.3, max(values) * 1.3, begin, end

    def __call__(self, value):
        share = math.log(value / self.low) / math.log(self.high / self.low)
        return self.begin + share * (self.end - self.begin)


def grid(x, y):
    lines = []
    for t in ticks(x.low, x.high):
        lines.append(f'<path d="M{x(t):.1f} {TOP}V{HEIGHT - BOTTOM}" stroke="#ddd"/>'
                     f'<text x="{x(t):.1f}" y="{HEIGHT - BOTTOM + 18}" text-anchor="middle">{t:g}</text>')
    for t in ticks(y.low, y.high):
        lines.append(f'<path d="M{LEFT} {y(t):.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>'
                     f'<text x="{LEFT - 8}" y="{y(t) + 4:.1f}" text-anchor="end">{100 * t:g} %</text>')
    return lines


def curve(x, y, color, points, edge):
    path = "M" + "L".join(f"{x(p.seconds):.1f} {y(p.error):.1f}" for p in edge)
    dots = [f'<circle cx="{x(p.seconds):.1f}" cy="{y(p.error):.1f}" r="{4 if p in edge else 2.5}" fill="{color}" '
            f'fill-opacity="{1 if p in edge else 0.45}"><title>{html.escape(p.label)}: {p.error:.2%} in {p.seconds:.2f} s</title>'
            "</circle>" for p in points]
    return [f'<path d="{path}" fill="none" stroke="{color}" stroke-width="2"/>', *dots]


def chart(title, curves):
    """curves: (name, points, their envelope). Returns the SVG's text."""
    everything = [p for _, points, _ in curves for p in points]
    x = Axis([p.seconds for p in everything], LEFT, WIDTH - RIGHT)
    y = Axis([p.error for p in everything], HEIGHT - BOTTOM, TOP)
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" '
             'font-family="sans-serif" font-size="12">', f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>',
             f'<text x="{LEFT}" y="24" font-size="15">{html.escape(title)}</text>', *grid(x, y)]
    for k, (name, points, edge) in enumerate(curves):
        lines += curve(x, y, COLORS[k], points, edge)
        lines.append(f'<text x="{WIDTH - RIGHT - 8}" y="{TOP + 18 + 18 * k}" text-anchor="end" fill="{COLORS[k]}" '
                     f'font-weight="bold">{html.escape(name)}</text>')
    lines += [f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 18}" text-anchor="middle">seconds</text>',
              f'<text transform="translate(18 {(TOP + HEIGHT - BOTTOM) / 2}) rotate(-90)" text-anchor="middle">'
              "relative error against path-traced truth</text>", "</svg>"]
    return "\n".join(lines) + "\n"
