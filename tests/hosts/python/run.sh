#!/bin/sh
# SPDX-License-Identifier: MIT
# Does the Python package work? Builds its wheel from the tree with pip, puts it into an environment of its own, and runs the
# pytest suite and mypy there.
#
#     sh tests/hosts/python/run.sh BUILD_FOLDER [pytest argument ...]
#
# numpy, cffi, pytest and mypy are Debian's; the environment sees them.
set -eu

build=$(cd -- "$1" && pwd -P)
shift
CDPATH='' cd -- "$(dirname -- "$0")/../../.."
environment=$build/tests/python
wheels=$build/tests/wheels
package=plugin/hosts/python

rm -rf "$environment" "$wheels"
/usr/bin/python3 -m venv --system-site-packages "$environment"
# pip builds in the tree; what setuptools leaves there goes into the build folder.
HEMIBAKE_BUILD=$build "$environment/bin/python" -m pip wheel --quiet --no-deps --no-build-isolation --no-index \
  --wheel-dir "$wheels" "./$package"
rm -rf "$package/build" "$package/hemibake.egg-info"
"$environment/bin/python" -m pip install --quiet --no-deps --no-index "$wheels"/hemibake-*.whl

"$environment/bin/python" -m mypy --config-file "$package/pyproject.toml" "$package/hemibake"
exec "$environment/bin/python" -B -m pytest -q -p no:cacheprovider tests/hosts/python "$@"
