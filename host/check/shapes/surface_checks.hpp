// surface_checks.hpp -- whether `<id>_surface` agrees with where rays meet the shape.
#pragma once
#include "check/shapes/shape_bench.hpp"
#include "check/steps.hpp"

namespace clarity::check {

Outcome surface_height(ShapeBench& bench, const Step& step);
Outcome surface_normal(ShapeBench& bench, const Step& step);
Outcome surface_leaving(ShapeBench& bench, const Step& step);

}  // namespace clarity::check
