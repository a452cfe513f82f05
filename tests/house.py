# SPDX-License-Identifier: MIT
"""Does the tree keep its own rules? The figures of house.sh: who may include whom, how long things are, what exists twice.

The order of the folders of plugin/core is that of the table in plugin/core/README.md; the other rules stand here.
"""

import argparse
import collections
import fnmatch
import os
import re
import sys

import mutations
from functions import blanked, functions

C_ENDS = (".c", ".h", ".cpp")
HOST_ENDS = C_ENDS + (".py", ".mjs", ".ts")

# What commit 662aa59 had, counted by this program, before the house was redrawn; and how many fewer lines it was to have after.
BEFORE = {"product": 35366, "hosts": 6162}

# Of the code, each in a line that is there once, and one at least in every folder.
MUTATIONS = 40

API_SOURCES, API_LINES, BAKE_LINES, FILE_LINES, FUNCTION_LINES, README_WORDS = 17, 3000, 150, 400, 60, 900

# ---- who may include whom ----------------------------------------------------------------------------------------------

# Data and mathematics that these converters take from core: its mesh, and the folders that the mesh stands on.
CONVERTERS_ON_CORE = ("tessellate", "probes", "simplify", "subdivide")
LAST_FOR_CONVERTERS = "mesh"

# Area of the tree: the areas that it may include beside itself and the ABI, as patterns.
MAY_INCLUDE = {
    "api": ("core/*", "converters/subdivide", "converters/tessellate", "converters/simplify"),
    "converters/gltf": ("converters/draco", "converters/file", "converters/ies", "converters/image", "core/geometry"),
    "converters/probes": ("converters/file",),
    "converters/vs3": ("converters/file",),
    "color": ("core/geometry",),
    "converters/usd": ("converters/image",),
    "hosts/cli": ("converters/*", "color", "hosts/options", "core/geometry"),
    "hosts/gltf-transform": ("color", "hosts/options", "core/geometry"),
}

# Where headers of other people's libraries may be included: in one file each, where there is no reason for more.
LIBRARIES = {
    "cjson/cJSON.h": ("converters/gltf/gltf_document.h", "plugin/hosts/cli/*"),  # glTF is a JSON document, and so is a report
    "meshoptimizer.h": ("converters/simplify/meshopt_shim.cpp", "converters/gltf/gltf_meshopt.cpp"),
    "png.h": ("converters/image/image_decode.c", "converters/image/png_encode.c"),
    "turbojpeg.h": ("converters/image/image_decode.c", "converters/image/jpeg_encode.c"),
    "openexr.h": ("converters/image/exr_channels.h",),
    "Imf*": ("converters/image/openexr_shim.cpp",),
    "ktx.h": ("converters/image/ktx2_decode.c",),
    "webp/*": ("converters/image/image_decode.c",),
    "stb/*": ("converters/image/image_decode.c",),
    "tiny_gltf.h": ("converters/gltf/gltf_model.h",),
    "draco/*": ("converters/draco/draco_codec.cpp",),
    "opensubdiv/*": ("converters/subdivide/osd_shim.cpp",),
    "OpenColorIO/*": ("color/ocio_config.h",),
    "pxr/*": ("converters/usd/*.cpp",),
    "GL/glcorearb.h": ("plugin/core/visibility/item_device.h",),
    "GL/osmesa.h": ("plugin/core/visibility/osmesa.c",),
    "EGL/*": ("plugin/core/visibility/egl.c",),
    "embree*": ("plugin/core/visibility/embree.c",),
    "xxhash.h": ("plugin/core/base/chunk_file.c", "plugin/hosts/cli/checkpoint_file.c"),
    "mpi.h": ("plugin/hosts/cli/processes.c",),
    "node_api.h": ("plugin/hosts/gltf-transform/*",),
    "sha256.h": ("plugin/hosts/cli/digest.c",),
    "report_page_html.h": ("plugin/hosts/cli/report_page.c",),
}

# What a README need not name, since every folder has it or tools insist on it.
NEED_NO_LINE = ("README.md", "CMakeLists.txt", "__init__.py", "package-lock.json", "py.typed")

