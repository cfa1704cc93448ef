// reading_sink.hpp -- a sink and a host for fuzz targets. They read every byte that an importer passes, so that a sanitizer
// sees each pointer and count that is wrong, and they end the process on what the host would call a bug of the importer.
#pragma once
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "rt_plugin.h"
#include "scene/light_kinds.hpp"
#include "scene/map_uses.hpp"
#include "scene/material_keys.hpp"
#include "scene/sky_kinds.hpp"

namespace clarity::fuzz {

class ReadingSink {
 public:
    ReadingSink();
    const rt_host* host() const { return &host_; }
    const rt_scene_sink* sink() const { return &sink_; }
    // Ends the process if a message is not one that a user could read.
    void check_message(const std::string& text) const;

 private:
    template <class T>
    void read(const T* from, uint64_t count, uint64_t stride = sizeof(T)) {
        for (uint64_t i = 0; from && i < count; ++i) {
            T value;
            std::memcpy(&value, reinterpret_cast<const char*>(from) + i * stride, sizeof value);
            const volatile unsigned char last = reinterpret_cast<const unsigned char*>(&value)[sizeof value - 1];
            sum_ += last;
        }
    }
    void read(const char* text) { sum_ += text ? std::strlen(text) : 0; }
    static void require(bool is_right, const char* what) {
        if (is_right) return;
        std::fprintf(stderr, "the importer broke the contract: %s\n", what);
        std::abort();
    }
    void mesh(const rt_mesh&);
    void channel(const rt_channel_desc&);
    void read_values(const rt_key_value* values, rt_u32 count) {
        for (rt_u32 i = 0; i < count; ++i) read(values[i].key), read(values[i].numbers, 3);
    }
    void skin(const rt_skin_desc&);
    void morph(const rt_morph_desc&);

