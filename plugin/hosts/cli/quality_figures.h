/* SPDX-License-Identifier: MIT
 * What does each quality cost and give? Made by tests/bench/quality_figures.py, which also says whether it still holds.
 */
/* scene, quality, surfaces, elements, error against path-traced probes in %, processor seconds, MiB, kB of the output */
QUALITY_FIGURES("pillar-room", "draft", 972, 2768, 1.41, 0.89, 109, 21)
QUALITY_FIGURES("pillar-room", "medium", 972, 7499, 0.63, 3.51, 163, 28)
QUALITY_FIGURES("pillar-room", "high", 972, 8063, 0.55, 13.50, 370, 29)
QUALITY_FIGURES("cornell-box", "draft", 18, 2242, 1.08, 0.81, 112, 16)
QUALITY_FIGURES("cornell-box", "medium", 18, 7439, 0.65, 2.03, 141, 27)
QUALITY_FIGURES("cornell-box", "high", 18, 7598, 0.45, 6.72, 269, 27)
QUALITY_FIGURES("living-room", "draft", 2536, 58921, 0.65, 5.12, 221, 156)
QUALITY_FIGURES("living-room", "medium", 2536, 199447, 0.28, 18.87, 560, 456)
QUALITY_FIGURES("living-room", "high", 2536, 462326, 0.15, 138.74, 2065, 770)
