// SPDX-License-Identifier: MIT
// How does the command of glTF-Transform learn to bake?
//
//     gltf-transform bake in.glb out.glb --quality high --config node_modules/hemibake-gltf-transform/gltf-transform.config.mjs

import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { bake } from './index.mjs';

/** Reads from `least` to `most` numbers between commas. */
function numbers(least, most) {
	return (text) => {
		const all = String(text).split(',').map(Number);
		return all.length < least || all.length > most || all.some(Number.isNaN) ? NaN : all;
	};
}

// [flag, help, kind]
const FLAGS = [
	['--quality <q>', 'Preset of sizes and targets: draft, medium, high, reference', ['draft', 'medium', 'high', 'reference']],
	['--method <m>', 'How radiosity is solved: hybrid, analytic, pr, fm', ['hybrid', 'analytic', 'pr', 'fm']],
	['--error <e>', 'Stop when the estimated relative error is below this', Number],
	['--time <s>', 'Stop after so many seconds', Number],
	['--unshot <u>', 'Stop when this fraction of the emitted power is unshot', Number],
	['--element-size <m>', 'Target edge of an element, metres', Number],
	['--patch-size <m>', 'Target edge of a patch, metres', Number],
	['--max-elements <n>', 'Refine to no more elements than this', Number],
	['--refine-levels <n>', 'Quarter elements up to so many times where light is not linear', Number],
	['--refine-error <e>', 'Refine until the size of elements costs less than this relative error', Number],
	['--uniform', 'Elements of one size: do not refine', Boolean],
	['--cluster-angle <deg>', 'Small patches shoot as one with those beside them whose normals differ by less; 0: never', Number],
	['--merge-error <e>', 'Merge triangles where that changes no colour by more than this share of it; 0: never', Number],
	['--stand-in <d>', 'Elements that a simpler mesh may be off that stands in for one too dense; 0: never', Number],
	['--hemicube <n>', 'Hemi-cube resolution, pixels across', Number],
	['--hemicube-light <n>', 'The same on emitters', Number],
	['--light-tolerance <f>', "Share of an emitter's power in penumbra that quarters it further", Number],
	['--threads <n>', 'Worker threads', Number],
	['--seed <n>', 'Turns the hemi-cubes differently', Number],
	['--memory <mib>', 'For kept form factors', Number],
	['--exposure <ev>', 'Stops to brighten by, or auto', (text) => (text === 'auto' ? text : Number(text))],
	['--ocio <file>', 'OpenColorIO configuration', String],
	['--display <d>', 'Display of the configuration', String],
	['--view <v>', 'View of the display', String],
	['--look <l>', 'Look to apply', String],
	['--working-space <s>', 'Linear space whose primaries light is added up in', String],
	['--sun <azimuth,elevation,lux[,angle]>', 'A sun; in degrees, from -z over +x', numbers(3, 4)],
	['--environment <r,g,b>', 'A sky of this radiance', numbers(3, 3)],
	['--flat', 'One colour a triangle', Boolean],
	['--scene-linear', 'No view transform: radiance in _RADIOSITY', Boolean],
];

const keyOf = (flag) => flag.split(' ')[0].slice(2).replace(/-(.)/g, (_, letter) => letter.toUpperCase());

/** Checks and converts what was written on the command line. */
function toOptions(given) {
	const out = {};
	for (const [flag, , kind] of FLAGS) {
		const key = keyOf(flag);
		if (given[key] === undefined) continue;
		out[key] = Array.isArray(kind) ? given[key] : kind(given[key]);
		if (Number.isNaN(out[key])) throw new Error(`${flag.split(' ')[0]}: '${given[key]}' is not what it takes`);
	}
	return out;
}

export default {
	extensions: ALL_EXTENSIONS,
	onProgramReady: async ({ program, io, Session }) => {
		let command = program
			.command('bake', 'Bakes global illumination into vertex colors')
			.help('Solves the radiosity of the scene and writes its light into COLOR_0; materials become unlit.')
			.argument('<input>', 'Path to glTF 2.0 (.glb, .gltf) input')
			.argument('<output>', 'Path to glTF 2.0 (.glb, .gltf) output');
		for (const [flag, help, kind] of FLAGS) {
			command = command.option(flag, help, Array.isArray(kind) ? { validator: kind } : {});
		}
		command.action(async ({ args, options, logger }) =>
			Session.create(io, logger, args.input, args.output).transform(bake(toOptions(options))));
	},
};
