// scene_sink_calls.cpp -- the functions that a plugin calls: they catch what the sink throws, and copy structs of other sizes.
#include "base/error.hpp"
#include "import/sink/scene_sink.hpp"
#include "plugin/abi_struct.hpp"
#include "rt_plugin.hpp"

namespace clarity::import {
namespace {

// Copies a struct of the plugin into one of this host's size. Throws Error(import_failed) if it is too small; the sink's
// function then fails with that reason.
template <class T>
T taken(const T* from, const char* what) {
    if (const Problem why = from ? check_bytes<T>(what, from->struct_bytes) : std::string(what) + " is NULL")
        throw Error(Exit::import_failed, why.text());
    return copied<T>(from, from->struct_bytes);
}

}  // namespace

// Catches all exceptions, because the plugin that calls may be written in C.
template <class Result, class Body>
Result SceneSink::guarded(void* ctx, Result failed, const Body& body) {
    auto* self = static_cast<SceneSink*>(ctx);
    try {
        return body(*self);
    } catch (const Cancelled&) {
        self->cancelled_ = true;
        self->services_.fail("cancelled");
    } catch (const std::bad_alloc&) {
        self->services_.fail(rt::kOutOfMemory, Failure::no_memory);
    } catch (const Error& e) {
        self->services_.fail(e.what(), e.failure());
    } catch (const std::exception& e) {
        self->services_.fail(e.what());
    }
    return failed;
}

SceneSink::SceneSink(SceneBuilder& builder, HostServices& services, std::string path, FileContent& content)
    : builder_(builder), services_(services), path_(std::move(path)), content_(content), motion_(builder.scene(), content) {
    sink_.struct_bytes = sizeof(rt_scene_sink);
    sink_.ctx = this;
    sink_.texture = [](void* ctx, const rt_texture_desc* d) {
        return guarded(ctx, kFailed, [&](SceneSink& s) { return s.texture(taken(d, "rt_texture_desc")); });
    };
    sink_.material = [](void* ctx, const rt_material_desc* d) {
        return guarded(ctx, kFailed, [&](SceneSink& s) { return s.material(taken(d, "rt_material_desc")); });
    };
    sink_.mesh = [](void* ctx, const rt_mesh* d) {
        return guarded(ctx, kFailed, [&](SceneSink& s) { return s.mesh(taken(d, "rt_mesh")); });
    };
    sink_.instance = [](void* ctx, const rt_instance_desc* d) {
        return guarded(ctx, kFailed, [&](SceneSink& s) { return s.instance(taken(d, "rt_instance_desc")); });
    };
    sink_.sphere = [](void* ctx, const float* center, float radius, rt_u32 material) {
        return guarded(ctx, kFailed, [&](SceneSink& s) { return s.sphere(center, radius, material); });
    };
    sink_.plane = [](void* ctx, const float* normal, float offset, rt_u32 material) {
        return guarded(ctx, kFailed, [&](SceneSink& s) { return s.plane(normal, offset, material); });
    };
    sink_.polygon = [](void* ctx, const float* corners, rt_u32 count, rt_u32 material) {
        return guarded(ctx, kFailed, [&](SceneSink& s) { return s.polygon(corners, count, material); });
    };
    sink_.light = [](void* ctx, const rt_light_desc* d) {
        return guarded(ctx, kFailed, [&](SceneSink& s) { return s.light(taken(d, "rt_light_desc")); });
    };
    sink_.camera = [](void* ctx, const rt_camera* d) {
        return guarded(ctx, kFailed, [&](SceneSink& s) { return s.camera(taken(d, "rt_camera")); });
    };
    sink_.info = [](void* ctx, const rt_scene_info* d) {
        guarded(ctx, 0, [&](SceneSink& s) { return s.info(taken(d, "rt_scene_info")), 0; });
    };
    sink_.warn = [](void* ctx, const char* text) {
        guarded(ctx, 0, [&](SceneSink& s) { return s.builder_.warn(s.path_, clean_name(text)), 0; });
    };
    sink_.load = [](void* ctx, const rt_load* d) {
        return guarded(ctx, int32_t(RT_FAILED), [&](SceneSink& s) { return s.load(taken(d, "rt_load")); });
    };
    for (const rt_plugin* plugin : builder.plugins().primitives()) {
        const rt_primitive& primitive = *plugin->primitive;
        kinds_.push_back({sizeof(rt_primitive_kind), primitive.key_count, plugin->id, primitive.keys, sizeof(rt_key), 0});
    }
    sink_.primitive_kind = [](void* ctx, rt_u32 number) {
        const auto& kinds = static_cast<const SceneSink*>(ctx)->kinds_;
        return number < kinds.size() ? &kinds[number] : nullptr;
    };
    sink_.primitive = [](void* ctx, const rt_primitive_desc* d) {
        return guarded(ctx, kFailed, [&](SceneSink& s) { return s.primitive(taken(d, "rt_primitive_desc")); });
    };
    sink_.light_kind = [](void*, rt_u32 kind) { return light_kind_for_plugins(kind); };
    sink_.material_kind = [](void*) { return material_kind_for_plugins(); };
    sink_.sky_kind = [](void*, rt_u32 kind) { return sky_kind_for_plugins(kind); };
    sink_.map_kind = [](void*) { return map_kind_for_plugins(); };
    offer_motion();
    sink_.edit = [](void* ctx, const char* key, const char* value, const char* where) {
        return guarded(ctx, int32_t(RT_FAILED), [&](SceneSink& s) { return s.edit(key, value, where); });
    };
    sink_.sky = [](void* ctx, const rt_sky_desc* d) {
        return guarded(ctx, int32_t(RT_FAILED), [&](SceneSink& s) { return s.sky(taken(d, "rt_sky_desc")); });
    };
}

void SceneSink::offer_motion() {
    sink_.node = [](void* ctx, const rt_node_desc* from) {
        return guarded(ctx, kFailed, [&](SceneSink& s) {
            const rt_node_desc d = taken(from, "rt_node_desc");
            return s.motion_.node(d, clean_name(d.name));
        });
    };
    sink_.clip = [](void* ctx, const rt_clip_desc* from) {
        return guarded(ctx, kFailed, [&](SceneSink& s) {
            const rt_clip_desc d = taken(from, "rt_clip_desc");
            return s.motion_.clip(d, clean_name(d.name));
        });
    };
    sink_.morph = [](void* ctx, const rt_morph_desc* from) {
        return guarded(ctx, kFailed, [&](SceneSink& s) {
            const rt_morph_desc d = taken(from, "rt_morph_desc");
            return s.motion_.morph(d, clean_name(d.name), s.meshes_);
        });
    };
    sink_.channel = [](void* ctx, const rt_channel_desc* d) {
        return guarded(ctx, int32_t(RT_FAILED), [&](SceneSink& s) {
            return s.motion_.channel(taken(d, "rt_channel_desc"), s.camera_sources_, s.light_sources_), int32_t(RT_OK);
        });
    };
    sink_.skin = [](void* ctx, const rt_skin_desc* d) {
        return guarded(ctx, int32_t(RT_FAILED),
                       [&](SceneSink& s) { return s.motion_.skin(taken(d, "rt_skin_desc"), s.meshes_), int32_t(RT_OK); });
    };
    sink_.vertex_frames = [](void* ctx, const rt_vertex_frames* d) {
        return guarded(ctx, int32_t(RT_FAILED), [&](SceneSink& s) {
            return s.motion_.vertex_frames(taken(d, "rt_vertex_frames"), s.meshes_), int32_t(RT_OK);
        });
    };
}

}  // namespace clarity::import
