/* SPDX-License-Identifier: MIT
 * Which surfaces share an edge? An edge whose two ends lie exactly where those of another surface's edge do joins the
 * two, whatever their vertices are called: hard edges have vertices of their own on each side.
 */
#ifndef HEMIBAKE_CORE_SCENE_NEIGHBOURS_H
#define HEMIBAKE_CORE_SCENE_NEIGHBOURS_H

#include "scene/scene.h"

/* neighbours[4*i+k]: a surface that shares the edge from corner k of surface i to the next, or NO_INDEX; where several
 * do, the next of them in index order, and the first after the last. False when out of memory. */
bool scene_find_neighbours(const scene *s, uint32_t *neighbours);

/* mates[4*i+k]: the edge 4*j+l of surface j on which i goes on past the edge from its corner k: the same edge run the
 * other way, of a surface that faces the same side. NO_INDEX where there is none, or more than one. False when out of
 * memory. */
bool scene_find_mates(const scene *s, uint32_t *mates);

#endif
