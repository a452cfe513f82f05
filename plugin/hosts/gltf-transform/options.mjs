// SPDX-License-Identifier: MIT
// Which options are there, and how does the addon take them? The list is the addon's, from plugin/hosts/options/option_list.h.

import { load } from './native.mjs';

/** '--element-size' is elementSize. */
export const keyOf = ({ name }) => name.slice(2).replace(/-(.)/g, (_, letter) => letter.toUpperCase());

/** Options of bake, or of bakeScene. */
export const optionsOf = (documents) => load().options.filter((option) => documents || !option.documents);

const IS = {
	flag: ['true or false', (value) => typeof value === 'boolean'],
	number: ['a number', (value) => typeof value === 'number'],
	count: ['a number', (value) => typeof value === 'number'],
	exposure: ["a number or 'auto'", (value) => typeof value === 'number' || value === 'auto'],
	sun: ['an array of three or four numbers', (value) => isNumbers(value, 3, 4)],
	sky: ['an array of three numbers', (value) => isNumbers(value, 3, 3)],
};
const IS_TEXT = ['a string', (value) => typeof value === 'string'];

function isNumbers(value, least, most) {
	return Array.isArray(value) && value.length >= least && value.length <= most && value.every(Number.isFinite);
}

/**
 * The options that are given, as the addon takes them, in the order of its list: of two that say the same in two ways the later
 * is taken. What is no option, or of another kind, is a TypeError.
 */
export function optionTexts(settings, documents = false) {
	const known = optionsOf(documents);
	const keys = known.map(keyOf);
	for (const key of Object.keys(settings)) {
		if (!keys.includes(key)) throw new TypeError(`hemibake: '${key}' is no option; there are ${keys.join(', ')}`);
	}
	return known.flatMap((option, i) => {
		const value = settings[keys[i]];
		if (value === undefined || value === null) return [];
		const [what, isIt] = IS[option.kind] ?? IS_TEXT;
		if (!isIt(value)) throw new TypeError(`hemibake: '${keys[i]}' is not ${what}`);
		if (option.kind === 'choice') checkWord(keys[i], option.argument.split('|'), value);
		return value === false ? [] : [[option.index, value === true ? '' : String(value)]];
	});
}

function checkWord(key, words, value) {
	if (!words.includes(value)) throw new TypeError(`hemibake: ${key} '${value}' is none of ${words.join(', ')}`);
}
