// traversal_source.hpp -- a plugin's traversal as kernels get it: the buffers it reads, and one instance of its template for
// each of {scene, mesh} x {nearest hit, any hit}. What a traversal may use: cl/CONTRACT.md.
#pragma once
#include "render/kernels/scene_features.hpp"
#include "render/kernels/source_writer.hpp"

namespace clarity {

// rt_ctx: the scene's buffers and the slots of the structure, as a struct, kernel arguments and initialisation.
void write_context(SourceWriter& out, const rt_accel& accel);

// A plugin's traversal, read once, and what its instances are to have.
struct TraversalTemplate {
    std::string file, text;
    bool cpu = false;          // leaf tests in two steps, and tests of a single ray against several primitives
    bool requeues = false;     // RT_TRAVERSE_REQUEUED too
    bool by_warps = false;     // RT_TRAVERSE_WARP too
    bool double_leaf = false;  // every leaf test is done twice, to measure what they take
};
// Primitive tests, traversals and the query over both, for nearest hits or for any hit.
void write_query(SourceWriter& out, const TraversalTemplate& traversal, const SceneFeatures& features, bool any_hit);

}  // namespace clarity
