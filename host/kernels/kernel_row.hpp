// kernel_row.hpp -- what makes up a kernel that traces rays. Each tracer (tracers/<id>) describes its own kernels.
#pragma once
#include <string>
#include <vector>

#include "rt_plugin.h"
#include "view/settings/settings.hpp"

namespace clarity {

class SourceWriter;

// Properties of a kernel, as bits of KernelRow::traits.
enum : unsigned {
    kNearestOnly = 1,     // has no any-hit traversals
    kReadsUvs = 2,        // reads texture coordinates even if the scene has no texture
    kLimitRegisters = 4,  // is faster on GPUs with fewer registers than it would take, where a scene is of triangles and
                          // spheres alone: program_cache.cpp has the numbers
    kVotes = 8,           // uses votes among the work-items of a warp: cl/lanes/subgroup.h
    kFrame = 16,          // traces frames; so on a frame of no size it ends at once
    kCountsRays = 32,     // traces more than camera rays: it has `counters`, and the `distances` of the camera rays
    kLayers = 64,         // one launch may trace several samples: rt_layer_of() in cl/tracers/camera.h
    kPicksLights = 128,   // has the table of emitters and the sky: cl/shading/emitters.h
    kSumsSamples = 256,   // adds several samples of a launch in their order, to a film of two planes: cl/tracers/path/sum.h
    kWhitted = 512,       // lights with cl/shading/shading.h
    kAllHits = 1024,      // lists hits instead of looking for the nearest: cl/lanes/hit_list.h
    kLimitRegistersAlways = 2048,  // is faster with fewer registers, whatever the scene holds
    kGuides = 4096                 // with kSumsSamples: the film has the denoiser's guides, too: cl/tracers/path/guides.h
};

struct KernelRow {
    const char* tracer = "";           // id of the tracer that it belongs to
    const char* what = "";             // for messages: "ray queries"
    const char* file = "";             // below cl/, included last
    const char* entry = "";            // name of the kernel function
    std::vector<const char*> headers;  // below cl/, included after the traversals and before `file`
    std::vector<std::string> defines;  // "NAME" or "NAME VALUE", ahead of all includes
    unsigned traits = 0;
    void (*define)(SourceWriter&, const Settings&) = nullptr;  // writes more defines, which depend on settings
    rt_u32 needs = 0;            // capabilities that the structure must have: RT_TRAVERSES_STEPS...
    unsigned rays_per_item = 0;  // for kernels that trace a warp's rays together
    bool has(unsigned trait) const { return (traits & trait) != 0; }
};

// Of the optics of a scene, those that the kernel is compiled for.
inline Optics optics_known(const KernelRow& row, const Optics& optics) {
    if (row.has(kPicksLights)) return optics;
    return row.has(kWhitted) ? optics.for_whitted() : Optics{0, 0, optics.cutouts};
}

// Headers below cl/ that know what surfaces look like, in their order: the first of most kernels.
inline const std::vector<const char*>& material_headers() {
    static const std::vector<const char*> headers = {"shading/textures.h", "shading/maps.h", "shading/material.h",
                                                     "shading/cutouts.h"};
    return headers;
}

// Headers below cl/ of the surface models of `path`, in their order, after those above and sampling/.
inline const std::vector<const char*>& surface_headers() {
    static const std::vector<const char*> headers = {"shading/albedo_grazing.h",
                                                     "shading/albedo_sheen.h",
                                                     "shading/lost_metal.h",
                                                     "shading/lost_glass_outside.h",
                                                     "shading/lost_glass_inside.h",
                                                     "shading/microfacets.h",
                                                     "shading/sheen.h",
                                                     "shading/matter.h",
                                                     "shading/matter_maps.h",
                                                     "shading/film.h",
                                                     "shading/layers.h",
                                                     "shading/layer_lobes.h",
                                                     "shading/bsdf.h",
                                                     "shading/bsdf_of.h"};
    return headers;
}

// Planes of the film of colours that a kernel traces into.
inline unsigned film_planes(const KernelRow& row) {
    return row.has(kGuides) ? RT_FILM_PLANES : row.has(kSumsSamples) ? RT_PLANE_REST + 1 : RT_PLANE_SUM + 1;
}

}  // namespace clarity
