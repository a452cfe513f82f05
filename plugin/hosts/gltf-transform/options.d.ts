// SPDX-License-Identifier: MIT
// Which options do bakeScene and bake take? Made by plugin/hosts/options_table.py; not edited by hand.

/** What a bake of arrays and of a Document share. What is missing follows from the quality. */
export interface SceneOptions {
	/** preset of sizes and targets below (default medium; with --error: as fine as meets it) */
	quality?: 'draft' | 'medium' | 'high' | 'reference';
	/** how radiosity is solved (default auto: rows, by rays, under a sky, where a sun shines beside lamps and for many small faces, else hybrid; the report says which); the others are the paper's, to compare with */
	method?: 'hybrid' | 'analytic' | 'pr' | 'fm' | 'rows' | 'auto';
	/** what draws the item buffers of columns: OpenGL by OSMesa or EGL, or Embree's rays (default auto: what is there and predicted to be fastest; the report says which) */
	visibility?: 'osmesa' | 'egl' | 'rays' | 'auto';
	/** by which normals light is received: the file's, so that what is smooth looks smooth (default), or those of its facets */
	normals?: 'file' | 'faces';
	/** stop when the estimated relative error is below E (e.g. 0.01) */
	error?: number;
	/** stop after T seconds with the best answer so far (exit status 4); where neither quality nor sizes are given, elements are as small as T allows */
	time?: number;
	/** stop when this fraction of the emitted power is unshot */
	unshot?: number;
	/** target edge of an element, metres (default: from quality and scene) */
	elementSize?: number;
	/** target edge of a patch, metres */
	patchSize?: number;
	/** refine to no more elements than this, and refuse to start with more (default 4000000) */
	maxElements?: number;
	/** quarter elements up to N times where light is not linear (default: by quality; never with --element-size) */
	refineLevels?: number;
	/** refine until the size of elements costs less than this relative error (default: by quality) */
	refineError?: number;
	/** elements of one size: do not refine */
	uniform?: boolean;
	/** merge triangles where that changes no colour by more than this share of it (default: by quality; 0, or with --flat or kept instances: never) */
	mergeError?: number;
	/** a mesh that is too dense is solved on a simpler one, off by so many elements at most (default 0.035, by rows 0.02; 0: never) */
	standIn?: number;
	/** small patches shoot as one with those beside them whose normals differ by less (default 20; 0: never) */
	clusterAngle?: number;
	/** hemi-cube resolution, pixels across */
	hemicube?: number;
	/** the same on emitters */
	hemicubeLight?: number;
	/** share of an emitter's power in penumbra that quarters it further (default 0.005) */
	lightTolerance?: number;
	/** worker threads (default: all cores); the result is the same for any number */
	threads?: number;
	/** turns the hemi-cubes differently */
	seed?: number;
	/** of the process at its peak, within a tenth: fewer rays, kept form factors and elements where they do not fit; what cannot fit is refused (default: any, with 4096 for kept form factors) */
	memory?: number;
	/** follow light through so many reflections before the one that is seen (default: all; 0: direct light only) */
	bounces?: number;
	/** as --bounces 0 */
	directOnly?: boolean;
	/** what is farther away than this does not occlude (default, with --ao: a tenth of the diagonal of the scene) */
	aoDistance?: number;
	/** no view transform: linear Rec.709 radiance as float in _RADIOSITY, clamped in COLOR_0 */
	sceneLinear?: boolean;
	/** where the estimated error lies, as float in _ERROR: as a share of the rms radiance; its mean square is about the square of the estimate */
	vertexErrors?: boolean;
	/** stops to brighten by before the view transform (default auto: lit surfaces average to middle grey) */
	exposure?: number | 'auto';
	/** OpenColorIO configuration (default: $OCIO, else one of our own) */
	ocio?: string;
	/** linear space whose primaries light is added up in (default: the role scene_linear) */
	workingSpace?: string;
	/** display of the configuration */
	display?: string;
	/** view of the display */
	view?: string;
	/** look to apply */
	look?: string;
	/** one colour a triangle, in the picture and in what is written */
	flat?: boolean;
}

/** What only a bake of a Document takes. */
export interface DocumentOptions {
	/** a sun, in degrees: azimuth from north (-z) by east (+x), angular diameter 0.533 by default */
	sun?: [number, number, number, number?];
	/** radiance of the sky all around: one colour, or a panorama (default: 1 if nothing else gives light) */
	environment?: [number, number, number];
}
