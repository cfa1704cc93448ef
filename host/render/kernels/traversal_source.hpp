// traversal_source.hpp -- writes a plugin's traversal into a kernel: the buffers that it reads, and one instance of its
// template for each of {scene, mesh} x {nearest hit, any hit}. cl/CONTRACT.md says what a traversal may use.
#pragma once
#include "render/kernels/scene_features.hpp"
#include "render/kernels/source_writer.hpp"

namespace clarity {

// Writes rt_ctx: the scene's buffers and the structure's slots, as a struct, as kernel arguments, and as initialisation.
// Returns the names of the arguments, separated by commas. picks_lights: with the buffers of kernels with kPicksLights.
std::string write_context(SourceWriter& out, const rt_accel& accel, const SceneFeatures& features, bool picks_lights);

// A plugin's traversal as a template. The text is read once; the flags apply to all instances.
struct TraversalTemplate {
    std::string file, text;
    bool cpu = false;       // with leaf tests in two steps, and tests of a single ray against several primitives
    bool requeues = false;  // with RT_TRAVERSE_REQUEUED
    bool by_warps = false;  // with RT_TRAVERSE_WARP
    bool spreads = false;   // it traces one ray, and the host spreads packets over it (RT_TRAVERSES_SINGLE_RAYS)
};
// Writes the primitive tests, the traversals, and the query that calls both, for nearest hits or for any hit.
void write_query(SourceWriter& out, const TraversalTemplate& traversal, const SceneFeatures& features, bool any_hit);

}  // namespace clarity
