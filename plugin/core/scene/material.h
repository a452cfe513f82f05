/* SPDX-License-Identifier: MIT
 * What does a surface make of the light that meets it? Shares of it are reflected, go straight through, or leave
 * diffusely by the other side; together never more than all.
 */
#ifndef HEMIBAKE_CORE_SCENE_MATERIAL_H
#define HEMIBAKE_CORE_SCENE_MATERIAL_H

#include "scene/scene.h"

/* Of a reflectance and emitted radiance, opaque. False: those are not numbers that a surface can have. */
bool material_set(material *out, const double rho[3], const double radiance[3]);

/* Sets what goes straight through, and adds what leaves diffusely by the other side to the reflectance, as far as both
 * are no more than rho_max and the method knows such light. False where they are no shares. */
bool material_set_transmission(material *out, const double straight[3], const double diffuse[3], double rho_max,
                               bool solves_diffuse_transmission);

/* Does light that passes it leave with less than it had? What is wholly clear stands in no light's way, and what emits
 * beside that lights and is not lit. varies: a picture says what it is where, and these are the most that it may be. */
bool material_tints(const double rho[3], const double straight[3], const double diffuse[3], bool varies);

/* Does a share of the light leave by the other side, diffusely? */
bool material_transmits_diffusely(const material *m);

/* Reduces the reflectance to rho_max. What is demodulated is multiplied by the texture again, so it is reduced as much
 * as their product is; may be NULL. True: there was something to reduce. */
bool material_clamp(material *out, material *demodulated, double rho_max);

#endif
