/* check.h -- checks of a C program: a failed one prints its line to `report`, and the program goes on. */
#ifndef CHECK_H
#define CHECK_H
#include <stdio.h>
#include <string.h>

#include "clarity.h"

extern FILE* report; /* stderr of the test; the library must not write to it */
extern int failures;

#define CHECK(condition)                                                                                       \
    do {                                                                                                       \
        if (!(condition)) {                                                                                    \
            ++failures;                                                                                        \
            fprintf(report, "%s:%d: not true: %s; the last error is '%s'\n", __FILE__, __LINE__, #condition,   \
                    clarity_error_text());                                                                     \
        }                                                                                                      \
    } while (0)
/* A call that has to succeed. */
#define WORKS(call) CHECK((call) == CLARITY_OK && strcmp(clarity_error_text(), "") == 0)
/* A call that has to fail with this code and these words. */
#define FAILS(call, code, words) CHECK((call) == (code) && strstr(clarity_error_text(), (words)) != NULL)

#endif
