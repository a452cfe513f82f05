# SPDX-License-Identifier: MIT
"""How is a case written down? A function of a Bench that yields rows (what, expected, got, right)."""

CASES = {}

SKY = ("--environment", "1,1,1")


def case(only=None, fast=False):
    """Registers a case under its function's name; only: the qualities it is asked at; fast: right at draft in a second, for CTest."""
    def register(function):
        CASES[function.__name__.replace("_", "-")] = (function, only, fast)
        return function
    return register


def show(value):
    return "none" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def at_most(what, value, limit):
    return what, f"<= {limit:g}", show(value), value is not None and value <= limit


def near(what, value, expected, share):
    right = value is not None and expected is not None and abs(value - expected) <= share * abs(expected)
    return what, f"{show(expected)} within {100 * share:g} %", show(value), right


def holds(what, truth, got=""):
    return what, "yes", str(got) if got and not truth else "yes" if truth else "no", bool(truth)


def ends(bake, code=0):
    last = bake.text.strip().splitlines()[-1:] or [""]
    return "exit status", str(code), str(bake.code) if bake.code == code else f"{bake.code}: {last[0][:90]}", bake.code == code


def ratio(a, b):
    return a / b if a is not None and b else None
