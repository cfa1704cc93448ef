#include "load.hpp"

#include "animations.hpp"
#include "materials.hpp"
#include "meshes.hpp"
#include "nodes.hpp"
#include "rt_plugin.hpp"

namespace gltf_import {
namespace {

// The share of the meshes in the progress. The rest is animations.
constexpr float kMeshShare = 0.8f;

bool has_targets(const Document& document) {
    const Value meshes = document.list("meshes");
    for (size_t i = 0; i < meshes.size(); ++i) {
        const Value primitives = meshes[i]["primitives"];
        for (size_t k = 0; k < primitives.size(); ++k) {
            if (primitives[k].list("targets").size() > 0) return true;
        }
    }
    return false;
}

}  // namespace

void load_document(const Document& document, const rt_host* host, const rt_scene_sink& sink) {
    // What stands still is placed once and for all, which is faster to render.
    const bool moves = RT_HAS(&sink, rt_scene_sink, vertex_frames) &&
                       (document.list("animations").size() > 0 || document.list("skins").size() > 0 || has_targets(document));
    const NodeTree tree(document, sink, moves);
    Accessors accessors(document);
    Materials materials(document, accessors, sink);
    Meshes meshes(document, accessors, materials, tree, sink, moves,
                  moves ? nodes_with_animated_weights(document) : std::set<size_t>());
    size_t done = 0;
    for (const size_t node : tree.shown()) {
        rt::progress(host, kMeshShare * float(++done) / float(tree.shown().size()));
        meshes.place(node);
    }
    meshes.report();
    add_lights(document, tree, host, sink);
    add_cameras(document, tree, sink);
    if (moves) add_animations(document, accessors, tree, meshes, sink);
    rt_scene_info info{};
    info.struct_bytes = sizeof info;
    info.up_axis = 1;
    info.unit_scale = 1;
    sink.info(sink.ctx, &info);
}

}  // namespace gltf_import
