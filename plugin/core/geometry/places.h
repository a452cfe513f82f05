/* SPDX-License-Identifier: MIT
 * Which vertices are in one place? Files split a vertex for each normal and texture coordinate that it has, and meshes
 * that touch have vertices of their own: surfaces go on where positions are the same.
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_PLACES_H
#define HEMIBAKE_CORE_GEOMETRY_PLACES_H

#include "base/block.h"

#include <stdint.h>

/* How many numbers of scratch it takes to find the places of so many vertices. */
size_t places_slot_count(size_t count);

/* Sets place[v] of each position, positions[3*v+k]: the same number for the same three coordinates to the last bit,
 * except that -0 is 0. Places are numbered in the order in which their first vertices come. Returns how many there are.
 * slots: scratch, places_slot_count(count) of them. */
uint32_t places_find(const double *positions, size_t count, uint32_t *slots, uint32_t *place);
uint32_t places_find_floats(const float *positions, size_t count, uint32_t *slots, uint32_t *place);

/* The same with scratch of its own: a block of count + 1 places; NULL when out of memory. */
uint32_t *places_new(allocator *memory, const double *positions, size_t count, uint32_t *place_count);

#endif
