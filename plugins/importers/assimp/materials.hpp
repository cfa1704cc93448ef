// materials.hpp -- converts assimp's materials and textures to those of the host.
#pragma once
#include <assimp/scene.h>

#include <array>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "../common/materials.hpp"
#include "../common/texture_path.hpp"
#include "collada_pictures.hpp"
#include "rt_plugin.h"

namespace assimp_import {

// The uv channels that are the two sets of coordinates of a material.
using Channels = std::array<unsigned, 2>;

// Converts materials and passes each to the sink when it is first used.
class MaterialTable {
 public:
    MaterialTable(const aiScene& scene, const std::string& file, ColladaPictures pictures, const rt_scene_sink& sink);
    rt_u32 id(unsigned material);  // RT_NONE: the default material
    Channels channels(unsigned material) const;

 private:
    std::vector<rt_map_desc> maps_of(const aiMaterial& material, std::string& left_out);
    // How the picture of the transparency counts: by a map, or by the alpha of that of the colour.
    void read_transparency(const aiMaterial& material, std::vector<rt_map_desc>& maps, importers::AlphaKeys& alpha,
                           std::string& left_out);
    rt_map_desc map(const aiMaterial& material, aiTextureType type, rt_u32 use, rt_u32 space);
    rt_u32 texture(const aiMaterial& material, aiTextureType type, rt_u32 space);
    rt_u32 wrap_mode(const aiMaterial& material, const char* key, unsigned type, unsigned index);
    rt_u32 add_texture(const std::string& reference, rt_u32 wrap_u, rt_u32 wrap_v, rt_u32 space);
    rt_u32 embedded_texture(const aiTexture& texture, rt_texture_desc& desc);

    const aiScene& scene_;
    const importers::FilePlace place_;
    const ColladaPictures pictures_;
    const rt_scene_sink& sink_;
    std::vector<rt_u32> ids_;
    std::vector<bool> done_;
    bool warned_of_decals_ = false;
    std::map<std::tuple<std::string, rt_u32, rt_u32, rt_u32>, rt_u32> textures_;  // by reference, wrap modes and space
};

}  // namespace assimp_import
