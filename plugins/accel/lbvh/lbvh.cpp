// lbvh.cpp -- the plugin of the linear BVH: a binary tree along a Morton curve, which can be built on the device that traces
// it. bvh4 packs and traces it.
#include "host_build.hpp"
#include "plan.hpp"
#include "rt_device.hpp"

namespace lbvh {
namespace {

constexpr rt_cl_file kFiles[] = {
#include "lbvh.inc"
};
constexpr rt_accel kAccel = rt::topology("bvh4", rt::guarded<topology>, rt::Traits());
constexpr rt_device_build kBuild = rt::device_topology(rt::file(kFiles, "lbvh_build.cl"), rt::guarded<plan>);
constexpr rt_extension kExtensions[] = {rt::extension(kBuild), rt::kNoMoreExtensions};
static_assert(kBuild.kernels.text, "the kernel file is embedded");

}  // namespace
}  // namespace lbvh

const rt_plugin rt_plugin_v1 = rt::with_extensions(
    rt::accel_plugin("lbvh", "Linear BVH along a Morton curve, for builds on the device", "1.0.0",
                     "Karras 2012, Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees", lbvh::kAccel),
    lbvh::kExtensions);
