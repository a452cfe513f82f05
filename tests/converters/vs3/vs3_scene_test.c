/* SPDX-License-Identifier: MIT
 * Does the reader take View3D's text format, and does it name the line of what it refuses?
 */
#include "check.h"
#include "vs3_scene.h"

static char message[VS3_MESSAGE_SIZE];

static hemi_result read_text(const char *text, size_t size, vs3_scene *out) {
    return vs3_parse(text, size, out, message);
}

static const char SQUARES[] =
    "T two squares\nF 3\nC eps=1e-4\n! comment\nV 1 0 0 0\nV 2 1 0 0\nV 3 1 1 0 ! here too\n"
    "v 4 0 1 0\nS 1 1 2 3 4 0 0 0.9 floor\nS 2 1 3 2 0 0 1 0.9\nO 3 4 3 2 1\nEnd of data\nrubbish\n";

static void it_reads_vertices_surfaces_triangles_and_obstructions(void) {
    vs3_scene s;
    CHECK_EQUAL(read_text(SQUARES, strlen(SQUARES), &s), HEMI_OK);
    CHECK_EQUAL(s.vertex_count, 4);
    CHECK_EQUAL(s.polygon_count, 3);
    CHECK_EQUAL(s.combined, 1);
    CHECK_TEXT(s.names[0], "floor");
    CHECK_TEXT(s.names[1], "2");
    CHECK_EQUAL(s.corners[3], 3);
    CHECK_EQUAL(s.corners[7], -1);
    CHECK(!s.obstructions[0] && s.obstructions[2]);
    CHECK_NEAR(s.positions[7], 1.0, 0.0);
    vs3_scene_free(&s);
}

typedef struct refusal {
    const char *text, *place; /* place: what the message must name */
    hemi_result result;
} refusal;

static void it_refuses_what_is_wrong_and_names_the_line(void) {
    static const refusal cases[] = {
        { "", "no surface", HEMI_ERROR_DATA },
        { "V 1 0 0\n", "line 1", HEMI_ERROR_DATA },
        { "V 0 0 0 0\n", "line 1", HEMI_ERROR_DATA },
        { "V 1 0 0 nan\n", "line 1", HEMI_ERROR_DATA },
        { "V 1 0 0 1e999\n", "line 1", HEMI_ERROR_DATA },
        { "V 99999999999999999999 0 0 0\n", "line 1", HEMI_ERROR_DATA },
        { "V 1 0 0 0\nV 1 0 0 0\n", "line 2", HEMI_ERROR_DATA },
        { "V 1 0 0 0\nS 1 1 1 2 0 0 0 0 a\n", "no vertex 2", HEMI_ERROR_DATA },
        { "V 3 0 0 0\nS 1 1 2 3 0 0 0 0 a\n", "no vertex 1", HEMI_ERROR_DATA },
        { "V 1 0 0 0\nS 1 -1 1 1 0 0 0 0 a\n", "line 2", HEMI_ERROR_DATA },
        { "S 1 1 2\n", "line 1", HEMI_ERROR_DATA },
        { "F 2\n", "line 1", HEMI_ERROR_UNSUPPORTED },
        { "V 1 0 0 0\nS 1 1 1 1 0 5 0 0 a\n", "line 2", HEMI_ERROR_UNSUPPORTED },
        { "\n\nquack\n", "line 3", HEMI_ERROR_DATA },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vs3_scene s;
        CHECK_EQUAL(read_text(cases[i].text, strlen(cases[i].text), &s), cases[i].result);
        CHECK(strstr(message, cases[i].place) != NULL);
        CHECK(s.positions == NULL);
    }
}

static void every_truncation_and_every_changed_byte_ends_well(void) {
    char copy[sizeof SQUARES];
    vs3_scene s;
    for (size_t n = 0; n < strlen(SQUARES); n++) {
        hemi_result result = read_text(SQUARES, n, &s);
        CHECK(result == HEMI_OK || message[0]);
        if (result == HEMI_OK) vs3_scene_free(&s);
        for (int byte = 0; byte < 256; byte += 51) {
            memcpy(copy, SQUARES, sizeof SQUARES);
            copy[n] = (char)byte;
            result = read_text(copy, strlen(SQUARES), &s);
            CHECK(result == HEMI_OK || message[0]);
            if (result == HEMI_OK) vs3_scene_free(&s);
        }
    }
}

int main(void) {
    RUN(it_reads_vertices_surfaces_triangles_and_obstructions);
    RUN(it_refuses_what_is_wrong_and_names_the_line);
    RUN(every_truncation_and_every_changed_byte_ends_well);
    return check_end();
}
