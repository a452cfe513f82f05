/* SPDX-License-Identifier: MIT
 * Which vertex colour shows a radiance on a display?
 *
 *     radiance, working space (exposed) -> display and view of an OpenColorIO configuration -> display code values
 *                                        -> inverse of the sRGB encoding -> COLOR_0
 *
 * A glTF viewer takes COLOR_0 as linear and encodes it as sRGB; so what it shows are the code values of the view. The
 * working space is the one that light was added up in; radiosity in rgb depends on its primaries (README.md).
 *
 * The library reads no environment; OpenColorIO does: OCIO_ACTIVE_DISPLAYS, OCIO_ACTIVE_VIEWS (which change defaults),
 * OCIO_OPTIMIZATION_FLAGS.
 */
#ifndef HEMIBAKE_COLOR_COLOR_TRANSFORM_H
#define HEMIBAKE_COLOR_COLOR_TRANSFORM_H

#include <hemibake/hemibake.h>

HEMI_C_BEGIN

enum { COLOR_MESSAGE_SIZE = 1024 };

/* Radiance above this is taken as this, infinity too: far above any exposed value, and no matrix overflows from it. */
#define COLOR_RADIANCE_MAX 1e9f

/* A value beyond [0,1] by less than this is rounding of float matrices that undo each other, not a clipped colour. */
#define COLOR_CLIP_SLACK 1e-5f

typedef struct color_transform color_transform;

/* NULL: the default. Displays and views match whatever their case. */
typedef struct color_transform_desc {
    const char *config;        /* path of an .ocio file; NULL: the one inside (displays: sRGB, Display P3; views: Soft,
                                  Standard, which clips, "ACES 1.x SDR", Filmic, Raw) */
    const char *display;       /* NULL: the configuration's default */
    const char *view;          /* NULL: the display's default */
    const char *look;          /* names separated by commas, - before one undoes it; NULL: the view's own; "": none */
    const char *working_space; /* of radiance: name, alias or role; linear. NULL: the role scene_linear */
    /* May a file be read that the configuration names? False: reason (COLOR_MESSAGE_SIZE) says why not. NULL: any. */
    bool (*may_read)(void *user, const char *path, char *reason);
    void *may_read_user;
} color_transform_desc;

/* desc may be NULL. HEMI_ERROR_FILE: the configuration, or a table that it names, cannot or may not be read;
 * HEMI_ERROR_UNSUPPORTED: it needs a newer OpenColorIO; HEMI_ERROR_DATA: it is broken; HEMI_ERROR_ARGUMENT: it has no
 * such display, view, look or space, or the space is not linear; HEMI_ERROR_MEMORY. message gets one line then, with
 * the names that it has; *out is NULL. */
hemi_result color_transform_create(const color_transform_desc *desc, color_transform **out,
                                   char message[COLOR_MESSAGE_SIZE]);
void color_transform_destroy(color_transform *transform); /* NULL is fine */

/* What was chosen; valid as long as the transform. The configuration is its path, or "hemibake" for the one inside; the
 * look is "" if there is none. */
typedef enum color_part {
    COLOR_PART_CONFIG,
    COLOR_PART_DISPLAY,
    COLOR_PART_VIEW,
    COLOR_PART_LOOK,
    COLOR_PART_WORKING_SPACE,
    COLOR_PART_COUNT
} color_part;

const char *color_transform_name(const color_transform *transform, color_part part);

/* The files that the transforms of a configuration name, tables for the most part: each that is there once, in the
 * order of their paths. None of what is no configuration, nor of one that OpenColorIO has inside. */
void color_config_files(const char *config, void (*see)(void *user, const char *path), void *user);

/* rgb[3*i+c], in place: radiance to linear values for COLOR_0, in [0,1] and finite whatever went in. *clipped (may be
 * NULL) is how many of the colours had a band that is not finite, negative, or beyond [0,1] on the display.
 * One transform may be applied from many threads. HEMI_ERROR_BACKEND: OpenColorIO failed; rgb is then undefined. */
hemi_result color_transform_apply(const color_transform *transform, float *rgb, size_t count, size_t *clipped);

/* The least grey from 1 to 8, in eighths of a stop, that is shown at code value 240 of 255 or above: 1 by a view that
 * clips, 2 by Soft; where it is none, 8, and 1 where colours are not to be had. */
double color_transform_white(const color_transform *transform);

/* The same up to the display code values, in [0,1]: times 255 they are the pixels of an sRGB picture. */
hemi_result color_transform_apply_display(const color_transform *transform, float *rgb, size_t count, size_t *clipped);

/* Radiance to scene-linear Rec.709, the primaries of glTF, without exposure and view. A colour outside of Rec.709 keeps
 * its negative bands. HEMI_ERROR_UNSUPPORTED: the configuration knows neither linear Rec.709 by one of its usual names
 * nor the role aces_interchange; rgb is then untouched. */
hemi_result color_transform_apply_rec709(const color_transform *transform, float *rgb, size_t count);

HEMI_C_END
#endif
