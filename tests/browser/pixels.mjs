// SPDX-License-Identifier: MIT
// How far are two pictures apart, on a tile or wherever both are smooth?

// Where a point of the plane z = 0 is in the picture of the board's camera.
export function project(facts, [x, y]) {
    const scale = facts.height / 2 / Math.tan(facts.yfov / 2) / facts.distance;
    return [facts.width / 2 + scale * x, facts.height / 2 - scale * y];
}

const at = (picture, x, y) => picture.data.subarray(4 * (y * picture.width + x), 4 * (y * picture.width + x) + 3);

const apart = (a, b) => Math.max(...[0, 1, 2].map(k => Math.abs(a[k] - b[k])));

// The largest difference from the expected code values over the middle of every tile, 7 x 7 pixels each.
export function compareTiles(picture, facts, expected) {
    let most = 0, where = '';
    facts.centres.forEach((centre, tile) => {
        const [x, y] = project(facts, centre).map(Math.floor);
        for (let j = -3; j <= 3; j++)
            for (let i = -3; i <= 3; i++) {
                const shown = at(picture, x + i, y + j), difference = apart(shown, expected[tile]);
                if (difference > most) [most, where] = [difference, `tile ${tile}: ${[...shown]}, not ${expected[tile]}`];
            }
    });
    return { most, where };
}

// No edge of a surface comes near, which one picture smooths and another does not: 5 x 5 pixels are nearly of one colour.
function isSmooth(picture, x, y) {
    const middle = at(picture, x, y);
    for (let j = -2; j <= 2; j++)
        for (let i = -2; i <= 2; i++) if (apart(middle, at(picture, x + i, y + j)) > 4) return false;
    return true;
}

// Of all pixels that are smooth in both: the largest difference, and their part of the picture.
export function compareSmooth(a, b) {
    let most = 0, count = 0, where = '';
    for (let y = 2; y < a.height - 2; y++)
        for (let x = 2; x < a.width - 2; x++) {
            if (!isSmooth(a, x, y) || !isSmooth(b, x, y)) continue;
            count++;
            const difference = apart(at(a, x, y), at(b, x, y));
            if (difference > most) [most, where] = [difference, `${x},${y}: ${[...at(a, x, y)]} and ${[...at(b, x, y)]}`];
        }
    return { most, where, covered: count / (a.width * a.height) };
}
