// SPDX-License-Identifier: MIT
// What does the package offer? The transform, and the bake of plain arrays behind it.

export { bake, BAKE_DEFAULTS } from './bake.mjs';
export { bakeScene, version } from './native.mjs';