NOT_OURS = ("node_modules", "build", "__pycache__")

SYSTEM = set("""assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal spawn stdalign stdarg stdatomic stdbool
    stddef stdint stdio stdlib stdnoreturn string strings tgmath threads time uchar wchar wctype dirent dlfcn fcntl ftw link netdb poll
    pthread semaphore unistd""".split())

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)


def is_system(name):
    """libc, POSIX and the C++ library, whose headers have no ending."""
    stem, end = os.path.splitext(name)
    return end == "" or end == ".h" and (stem in SYSTEM or re.match(r"(sys|netinet|arpa)/", name) is not None)


# ---- dot and cross -----------------------------------------------------------------------------------------------------

CALLED_DOT_OR_CROSS = re.compile(r"(?:\w+_)?(?:dot|cross)(?:_?3d?|_product)?")
MACRO = re.compile(r"^[ \t]*#[ \t]*define[ \t]+(?:\w+_)?(?:DOT|CROSS|dot|cross)\(", re.MULTILINE)
VECTOR = r"\b([A-Za-z_]\w*(?:(?:\.|->)\w+|\[\w+\])*?)"


def products(*terms):
    """A pattern of terms such as '1*2 - 2*1': components of two vectors, written a[1] or a.y. The vectors are two different ones."""
    first, second, component = r"\1", r"\2", {"0": r"(?:\[0\]|\.x)", "1": r"(?:\[1\]|\.y)", "2": r"(?:\[2\]|\.z)"}
    out = VECTOR + component[terms[0][0]] + r"\s*\*\s*(?!\1\W)" + VECTOR + component[terms[0][1]]
    for sign, a, b in terms[1:]:
        out += rf"\s*\{sign}\s*{first}{component[a]}\s*\*\s*{second}{component[b]}"
    return re.compile(out)


DOT = products("00", "+11", "+22")
CROSS = (products("12", "-21"), products("20", "-02"))


def dots_and_crosses(path, text):
    """(line, name) of each function that is called a dot or cross product, or computes one; a length is none."""
    found, code = [], blanked(text)
    bodies = functions(path, text)
    products_at = {code.count("\n", 0, m.start()) + 1 for pattern in (DOT, *CROSS) for m in pattern.finditer(code)}
    for name, first, last in bodies:
        if CALLED_DOT_OR_CROSS.fullmatch(name) or any(first <= line <= last for line in products_at):
            found.append((first, name))
    return found + [(text.count("\n", 0, m.start()) + 1, "a macro") for m in MACRO.finditer(text)]


# ---- the tree ----------------------------------------------------------------------------------------------------------


class Tree:
    """The product's sources, path to text, and the order of the folders of core."""

    def __init__(self, root):
        self.root, self.sources = root, {}
        for top in ("plugin", "converters", "color"):
            for folder, folders, names in os.walk(os.path.join(root, top)):
                folders[:] = sorted(name for name in folders if name not in NOT_OURS)
                for name in sorted(names):
                    path = os.path.relpath(os.path.join(folder, name), root).replace(os.sep, "/")
                    if name.endswith(HOST_ENDS if path.startswith("plugin/hosts/") else C_ENDS):
                        with open(os.path.join(root, path), encoding="utf-8") as f:
                            self.sources[path] = f.read()
        with open(os.path.join(root, "plugin/core/README.md"), encoding="utf-8") as f:
            self.order = re.findall(r"^\| `(\w+)/` \|", f.read(), re.MULTILINE)
        self.by_name = collections.defaultdict(list)
        for path in self.sources:
            self.by_name[os.path.basename(path)].append(path)

    def matching(self, prefix="", ends=HOST_ENDS):
        return {path: text for path, text in self.sources.items() if path.startswith(prefix) and path.endswith(ends)}

    def lines(self, prefix="", ends=HOST_ENDS):
        return sum(text.count("\n") for text in self.matching(prefix, ends).values())

    def included(self, path, name):
        """The file of the tree that an #include names, or None."""
        beside = os.path.normpath(os.path.join(os.path.dirname(path), name)).replace(os.sep, "/")
        for candidate in (beside, "plugin/core/" + name, "plugin/include/" + name):
            if candidate in self.sources:
                return candidate
        return next(iter(self.by_name[name]), None)


