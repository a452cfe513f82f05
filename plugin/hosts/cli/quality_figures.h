/* SPDX-License-Identifier: MIT
 * What does each quality cost and give? Made by tests/bench/quality_figures.py, which also says whether it still holds.
 */
/* scene, quality, surfaces, elements, error against path-traced probes in %, processor seconds, MiB, kB of the output */
QUALITY_FIGURES("pillar-room", "draft", 972, 2762, 1.32, 1.01, 109, 23)
QUALITY_FIGURES("pillar-room", "medium", 972, 7496, 0.60, 3.08, 162, 31)
QUALITY_FIGURES("pillar-room", "high", 972, 8063, 0.56, 13.39, 370, 32)
QUALITY_FIGURES("cornell-box", "draft", 18, 2242, 1.06, 0.63, 112, 18)
QUALITY_FIGURES("cornell-box", "medium", 18, 7439, 0.61, 1.50, 142, 30)
QUALITY_FIGURES("cornell-box", "high", 18, 7598, 0.45, 4.54, 270, 30)
QUALITY_FIGURES("living-room", "draft", 2536, 58921, 0.55, 3.17, 193, 136)
QUALITY_FIGURES("living-room", "medium", 2536, 199552, 0.26, 13.19, 525, 346)
QUALITY_FIGURES("living-room", "high", 2536, 405016, 0.16, 49.02, 963, 547)
