/* SPDX-License-Identifier: MIT
 * Has each photometric type its intensities where LM-63 says, and is what is no such file refused in one line?
 */
#include "check.h"
#include "ies_profile.h"

static const double PI = 3.14159265358979323846;
static char message[IES_MESSAGE_SIZE];

static hemi_result read_text(const char *text, ies_profile *out) {
    return ies_profile_read((const uint8_t *)text, strlen(text), out, message);
}

/* At the nearest direction of the grid, in degrees from the aim and about it. */
static double at(const ies_profile *p, double theta, double phi) {
    size_t row = (size_t)lround(theta / 180.0 * (p->rows - 1.0));
    size_t column = (size_t)lround(phi / 360.0 * p->columns) % p->columns;
    return (double)p->candela[row * p->columns + column];
}

#define HEAD(counts_and_type) "IESNA:LM-63-2002\n[TEST] one\nTILT=NONE\n1 -1 2 " counts_and_type " 2 0 0 0\n0.5 1 60\n"

/* The multiplier 2 and the ballast factor 0.5 are 1 together. */
static void one_plane_of_type_c_is_the_same_all_round_and_dark_past_its_end(void) {
    ies_profile p;
    CHECK_EQUAL(read_text(HEAD("3 1 1") "0 45 90\n0\n100 60 20\n", &p), HEMI_OK);
    CHECK_EQUAL(p.columns, 1);
    CHECK_NEAR(at(&p, 0, 0), 100, 1e-4);
    CHECK_NEAR(at(&p, 22.5, 0), 80, 1e-4); /* between its angles */
    CHECK_NEAR(at(&p, 90, 0), 20, 1e-4);
    CHECK_NEAR(at(&p, 91, 0), 0, 0);
    ies_profile_free(&p);
}

static void all_three_multipliers_count(void) {
    ies_profile p;
    CHECK_EQUAL(read_text("TILT=NONE\n1 -1 3 2 1 1 2 0 0 0\n0.5 0.8 60\n0 180\n0\n10 10\n", &p), HEMI_OK);
    CHECK_NEAR(at(&p, 90, 0), 12, 1e-5);
    ies_profile_free(&p);
}

/* Of planes at 0, 45 and 90 degrees the mirrored ones follow: 135 is 45, 180 is 0, 270 is 90. */
static void quarters_and_halves_of_type_c_are_unfolded(void) {
    ies_profile p;
    CHECK_EQUAL(read_text(HEAD("2 3 1") "0 90\n0 45 90\n1 1\n2 2\n3 3\n", &p), HEMI_OK);
    const double quarter[] = { 1, 2, 3, 2, 1, 2, 3, 2 };
    for (int i = 0; i < 8; i++) CHECK_NEAR(at(&p, 45, 45 * i), quarter[i], 1e-5);
    ies_profile_free(&p);
    CHECK_EQUAL(read_text(HEAD("2 3 1") "0 90\n0 90 180\n1 1\n2 2\n3 3\n", &p), HEMI_OK);
    const double half[] = { 1, 2, 3, 2 };
    for (int i = 0; i < 4; i++) CHECK_NEAR(at(&p, 45, 90 * i), half[i], 1e-5);
    ies_profile_free(&p);
    CHECK_EQUAL(read_text(HEAD("2 3 1") "0 90\n90 180 270\n1 1\n2 2\n3 3\n", &p), HEMI_OK);
    const double other[] = { 2, 1, 2, 3 };
    for (int i = 0; i < 4; i++) CHECK_NEAR(at(&p, 45, 90 * i), other[i], 1e-5);
    ies_profile_free(&p);
}

/* 330 degrees lies half way between the last plane, at 300, and the first. */
static void a_round_that_is_not_closed_goes_on_to_its_beginning(void) {
    ies_profile p;
    CHECK_EQUAL(read_text(HEAD("2 3 1") "0 90\n0 150 300\n1 1\n2 2\n4 4\n", &p), HEMI_OK);
    CHECK_NEAR(at(&p, 45, 330), 2.5, 1e-5);
    ies_profile_free(&p);
}

