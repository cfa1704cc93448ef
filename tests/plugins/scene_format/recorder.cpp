#include "recorder.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "scene/light_kinds.hpp"
#include "scene/map_uses.hpp"
#include "scene/material_keys.hpp"
#include "scene/sky_kinds.hpp"

namespace {

Recording& recording_of(void* ctx) {
    return *static_cast<Recording*>(ctx);
}
std::string text_or_empty(const char* text) {
    return text != nullptr ? text : "";
}
rt_u32 id_of(size_t count) {
    return static_cast<rt_u32>(count - 1);
}

rt_host recording_host(Recording& recording) {
    rt_host host{};
    host.struct_bytes = sizeof host;
    host.ctx = &recording;
    host.fail = [](void* ctx, const char* why) -> int32_t {
        if (recording_of(ctx).why.empty()) recording_of(ctx).why = why;
        return RT_FAILED;
    };
    host.log = [](void* ctx, int32_t, const char* text) { recording_of(ctx).log.push_back(text); };
    host.progress = [](void* ctx, float) -> int32_t {
        Recording& recording = recording_of(ctx);
        if (recording.reports_before_cancel < 0) return 1;
        return recording.reports_before_cancel-- > 0 ? 1 : 0;
    };
    host.parallel_for = [](void*, rt_u32 count, void (*body)(void*, rt_u32), void* user) {
        for (rt_u32 i = 0; i < count; ++i) body(user, i);
    };
    return host;
}

void add_geometry_calls(rt_scene_sink& sink) {
    sink.mesh = [](void* ctx, const rt_mesh* mesh) -> rt_u32 {
        Recording& r = recording_of(ctx);
        RecordedMesh copy;
        copy.positions.assign(mesh->positions, mesh->positions + 3 * mesh->vertex_count);
        copy.indices.assign(mesh->indices, mesh->indices + mesh->index_count);
        copy.face_materials.assign(mesh->face_materials, mesh->face_materials + mesh->face_count);
        r.meshes.push_back(std::move(copy));
        r.order.push_back("mesh");
        return id_of(r.meshes.size());
    };
    sink.instance = [](void* ctx, const rt_instance_desc* instance) -> rt_u32 {
        recording_of(ctx).instanced_meshes.push_back(instance->mesh);
        return id_of(recording_of(ctx).instanced_meshes.size());
    };
    sink.sphere = [](void* ctx, const float c[3], float radius, rt_u32 material) -> rt_u32 {
        if (recording_of(ctx).refuse_spheres) return RT_NONE;
        recording_of(ctx).spheres.push_back({{c[0], c[1], c[2]}, radius, material});
        recording_of(ctx).order.push_back("sphere");
        return id_of(recording_of(ctx).spheres.size());
    };
    sink.plane = [](void* ctx, const float n[3], float offset, rt_u32 material) -> rt_u32 {
        recording_of(ctx).planes.push_back({{n[0], n[1], n[2]}, offset, material});
        recording_of(ctx).order.push_back("plane");
        return id_of(recording_of(ctx).planes.size());
    };
    sink.polygon = [](void* ctx, const float* corners, rt_u32 count, rt_u32 material) -> rt_u32 {
        recording_of(ctx).polygons.push_back({{corners, corners + 3 * count}, material});
        recording_of(ctx).order.push_back("polygon");
        return id_of(recording_of(ctx).polygons.size());
    };
    sink.load = [](void* ctx, const rt_load* load) -> int32_t {
        Recording& r = recording_of(ctx);
        RecordedLoad copy{load->path, text_or_empty(load->name), {}, load->material, load->node};
        std::copy(load->world_from_object, load->world_from_object + 12, copy.world_from_object.begin());
        r.loads.push_back(copy);
        r.order.push_back("load");
        if (!r.refuse_loads) return RT_OK;
        if (r.why.empty()) r.why = text_or_empty(load->where) + ": the sink refused " + copy.path;
        return RT_FAILED;
    };
}

void add_look_calls(rt_scene_sink& sink) {
    sink.texture = [](void* ctx, const rt_texture_desc* texture) -> rt_u32 {
        Recording& r = recording_of(ctx);
        r.textures.push_back(texture->path);
        r.wraps.push_back({texture->wrap_u, texture->wrap_v});
        r.looks.push_back(*texture);
        return r.refuse_textures ? RT_NONE : id_of(r.textures.size());
    };
    sink.material = [](void* ctx, const rt_material_desc* material) -> rt_u32 {
        Recording& r = recording_of(ctx);
        std::string problem;
        r.materials.push_back({material->name, clarity::material_of(*material, problem), {}});
        if (material->maps) r.materials.back().maps.assign(material->maps, material->maps + material->map_count);
        if (!problem.empty()) r.warnings.push_back(problem);
        return id_of(recording_of(ctx).materials.size());
    };
    sink.light = [](void* ctx, const rt_light_desc* light) -> rt_u32 {
        Recording& r = recording_of(ctx);
        std::string problem;
        rt_light made{};
        if (clarity::light_of(*light, made, problem)) clarity::make_sound(made);
        r.lights.push_back({text_or_empty(light->name), *light, made});
        if (!problem.empty()) r.warnings.push_back(problem);
        return id_of(recording_of(ctx).lights.size());
    };
    sink.light_kind = [](void*, rt_u32 kind) { return clarity::light_kind_for_plugins(kind); };
    sink.material_kind = [](void*) { return clarity::material_kind_for_plugins(); };
    sink.sky_kind = [](void*, rt_u32 kind) { return clarity::sky_kind_for_plugins(kind); };
    sink.map_kind = [](void*) { return clarity::map_kind_for_plugins(); };
    sink.camera = [](void* ctx, const rt_camera* camera) -> rt_u32 {
        recording_of(ctx).cameras.push_back({camera->name, *camera});
        return id_of(recording_of(ctx).cameras.size());
    };
    sink.info = [](void* ctx, const rt_scene_info* info) {
        Recording& r = recording_of(ctx);
        r.has_background = info->background != nullptr;
        r.has_ambient = info->ambient != nullptr;
        if (r.has_background) std::copy(info->background, info->background + 3, r.background.begin());
        if (r.has_ambient) std::copy(info->ambient, info->ambient + 3, r.ambient.begin());
    };
    sink.warn = [](void* ctx, const char* text) { recording_of(ctx).warnings.push_back(text); };
    sink.sky = [](void* ctx, const rt_sky_desc* sky) -> int32_t {
        Recording& r = recording_of(ctx);
        r.skies.push_back(*sky);
        r.sky_path = sky->path ? sky->path : "";
        r.skies.back().path = nullptr;
        return RT_OK;
    };
}

void add_motion_calls(rt_scene_sink& sink) {
    sink.node = [](void* ctx, const rt_node_desc* node) -> rt_u32 {
        recording_of(ctx).nodes.push_back(*node);
        return static_cast<rt_u32>(recording_of(ctx).nodes.size());
    };
    sink.clip = [](void* ctx, const rt_clip_desc* clip) -> rt_u32 {
        recording_of(ctx).clips.push_back(*clip);
        return static_cast<rt_u32>(recording_of(ctx).clips.size());
    };
    sink.edit = [](void* ctx, const char* key, const char* value, const char* where) -> int32_t {
        recording_of(ctx).edits.push_back(std::string(key) + "=" + value + (where ? "" : " nowhere"));
        return RT_OK;
    };
    sink.channel = [](void* ctx, const rt_channel_desc* c) -> int32_t {
        const size_t values = c->key_count * (c->component == RT_ALL_COMPONENTS ? 4 : 1);
        recording_of(ctx).channels.push_back(
            {c->moves, c->target, c->component, {c->times_s, c->times_s + c->key_count}, {c->values, c->values + values}});
        return RT_OK;
    };
}

template <class Numbers>
bool all_finite(const Numbers& numbers) {
    return std::all_of(std::begin(numbers), std::end(numbers), [](float x) { return std::isfinite(x); });
}

void show_as_test_scene(const std::string& path, std::string& text) {
    for (size_t at; (at = text.find(path)) != std::string::npos;) text.replace(at, path.size(), "test.scene");
}

}  // namespace

