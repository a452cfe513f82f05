// SPDX-License-Identifier: MIT
// How does the command of glTF-Transform learn to bake?
//
//     gltf-transform bake in.glb out.glb --quality high --config node_modules/hemibake-gltf-transform/gltf-transform.config.mjs

import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { bake } from './index.mjs';
import { keyOf, optionsOf } from './options.mjs';

const list = (text) => String(text).split(',').map(Number);

/** What a word of the command line is as an option of bake. */
const FROM_TEXT = {
	flag: Boolean,
	number: Number,
	count: Number,
	exposure: (text) => (text === 'auto' ? text : Number(text)),
	sun: list,
	sky: list,
};

/** How help calls a value: the program takes no brackets and bars in it. */
const VALUES = { number: 'number', count: 'n', exposure: 'ev', sun: 'azimuth,elevation,lux,angle', sky: 'r,g,b' };

/** Checks and converts what was written on the command line. */
function toOptions(given) {
	const out = {};
	for (const option of optionsOf(true)) {
		const key = keyOf(option);
		if (given[key] === undefined) continue;
		out[key] = (FROM_TEXT[option.kind] ?? String)(given[key]);
		if ([out[key]].flat().some(Number.isNaN)) throw new Error(`${option.name}: '${given[key]}' is not what it takes`);
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
		for (const { name, argument, kind, help } of optionsOf(true)) {
			const validator = kind === 'choice' ? { validator: argument.split('|') } : {};
			command = command.option(argument ? `${name} <${VALUES[kind] ?? 'value'}>` : name, help, validator);
		}
		command.action(async ({ args, options, logger }) =>
			Session.create(io, logger, args.input, args.output).transform(bake(toOptions(options))));
	},
};
