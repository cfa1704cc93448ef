// path_test.cpp -- the reference itself meets the closed forms.
#include "reference/path.hpp"

#include <gtest/gtest.h>

#include "reference/closed_forms.hpp"

using namespace clarity;
using namespace clarity::reference;

TEST(PathReference, MeetsClosedForms) {
    for (const ClosedForm& form : closed_forms()) {
        const PathPicture picture = trace_paths(form.scene, form.view, {8, 8, form.depth, 1600, 1, form.bounce});
        for (size_t c = 0; c < 3; ++c) {
            const double error = picture.total_error(int(c));
            EXPECT_NEAR(picture.total()[c], form.expected[c], 4 * error + form.rounding) << form.name << ", channel " << c;
            EXPECT_LE(error, 0.04 * (form.expected[c] + 0.01)) << form.name << ": the bound tells nothing";
        }
    }
}
