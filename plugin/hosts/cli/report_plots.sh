#!/bin/sh
# SPDX-License-Identifier: MIT
# Which library draws the plots of a report page? Writes uPlot with its style and licence as a piece of a page.
#
#     sh report_plots.sh PIECE.html PLACE      PLACE: a folder for the package
#
# The package comes from npm, in the version of the lock, unless it is there. Without npm, or where that fails, it says so in one line,
# the piece is empty, and pages show their numbers as tables.
set -eu

here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd -P)
piece=$1 place=$2
package=$place/node_modules/uplot

fetch() {
  cmp -s "$here/package-lock.json" "$place/package-lock.json" && [ -f "$package/package.json" ] && return
  command -v npm >/dev/null 2>&1 || { why="no npm"; return 1; }
  mkdir -p "$place"
  cp "$here/package.json" "$here/package-lock.json" "$place/"
  (cd "$place" && npm ci --no-audit --no-fund --silent) && return
  rm -f "$place/package-lock.json"
  why="npm did not get uplot"
  return 1
}

if fetch; then
  {
    echo "<!-- uPlot draws the plots of this page."
    cat "$package/LICENSE"
    echo "-->"
    echo "<style>"
    cat "$package/dist/uPlot.min.css"
    echo "</style>"
    echo "<script>"
    cat "$package/dist/uPlot.iife.min.js"
    echo "</script>"
  } >"$piece.new"
else
  echo "report_plots.sh: reports will show tables in the place of plots: $why" >&2
  : >"$piece.new"
fi
if cmp -s "$piece.new" "$piece"; then rm "$piece.new"; else mv "$piece.new" "$piece"; fi
