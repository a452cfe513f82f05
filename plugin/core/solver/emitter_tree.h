/* SPDX-License-Identifier: MIT
 * Which of very many emitters does light come from here? They are the leaves of a tree by place, whose nodes know how
 * much all under them emit, and within which ball and which cone. Going down from the root, each step takes one of two
 * by how much light may come from either.
 */
#ifndef HEMIBAKE_CORE_SOLVER_EMITTER_TREE_H
#define HEMIBAKE_CORE_SOLVER_EMITTER_TREE_H

#include "light/punctual.h"
#include "mesh/mesh.h"

/* A patch that emits, or a punctual light that has a place: of that what it emits is its intensity. */
typedef struct tree_emitter {
    double center[3], normal[3], area, radius, M[3];
    double luminance; /* sum of M */
    double spread;    /* so much more than by the cosine to the normal may it emit to a side; 0 of a patch */
    double reach;     /* m, past which it gives nothing */
    uint32_t patch;   /* or the number of the light */
} tree_emitter;

/* Emitters first to end - 1; children are 2i+1 and 2i+2, the emitters halved between them. */
typedef struct tree_node {
    double center[3], radius, axis[3];
    double
        spread; /* the furthest that a normal is from the axis, as a chord, and how much the emitter itself spreads */
    double power;
    double reach; /* m, past which nothing comes from any of them */
} tree_node;

typedef struct emitter_tree {
    tree_emitter *emitters; /* along a curve that fills space */
    size_t count;
    tree_node *nodes;
    const mesh *mesh; /* of patches; NULL: they are lights */
} emitter_tree;

/* False when out of memory. */
bool emitter_tree_create(const mesh *m, const scene *s, emitter_tree *out);

/* Of the punctual lights that have a place and give light. False when out of memory. */
bool emitter_tree_of_lights(const punctual *all, size_t count, const scene *s, emitter_tree *out);
void emitter_tree_free(emitter_tree *t);

enum { EMITTER_CUT_MOST = 96 };

/* The emitters from first to end - 1 of a node. */
typedef struct emitter_part {
    size_t node, first, end;
    double light; /* that may come from it */
    double wide;  /* beside its distance; 0: it is not, or is one emitter, or gives nothing */
} emitter_part;

/* Parts of a tree as seen from one small area, that hold all emitters between them: what is near is in smaller ones, so
 * that what light may come from each is known better than from the root. */
typedef struct emitter_cut {
    const emitter_tree *tree;
    double point[3], normal[3];
    int count;
    emitter_part parts[EMITTER_CUT_MOST];
    double until[EMITTER_CUT_MOST]; /* running sums of light */
} emitter_cut;

void emitter_tree_cut(const emitter_tree *t, const double point[3], const double normal[3], emitter_cut *out);

/* One for a number in [0, 1), by the light that may come from it; NULL where none does. The number is then where it
 * lies among those that give the same one, as good as a new one. */
const tree_emitter *emitter_cut_sample(const emitter_cut *c, double *which, double *probability);

#endif
