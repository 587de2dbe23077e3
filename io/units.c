// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// "0.4 mm" = number, blanks, unit. The number is ours: plain decimal, so that no locale and no hexadecimal or
// NaN gets in. The unit is UDUNITS', but only what its grammar has in common with the way people write units:
// UDUNITS also takes "5 m 2" (10 m), "m since 1990" and "m^1.5" (5 m), which in a scene are slips of the pen.
#define _POSIX_C_SOURCE 200809L

#include "io/units.h"

#include "io/scene.h"

#include <ctype.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <udunits2.h>

enum { UNIT_LENGTH = 48 };

// The dimensions that have a name in messages; `unit` is SI.
static const struct {
    const char *unit, *name, *shown;
} dimensions[] = {
    {"1", "a plain number", "a plain number"},
    {"m", "a length", "a length (m)"},
    {"m^2", "an area", "an area (m^2)"},
    {"m^3", "a volume", "a volume (m^3)"},
    {"s", "a time", "a time (s)"},
    {"kg", "a mass", "a mass (kg)"},
    {"rad", "an angle", "an angle (rad)"},
    {"Pa", "a pressure", "a pressure (Pa)"},
    {"N", "a force", "a force (N)"},
    {"N/m", "a force per length", "a force per length (N/m)"},
    {"kg/m^3", "a density", "a density (kg/m^3)"},
    {"kg/m^2", "a mass per area", "a mass per area (kg/m^2)"},
    {"1/s", "a rate", "a rate (1/s)"},
    {"rad/s", "an angular velocity", "an angular velocity (rad/s)"},
    {"m/s", "a speed", "a speed (m/s)"},
    {"m/s^2", "an acceleration", "an acceleration (m/s^2)"},
    {"J", "an energy", "an energy (J)"},
    {"W", "a power", "a power (W)"},
    {"K", "a temperature", "a temperature (K)"},
};
enum { DIMENSION_COUNT = sizeof dimensions / sizeof dimensions[0] };

// Offered where a unit is wrong only in its capitals.
static const char* const common_units[] = {
    "nm", "um", "mm", "cm", "m",   "km",  "Pa",  "kPa", "MPa", "GPa", "N",      "mN",     "kN",  "s",
    "ms", "us", "kg", "g",  "deg", "rad", "bar", "psi", "N/m", "Hz",  "kg/m^3", "g/cm^3", "1/s", "m/s^2"};
enum { COMMON_COUNT = sizeof common_units / sizeof common_units[0] };

// UDUNITS' parser and its error handler are global, and reading its database takes a while: one for all.
static pthread_mutex_t unit_lock = PTHREAD_MUTEX_INITIALIZER;
static ut_system* unit_system;

static ruga_status open_unit_system(void) {
    if (unit_system) {
        return RUGA_OK;
    }
    (void)ut_set_error_message_handler(ut_ignore);
    ut_system* system = ut_read_xml(NULL);
    ut_unit* degree = system ? ut_get_unit_by_name(system, "degree") : NULL;
    // "deg" is what everyone writes, but UDUNITS does not have it.
    bool ready = degree && ut_map_name_to_unit("deg", UT_ASCII, degree) == UT_SUCCESS;
    ut_free(degree);
    if (!ready) {
        ut_free_system(system);
        return ruga_fail(RUGA_LIBRARY,
                         "the units database of UDUNITS-2 cannot be read: install libudunits2-data");
    }
    unit_system = system;
    return RUGA_OK;
}

const char* ruga_dimension_name(const char* dimension) {
    for (int i = 0; i < DIMENSION_COUNT; i++) {
        if (strcmp(dimensions[i].unit, dimension) == 0) {
            return dimensions[i].shown;
        }
    }
    return dimension;
}

static const char* skip_blanks(const char* text) {
    while (*text == ' ' || *text == '\t' || *text == '\n' || *text == '\r') {
        text++;
    }
    return text;
}

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

static bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

// The end of [+-] digits [. digits] [e [+-] digits] at the start of `text`; NULL where there is none.
static const char* scan_number(const char* text) {
    const char* c = text + (*text == '+' || *text == '-');
    int digits = 0;
    for (; is_digit(*c); c++) {
        digits++;
    }
    if (*c == '.') {
        for (c++; is_digit(*c); c++) {
            digits++;
        }
    }
    if (digits == 0) {
        return NULL;
    }
    if (*c == 'e' || *c == 'E') {
        const char* exponent = c + 1 + (c[1] == '+' || c[1] == '-');
        if (is_digit(*exponent)) {
            for (c = exponent; is_digit(*c);) {
                c++;
            }
        }
    }
    return c;
}

