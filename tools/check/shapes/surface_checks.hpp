// surface_checks.hpp -- whether `<id>_surface` agrees with where rays meet the shape.
#pragma once
#include "tools/check/shapes/shape_stand.hpp"
#include "tools/check/steps.hpp"

namespace clarity::check {

Outcome surface_height(ShapeStand& stand, const Step& step);
Outcome surface_normal(ShapeStand& stand, const Step& step);
Outcome surface_leaving(ShapeStand& stand, const Step& step);

// Whether a shape is hit in a scene where rays hit it alone.
Outcome hits_placed(ShapeStand& stand, const Step& step);

// Whether the texture coordinates of a shape lie on its surface as a picture does.
Outcome surface_uv(ShapeStand& stand, const Step& step);

}  // namespace clarity::check
