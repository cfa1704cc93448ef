// box: a box along the axes, given by two opposite corners. Its kernels take the corners as they are.
#include <algorithm>

#include "rt_plugin.hpp"

namespace {

int32_t bounds(const rt_host* host, const rt_key_values* values, float lo[3], float hi[3]) {
    const float *from = values[0].numbers, *to = values[1].numbers;
    for (int k = 0; k < 3; ++k) {
        lo[k] = std::min(from[k], to[k]);
        hi[k] = std::max(from[k], to[k]);
        if (lo[k] == hi[k]) throw rt::fail(host, "the corners `from` and `to` are in one plane; expected a box with a volume");
    }
    return RT_OK;
}

constexpr rt_key keys[] = {
    rt::key(RT_KEY_POINT, "from", "x y z of a corner"),
    rt::key(RT_KEY_POINT, "to", "x y z of the opposite corner"),
};
constexpr rt_cl_file files[] = {
#include "box.inc"
};
constexpr rt_primitive primitive = rt::primitive(keys, rt::file(files, "box.cl"), rt::guarded<bounds>, nullptr);

}  // namespace

extern "C" RT_EXPORT const rt_plugin rt_plugin_v1 = rt::primitive_plugin("box", "Box", "1.0.0", nullptr, primitive);
