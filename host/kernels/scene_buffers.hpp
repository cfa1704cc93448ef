// scene_buffers.hpp -- the table of a scene's buffers. From it come the members of rt_ctx, the arguments of kernels, and what
// the host uploads. The slots of the structure follow them.
#pragma once
#include <cstddef>

#include "kernels/scene_features.hpp"
#include "rt_shape.h"
#include "rt_types.h"

namespace clarity {

struct SceneBuffer {
    const char *type, *name;             // in rt_ctx; as an argument of kernels it is called ctx_NAME
    const char* what;                    // for messages
    size_t checked_bytes;                // if not 0: the size of the type, which is compared with the device's
    bool SceneFeatures::* of = nullptr;  // only kernels of scenes with this feature have it
    enum For {
        all_kernels,
        picking_lights,  // only kernels with kPicksLights have it; it comes from the frame (launch/emitters)
        layered          // only kernels with RT_LOBE_LAYERS or models of plugins have it
    } kernels = all_kernels;
};

constexpr SceneBuffer kSceneBuffers[] = {
    {"rt_packed_prim", "leaves", "leaves", sizeof(rt_packed_prim)},
    {"rt_instance", "instances", "instances", sizeof(rt_instance)},
    {"rt_polygon", "polygons", "polygons", 0},
    {"float", "polygon_corners", "polygon corners", 0},
    {"rt_plane", "planes", "planes", 0},
    {"rt_material", "materials", "materials", sizeof(rt_material)},
    {"rt_layers", "layers", "layers of materials", sizeof(rt_layers), nullptr, SceneBuffer::layered},
    {"rt_triangle", "triangles", "triangles", 0},
    {"float", "normals", "normals", 0},
    {"float", "uvs", "texture coordinates", 0},
    {"float", "colors", "colours of vertices", 0, &SceneFeatures::colors},
    {"float", "uvs2", "second texture coordinates", 0, &SceneFeatures::uvs2},
    {"uint", "tangents", "tangents", 0, &SceneFeatures::tangents},
    {"rt_map", "maps", "maps", sizeof(rt_map), &SceneFeatures::maps},
    {"uint", "material_maps", "maps of materials", 0, &SceneFeatures::maps},
    {"rt_texture", "textures", "texture table", 0},
    {"uint", "texels", "textures", 0},
    {"rt_light", "lights", "lights", 0},
    {"rt_shape", "shapes", "shapes", sizeof(rt_shape), &SceneFeatures::shapes},
    {"float", "shape_numbers", "numbers of shapes", 0, &SceneFeatures::shapes},
    {"rt_emitter", "emitters", "table of emitters", sizeof(rt_emitter), nullptr, SceneBuffer::picking_lights},
    {"rt_emitter_run", "emitter_runs", "runs of emitters", 0, nullptr, SceneBuffer::picking_lights},
    {"rt_light_node", "light_nodes", "light tree", sizeof(rt_light_node), &SceneFeatures::light_tree,
     SceneBuffer::picking_lights},
    {"rt_lighting", "lighting", "summary of emitters", sizeof(rt_lighting), nullptr, SceneBuffer::picking_lights},
    {"ushort", "sky_texels", "picture of the sky", 0, nullptr, SceneBuffer::picking_lights},
    {"uint", "sky_picks", "tables of the sky", 0, nullptr, SceneBuffer::picking_lights},
};

}  // namespace clarity
