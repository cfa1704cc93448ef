// torus: a tube bent into a ring.
#include <cmath>

#include "rt_plugin.hpp"

namespace {

enum { kCenter, kNormal, kRadius, kTube };

int32_t prepare(const rt_host* host, const rt_key_values* values, const rt_shape_output* out) {
    const float *center = values[kCenter].numbers, *normal = values[kNormal].numbers;
    const float radius = values[kRadius].numbers[0], tube = values[kTube].numbers[0];
    if (tube >= radius) throw rt::fail(host, "`tube` is not below `radius`; expected a ring with a hole");
    const double length = std::hypot(double(normal[0]), double(normal[1]), double(normal[2]));
    float lo[3], hi[3], numbers[8];
    for (int k = 0; k < 3; ++k) {
        const double n = normal[k] / length, reach = rt::disc_reach(radius, n) + tube;
        lo[k] = static_cast<float>(center[k] - reach);
        hi[k] = static_cast<float>(center[k] + reach);
        numbers[k] = center[k];
        numbers[3 + k] = static_cast<float>(n);
    }
    numbers[6] = radius;
    numbers[7] = tube;
    rt::part(out, lo, hi, numbers, 8);
    return RT_OK;
}

constexpr rt_key keys[] = {
    rt::key(RT_KEY_POINT, "center", "x y z", 0, 0, 0),
    rt::key(RT_KEY_VECTOR, "normal", "x y z of the direction across the ring", 0, 1, 0),
    rt::number_key("radius", "of the ring, in the middle of the tube", 1e-12, 1e15, 1),
    rt::number_key("tube", "radius of the tube, below that of the ring", 1e-12, 1e15, 0.25),
};
constexpr rt_cl_file files[] = {
#include "torus.inc"
};
constexpr rt_primitive primitive = rt::primitive(keys, rt::file(files, "torus.cl"), nullptr, rt::guarded<prepare>);

}  // namespace

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 = rt::primitive_plugin(
    "torus", "Torus", "1.0.0", "Yuksel 2022, High-Performance Polynomial Root Finding for Graphics", primitive);
