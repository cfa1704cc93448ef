// materials.hpp -- converts assimp's materials and textures to those of the host.
#pragma once
#include <assimp/scene.h>

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "../common/texture_path.hpp"
#include "collada_wraps.hpp"
#include "rt_plugin.h"

namespace assimp_import {

// Which uv channel the colour texture of a material uses, and how its coordinates are transformed.
struct TextureMapping {
    unsigned channel = 0;
    bool has_transform = false;
    aiUVTransform transform;
};

// Converts materials and passes each to the sink when it is first used.
class MaterialTable {
 public:
    MaterialTable(const aiScene& scene, const std::string& file, ColladaWraps wraps, const rt_scene_sink& sink);
    rt_u32 id(unsigned material);  // RT_NONE: the default material
    TextureMapping mapping(unsigned material) const;

 private:
    std::vector<rt_map_desc> maps_of(const aiMaterial& material);  // besides that of the colour
    rt_u32 texture(const aiMaterial& material, aiTextureType type, rt_u32 space);
    rt_u32 wrap_mode(const aiMaterial& material, const char* key, unsigned type, unsigned index);
    rt_u32 add_texture(const std::string& reference, rt_u32 wrap_u, rt_u32 wrap_v, rt_u32 space);
    rt_u32 embedded_texture(const aiTexture& texture, rt_texture_desc& desc);

    const aiScene& scene_;
    const importers::FilePlace place_;
    const ColladaWraps wraps_;
    const rt_scene_sink& sink_;
    std::vector<rt_u32> ids_;
    std::vector<bool> done_;
    bool warned_of_decals_ = false;
    std::map<std::tuple<std::string, rt_u32, rt_u32, rt_u32>, rt_u32> textures_;  // by reference, wrap modes and space
};

}  // namespace assimp_import