/* Type A has the vertical angle last, so all planes meet straight up and down; in type B they meet left and right. */
static void types_a_and_b_are_up_and_aside_of_the_aim(void) {
    static const char *const numbers[] = { "1 1 1\n3 7 4\n2 2 2\n", "3 1 4\n3 7 4\n3 2 4\n" };
    for (int type = 2; type <= 3; type++) {
        ies_profile p;
        char text[256];
        snprintf(text, sizeof text, HEAD("3 3 %d") "-90 0 90\n-90 0 90\n%s", type, numbers[type - 2]);
        CHECK_EQUAL(read_text(text, &p), HEMI_OK);
        CHECK_NEAR(at(&p, 0, 0), 7, 1e-5);
        CHECK_NEAR(at(&p, 90, 0), 4, 1e-5);   /* up: the vertical angle is 90 degrees */
        CHECK_NEAR(at(&p, 90, 180), 3, 1e-5); /* down */
        CHECK_NEAR(at(&p, 90, 90), 1, 1e-5);  /* left: the horizontal angle is -90 degrees */
        CHECK_NEAR(at(&p, 90, 270), 2, 1e-5); /* right */
        CHECK_NEAR(at(&p, 180, 0), 0, 0);     /* behind */
        ies_profile_free(&p);
    }
}

/* A direction 60 degrees off the aim, half way from up to the left: what tells the two types apart. */
static void types_a_and_b_are_told_apart(void) {
    const double theta = 60 * PI / 180, up = sin(theta) * sqrt(0.5), ahead = cos(theta);
    /* Intensities are the vertical angle, in degrees, wherever it is measured. */
    const double expected[] = { asin(up) * 180 / PI, atan2(up, ahead) * 180 / PI };
    for (int type = 3; type >= 2; type--) {
        ies_profile p;
        char text[256];
        snprintf(text, sizeof text, HEAD("2 2 %d") "0 90\n-90 90\n0 90\n0 90\n", type);
        CHECK_EQUAL(read_text(text, &p), HEMI_OK);
        CHECK_NEAR(at(&p, 60, 45), expected[type == 3 ? 0 : 1], 1e-4);
        ies_profile_free(&p);
    }
}

static void what_is_no_such_file_is_refused_with_a_reason(void) {
    static const struct {
        const char *text, *reason;
    } bad[] = { { "", "TILT=" },
                { "TILT=NONE\n1 1 1\n", "thirteen" },
                { HEAD("2 1 9") "0 90\n0\n1 1\n", "type" },
                { HEAD("0 1 1") "0\n0\n1\n", "counts" },
                { HEAD("2 1 1") "90 0\n0\n1 1\n", "ascend" },
                { HEAD("2 1 1") "0 90\n0\n1\n", "fewer" },
                { HEAD("2 1 1") "0 90\n0\n1 1e13\n", "1e12" },
                { HEAD("99999 99999 1") "0 90\n", "cut short" },
                { "TILT=INCLUDE\n1 3\n0 90\n", "cut short" } };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        ies_profile p;
        CHECK_EQUAL(read_text(bad[i].text, &p), HEMI_ERROR_DATA);
        CHECK(strstr(message, bad[i].reason) != NULL);
        CHECK(p.candela == NULL);
        ies_profile_free(&p);
    }
}

int main(void) {
    RUN(one_plane_of_type_c_is_the_same_all_round_and_dark_past_its_end);
    RUN(all_three_multipliers_count);
    RUN(quarters_and_halves_of_type_c_are_unfolded);
    RUN(a_round_that_is_not_closed_goes_on_to_its_beginning);
    RUN(types_a_and_b_are_up_and_aside_of_the_aim);
    RUN(types_a_and_b_are_told_apart);
    RUN(what_is_no_such_file_is_refused_with_a_reason);
    return check_end();
}
