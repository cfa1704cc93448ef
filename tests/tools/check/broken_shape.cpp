// broken_shape.cpp -- a ball, stretched along y, with one defect: own_defect.hpp. `none` is sound.
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "own_defect.hpp"
#include "rt_plugin.hpp"

namespace {

// Whether this library has the defect.
bool has(const char* defect) {
    return own_defect("shape_") == defect;
}

// Defects of the kernels: broken_shape.cl gets their number, counted from 1.
constexpr const char* kInKernels[] = {
    "far_root",    "octant",       "one_sided",        "forgets_t_min", "first_lane", "unit_direction", "wrong_radius",
    "wrong_scale", "wrong_normal", "inward",           "wrong_uv",      "inexact",    "reads_beyond",   "loop",
    "hole",        "nan",          "lanes_8",          "zero_radius",   "uv_seam",    "uv_off_centre",  "uv_world_centre",
    "uv_twice",    "uv_constant",  "uv_one_direction", "uv_steps",      "uv_halves",  "uv_never_ends",  "uv_mirrored_half",
    "axis",        "slim",         "uv_clamped"};
float number_of_defect() {
    float number = 0;
    for (size_t i = 0; i < std::size(kInKernels); ++i)
        if (has(kInKernels[i])) number = float(i + 1);
    return number;
}

enum { kCenter, kRadius, kStretch };
rt_key keys[] = {
    rt::key(RT_KEY_POINT, "center", "x y z", 0, 0, 0),
    rt::number_key("radius", "along x and z", 1e-3, 1e3, 1),
    rt::number_key("stretch", "factor along y", 0.2, 5, 1.5),
};

int32_t prepare(const rt_host* host, const rt_key_values* values, const rt_shape_output* out) {
    static float kept = 0;
    const float *center = values[kCenter].numbers, radius = values[kRadius].numbers[0], stretch = values[kStretch].numbers[0];
    if (has("crashes")) *static_cast<volatile int*>(nullptr) = 1;
    if (has("endless"))
        for (volatile bool forever = true; forever;) {
        }
    if (has("exits")) std::exit(0);
    if (has("leaks")) static_cast<char*>(std::malloc(1 << 16))[0] = 1;
    if (has("no_reason") && radius > 1) return RT_FAILED;
    if (radius > 500 && !has("box_inside_out")) throw rt::fail(host, "`radius` is above 500; expected a smaller ball");
    float lo[3], hi[3];
    for (int k = 0; k < 3; ++k) {
        float half = radius * (k == 1 ? stretch : 1);
        if (has("small_box") && k == 1) half *= 0.9f;
        lo[k] = center[k] - half;
        hi[k] = center[k] + half;
    }
    if (has("box_inside_out") && radius > 500) std::swap(lo[0], hi[0]);
    float numbers[6] = {center[0], center[1], center[2], radius, stretch, number_of_defect()};
    if (has("keeps_state")) numbers[4] += 1e-3f * (kept += 1);
    rt::part(out, lo, hi, numbers, 6);
    return RT_OK;
}

constexpr rt_cl_file files[] = {
#include "broken_shape.inc"
};
constexpr rt_cl_file file = {"broken_shape.cl", files[0].text};
rt_primitive primitive = rt::primitive(keys, file, nullptr, rt::guarded<prepare>);

// The host reads rt_plugin_v1 from the file, so it is a constant. What it points to may change while the library is loaded.
__attribute__((constructor)) void take_defect() {
    if (has("zero_radius")) keys[kRadius].min = 0;
    if (has("does_not_compile")) primitive.kernels.text = "vfloat broken_shape_hit(";
}

}  // namespace

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 =
    rt::primitive_plugin("broken_shape", "A ball with a defect", "1.0.0", nullptr, primitive);
