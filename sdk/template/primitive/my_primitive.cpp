// my_primitive.cpp -- an ellipsoid along the axes. Replace it by your own shape.
#include "rt_plugin.hpp"

namespace {

enum Key { kCenter, kRadii };
// The statement of text scenes: my_primitive center 0 1 0 radii 1 .5 2
constexpr rt_key kKeys[] = {
    rt::key(RT_KEY_POINT, "center", "x y z", 0, 0, 0),
    rt::key(RT_KEY_POINT, "radii", "half of its extent along x, y and z, each above 0", 1, 1, 1),
};

// The box of the shape. The kernels get the numbers of all keys, in their order.
int32_t bounds(const rt_host* host, const rt_key_values* values, float lo[3], float hi[3]) {
    const float *center = values[kCenter].numbers, *radii = values[kRadii].numbers;
    for (int axis = 0; axis < 3; ++axis) {
        if (!(radii[axis] > 0)) throw rt::fail(host, "`radii` has a number that is not above 0");
        lo[axis] = center[axis] - radii[axis];
        hi[axis] = center[axis] + radii[axis];
    }
    return RT_OK;
}

constexpr rt_cl_file kFiles[] = {
#include "my_primitive.inc"
};
constexpr rt_primitive kPrimitive = rt::primitive(kKeys, rt::file(kFiles, "my_primitive.cl"), rt::guarded<bounds>, nullptr);

}  // namespace

const rt_plugin rt_plugin_v1 = rt::primitive_plugin("my_primitive", "My shape", "0.1.0", nullptr, kPrimitive);
