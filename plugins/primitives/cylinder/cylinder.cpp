// cylinder: between two points, with or without caps.
#include <algorithm>
#include <cmath>

#include "rt_plugin.hpp"

namespace {

enum { kFrom, kTo, kRadius, kCaps };

int32_t prepare(const rt_host* host, const rt_key_values* values, const rt_shape_output* out) {
    const float *from = values[kFrom].numbers, *to = values[kTo].numbers, radius = values[kRadius].numbers[0];
    double axis[3];
    for (int k = 0; k < 3; ++k) axis[k] = double(to[k]) - from[k];
    const double length = std::hypot(axis[0], axis[1], axis[2]);
    if (!(length > 0)) throw rt::fail(host, "`from` and `to` are the same point; expected the two ends of its axis");
    float lo[3], hi[3], numbers[9];
    for (int k = 0; k < 3; ++k) {
        const double a = axis[k] / length, reach = rt::disc_reach(radius, a);
        lo[k] = static_cast<float>(std::min(from[k], to[k]) - reach);
        hi[k] = static_cast<float>(std::max(from[k], to[k]) + reach);
        numbers[k] = from[k];
        numbers[3 + k] = static_cast<float>(a);
    }
    numbers[6] = static_cast<float>(length);
    numbers[7] = radius;
    numbers[8] = values[kCaps].numbers[0];
    rt::part(out, lo, hi, numbers, 9);
    return RT_OK;
}

constexpr rt_key keys[] = {
    rt::key(RT_KEY_POINT, "from", "x y z of one end of its axis"),
    rt::key(RT_KEY_POINT, "to", "x y z of the other end"),
    rt::number_key("radius", "distance of the side from the axis", 1e-12, 1e15),
    rt::whole_key("caps", "1: with discs at both ends, 0: open", 0, 1, 1),
};
constexpr rt_cl_file files[] = {
#include "cylinder.inc"
};
constexpr rt_primitive primitive = rt::primitive(keys, rt::file(files, "cylinder.cl"), nullptr, rt::guarded<prepare>);

}  // namespace

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 = rt::primitive_plugin("cylinder", "Cylinder", "1.0.0", nullptr, primitive);
