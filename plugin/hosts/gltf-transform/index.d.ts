// SPDX-License-Identifier: MIT
import type { Transform } from '@gltf-transform/core';
import type { DocumentOptions, SceneOptions } from './options.js';

export interface BakeSceneOptions extends SceneOptions {
	/** Called about twenty times a second; false cancels. */
	onProgress?: (fraction: number, stage: string) => boolean | void;
	/** Cancels. */
	signal?: AbortSignal;
}

export interface BakeOptions extends BakeSceneOptions, DocumentOptions {
	/** COLOR_0 as normalised 16 bit rgba, or as float rgb: the better choice before draco(). Default: 'u16norm'. */
	colorFormat?: 'u16norm' | 'f32';
}

export interface SceneMaterial {
	name?: string;
	/** Diffuse reflectance, linear Rec.709. */
	reflectance: [number, number, number];
	/** Emitted radiance, W/m2/sr. */
	emission: [number, number, number];
	/** Light that gets straight through. */
	transmission?: [number, number, number];
	doubleSided?: boolean;
}

export interface SceneMesh {
	name?: string;
	/** Three numbers a vertex, metres. */
	positions: Float32Array;
	/** Three a triangle, counter-clockwise. */
	indices: Uint32Array;
	normals?: Float32Array;
	/** attributeCount numbers a vertex that must interpolate linearly over a face. */
	attributes?: Float32Array;
	attributeCount?: number;
	/** Index into the scene's materials. */
	material: number;
	/** Mesh to world, column by column. */
	transform?: number[];
	/** 0: none, 1: Catmull-Clark, 2: Loop. */
	subdivision?: 0 | 1 | 2;
	subdivisionLevel?: number;
}

/** A light without a surface, as in KHR_lights_punctual. */
export interface SceneLight {
	name?: string;
	kind: 'point' | 'spot' | 'directional';
	/** W/sr, or W/m2 of a directional light; linear Rec.709. */
	intensity: [number, number, number];
	position?: [number, number, number];
	/** The way its light travels. */
	direction?: [number, number, number];
	/** Radians from the direction to where a spot begins to fade ... */
	innerCone?: number;
	/** ... and to where it ends. Default: a quarter of pi. */
	outerCone?: number;
	/** Where point and spot have faded out, metres. */
	range?: number;
	/** Radians, of a directional light with a disc; the sun's is 0.0093. */
	angularDiameter?: number;
}

/** What is seen past all surfaces. */
export interface SceneSky {
	/** W/m2/sr; what the image is multiplied by, if there is one. Default: 1. */
	radiance?: [number, number, number];
	/** A panorama: three numbers a texel, row 0 at the zenith, +x in the middle, +z a quarter to the right of it. */
	image?: Float32Array;
	width?: number;
	height?: number;
}

export interface BakedMesh {
	positions: Float32Array;
	normals: Float32Array;
	/** Outgoing radiance, linear Rec.709. */
	radiance: Float32Array;
	/** COLOR_0: four normalised shorts a vertex. */
	colors: Uint16Array;
	indices: Uint32Array;
	/** A triangle of the input that holds the vertex; missing if the mesh was subdivided. */
	sourceTriangles?: Uint32Array;
	/** The vertex's barycentric coordinates there. */
	sourceWeights?: Float32Array;
	/** Where the estimated error lies, as a share of the rms radiance; with vertexErrors. */
	errors?: Float32Array;
}

export interface BakedScene {
	meshes: BakedMesh[];
	statistics: {
		surfaces: number;
		patches: number;
		elements: number;
		shots: number;
		hemicubes: number;
		clampedMaterials: number;
		degenerateTriangles: number;
		unshotFraction: number;
		energyResidual: number;
		errorEstimate: number;
		seconds: number;
		converged: boolean;
	};
	/** Stops that the colours were brightened by. */
	exposure: number;
	clippedFraction: number;
}

export declare const BAKE_DEFAULTS: Required<Pick<BakeOptions, 'colorFormat'>>;

/** Writes the light of the scene into the vertex colours of a Document. */
export declare function bake(options?: BakeOptions): Transform;

/** Bakes a scene of plain arrays. */
export declare function bakeScene(
	scene: { materials: SceneMaterial[]; meshes: SceneMesh[]; lights?: SceneLight[]; sky?: SceneSky },
	options?: BakeSceneOptions,
): Promise<BakedScene>;

/** The version of the library behind the addon. */
export declare function version(): string;
