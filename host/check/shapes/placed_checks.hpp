// placed_checks.hpp -- whether a shape is hit in a scene where rays hit it alone.
#pragma once
#include "check/shapes/shape_bench.hpp"
#include "check/steps.hpp"

namespace clarity::check {

Outcome hits_placed(ShapeBench& bench, const Step& step);

}  // namespace clarity::check
