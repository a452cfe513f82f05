#!/bin/sh
# SPDX-License-Identifier: MIT
# Which Python do the tests run on? One of their own in build/tests/python, made by the first call; prints its path.
#
#     sh tests/install-python.sh
#
# The python3 that PATH shows first may be anybody's and lack what the tests import. Debian's comes first, with Debian's packages; where
# no Python has them all, pip gets them by name.
set -eu

CDPATH='' cd -- "$(dirname -- "$0")/.."
place=$(pwd -P)/build/tests/python
python=$place/bin/python3
# setuptools is first, since it refuses to be imported after others have imported distutils.
modules="setuptools cffi mypy numpy pip pytest typing_extensions wheel PyOpenColorIO"
packages="setuptools cffi mypy numpy opencolorio pip pytest typing_extensions wheel" # as pip calls them

# imports PYTHON: has it all of them?
imports() {
  # shellcheck disable=SC2086 # the list is split into words on purpose
  "$1" -B -c 'import importlib, sys; [importlib.import_module(name) for name in sys.argv[1:]]' $modules >/dev/null 2>&1
}

# make PYTHON: an environment that sees the packages of PYTHON, in the place of any older one.
make() {
  rm -rf "$place"
  "$1" -m venv --system-site-packages "$place" >/dev/null 2>&1
}

# pythons: those of this machine that are new enough, Debian's first.
pythons() {
  for folder in /usr/bin $(echo "$PATH" | tr ':' ' '); do
    ! "$folder/python3" -B -c 'import sys; sys.exit(sys.version_info < (3, 9))' >/dev/null 2>&1 || echo "$folder/python3"
  done
}

# from_what_is_here, from_pip: makes the environment if it can.
from_what_is_here() {
  for candidate in $(pythons); do
    ! { imports "$candidate" && make "$candidate" && imports "$python"; } || return 0
  done
  return 1
}

from_pip() {
  for candidate in $(pythons); do
    # shellcheck disable=SC2086
    ! { make "$candidate" && "$python" -m pip install --quiet $packages >&2 && imports "$python"; } || return 0
  done
  return 1
}

if ! imports "$python" && ! from_what_is_here && ! from_pip; then
  echo "install-python.sh: no python3 of 3.9 or newer has, or gets by pip, all of: $modules" >&2
  exit 1
fi
# USD alone may be missing: tests of it then say so and are skipped.
"$python" -B -c 'import pxr' >/dev/null 2>&1 || "$python" -m pip install --quiet usd-core >&2 ||
  echo "install-python.sh: usd-core cannot be had; tests of USD are skipped" >&2
echo "$python"
