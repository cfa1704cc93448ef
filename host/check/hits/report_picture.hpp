// report_picture.hpp -- a picture of the checked scene around a ray with a wrong answer: red where hits differ from the
// reference's.
#pragma once
#include <string>

#include "check/hits/checked_scene.hpp"
#include "rt_types.h"

namespace clarity::check {

struct ReportPicture {
    size_t differing = 0, pixels = 0;
};
// Writes `path`, a PNG, whole or not at all. The camera is at the ray's origin and looks along it, with its limits. Red pixels
// are those whose answer is wrong, the others show what the reference hits: brighter where it is nearer. Throws Error.
ReportPicture write_report_picture(const std::string& path, CheckedScene& scene, const Variant& variant, const rt_ray& ray,
                                   bool any_hit);

}  // namespace clarity::check
