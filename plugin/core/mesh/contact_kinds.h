/* SPDX-License-Identifier: MIT
 * Which patches lie in other surfaces or under them? Those reflect no light, and rays see only one of two in one plane.
 */
#ifndef HEMIBAKE_CORE_MESH_CONTACT_KINDS_H
#define HEMIBAKE_CORE_MESH_CONTACT_KINDS_H

#include "base/jobs.h"
#include "mesh/mesh.h"
#include "scene/contact_lines.h"

/* Sets the contact of each patch of a mesh that was cut along lines, and which elements are feet. Jobs may be NULL. */
void contact_kinds_set(const scene *s, const contact_lines *lines, mesh *m, jobs *j);

#endif
