/* SPDX-License-Identifier: MIT
 * Which elements does a surface that stands on them, crosses them or ends on them have in the light in part only? They
 * are cut along the line in which it does [Baum91], and what is on either side of the line has colours of its own, but
 * where light goes on under what hangs there.
 *
 * Patches are cut too, since a patch shoots the mean of its elements: patch and elements along the same lines.
 *
 * Neighbours of what is cut get the new corners too, whatever their vertices are called, so that no edge has a
 * T-junction. The two sides of a sheet are cut alike.
 */
#ifndef HEMIBAKE_CORE_MESH_CONTACT_CUT_H
#define HEMIBAKE_CORE_MESH_CONTACT_CUT_H

#include "mesh/refinement.h"
#include "scene/contact_lines.h"

/* Cuts the elements of a mesh that is not measured, whose patches, elements and vertices are blocks, and its patches
 * where a line runs through at least `least` of one, m. Colours are shared across a line whose gap is at least
 * wide_gap, m. Where that would be more elements than elements_max, or several times as many as there are, those that
 * many lines run through stay as they are, or all; and what no cut came to in time. False when out of memory.
 */
bool contact_cut(const refinement_setup *setup, const contact_lines *lines, double least, double wide_gap,
                 uint32_t elements_max, const deadline *latest);

#endif
