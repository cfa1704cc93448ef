// ploc.cpp -- the plugin of parallel locally-ordered clustering: a binary tree that is built from the leaves up, nearly as good
// as one by the surface area heuristic, and which can be built on the device that traces it. bvh4 packs and traces it.
#include "host_build.hpp"
#include "plan.hpp"
#include "rt_device.hpp"

namespace ploc {
namespace {

constexpr rt_cl_file kFiles[] = {
#include "ploc.inc"
};
constexpr rt_accel kAccel = rt::topology("bvh4", rt::guarded<topology>, rt::Traits());
constexpr rt_device_build kBuild = rt::device_topology(rt::file(kFiles, "ploc_build.cl"), rt::guarded<plan>);
constexpr rt_extension kExtensions[] = {rt::extension(kBuild), rt::kNoMoreExtensions};
static_assert(kBuild.kernels.text, "the kernel file is embedded");

}  // namespace
}  // namespace ploc

const rt_plugin rt_plugin_v1 = rt::with_extensions(
    rt::accel_plugin("ploc", "BVH by locally-ordered clustering, for builds on the device", "1.0.0",
                     "Benthin, Meister, Barczak, Mehalwal, Tsakok, Kensler 2024, H-PLOC: Hierarchical Parallel Locally-Ordered "
                     "Clustering for Bounding Volume Hierarchy Construction",
                     ploc::kAccel),
    ploc::kExtensions);