def area(path):
    parts = path.split("/")
    if parts[0] == "plugin":
        return {"include": "abi", "api": "api"}.get(parts[1]) or "/".join(parts[1:3])
    return "color" if parts[0] == "color" else "/".join(parts[:2])


def backward_arrows(tree):
    """Includes of a later folder of core by an earlier one, and folders that the order does not know."""
    for path, text in tree.matching("plugin/core/", C_ENDS).items():
        folder = path.split("/")[2]
        if folder not in tree.order:
            yield path, 1, f"{folder}/ is not in the order of plugin/core/README.md"
            continue
        for line, name in includes(text):
            target = tree.included(path, name)
            if not target or not target.startswith("plugin/core/"):
                continue
            other = target.split("/")[2]
            if other not in tree.order or tree.order.index(other) > tree.order.index(folder):
                yield path, line, f"{folder} includes {name}"


def includes(text):
    return [(text.count("\n", 0, m.start(1)) + 1, m.group(2)) for m in INCLUDE.finditer(text)]


def may_include(tree, here, there):
    """Whether the rules of areas let one include another."""
    if here == there or there == "abi" and not here.startswith("core/"):
        return True
    if here.startswith("core/"):
        return there.startswith("core/")
    if there.startswith("core/") and here in ["converters/" + name for name in CONVERTERS_ON_CORE]:
        floor = tree.order[: tree.order.index(LAST_FOR_CONVERTERS) + 1]
        return there.split("/")[1] in floor
    return any(fnmatch.fnmatch(there, pattern) for pattern in MAY_INCLUDE.get(here, ()))


def forbidden_includes(tree):
    for path, text in tree.matching(ends=C_ENDS).items():
        for line, name in includes(text):
            target = tree.included(path, name)
            if target:
                if not may_include(tree, area(path), area(target)):
                    yield path, line, f"{area(path)} includes {target}"
            elif not is_system(name) and not name.endswith(".inc"):
                places = next((where for pattern, where in LIBRARIES.items() if fnmatch.fnmatch(name, pattern)), ())
                if not any(fnmatch.fnmatch(path, place) for place in places):
                    yield path, line, f"includes {name}, which belongs into {' or '.join(places) or 'no file that is known'}"


def products_elsewhere(tree):
    for path, text in tree.matching(ends=C_ENDS).items():
        if not path.startswith("plugin/core/geometry/"):
            yield from ((path, line, name) for line, name in dots_and_crosses(path, text))


def readme_words(root):
    with open(os.path.join(root, "README.md"), encoding="utf-8") as f:
        return len(f.read().split())


def long_files(tree):
    return [(path, 1, f"{text.count(chr(10))} lines") for path, text in tree.sources.items() if text.count("\n") > FILE_LINES]


def long_functions(tree):
    for path, text in tree.sources.items():
        for name, first, last in functions(path, text):
            if last - first + 1 > FUNCTION_LINES:
                yield path, first, f"{name}, {last - first + 1} lines"


def unnamed_files(root):
    """Files that no README names, their folder's or else the next one above, with or without their ending."""
    readmes = {}
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(name for name in folders if not name.startswith(".") and name not in NOT_OURS)
        readmes[folder] = readmes.get(os.path.dirname(folder), ("", ""))
        if "README.md" in names:
            path = os.path.join(folder, "README.md")
            with open(path, encoding="utf-8") as f:
                readmes[folder] = os.path.relpath(path, root), f.read()
        where, text = readmes[folder]
        for name in sorted(names):
            stem = os.path.splitext(name)[0]
            if folder != root and name not in NEED_NO_LINE and not re.search(rf"\b{re.escape(stem)}\b", text):
                yield os.path.relpath(os.path.join(folder, name), root), 1, f"is not in {where}"


# ---- mutations ---------------------------------------------------------------------------------------------------------


