#!/bin/sh
# SPDX-License-Identifier: MIT
# Packs the add-on as an extension of Blender 4.2 and newer, which older ones install as an add-on too.
#
#     sh plugin/hosts/blender/build-extension.sh [FILE.zip]      default: build/hemibake-blender.zip
set -eu

here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd -P)
root=$(CDPATH='' cd -- "$here/../../.." && pwd -P)
out=${1:-$root/build/hemibake-blender.zip}
mkdir -p "$(dirname -- "$out")"
# The same files give the same bytes: their dates are not theirs.
python3 - "$here/hemibake" "$out" <<'END'
import os, sys, zipfile

folder, out = sys.argv[1:]
names = sorted(name for name in os.listdir(folder) if name.endswith((".py", ".toml")))
with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as packed:
    for name in names:
        entry = zipfile.ZipInfo("hemibake/" + name)
        entry.compress_type = zipfile.ZIP_DEFLATED
        with open(os.path.join(folder, name), "rb") as f:
            packed.writestr(entry, f.read())
END
echo "$out"
