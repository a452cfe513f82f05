# SPDX-License-Identifier: MIT
"""What does `python -m hemibake.usd` do? `bake` runs the program with this Python as its reader of USD; `scene` and `write` are the
two ways of that reader: a stage to a scene GLB, a baked GLB to USD."""

from __future__ import annotations

import argparse
import ctypes
import importlib.util
import os
import resource
import shutil
import signal
import subprocess
import sys
from typing import TextIO

from .losses import Refused, one_line, print_error

DONE, BAD_INPUT, USAGE, OUTPUT = 0, 1, 2, 3
MODULES = ("pxr", "numpy")


def _missing() -> str | None:
    lacking = [name for name in MODULES if importlib.util.find_spec(name) is None]
    if not lacking:
        return None
    return f"USD needs Python with usd-core, and {sys.executable} lacks {' and '.join(lacking)}: {sys.executable} -m pip install usd-core numpy"


def _find_materialx() -> None:
    """usd-exchange reads .mtlx by the definitions that the package materialx brings; pxr looks for them when it is imported."""
    found = importlib.util.find_spec("MaterialX")
    places = list(found.submodule_search_locations or []) if found else []
    library = os.path.join(places[0], "libraries") if places else ""
    if os.path.isdir(library):
        os.environ.setdefault("PXR_MTLX_STDLIB_SEARCH_PATHS", library)


def _own_stderr() -> TextIO:
    """A stderr for our lines; what pxr prints itself goes nowhere, since it is told in our words."""
    own = os.fdopen(os.dup(2), "w", encoding="utf-8", errors="replace")
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 2)
    os.close(nothing)
    return own


def _limit_memory() -> None:
    """A broken file may ask for more than there is; then Python is told so and not the machine."""
    try:
        total = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
        resource.setrlimit(resource.RLIMIT_DATA, (total, resource.getrlimit(resource.RLIMIT_DATA)[1]))
    except (ValueError, OSError):
        pass


def _end_with_parent() -> None:
    """Whoever ends the program ends its reader too. [prctl(2): PR_SET_PDEATHSIG]"""
    try:
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)
    except (AttributeError, OSError):
        pass


# ---- the two ways ------------------------------------------------------------------------------------------------------


def _scene(o: argparse.Namespace, to: TextIO) -> int:
    from . import pictures
    from .scene import Scene
    from .stage import dependencies, open_source

    source = open_source(o.stage, o.variant, o.time_code, o.root)
    scene = Scene(source)
    source.losses.print(to)
    if not scene.reader.gprims:
        raise Refused(f"there is nothing to bake: {source.losses.cause() or 'no mesh or shape is active, visible and of purpose default or render'}")
    data = scene.glb.bytes()
    with open(o.output, "wb") as f:
        f.write(data)
    if o.sky and scene.sky is not None:
        pictures.write_pfm(o.sky, scene.sky)
    if o.dependencies:
        with open(o.dependencies, "w", encoding="utf-8") as f:
            f.writelines(name + "\n" for name in dependencies(o.stage) if "\n" not in name)
    return DONE


def _write(o: argparse.Namespace, to: TextIO) -> int:
    from .baked import Baked
    from .write_stage import write_stage

    baked = Baked.read(o.baked)
    if o.output:
        write_stage(baked, o.output, o.name or os.path.basename(o.output))
        for path in dict.fromkeys(piece.path for piece in baked.pieces if piece.is_cut):
            print(f"warning: {path}: cut out by its picture, which the stage that is written shows whole", file=to)
    if o.layer:
        from .write_layer import write_layer

        for line in write_layer(baked, o):
            print(f"warning: {line}", file=to)
    return DONE


# ---- bake --------------------------------------------------------------------------------------------------------------


def _program() -> str:
    named = os.environ.get("HEMIBAKE")
    here = os.path.dirname(os.path.abspath(__file__))
    for place in (named, os.path.join(here, "..", "bin", "hemibake"), shutil.which("hemibake")):
        if place and os.access(place, os.X_OK):
            return place
    raise Refused("the program hemibake is not on PATH; install it, or set HEMIBAKE")


def bake(arguments: list[str]) -> int:
    """The program's own exit status."""
    environment = {**os.environ, "HEMIBAKE_USD_PYTHON": sys.executable}
    return subprocess.run([_program(), "bake", *arguments], env=environment, check=False).returncode


# ---- the line ----------------------------------------------------------------------------------------------------------


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m hemibake.usd", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("bake", help="a stage or a glTF to GLB or USD: the options of 'hemibake bake'")
    scene = commands.add_parser("scene", help="a stage to the GLB that the program reads")
    scene.add_argument("stage")
    scene.add_argument("-o", dest="output", required=True, help="the GLB")
    scene.add_argument("--variant", default="", help="/Prim{set=choice},...")
    scene.add_argument("--time-code", type=float, default=None)
    scene.add_argument("--sky", help="a .pfm for the domes of the stage")
    scene.add_argument("--root", help="the folder outside of which nothing is read")
    scene.add_argument("--dependencies", help="a file for the list of layers and textures")
    write = commands.add_parser("write", help="a baked GLB to USD")
    write.add_argument("baked")
    write.add_argument("-o", dest="output", help=".usda, .usdc or .usdz")
    write.add_argument("--name", help="how the file will be called")
    write.add_argument("--layer", help="a thin layer over the stage")
    write.add_argument("--stage", help="of --layer: the stage that was baked")
    write.add_argument("--payload", help="of --layer: where the baked stage will be, as the layer names it")
    write.add_argument("--place", help="of --layer: where the layer will be")
    write.add_argument("--variant", default="")
    write.add_argument("--time-code", type=float, default=None)
    return parser


def _run(o: argparse.Namespace, to: TextIO) -> int:
    try:
        try:
            return _scene(o, to) if o.command == "scene" else _write(o, to)
        finally:
            from .stage import remove_links

            remove_links()
    except Refused as refused:
        print_error(str(refused), to)
    except UnicodeDecodeError:
        print_error("it cannot be read as USD: what it says is not UTF-8", to)
    except MemoryError:
        print_error("it needs more memory than there is", to)
    except OSError as fault:
        print_error(f"{fault.filename or ''}: {fault.strerror or fault}", to)
        return OUTPUT if fault.filename in (o.output, getattr(o, "layer", None)) else BAD_INPUT
    except Exception as fault:  # a fault of pxr or of ours is one line too
        print_error(f"it cannot be read as USD: {type(fault).__name__}: {one_line(fault)[:300]}", to)
    return BAD_INPUT


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["bake"]:
        try:
            return bake(arguments[1:])
        except Refused as refused:
            print_error(str(refused))
            return BAD_INPUT
    o = _parser().parse_args(arguments)
    lacking = _missing()
    if lacking:
        print_error(lacking)
        return BAD_INPUT
    # Small systems of equations are no work for many threads, and their sums are to be the same everywhere.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    _find_materialx()
    _limit_memory()
    _end_with_parent()
    sys.setrecursionlimit(100000)
    to = _own_stderr()
    status = _run(o, to)
    to.flush()
    # What pxr would tidy up at the end takes longer than the reading of a small stage.
    os._exit(status)