// The number from `text` to `end`. strtod reads on into what follows only for hexadecimal, which is refused.
static ruga_status convert_number(const char* text, const char* end, double* value) {
    char shown[64];
    (void)snprintf(shown, sizeof shown, "%.*s", (int)(end - text < 60 ? end - text : 60), text);
    if (end[0] == 'x' || end[0] == 'X') {
        return ruga_fail(RUGA_BAD_INPUT, "'%.60s' is not a decimal number", text);
    }
    locale_t decimal_point = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (decimal_point == (locale_t)0) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory: a locale");
    }
    locale_t before = uselocale(decimal_point);
    *value = strtod(text, NULL);
    (void)uselocale(before);
    freelocale(decimal_point);
    return isfinite(*value) ? RUGA_OK : ruga_fail(RUGA_BAD_INPUT, "%s is too large for a number", shown);
}

static ruga_status fail_no_number(const char* text) {
    const char* word = text + (*text == '+' || *text == '-');
    word += *word == '.';
    if (strncasecmp(word, "nan", 3) == 0 || strncasecmp(word, "inf", 3) == 0) {
        return ruga_fail(RUGA_BAD_INPUT, "'%.60s' is not a finite number", text);
    }
    return *text ? ruga_fail(RUGA_BAD_INPUT, "'%.60s' is not a number", text)
                 : ruga_fail(RUGA_BAD_INPUT, "a number is needed, but there is nothing");
}

ruga_status ruga_number_parse(const char* text, double* value) {
    text = skip_blanks(text);
    const char* end = scan_number(text);
    if (!end) {
        return fail_no_number(text);
    }
    if (*skip_blanks(end)) {
        return ruga_fail(RUGA_BAD_INPUT, "'%.60s' is not a plain number", text);
    }
    return convert_number(text, end, value);
}

// Bytes of a letter that may stand in a unit: ASCII, %, micro sign, Greek mu, degree sign; 0 = none.
static int unit_letter(const char* c) {
    if (is_letter(*c) || *c == '%' || *c == '_') {
        return 1;
    }
    static const char* const wide[] = {"\xc2\xb5", "\xce\xbc", "\xc2\xb0"};
    for (int i = 0; i < 3; i++) {
        if (strncmp(c, wide[i], 2) == 0) {
            return 2;
        }
    }
    return 0;
}

// One name with its exponent: m, m2, m^2, m^-2, m-2, m**2. NULL where the text is something else.
static const char* scan_unit_factor(const char* c) {
    const char* start = c;
    for (int bytes; (bytes = unit_letter(c)) > 0;) {
        c += bytes;
    }
    if (c == start) {
        return NULL;
    }
    bool marked = *c == '^' || (c[0] == '*' && c[1] == '*');
    c += marked ? (*c == '^' ? 1 : 2) : 0;
    const char* digits = c + (*c == '-' || (marked && *c == '+'));
    if (!is_digit(*digits)) {
        return marked || digits > c ? NULL : c;
    }
    c = digits + 1; // one digit: no quantity has a tenth power
    return is_digit(*c) ? NULL : c;
}

// Factors separated by one of * . / or blanks; "1/s" may begin with its 1.
static bool unit_is_plain(const char* unit) {
    const char* c = unit;
    if (c[0] == '1') {
        c = skip_blanks(c + 1);
        if (*c != '/') {
            return false;
        }
        c = skip_blanks(c + 1);
    }
    while ((c = scan_unit_factor(c)) != NULL) {
        c = skip_blanks(c);
        if (*c == '\0') {
            return true;
        }
        if (*c == '*' || *c == '.' || *c == '/') {
            c = skip_blanks(c + 1);
        }
    }
    return false;
}

// UDUNITS' times and offsets would be other words in a unit of ours.
static bool unit_is_word_of_offset(const char* unit) {
    static const char* const words[] = {"since", "after", "from", "ref"};
    char copy[UNIT_LENGTH];
    (void)snprintf(copy, sizeof copy, "%s", unit);
    char* rest = NULL;
    for (char* word = strtok_r(copy, " \t*./", &rest); word; word = strtok_r(NULL, " \t*./", &rest)) {
        for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
            if (strcasecmp(word, words[i]) == 0) {
                return true;
            }
        }
    }
    return false;
}

// Whether `unit` is a multiple of `base`, and how much of it. UDUNITS holds radians to be convertible to
// plain numbers; we do not, so the quotient must be spelt without any unit.
static bool unit_multiple(ut_unit* unit, ut_unit* base, double* factor) {
    cv_converter* converter = ut_are_convertible(unit, base) ? ut_get_converter(unit, base) : NULL;
    if (!converter) {
        return false;
    }
    double zero = cv_convert_double(converter, 0);
    *factor = cv_convert_double(converter, 1);
    bool linear = zero == 0 && fabs(cv_convert_double(converter, 2) - 2 * *factor) <= 1e-12 * fabs(*factor);
    cv_free(converter);
    ut_unit* quotient = linear ? ut_divide(unit, base) : NULL;
    char spelt[128] = "?";
    int length = quotient ? ut_format(quotient, spelt, sizeof spelt - 1, UT_ASCII | UT_DEFINITION) : -1;
    ut_free(quotient);
    return length > 0 && spelt[strspn(spelt, "0123456789.+-eE ")] == '\0' && isfinite(*factor) && *factor > 0;
}