    rt_host host_{};
    rt_scene_sink sink_{};
    uint64_t sum_ = 0;
    rt_u32 textures_ = 0, materials_ = 0, meshes_ = 0, views_ = 0, nodes_ = 0, clips_ = 0, morphs_ = 0;
};

inline ReadingSink::ReadingSink() {
    host_.struct_bytes = sizeof host_;
    host_.ctx = this;
    host_.fail = [](void* ctx, const char* why) {
        static_cast<ReadingSink*>(ctx)->check_message(why);
        return int32_t(RT_FAILED);
    };
    host_.log = [](void* ctx, int32_t, const char* text) { static_cast<ReadingSink*>(ctx)->read(text); };
    host_.progress = [](void*, float fraction) {
        require(fraction >= 0 && fraction <= 1, "progress");
        return 1;
    };
    host_.parallel_for = [](void*, rt_u32 count, void (*body)(void*, rt_u32), void* user) {
        for (rt_u32 i = 0; i < count; ++i) body(user, i);
    };
#define SINK(call, type, ...)                      \
    sink_.call = [](void* ctx, const type* d) {    \
        auto& s = *static_cast<ReadingSink*>(ctx); \
        __VA_ARGS__;                               \
    }
    sink_.struct_bytes = sizeof sink_;
    sink_.ctx = this;
    SINK(texture, rt_texture_desc, s.read(d->path); s.read(d->bytes, d->byte_count); return s.textures_++);
    SINK(material, rt_material_desc, s.read(d->name); s.read_values(d->values, d->value_count);
         require(d->texture == RT_NONE || d->texture < s.textures_, "texture"); s.read(d->maps, d->map_count);
         for (rt_u32 i = 0; i < d->map_count; ++i)
             require(d->maps[i].texture < s.textures_ && d->maps[i].set < 2 && d->maps[i].use < RT_MAP_USES, "map");
         return s.materials_++);
    SINK(mesh, rt_mesh, s.mesh(*d); return s.meshes_++);
    SINK(instance, rt_instance_desc, s.read(d->name); require(d->mesh < s.meshes_ && d->node <= s.nodes_, "instance");
         return rt_u32(0));
    SINK(light, rt_light_desc, s.read(d->name); s.read_values(d->values, d->value_count); require(d->node <= s.nodes_, "light");
         return s.views_++);
    SINK(camera, rt_camera, s.read(d->name); require(d->node <= s.nodes_, "camera"); return s.views_++);
    SINK(info, rt_scene_info, s.sum_ += d->up_axis);
    SINK(load, rt_load, s.read(d->path); return int32_t(RT_OK));
    SINK(primitive, rt_primitive_desc, s.read(d->kind); return rt_u32(0));
    SINK(node, rt_node_desc, s.read(d->name); require(d->parent <= s.nodes_, "parent"); return ++s.nodes_);
    SINK(clip, rt_clip_desc, s.read(d->name); s.read(d->layers, d->layer_count); return ++s.clips_);
    SINK(morph, rt_morph_desc, s.morph(*d); return ++s.morphs_);
    SINK(channel, rt_channel_desc, s.channel(*d); return int32_t(RT_OK));
    SINK(skin, rt_skin_desc, s.skin(*d); return int32_t(RT_OK));
    SINK(vertex_frames, rt_vertex_frames, s.read(d->times_s, d->frame_count); return int32_t(RT_OK));
#undef SINK
    sink_.sphere = [](void*, const float*, float, rt_u32) { return rt_u32(0); };
    sink_.plane = [](void*, const float*, float, rt_u32) { return rt_u32(0); };
    sink_.polygon = [](void* ctx, const float* corners, rt_u32 count, rt_u32) {
        static_cast<ReadingSink*>(ctx)->read(corners, 3 * uint64_t(count));
        return rt_u32(0);
    };
    sink_.warn = [](void* ctx, const char* text) { static_cast<ReadingSink*>(ctx)->check_message(text); };
    sink_.light_kind = [](void*, rt_u32 kind) { return clarity::light_kind_for_plugins(kind); };
    sink_.material_kind = [](void*) { return clarity::material_kind_for_plugins(); };
    sink_.sky_kind = [](void*, rt_u32 kind) { return clarity::sky_kind_for_plugins(kind); };
    sink_.map_kind = [](void*) { return clarity::map_kind_for_plugins(); };
    sink_.primitive_kind = [](void*, rt_u32) { return static_cast<const rt_primitive_kind*>(nullptr); };
}

inline void ReadingSink::mesh(const rt_mesh& d) {
    read(d.name);
    for (rt_u32 i = 0; i < d.vertex_count; ++i) {
        const auto* at = reinterpret_cast<const char*>(d.positions) + uint64_t(i) * d.position_stride;
        read(reinterpret_cast<const float*>(at), 3);
        if (d.normals)
            read(reinterpret_cast<const float*>(reinterpret_cast<const char*>(d.normals) + uint64_t(i) * d.normal_stride), 3);
        if (d.uvs) read(reinterpret_cast<const float*>(reinterpret_cast<const char*>(d.uvs) + uint64_t(i) * d.uv_stride), 2);
        if (d.uvs2) read(reinterpret_cast<const float*>(reinterpret_cast<const char*>(d.uvs2) + uint64_t(i) * d.uv2_stride), 2);
        if (d.tangents)
            read(reinterpret_cast<const float*>(reinterpret_cast<const char*>(d.tangents) + uint64_t(i) * d.tangent_stride), 4);
        if (d.colors)
            read(reinterpret_cast<const float*>(reinterpret_cast<const char*>(d.colors) + uint64_t(i) * d.color_stride), 4);
    }
    read(d.indices, d.index_count);
    read(d.face_sizes, d.face_count);
    uint64_t corners = d.face_sizes ? 0 : 3 * d.face_count;
    for (uint64_t i = 0; d.face_sizes && i < d.face_count; ++i) corners += d.face_sizes[i];
    require(corners == d.index_count, "corners");
    for (uint64_t i = 0; d.face_materials && i < d.face_count; ++i)
        require(d.face_materials[i] == RT_NONE || d.face_materials[i] < materials_, "material of a face");
    require(d.material == RT_NONE || d.material < materials_, "material");
}

inline void ReadingSink::channel(const rt_channel_desc& d) {
    const rt_u32 width = d.component == RT_ALL_COMPONENTS ? 4 : 1;
    require(d.clip >= 1 && d.clip <= clips_ && d.key_count > 0, "channel");
    require(d.target <= (d.moves == RT_MOVES_MORPH ? morphs_ : d.moves >= RT_MOVES_FOV ? views_ : nodes_), "target");
    read(d.times_s, d.key_count);
    for (uint64_t i = 1; i < d.key_count; ++i) require(d.times_s[i - 1] <= d.times_s[i], "order of keys");
    read(d.values, d.key_count * width);
    read(d.spans, d.key_count);
    read(d.handles, d.key_count * width * 4);
}

inline void ReadingSink::skin(const rt_skin_desc& d) {
    require(d.mesh < meshes_, "mesh of a skin");
    for (rt_u32 i = 0; i < d.bone_count; ++i) require(d.bones[i].node >= 1 && d.bones[i].node <= nodes_, "bone");
    for (uint64_t i = 0; i < d.weight_count; ++i) require(d.weights[i].bone < d.bone_count, "weight");
    read(d.dual_quaternion_shares, 0);
}

inline void ReadingSink::morph(const rt_morph_desc& d) {
    read(d.name);
    require(d.mesh < meshes_, "mesh of a morph");
    for (rt_u32 i = 0; i < d.target_count; ++i) {
        const rt_morph_target& target = d.targets[i];
        read(target.vertices, target.count);
        read(target.positions, 3 * target.count);
        read(target.normals, 3 * target.count);
    }
}

inline void ReadingSink::check_message(const std::string& text) const {
    bool is_readable = text.size() >= 10 && text.size() < 4000;
    for (const char c : text) is_readable = is_readable && static_cast<unsigned char>(c) >= ' ' && c != 0x7F;
    // Words of the file, in quotes, may be any.
    constexpr const char* kQuotes = "'`";
    const size_t first = text.find_first_of(kQuotes), last = text.find_last_of(kQuotes);
    const std::string own = first == last ? text : text.substr(0, first) + text.substr(last);
    for (const char* words :
         {"std::", "vector::", "basic_string", "json.exception", "nknown error", "nknown type", "out of memory"})
        is_readable = is_readable && own.find(words) == own.npos;
    if (is_readable) return;
    std::fprintf(stderr, "a message that nobody can act on: %s\n", text.c_str());
    std::abort();
}

}  // namespace clarity::fuzz
