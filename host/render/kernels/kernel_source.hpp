// kernel_source.hpp -- one source string for one specialisation of the tracer: shared types, lanes, primitives, the generated
// context, the plugin's traversal included as a template, and the kernel. What may be included where: cl/CONTRACT.md.
#pragma once
#include <map>
#include <string>

#include "render/accel/accel_build.hpp"
#include "render/kernels/layout.hpp"
#include "render/settings/settings.hpp"

namespace clarity {

// What of the scene decides which code is compiled in.
struct SceneFeatures {
    bool instances = false, spheres = false, polygons = false, planes = false, normals = false, uvs = false, textures = false;
};
SceneFeatures features_of(const Scene& scene, const BuildScene& build);

// long_rays: of one lane, where requeues_long_rays(); queued_rays: nearest hits alone, where traverses_by_steps(); warp_rays
// and warp_pairs: where traverses_by_warps(). generations: the tracer of color, whose picture is how many generations of rays
// each pixel has.
enum class KernelKind {
    color,
    generations,
    aov,
    rays,
    counted_rays,
    requeued_rays,
    dynamic_fetch,
    warp_rays,
    warp_pairs,
    inspect
};

// How much of a frame a program of kind `color` does; see frame_parts.hpp. The first three are its beginning: the film alone,
// camera rays, their nearest hits. twice: leaf tests are done twice, which changes no picture.
enum class FramePart { film, rays, closest, closest_double_leaf, whole, whole_closest_double_leaf, whole_any_double_leaf };

// Whether a plugin's traversal lets go of rays and takes one by many work-items (requeued_rays.cl).
bool requeues_long_rays(const rt_plugin& accel);
// Whether it goes turn by turn, so that who is done may begin another ray (dynamic_fetch.cl).
bool traverses_by_steps(const rt_plugin& accel);
// Whether it takes all rays of a warp one way (warp_rays.cl), and how many of them a work-item then has.
bool traverses_by_warps(const rt_plugin& accel);
constexpr unsigned warp_rays_each(KernelKind kind) {
    return kind == KernelKind::warp_rays ? 1 : kind == KernelKind::warp_pairs ? 2 : 0;
}
constexpr unsigned kRequeueItems = 32;  // as many as a warp has

constexpr const char* kWavefrontEntry = "trace_wavefront";  // of its several kernels the one that traces

struct KernelSource {
    std::string text, options, entry;  // entry: name of the kernel
    bool fewer_registers = false;      // it gains by more warps side by side than its registers would let be
};
KernelSource assemble_kernel(const Settings& settings, const Layout& layout, KernelKind kind, const SceneFeatures& features,
                             const rt_plugin& accel, const std::map<std::string, rt_u32>& defines,
                             FramePart part = FramePart::whole);

}  // namespace clarity
