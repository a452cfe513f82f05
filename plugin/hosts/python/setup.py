# SPDX-License-Identifier: MIT
"""What goes into the wheel? The package, the reader and writer of USD from converters/usd as hemibake.usd, the structs of hemibake.h,
and the library and the program of this tree.

They are taken from the build folder that $HEMIBAKE_BUILD names; without it, the tree is built first.
"""

import os
import re
import shutil
import subprocess
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.dist import Distribution

ROOT = Path(__file__).resolve().parents[3]
HEADER = (ROOT / "plugin/include/hemibake/hemibake.h").read_text()
VERSION = re.search(r'^#define HEMI_VERSION_STRING "([\d.]+)"', HEADER, re.M).group(1)


def build_tree(folder):
    """A release build of the library and the program; the folder that holds it."""
    subprocess.run(["cmake", "-S", ROOT, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", "-DHEMIBAKE_TESTS=OFF"], check=True)
    subprocess.run(["cmake", "--build", folder, "--target", "hemibake_shared", "hemibake_cli",
                    "--parallel", str(os.cpu_count() or 1)], check=True)
    return Path(folder)


def declarations():
    """The header as cffi reads it: what the preprocessor leaves of hemibake's own files."""
    include = ROOT / "plugin/include"
    command = ["cc", "-E", "-I", include, "-D", "HEMI_API=", "-U", "__GNUC__", include / "hemibake/plugin_table.h"]
    kept, own = [], False
    for line in subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines():
        marker = re.match(r'# \d+ "(.*?)"', line)
        if marker:
            own = str(include) in marker.group(1)
        elif own:
            kept.append(line)
    return "\n".join(kept)


def write_header(path):
    import cffi

    ffi = cffi.FFI()
    ffi.set_source("hemibake._header", None)
    ffi.cdef(declarations())
    ffi.emit_python_code(str(path))


class Build(build_py):
    def run(self):
        super().run()
        package = Path(self.build_lib) / "hemibake"
        tree = os.environ.get("HEMIBAKE_BUILD")
        tree = Path(tree) if tree else build_tree(Path(self.build_lib).resolve().parent / "tree")
        write_header(package / "_header.py")
        (package / "usd").mkdir(exist_ok=True)
        for module in sorted((ROOT / "converters/usd").glob("*.py")):
            shutil.copy(module, package / "usd" / module.name)
        if (tree / "share/hemibake/viewer").is_dir():  # the page of 'hemibake view', where it was built
            shutil.copytree(tree / "share/hemibake/viewer", package / "viewer", dirs_exist_ok=True)
        for folder, name in (("lib", "libhemibake.so"), ("bin", "hemibake")):
            (package / folder).mkdir(exist_ok=True)
            shutil.copy((tree / folder / name).resolve(), package / folder / name)


class Binary(Distribution):
    def has_ext_modules(self):
        return True


try:
    from wheel.bdist_wheel import bdist_wheel

    class Wheel(bdist_wheel):
        """Any Python 3, this platform."""

        def get_tag(self):
            return "py3", "none", super().get_tag()[2]

    commands = {"build_py": Build, "bdist_wheel": Wheel}
except ImportError:
    commands = {"build_py": Build}

setup(version=VERSION, cmdclass=commands, distclass=Binary)