void import_text(const std::string& text, Recording& recording) {
    // The file is in memory, because thousands of files would keep a disk busy.
    static const int file = memfd_create("test.scene", 0);
    static const std::string path = "/proc/self/fd/" + std::to_string(file);
    if (ftruncate(file, 0) != 0 || pwrite(file, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) std::abort();

    rt_scene_sink sink{};
    sink.struct_bytes = sizeof sink;
    sink.ctx = &recording;
    add_geometry_calls(sink);
    add_look_calls(sink);
    add_motion_calls(sink);
    const rt_host host = recording_host(recording);
    recording.status = rt_plugin_v1.importer->load(&host, path.c_str(), nullptr, &sink);

    show_as_test_scene(path, recording.why);
    for (std::string& line : recording.log) show_as_test_scene(path, line);
    for (std::string& line : recording.warnings) show_as_test_scene(path, line);
}

Recording import_text(const std::string& text) {
    Recording recording;
    import_text(text, recording);
    return recording;
}

std::string Recording::unsound() const {
    const auto bad_material = [&](rt_u32 id) { return id != RT_NONE && id >= materials.size(); };
    for (const auto& s : spheres) {
        if (!all_finite(s.center) || !(s.radius > 0) || !std::isfinite(s.radius) || bad_material(s.material)) return "sphere";
    }
    for (const auto& p : planes) {
        const double length = std::hypot(p.normal[0], p.normal[1], p.normal[2]);
        if (!(std::fabs(length - 1) < 1e-4) || !std::isfinite(p.offset) || bad_material(p.material)) return "plane";
    }
    for (const auto& p : polygons) {
        if (p.corners.size() < 9 || !all_finite(p.corners) || bad_material(p.material)) return "polygon";
    }
    for (const auto& m : meshes) {
        if (!all_finite(m.positions) || m.indices.size() != 3 * m.face_materials.size()) return "mesh";
        if (std::any_of(m.indices.begin(), m.indices.end(), [&](rt_u32 i) { return 3 * i >= m.positions.size(); }))
            return "index";
        if (std::any_of(m.face_materials.begin(), m.face_materials.end(), bad_material)) return "face material";
    }
    for (const auto& m : materials) {
        const rt_material& v = m.values;
        if (clarity::material_fault(v)) return "material keys";
        if (!all_finite(v.color) || !all_finite(v.emission) || !all_finite(v.specular)) return "material";
        if (!(v.reflect >= 0 && v.refract >= 0 && v.reflect + v.refract <= 1.0001f && v.ior > 0)) return "material shares";
        if (v.texture != RT_NONE && v.texture >= textures.size()) return "texture";
        for (const rt_map_desc& map : m.maps)
            if (!all_finite(map.matrix) || (map.texture != RT_NONE && map.texture >= textures.size())) return "map";
    }
    for (const auto& l : lights) {
        if (!all_finite(l.values.position) || !all_finite(l.values.direction) || !all_finite(l.values.color)) return "light";
        if (clarity::light_fault(l.light)) return "light keys";
    }
    for (const auto& c : cameras) {
        if (!all_finite(c.values.eye) || !all_finite(c.values.target) || !all_finite(c.values.up)) return "camera";
        if (!(c.values.fov_y_rad > 0 && c.values.fov_y_rad < 3.1415926f)) return "fov";
    }
    for (const auto& l : loads) {
        if (l.path.empty() || !all_finite(l.world_from_object) || bad_material(l.material)) return "load";
    }
    if (!all_finite(background) || !all_finite(ambient)) return "background or ambient";
    return {};
}
