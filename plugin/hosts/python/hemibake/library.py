# SPDX-License-Identifier: MIT
"""How is libhemibake called? Through its table of functions, with the structs of the header that the package was built with
(`_header.py` is made of hemibake.h by setup.py)."""

from __future__ import annotations

import functools
import os
from typing import Any

from . import places
from ._header import ffi
from .errors import Cancelled, DataError, HemibakeError, LibraryMissing, UsageError

TABLE = "hemi_plugin_table"
ABI = 1

_ERRORS = {"HEMI_ERROR_ARGUMENT": UsageError, "HEMI_CANCELLED": Cancelled}


def _open(path: str) -> Any:
    library = ffi.dlopen(path)
    try:
        table = getattr(library, TABLE)
    except (AttributeError, ffi.error) as e:
        raise LibraryMissing(f"{path} is no libhemibake of this version: it has no {TABLE}") from e
    if table.abi != ABI or table.struct_size < ffi.sizeof("hemi_plugin"):
        raise LibraryMissing(f"{path} has ABI {table.abi}, this package was built for {ABI}; install both of one version")
    return library, table


@functools.lru_cache(maxsize=1)
def _library() -> Any:
    # hemibake brings its own threads; llvmpipe reads this when its first context is made.
    os.environ.setdefault("LP_NUM_THREADS", "0")
    reasons = []
    for path in places.libraries():
        try:
            return _open(path)
        except OSError as e:
            reasons.append(str(e))
    raise LibraryMissing(f"libhemibake cannot be opened: {reasons[0]}; install it, or set HEMIBAKE_LIBRARY")


def table() -> Any:
    """Every function of the library."""
    return _library()[1]


def result_name(code: int) -> str:
    names: dict[int, str] = ffi.typeof("hemi_result").elements
    return names.get(code, str(code))


def check(code: int, text: str | None = None) -> None:
    """Raises what a result other than HEMI_OK means; text is the library's own."""
    name = result_name(code)
    if name != "HEMI_OK":
        text = text or ffi.string(table().result_text(code)).decode()
        raise _ERRORS.get(name, DataError if name.startswith("HEMI_ERROR") else HemibakeError)(text, name)


# ---- structs ---------------------------------------------------------------------------------------------------------


def enum_value(kind: Any, word: str) -> int:
    """The value of "catmull-clark" in hemi_subdivision."""
    values: dict[str, int] = kind.relements
    prefix = os.path.commonprefix(list(values)).rpartition("_")[0] + "_"
    name = prefix + str(word).upper().replace("-", "_")
    if name not in values:
        words = ", ".join(key[len(prefix) :].lower().replace("_", "-") for key in sorted(values, key=values.__getitem__) if key.startswith(prefix))
        raise UsageError(f"'{word}' is none of {words}")
    return values[name]


def field_value(kind: Any, value: Any) -> Any:
    if kind.kind == "enum":
        return enum_value(kind, value)
    if kind.kind == "array" and len(value) != kind.length:
        raise UsageError(f"{len(value)} numbers where {kind.length} are needed")
    return value


def desc(kind: str, /, **fields: Any) -> Any:
    """A desc struct of the header: its size is set, fields are set by their names, words become enum values."""
    known = {name: field.type for name, field in ffi.typeof(kind).fields}
    out = ffi.new(f"{kind} *", {"struct_size": ffi.sizeof(kind)})
    for name, value in fields.items():
        if name not in known or name == "struct_size":
            raise UsageError(f"'{name}' is no field of {kind}; it has {', '.join(key for key in known)}")
        try:
            setattr(out, name, field_value(known[name], value))
        except (TypeError, OverflowError, UsageError) as e:
            raise UsageError(f"{name}: {e}") from e
    return out


def field_names(kind: str) -> list[str]:
    """Of a struct of the header that begins with its size."""
    return [name for name, _ in ffi.typeof(kind).fields if name != "struct_size"]


def view(kind: str) -> Any:
    """A struct of the header for the library to fill: its size is set."""
    return ffi.new(f"{kind} *", {"struct_size": ffi.sizeof(kind)})


def as_dict(struct: Any) -> dict[str, Any]:
    """The numbers of a struct by their names; a struct in it is a dict too."""
    out = {}
    for name, field in ffi.typeof(struct).fields:
        value = getattr(struct, name)
        if name != "struct_size":
            out[name] = as_dict(value) if field.type.kind == "struct" else value
    return out
