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

}  // namespace

void load_document(const Document& document, const rt_host* host, const rt_scene_sink& sink) {
    if (!RT_HAS(&sink, rt_scene_sink, vertex_frames)) throw Error("this importer needs a newer version of the program");
    const NodeTree tree(document, sink);
    Accessors accessors(document, sink);
    Materials materials(document, accessors, sink);
    Meshes meshes(document, accessors, materials, tree, sink, nodes_with_animated_weights(document));
    size_t done = 0;
    for (const size_t node : tree.shown()) {
        rt::progress(host, kMeshShare * float(++done) / float(tree.shown().size()));
        meshes.place(node);
    }
    meshes.report();
    add_lights(document, tree, host, sink);
    add_sky(document, accessors, sink);
    add_cameras(document, tree, sink);
    add_animations(document, accessors, tree, meshes, sink);
    rt_scene_info info{};
    info.struct_bytes = sizeof info;
    info.up_axis = 1;
    info.unit_scale = 1;
    sink.info(sink.ctx, &info);
}

}  // namespace gltf_import
