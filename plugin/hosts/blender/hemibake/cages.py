# SPDX-License-Identifier: MIT
"""How does a Subdivision Surface modifier leave Blender? Applied by the exporter, or as its cage with a level for the program."""

import contextlib


class CageError(Exception):
    """The meshes cannot be handed over as cages."""


def last_subdivision(mesh_object):
    """The modifier, if it is the last that shows."""
    shown = [each for each in mesh_object.modifiers if each.show_viewport]
    return shown[-1] if shown and shown[-1].type == "SUBSURF" else None


def common_level(objects):
    """The level that all cages have; the program refines every mesh by one."""
    found = {each.name: last_subdivision(each) for each in objects}
    without = [name for name, modifier in found.items() if modifier is None]
    if without:
        raise CageError(f"'{without[0]}' has no Subdivision Surface as its last modifier; as cages, all meshes need one")
    levels = {modifier.levels for modifier in found.values()}
    if len(levels) != 1:
        raise CageError(f"the Subdivision Surface modifiers have the levels {sorted(levels)}; as cages, all need the same")
    return levels.pop()


@contextlib.contextmanager
def subdivisions_as_cages(objects):
    """Within, the modifiers are off; gives the options that stand for them."""
    level = common_level(objects)
    modifiers = [last_subdivision(each) for each in objects]
    simple = {modifier.subdivision_type for modifier in modifiers} != {"CATMULL_CLARK"}
    if simple:
        raise CageError("a Subdivision Surface modifier is Simple; as cages, all need Catmull-Clark")
    for modifier in modifiers:
        modifier.show_viewport = False
    try:
        yield [f"--subdivide={level}"]
    finally:
        for modifier in modifiers:
            modifier.show_viewport = True
