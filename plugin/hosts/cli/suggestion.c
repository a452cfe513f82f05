/* SPDX-License-Identifier: MIT
 * See suggestion.h. The distance is that of Damerau, restricted: letters that are added, left out, wrong, or swapped
 * with the next one.
 */
#include "suggestion.h"

#include <string.h>

enum { LENGTH_MAX = 40, LETTERS_A_MISTAKE = 3 };

static size_t least(size_t a, size_t b) {
    return a < b ? a : b;
}

static size_t distance(const char *a, const char *b) {
    size_t rows[3][LENGTH_MAX + 1], n = strlen(a), m = strlen(b);
    if (n > LENGTH_MAX || m > LENGTH_MAX) return LENGTH_MAX;
    for (size_t j = 0; j <= m; j++) rows[0][j] = j;
    for (size_t i = 1; i <= n; i++) {
        size_t *row = rows[i % 3];
        const size_t *last = rows[(i + 2) % 3], *before = rows[(i + 1) % 3];
        row[0] = i;
        for (size_t j = 1; j <= m; j++) {
            row[j] = least(least(last[j], row[j - 1]) + 1, last[j - 1] + (a[i - 1] != b[j - 1]));
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = least(row[j], before[j - 2] + 1);
        }
    }
    return rows[n % 3][m];
}

void suggestion_consider(suggestion *s, const char *candidate) {
    size_t far = distance(s->word, candidate), most = strlen(candidate) / LETTERS_A_MISTAKE;
    if (far > most || (s->found && far >= s->distance)) return;
    s->found = candidate;
    s->distance = far;
}
