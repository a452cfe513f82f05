# SPDX-License-Identifier: MIT
"""Which page shows bakes? index.html of a folder, from the reports and pictures in it; gallery.sh makes those.

    python3 gallery.py FOLDER
"""

import glob
import html
import json
import os
import sys

PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>hemibake: samples</title>
<style>
:root {{ --ground: #f6f6f4; --card: #fff; --ink: #1c2024; --soft: #5c6670; --line: #dcdfe2; }}
@media (prefers-color-scheme: dark) {{ :root {{ --ground: #14171a; --card: #1c2024; --ink: #e7eaed; --soft: #98a3ae; --line: #333a41; }} }}
* {{ box-sizing: border-box; }}
body {{ margin: 0 auto; max-width: 90rem; padding: 1.2rem; background: var(--ground); color: var(--ink);
  font: 16px/1.5 system-ui, sans-serif; }}
main {{ display: grid; gap: 1.2rem; grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); }}
figure {{ margin: 0; background: var(--card); border: 1px solid var(--line); border-radius: .6rem; overflow: hidden; }}
img {{ display: block; width: 100%; height: auto; }}
figcaption {{ padding: .8rem 1rem; overflow-wrap: anywhere; }}
p {{ margin: .2rem 0 0; color: var(--soft); font-variant-numeric: tabular-nums; }}
</style>
<h1>Vertex colours only</h1>
<main>
{figures}
</main>
</html>
"""

FIGURE = """<figure>
<img src="{name}.jpg" alt="{name}, as an unlit viewer shows it" width="960" height="600" loading="lazy">
<figcaption><b>{name}</b>
<p>{elements:,} elements in {seconds:.1f} s of processors; error about {error}</p>
<p>{size:.0f} kB, {triangles:,} triangles; method {method}</p></figcaption>
</figure>"""


def figure(path):
    with open(path) as f:
        report = json.load(f)
    error = report["error"]["estimate"]
    return FIGURE.format(
        name=html.escape(os.path.basename(path)[: -len(".json")]), elements=report["scene"]["elements"], seconds=report["time"]["processor_s"],
        error="unknown" if error is None else f"{100 * error:.1f} %",
        size=report["output"]["bytes"] / 1000, triangles=report["scene"]["triangles_out"], method=html.escape(report["solver"]["method"]),
    )


def main():
    folder = sys.argv[1]
    reports = sorted(glob.glob(os.path.join(glob.escape(folder), "*.json")), key=os.path.getmtime)
    page = os.path.join(folder, "index.html")
    with open(page, "w") as f:
        f.write(PAGE.format(figures="\n".join(map(figure, reports))))
    print(page)


main()
