# SPDX-License-Identifier: MIT
"""What do nodes of MaterialX that compute make of what they are fed? Numbers are computed; a picture or a primvar can be multiplied,
and chosen from two."""

from __future__ import annotations

import dataclasses
import math
import operator
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .shading import Feed, Network

NODE = re.compile(r"ND_([a-z]+)_")
PASSING = {"constant": "value", "dot": "in", "convert": "in"}
OPERATIONS: dict[str, Callable[[float, float], float]] = {
    "add": operator.add, "subtract": operator.sub, "multiply": operator.mul, "divide": lambda a, b: a / b if b else 0.0,
    "min": min, "max": max, "power": lambda a, b: a**b if a > 0 else 0.0,
}  # fmt: skip
# Of in2, where it is not authored.
SECOND = {"multiply": 1.0, "divide": 1.0, "power": 1.0}


def _is_number(feed: Feed) -> bool:
    return feed.texture is None and feed.primvar is None


def _each(operation: Callable[[float, float], float], a: Any, b: Any) -> Any:
    """Of two numbers, or of colours, part by part."""
    if not hasattr(a, "__len__") and not hasattr(b, "__len__"):
        return operation(a, b)
    return tuple(operation(p, q) for p, q in zip(*(v if hasattr(v, "__len__") else (v,) * 3 for v in (a, b))))


def _filled(like: Any, value: float) -> Any:
    return (value,) * 3 if hasattr(like, "__len__") else value


def computed(network: Network, node: Any, kind: str, like: Any) -> Feed | None:
    """like: a colour or a number, as the input is that it feeds. None: it is no such node, or it does what a glTF texture cannot."""
    found = NODE.match(kind)
    name = found[1] if found else ""
    if name in PASSING:
        return network.feed(node, PASSING[name], _filled(like, 0.0))
    if name == "mix":
        return _mixed(network, node, like)
    if name not in OPERATIONS:
        return None
    a, b = network.feed(node, "in1", _filled(like, 0.0)), network.feed(node, "in2", _filled(like, SECOND.get(name, 0.0)))
    if name == "multiply" and _is_number(a) != _is_number(b):
        pictured, factor = (b, a) if _is_number(a) else (a, b)
        return dataclasses.replace(pictured, value=_each(operator.mul, pictured.value, factor.value))
    if not (_is_number(a) and _is_number(b)):
        return None
    value = _each(OPERATIONS[name], a.value, b.value)
    finite = all(map(math.isfinite, value if hasattr(value, "__len__") else (value,)))
    return dataclasses.replace(a, value=value) if finite else None


def _mixed(network: Network, node: Any, like: Any) -> Feed | None:
    """fg where mix is 1, bg where it is 0."""
    front, back, share = network.feed(node, "fg", _filled(like, 0.0)), network.feed(node, "bg", _filled(like, 0.0)), network.feed(node, "mix", 0.0)
    if not _is_number(share):
        return None
    if share.value in (0.0, 1.0):
        return front if share.value else back
    if not (_is_number(front) and _is_number(back)):
        return None
    return dataclasses.replace(front, value=_each(lambda f, b: share.value * f + (1 - share.value) * b, front.value, back.value))
