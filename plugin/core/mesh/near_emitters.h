/* SPDX-License-Identifier: MIT
 * Which elements are split because a lamp is close to them? By rows an element reflects the same all over, as a patch
 * does that shoots. A ceiling 3 cm over a lamp is as bright as the lamp itself where that is, and dark a hand's breadth
 * beside it: a surface close to a lamp is an emitter in all but name, and what of its light comes out of the gap, and
 * where it goes, is right only where elements are as small as the light is uneven.
 */
#ifndef HEMIBAKE_CORE_MESH_NEAR_EMITTERS_H
#define HEMIBAKE_CORE_MESH_NEAR_EMITTERS_H

#include "base/deadline.h"
#include "mesh/refinement.h"

/* Splits elements of a measured mesh as often as what emitters give them, by closed forms and without what may stand
 * between, differs over them by more than a small share of all light. alike: whatever emits is taken to be equally
 * bright, so that rows that are kept are of the same elements by other light. No more than elements_max come of it, and
 * none that are not marked in time.
 * False when out of memory. */
bool near_emitters_split(const refinement_setup *setup, bool alike, uint32_t elements_max, const deadline *latest,
                         arena *memory);

#endif
