#!/bin/sh
# SPDX-License-Identifier: MIT
# Which Debian packages does hemibake need that are not here yet? Installs them with apt, through sudo when not root.
#
#     sh install-packages.sh [PACKAGE ...]      what the build needs, and the packages named
#
# Asks dpkg first: where nothing is missing it takes no time, needs no network and no rights.
set -eu

build_packages="build-essential cmake ninja-build pkg-config libtinygltf-dev libdraco-dev libosd-dev
  libopencolorio-dev libopenexr-dev libosmesa6-dev libembree-dev libegl-dev libpng-dev libcjson-dev libmd-dev libmeshoptimizer-dev
  libstb-dev libturbojpeg0-dev libwebp-dev libxxhash-dev"

is_installed() {
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

fail() {
  echo "install-packages.sh: $*" >&2
  exit 1
}

# Runs apt-get without questions; shows what it said only if it fails.
apt_get() {
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y "$@" >"$log" 2>&1 && return
  cat "$log" >&2
  fail "'apt-get $1' failed; what it said is above"
}

# shellcheck disable=SC2086 # the list is split into words on purpose
set -- $build_packages "$@"
command -v dpkg-query >/dev/null 2>&1 && command -v apt-get >/dev/null 2>&1 || {
  echo "install-packages.sh: this is no Debian; the build needs what Debian calls: $*" >&2
  exit 0
}

missing=
for package in "$@"; do
  is_installed "$package" || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null 2>&1 || fail "neither root nor sudo; as root run: apt-get install$missing"
  as_root=sudo
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
echo "Installing$missing ..."
apt_get update
# shellcheck disable=SC2086
apt_get install --no-install-recommends $missing