static ut_unit* unit_from_text(const char* text) {
    char copy[UNIT_LENGTH];
    (void)snprintf(copy, sizeof copy, "%s", text);
    return ut_parse(unit_system, copy, UT_UTF8);
}

static const char* name_of_unit(ut_unit* unit) {
    for (int i = 0; i < DIMENSION_COUNT; i++) {
        ut_unit* base = unit_from_text(dimensions[i].unit);
        double factor;
        bool is = base && unit_multiple(unit, base, &factor);
        ut_free(base);
        if (is) {
            return dimensions[i].name;
        }
    }
    return "of another dimension";
}

// The common unit that differs only in capitals and has the dimension; NULL where there is none.
static const char* unit_in_other_capitals(const char* text, ut_unit* base) {
    for (int i = 0; i < COMMON_COUNT; i++) {
        double factor;
        if (strcasecmp(common_units[i], text) == 0 && strcmp(common_units[i], text) != 0) {
            ut_unit* unit = unit_from_text(common_units[i]);
            bool fits = unit && unit_multiple(unit, base, &factor);
            ut_free(unit);
            if (fits) {
                return common_units[i];
            }
        }
    }
    return NULL;
}

// `shown`: the whole quantity for the sentence. With unit_lock held.
static ruga_status factor_locked(const char* shown, const char* text, const char* dimension, double* factor) {
    RUGA_TRY(open_unit_system());
    ut_unit* base = unit_from_text(dimension);
    if (!base) {
        return ruga_fail(RUGA_LIBRARY, "UDUNITS-2 does not know %s", dimension);
    }
    ut_unit* unit = unit_from_text(text);
    const char* name = ruga_dimension_name(dimension);
    ruga_status status = RUGA_OK;
    if (!unit || !unit_multiple(unit, base, factor)) {
        const char* meant = unit_in_other_capitals(text, base);
        char question[64] = "";
        if (meant) {
            (void)snprintf(question, sizeof question, "; did you mean %s?", meant);
        }
        status = unit ? ruga_fail(RUGA_BAD_INPUT, "%s is %s, but %s is needed%s", shown, name_of_unit(unit),
                                  name, question)
                      : ruga_fail(RUGA_BAD_INPUT, "%s: '%s' is not a unit; %s is needed%s", shown, text, name,
                                  question);
    }
    ut_free(unit);
    ut_free(base);
    return status;
}

static ruga_status unit_factor(const char* shown, const char* text, const char* dimension, double* factor) {
    if (strlen(text) >= UNIT_LENGTH || !unit_is_plain(text) || unit_is_word_of_offset(text)) {
        return ruga_fail(RUGA_BAD_INPUT, "%.60s: '%.40s' is not a unit; %s is needed", shown, text,
                         ruga_dimension_name(dimension));
    }
    locale_t decimal_point = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (decimal_point == (locale_t)0) {
        return ruga_fail(RUGA_NO_MEMORY, "out of memory: a locale");
    }
    (void)pthread_mutex_lock(&unit_lock);
    locale_t before = uselocale(decimal_point);
    ruga_status status = factor_locked(shown, text, dimension, factor);
    (void)uselocale(before);
    (void)pthread_mutex_unlock(&unit_lock);
    freelocale(decimal_point);
    return status;
}

ruga_status ruga_unit_factor(const char* unit, const char* dimension, double* factor) {
    return unit_factor(unit, unit, dimension, factor);
}

// 2 mm is 2/1000, which rounds to the same number as 0.002; 2 * 0.001 may not. UDUNITS' own factors are off
// by a last bit here and there (1 g/cm^3 = 999.9999999999999 kg/m^3).
static double scale_number(double number, double factor) {
    double whole = nearbyint(factor < 1 ? 1 / factor : factor);
    double off = factor < 1 ? whole * factor - 1 : factor / whole - 1;
    if (fabs(off) > 1e-14) {
        return number * factor;
    }
    return factor < 1 ? number / whole : number * whole;
}

ruga_status ruga_quantity_parse(const char* text, const char* dimension, double* value) {
    text = skip_blanks(text);
    const char* end = scan_number(text);
    if (!end) {
        return fail_no_number(text);
    }
    double number;
    RUGA_TRY(convert_number(text, end, &number));
    char unit[UNIT_LENGTH + 1], shown[64];
    (void)snprintf(unit, sizeof unit, "%s", skip_blanks(end));
    (void)snprintf(shown, sizeof shown, "%s", text);
    for (size_t n = strlen(unit); n > 0 && isspace((unsigned char)unit[n - 1]); n--) {
        unit[n - 1] = '\0';
    }
    if (unit[0] == '\0') {
        *value = number;
        return RUGA_OK;
    }
    double factor;
    RUGA_TRY(unit_factor(shown, unit, dimension, &factor));
    *value = scale_number(number, factor);
    return isfinite(*value) ? RUGA_OK : ruga_fail(RUGA_BAD_INPUT, "%s is too large for a number", shown);
}
