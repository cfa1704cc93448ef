// materials.hpp -- converts metallic-roughness materials to Whitted materials of the host, and images to its textures.
#pragma once
#include <array>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "accessors.hpp"
#include "rt_plugin.h"

namespace gltf_import {

// The set of texture coordinates that the colour's texture uses, and how they are transformed (KHR_texture_transform).
struct TextureMapping {
    uint64_t set = 0;
    std::array<double, 6> matrix = {1, 0, 0, 0, 1, 0};  // 2x3, row-major, from the file's coordinates
    bool operator==(const TextureMapping& other) const { return set == other.set && matrix == other.matrix; }
};

class Materials {
 public:
    Materials(const Document& document, Accessors& accessors, const rt_scene_sink& sink);

    // The material of a primitive, which the sink gets at its first use. RT_NONE: the host's default material.
    rt_u32 id(const Value& primitive);
    TextureMapping mapping(const Value& primitive) const;

 private:
    rt_u32 add(const Value& material);
    rt_u32 texture(const Value& info);
    rt_u32 wrap_mode(const Value& sampler, const char* key) const;
    rt_u32 add_image(const Value& image, rt_u32 wrap_u, rt_u32 wrap_v);

    Accessors& accessors_;
    const std::string folder_;
    const Value materials_, textures_, images_, samplers_;
    const rt_scene_sink& sink_;
    std::vector<std::optional<rt_u32>> ids_;
    std::map<std::tuple<size_t, rt_u32, rt_u32>, rt_u32> texture_ids_;  // by image and wrap modes
};

}  // namespace gltf_import
