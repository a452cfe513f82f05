/* SPDX-License-Identifier: MIT
 * Which numbers decide "near enough", and where does each come from? Lengths are relative to what is named.
 */
#ifndef HEMIBAKE_CORE_BASE_TOLERANCE_H
#define HEMIBAKE_CORE_BASE_TOLERANCE_H

/* The cosine between the normals of neighbours that are facets of one smooth surface: 60 degrees and less. */
#define TOLERANCE_SMOOTH 0.5

/* An occluder must cross the segment eye -> point inside (this, 1 - this) of its length. Positions come as floats,
 * whose rounding is 6e-8 of the scene; surfaces that touch (wall on floor) are apart by a few of those, and 1e-5 of a
 * segment's length is above that and far below any gap that light gets through. */
#define TOLERANCE_SEGMENT_END 1e-5

/* A point counts as in front of a plane when it is further than this, relative to the scene's radius: two float
 * roundings of a coordinate of the size of the scene (2 x 6e-8), doubled. */
#define TOLERANCE_PLANE 2.5e-7

/* Surfaces that meet lie in one plane, or end at one line, when they are this near, relative to the scene's radius:
 * float positions are off by 6e-8. */
#define TOLERANCE_IN_PLANE 1e-6

/* The eye of a hemi-cube is this far above its surface, relative to the scene's radius, so that the roundings of float
 * positions (a few times 6e-8) never put it behind its own surface, which would then fill the view. */
#define TOLERANCE_EYE_LIFT 2e-6

/* A ray that meets a surface's plane this near outside an edge, relative to the scene's radius, meets the surface:
 * along an edge that two surfaces share it must meet one of them. The crossings are off by some roundings (1e-16) of
 * coordinates of the scene's size, divided by the cosine at which the ray comes. */
#define TOLERANCE_EDGE 1e-12

/* The near plane of item buffers, relative to the scene's radius. Depth is near / z in a reversed float buffer, which
 * keeps its relative precision of 6e-8 whatever near is; so near may be as small as the smallest gap of the scene. */
#define TOLERANCE_NEAR_PLANE 1e-6

/* A triangle whose area is this small against the square of its longest edge has none: its plane is made of the
 * roundings of its corners. The cross product of edges in doubles is exact to about 1e-16 of that square. */
#define TOLERANCE_DEGENERATE 1e-12

/* Facets that meet in an edge lie in one plane when their normals differ by less than this (radians, a twentieth of a
 * degree): float positions of a flat wall differ by 1e-7 of their size, so a triangle a thousandth of the wall's size
 * is tilted by 1e-4. */
#define TOLERANCE_SAME_PLANE 1e-3

/* The same of a control cage (half a degree): corners quantised to 14 bits tilt a face by that much when its edge is a
 * hundredth of the mesh. */
#define TOLERANCE_SAME_PLANE_CAGE 0.01

/* Positions and attributes are affine over a face when they depart from it by this, relative to their largest: floats
 * of exported rectangles are within a few roundings (6e-8) of the size of the coordinates. Normals are less exact. */
#define TOLERANCE_AFFINE        2e-6
#define TOLERANCE_AFFINE_NORMAL 1e-3

/* Two triangles lie in one plane, or overlap, when they do by this much, relative to the largest coordinate: float
 * positions and the plane through them are off by a few times 6e-8. */
#define TOLERANCE_OVERLAP 1e-6

/* A face that covers fewer pixels than this across may be missed by the exact ray although its neighbours cover the
 * ray: item buffers see faces of about a pixel as one of several. */
#define TOLERANCE_SMALL_FACE_PIXELS 3.0

/* With such faces visibility falls back on depth. A facet next to the sample's own may lie in front of it by one
 * pixel's footprint on the surface and the same again for its tilt; twice that is the bias, in pixel footprints. */
#define TOLERANCE_DEPTH_BIAS_PIXELS 4.0

/* The relative error that a point estimate of a form factor may have in the worst of the geometries of near_distance.h;
 * the errors of the others differ in sign and are smaller. Nearer than this asks for, the closed form is used. The
 * paper takes 2.5 % in its discussion of figure 4. */
#define TOLERANCE_POINT_FACTOR 0.025

/* Something crosses a piece of surface when it is met this fraction before the border: walls that meet the floor at the
 * border itself do not. The lowest pixel looks up by 1 / resolution, which moves the meeting by less than that. */
#define TOLERANCE_CROSSING 0.02

/* What hangs lower than this over a piece of surface, in edges of a square as large, hides parts of what is under it
 * from other parts: a sphere on a floor does, whether it touches the floor or not. Looked for up to this slope from the
 * middle of the piece. */
#define TOLERANCE_LOW       0.05
#define TOLERANCE_LOW_SLOPE 0.1

/* A piece whose hemi-cube sees more than this fraction of backs is inside something, and shoots nothing. */
#define TOLERANCE_BURIED 0.5

/* A whole patch is inside something when its hemi-cube sees less than this of fronts and sky. Inside a closed solid it
 * sees none; under an emitter that hangs a hundredth of its width below the ceiling it still sees 1e-4. */
#define TOLERANCE_ENCLOSED 1e-7

/* A column's sum over receivers [Baum89, eq. 10] may exceed what the hemi-cube says reaches fronts by this fraction
 * and be normalised [Baum89, eq. 11: "a few percent"]; more means wrong visibility and splits the shooter. */
#define TOLERANCE_CLOSURE_EXCESS 0.04

/* A hemi-cube sees a closed room when no more than this misses fronts: not one pixel of the smallest (16 across), whose
 * least weight is 2e-5, but the rounding of 10^6 weights. */
#define TOLERANCE_CLOSED 1e-9

/* In a closed room the factors of a sample sum to 1 to within this, by the errors of point estimates (2.5 % at worst)
 * and of visibility in corners. A sample that is further off is inside something, or sees what its shooters do not. */
#define TOLERANCE_ROW 0.1

/* A border is straight at a vertex when it turns by less than this: vertices halfway between others are off by
 * roundings (1e-16) of coordinates a million times an edge at most. */
#define TOLERANCE_STRAIGHT 1e-9

#endif
