// maps.hpp -- the textures of materials: which there are, how they lie, and their images.
#pragma once
#include <array>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "accessors.hpp"
#include "rt_plugin.h"

namespace gltf_import {

// The sets of texture coordinates that a material uses, in the order of the host's sets: TEXCOORD_n.
using TextureSets = std::vector<uint64_t>;
inline constexpr size_t kMostSets = 2;

// An element of `images`: where its bytes are. Refuses an empty one. The description points into it.
class Image {
 public:
    Image(const Value& image, Accessors& accessors, const std::string& folder);
    Image(const Image&) = delete;
    rt_texture_desc look{};  // without wrap modes, filter and space

 private:
    std::string name_, content_;
};

class Maps {
 public:
    Maps(const Document& document, Accessors& accessors, const rt_scene_sink& sink);

    // The sets that a material uses, two at most. Says nothing of what is wrong: read() does.
    TextureSets sets(const Value& material) const;
    // The maps of a material. emits: whether its emission is not black. Adds what is not understood to left_out.
    std::vector<rt_map_desc> read(const Value& material, bool emits, std::vector<std::string>& left_out);

 private:
    rt_u32 texture(const Value& info, rt_u32 space, std::string& why_not);
    rt_u32 wrap_mode(const Value& sampler, const char* key) const;
    rt_u32 add_image(const Value& image, rt_texture_desc look);

    Accessors& accessors_;
    const std::string folder_;
    const Value textures_, images_, samplers_;
    const rt_scene_sink& sink_;
    std::map<std::tuple<size_t, rt_u32, rt_u32, rt_u32, rt_u32>, rt_u32> ids_;  // by image, wrap modes, space and filter
};

}  // namespace gltf_import
