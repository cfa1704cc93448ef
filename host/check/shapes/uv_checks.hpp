// uv_checks.hpp -- whether the texture coordinates of a shape lie on its surface as a picture does.
#pragma once
#include "check/shapes/shape_bench.hpp"
#include "check/steps.hpp"

namespace clarity::check {

Outcome surface_uv(ShapeBench& bench, const Step& step);

}  // namespace clarity::check
