// cone: between two points, pointed or cut off, with or without caps.
#include <algorithm>
#include <cmath>

#include "rt_plugin.hpp"

namespace {

enum { kFrom, kTo, kRadius, kTop, kCaps };

int32_t prepare(const rt_host* host, const rt_key_values* values, const rt_shape_output* out) {
    const float *from = values[kFrom].numbers, *to = values[kTo].numbers;
    const float radius = values[kRadius].numbers[0], top = values[kTop].numbers[0];
    double axis[3];
    for (int k = 0; k < 3; ++k) axis[k] = double(to[k]) - from[k];
    const double length = std::hypot(axis[0], axis[1], axis[2]);
    if (!(length > 0)) throw rt::fail(host, "`from` and `to` are the same point; expected the two ends of its axis");
    if (radius == 0 && top == 0) throw rt::fail(host, "`radius` and `top` are both 0; expected a radius above 0 at one end");
    const double growth = (double(top) - radius) / length;
    if (!(std::fabs(growth) < 1e15))
        throw rt::fail(host, "`radius` and `top` differ too much for its length; expected less than 1e15 times the length");
    float lo[3], hi[3], numbers[10];
    for (int k = 0; k < 3; ++k) {
        const double a = axis[k] / length, base = rt::disc_reach(radius, a), tip = rt::disc_reach(top, a);
        lo[k] = static_cast<float>(std::min(from[k] - base, to[k] - tip));
        hi[k] = static_cast<float>(std::max(from[k] + base, to[k] + tip));
        numbers[k] = from[k];
        numbers[3 + k] = static_cast<float>(a);
    }
    numbers[6] = static_cast<float>(length);
    numbers[7] = radius;
    numbers[8] = static_cast<float>(growth);
    numbers[9] = values[kCaps].numbers[0];
    rt::part(out, lo, hi, numbers, 10);
    return RT_OK;
}

constexpr rt_key keys[] = {
    rt::key(RT_KEY_POINT, "from", "x y z of the base"),
    rt::key(RT_KEY_POINT, "to", "x y z of the tip"),
    rt::number_key("radius", "at the base", 0, 1e15),
    rt::number_key("top", "radius at the tip, which is cut off there", 0, 1e15, 0),
    rt::whole_key("caps", "1: with discs at both ends, 0: open", 0, 1, 1),
};
constexpr rt_cl_file files[] = {
#include "cone.inc"
};
constexpr rt_primitive primitive = rt::primitive(keys, rt::file(files, "cone.cl"), nullptr, rt::guarded<prepare>);

}  // namespace

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 = rt::primitive_plugin("cone", "Cone", "1.0.0", nullptr, primitive);