def read_mutations(root):
    """Each with the file whose line it breaks, or why there is none."""
    path = os.path.join(root, "tests/mutations.txt")
    listed = mutations.read_list(path) if os.path.exists(path) else []
    texts = {}
    for name in mutations.product_files(root):
        with open(name, encoding="utf-8") as f:
            texts[os.path.relpath(name, root).replace(os.sep, "/")] = f.read()
    for one in listed:
        try:
            one["file"] = mutations.find_place(one, texts)
        except mutations.Fault as fault:
            one["fault"] = str(fault)
    return listed


def lost_mutations(listed):
    return [("tests/mutations.txt", 1, one["fault"]) for one in listed if "fault" in one]


def unbroken_folders(tree, listed):
    """Folders of core, api, converters, color and hosts in which no line is broken on purpose."""
    def folder(path):
        parts = path.split("/")
        return "/".join(parts[: 1 if parts[0] == "color" else 2 if parts[:2] == ["plugin", "api"] or parts[0] == "converters" else 3])

    broken = {folder(one["file"]) for one in listed if "file" in one}
    paths = [os.path.relpath(path, tree.root).replace(os.sep, "/") for path in mutations.product_files(tree.root)]
    there = {folder(path) for path in paths if "/include/" not in path and path.count("/") >= (1 if path.startswith("color/") else 2)}
    there = {name for name in there if os.path.isdir(os.path.join(tree.root, name))}
    return [(name, 1, "no mutation breaks a line of it") for name in sorted(there - broken)]


# ---- the table ---------------------------------------------------------------------------------------------------------


def figures(tree):
    """(what, value, bound, does it hold, offenders) of each."""
    def none_of(what, offenders):
        offenders = sorted(offenders)
        return what, len(offenders), "0", not offenders, offenders

    def at_most(what, value, bound, said=None):
        return what, value, said or f"<= {bound:,}", value <= bound, []

    bake = tree.lines("plugin/core/bake/bake.c")
    product, hosts = tree.lines(ends=C_ENDS), tree.lines("plugin/hosts/")
    yield none_of("arrows against the order of folders in core", backward_arrows(tree))
    yield none_of("includes that cross the rules", forbidden_includes(tree))
    yield at_most("sources of plugin/api", len(tree.matching("plugin/api/", (".c", ".cpp"))), API_SOURCES)
    yield at_most("lines of plugin/api", tree.lines("plugin/api/"), API_LINES)
    yield "lines of core/bake/bake.c", bake, f"1 to {BAKE_LINES}", 0 < bake <= BAKE_LINES, []
    yield none_of("dot and cross products outside core/geometry", products_elsewhere(tree))
    yield at_most("words of README.md", readme_words(tree.root), README_WORDS)
    yield none_of("files that no README names", unnamed_files(tree.root))
    listed = read_mutations(tree.root)
    yield "mutations", len(listed), f">= {MUTATIONS}", len(listed) >= MUTATIONS, []
    yield none_of("mutations whose line is not there once", lost_mutations(listed))
    yield none_of("folders without a mutation", unbroken_folders(tree, listed))
    yield none_of(f"files over {FILE_LINES} lines", long_files(tree))
    yield none_of(f"functions over {FUNCTION_LINES} lines", long_functions(tree))
    yield "product lines, C and C++", product, f"any; {BEFORE['product']:,} before", True, []
    yield "lines of the hosts, all languages", hosts, f"any; {BEFORE['hosts']:,} before", True, []


def main():
    parser = argparse.ArgumentParser(prog="house.sh", description="Does the tree keep its own rules?")
    parser.add_argument("--list", action="store_true", help="name each offender")
    parser.add_argument("folder", nargs="?", default=os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    a = parser.parse_args()
    found = list(figures(Tree(a.folder)))
    print(f"{'figure':46} {'now':>7}  {'bound':28} holds")
    for what, value, bound, holds, _ in found:
        print(f"{what:46} {value:7,}  {bound:28} {'yes' if holds else 'NO'}")
    if a.list:
        for what, _, _, _, offenders in found:
            for path, line, text in offenders:
                print(f"{path}:{line}: {what}: {text}")
    return 0 if all(holds for _, _, _, holds, _ in found) else 1


if __name__ == "__main__":
    sys.exit(main())
