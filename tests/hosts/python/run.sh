#!/bin/sh
# SPDX-License-Identifier: MIT
# Does the Python package work? Builds its wheel from the tree with pip, puts it into an environment of its own, and runs the
# pytest suite and mypy there.
#
#     sh tests/hosts/python/run.sh BUILD_FOLDER [pytest argument ...]
#
# The environment sees the numpy, cffi, pytest and mypy of the Python of the tests, HEMIBAKE_PYTHON or else install-python.sh's.
set -eu

build=$(cd -- "$1" && pwd -P)
shift
CDPATH='' cd -- "$(dirname -- "$0")/../../.."
environment=$build/tests/python
wheels=$build/tests/wheels
package=plugin/hosts/python

rm -rf "$environment" "$wheels"
python=${HEMIBAKE_PYTHON:-$(sh tests/install-python.sh)}
"$python" -m venv --system-site-packages "$environment"
# An environment made from another one sees what lies below both, and not the other's own modules.
purelib='import sysconfig; print(sysconfig.get_path("purelib"))'
"$python" -c "$purelib" >"$("$environment/bin/python" -c "$purelib")/below.pth"
# pip builds in the tree; what setuptools leaves there goes into the build folder.
HEMIBAKE_BUILD=$build "$environment/bin/python" -m pip wheel --quiet --no-deps --no-build-isolation --no-index \
  --wheel-dir "$wheels" "./$package"
rm -rf "$package/build" "$package/hemibake.egg-info"
"$environment/bin/python" -m pip install --quiet --no-deps --no-index "$wheels"/hemibake-*.whl

"$environment/bin/python" -m mypy --config-file "$package/pyproject.toml" "$package/hemibake"
exec "$environment/bin/python" -B -m pytest -q -p no:cacheprovider tests/hosts/python "$@"
