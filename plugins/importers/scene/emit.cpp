#include "emit.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "../common/materials.hpp"
#include "../common/numbers.hpp"
#include "emit_motion.hpp"
#include "rt_plugin.hpp"
#include "shapes.hpp"
#include "textures.hpp"

namespace scene_format {
namespace {

template <class T>
T sized() {
    T value{};
    value.struct_bytes = sizeof(T);
    return value;
}

const char* name_or_null(const std::string& name) {
    return name.empty() ? nullptr : name.c_str();
}

class Emitter {
 public:
    Emitter(const Document& document, std::string_view file, const rt_scene_sink& sink)
        : document_(document), file_(file), sink_(sink), motion_(document, sink) {}

    void info() const;
    bool motion() { return motion_.emit(); }
    bool materials();
    bool lights_and_cameras();
    bool sky();
    bool edits();
    // Emits one item, or a run of consecutive triangles as one mesh. Moves `at` behind them.
    bool item(size_t& at);
    Position position() const { return position_; }

 private:
    rt_u32 material(const Name& use) const { return use.text.empty() ? RT_NONE : material_ids_.at(use.text); }
    rt_u32 texture(const Texture& texture, rt_u32 space);
    const Texture* texture_named(const std::string& name) const;  // nullptr: no statement has this name
    rt_u32 space_of(const Texture& texture, rt_u32 use) const;
    std::vector<rt_map_desc> maps_of(const Material& material);
    bool triangles(size_t first, size_t count);
    bool shape(const Shape& shape);
    bool load(const Load& load);
    std::string where() const { return file_ + ":" + std::to_string(position_.line) + ":" + std::to_string(position_.column); }

    const Document& document_;
    const std::string file_;
    const rt_scene_sink& sink_;
    MotionEmitter motion_;
    std::unordered_map<std::string, rt_u32> material_ids_;
    // By path, wrap modes, space, filter and name.
    std::map<std::tuple<std::string, rt_u32, rt_u32, rt_u32, rt_u32, std::string>, rt_u32> texture_ids_;
    Position position_;  // of the statement that is emitted; used when the sink refuses it
};

void Emitter::info() const {
    auto info = sized<rt_scene_info>();
    info.up_axis = 1;
    if (document_.background_position.line != 0) info.background = document_.background.data();
    if (document_.ambient_position.line != 0) info.ambient = document_.ambient.data();
    sink_.info(sink_.ctx, &info);
}

rt_u32 Emitter::texture(const Texture& texture, rt_u32 space) {
    const auto [known, is_new] = texture_ids_.insert(
        {{texture.path, texture.wrap_u, texture.wrap_v, space, texture.filter, texture.name.text}, RT_NONE});
    if (is_new) {
        auto desc = sized<rt_texture_desc>();
        desc.path = texture.path.c_str();
        desc.wrap_u = texture.wrap_u;
        desc.wrap_v = texture.wrap_v;
        desc.space = space;
        desc.filter = texture.filter;
        desc.name = name_or_null(texture.name.text);
        known->second = sink_.texture(sink_.ctx, &desc);  // RT_NONE: the host has already warned
    }
    return known->second;
}

const Texture* Emitter::texture_named(const std::string& name) const {
    const auto named = std::find_if(document_.textures.begin(), document_.textures.end(),
                                    [&](const Texture& texture) { return texture.name.text == name; });
    return named == document_.textures.end() ? nullptr : &*named;
}

rt_u32 Emitter::space_of(const Texture& texture, rt_u32 use) const {
    return texture.space != RT_NONE ? texture.space : static_cast<rt_u32>(key_of(*document_.kinds.maps, use).def[0]);
}

std::vector<rt_map_desc> Emitter::maps_of(const Material& material) {
    std::vector<rt_map_desc> maps;
    for (const auto& [use, name] : material.maps) {
        const Texture& named = *texture_named(name.text);
        maps.push_back(map_of(named, use, texture(named, space_of(named, use))));
    }
    return maps;
}

bool Emitter::materials() {
    for (const Material& material : document_.materials) {
        position_ = material.name.position;
        rt_material_desc desc = rt::material(material.name.text.c_str());
        desc.values = material.looks.data();
        desc.value_count = static_cast<rt_u32>(material.looks.size());
        if (!material.texture.empty()) {
            Texture unnamed;
            unnamed.path = material.texture;
            unnamed.wrap_u = material.wrap_u;
            unnamed.wrap_v = material.wrap_v;
            desc.texture = texture(unnamed, RT_SPACE_SRGB);
        }
        const std::vector<rt_map_desc> maps = maps_of(material);
        importers::give_maps(maps, desc);
        const rt_u32 id = sink_.material(sink_.ctx, &desc);
        if (id == RT_NONE) return false;
        material_ids_.emplace(material.name.text, id);
    }
    return true;
}

bool Emitter::lights_and_cameras() {
    for (const Light& light : document_.lights) {
        rt_light_desc desc = light.values;
        desc.struct_bytes = sizeof desc;
        desc.name = name_or_null(light.name.text);
        desc.values = light.looks.data();
        desc.value_count = static_cast<rt_u32>(light.looks.size());
        if (const rt_u32 node = motion_.node_of_light(light)) {
            desc.node = node;
            for (float& x : desc.position) x = 0;  // the node is there
        }
        if (sink_.light(sink_.ctx, &desc) == RT_NONE) return false;
    }
    constexpr float rad_per_deg = float(importers::kPi) / 180.0f;
    for (const Camera& camera : document_.cameras) {
        position_ = camera.name.position;
        auto desc = sized<rt_camera>();
        desc.name = camera.name.text.c_str();
        std::copy(camera.eye.begin(), camera.eye.end(), desc.eye);
        std::copy(camera.target.begin(), camera.target.end(), desc.target);
        std::copy(camera.up.begin(), camera.up.end(), desc.up);
        desc.fov_y_rad = camera.fov_deg * rad_per_deg;
        desc.aperture = camera.aperture;
        desc.focus = camera.focus;
        desc.node = motion_.node_of_camera(camera);
        for (int i = 0; desc.node != 0 && i < 3; ++i) {
            desc.target[i] -= desc.eye[i];
            desc.eye[i] = 0;  // the node is there
        }
        const rt_u32 id = sink_.camera(sink_.ctx, &desc);
        if (id == RT_NONE || !motion_.emit_fov(camera, id)) return false;
    }
    return true;
}

bool Emitter::sky() {
    if (document_.sky.position.line == 0) return true;
    position_ = document_.sky.position;
    rt_sky_desc desc = document_.sky.values;
    desc.struct_bytes = sizeof desc;
    desc.path = desc.kind == RT_SKY_PICTURE ? document_.sky.path.c_str() : nullptr;
    return sink_.sky(sink_.ctx, &desc) == RT_OK;
}

bool Emitter::edits() {
    for (const Edit& edit : document_.edits) {
        position_ = edit.position;
        if (!RT_HAS(&sink_, rt_scene_sink, edit)) {
            sink_.warn(sink_.ctx, (where() + ": this host cannot make edits").c_str());
            return true;
        }
        std::string value = edit.value;
        if (const Texture* named = edit.use == RT_NONE ? nullptr : texture_named(edit.value)) {
            const rt_u32 id = texture(*named, space_of(*named, edit.use));
            if (id == RT_NONE) continue;
            value = "#" + std::to_string(id);
        }
        if (sink_.edit(sink_.ctx, edit.key.c_str(), value.c_str(), where().c_str()) != RT_OK) return false;
    }
    return true;
}

bool Emitter::triangles(size_t first, size_t count) {
    std::vector<float> corners;
    std::vector<rt_u32> indices, face_materials;
    for (size_t i = first; i < first + count; ++i) {
        const Triangle& triangle = document_.triangles[i];
        corners.insert(corners.end(), triangle.corners.begin(), triangle.corners.end());
        for (int corner = 0; corner < 3; ++corner) indices.push_back(static_cast<rt_u32>(indices.size()));
        face_materials.push_back(material(triangle.material));
    }
    auto mesh = sized<rt_mesh>();
    mesh.name = "triangles";
    mesh.positions = corners.data();
    mesh.vertex_count = static_cast<rt_u32>(indices.size());
    mesh.position_stride = 3 * sizeof(float);
    mesh.indices = indices.data();
    mesh.index_count = indices.size();
    mesh.face_count = count;
    mesh.face_materials = face_materials.data();
    mesh.material = RT_NONE;
    auto instance = sized<rt_instance_desc>();
    instance.mesh = sink_.mesh(sink_.ctx, &mesh);
    if (instance.mesh == RT_NONE) return false;
    instance.material = RT_NONE;
    for (int i = 0; i < 3; ++i) instance.world_from_object[5 * i] = 1;
    return sink_.instance(sink_.ctx, &instance) != RT_NONE;
}

bool Emitter::shape(const Shape& shape) {
    std::vector<rt_key_values> values;
    for (const Shape::Values& v : shape.values)
        values.push_back({v.numbers.data(), static_cast<rt_u32>(v.numbers.size()), v.given ? 1u : 0u});
    auto desc = sized<rt_primitive_desc>();
    desc.kind = shape.kind.c_str();
    desc.values = values.data();
    desc.value_count = static_cast<rt_u32>(values.size());
    desc.material = material(shape.material);
    const std::string place = where();
    desc.where = place.c_str();
    return sink_.primitive(sink_.ctx, &desc) != RT_NONE;
}

bool Emitter::load(const Load& load) {
    position_ = load.position;
    auto desc = sized<rt_load>();
    desc.path = load.path.c_str();
    desc.name = name_or_null(load.name.text);
    desc.node = motion_.node_of_load(load);
    const StatedTransform placement = desc.node == 0 ? load.placement : StatedTransform();  // else the node has it
    const std::array<float, 12> placed = placement.world_from_object();
    std::copy(placed.begin(), placed.end(), desc.world_from_object);
    desc.material = material(load.material);
    const std::string place = where();
    desc.where = place.c_str();
    return sink_.load(sink_.ctx, &desc) == RT_OK;
}

bool Emitter::item(size_t& at) {
    const Item& item = document_.items[at++];
    position_ = item.position;
    switch (item.kind) {
        case ItemKind::sphere: {
            const Sphere& sphere = document_.spheres[item.index];
            return sink_.sphere(sink_.ctx, sphere.center.data(), sphere.radius, material(sphere.material)) != RT_NONE;
        }
        case ItemKind::plane: {
            const Plane& plane = document_.planes[item.index];
            return sink_.plane(sink_.ctx, plane.normal.data(), plane.offset, material(plane.material)) != RT_NONE;
        }
        case ItemKind::polygon: {
            const Polygon& polygon = document_.polygons[item.index];
            return sink_.polygon(sink_.ctx, polygon.corners.data(), static_cast<rt_u32>(polygon.corners.size() / 3),
                                 material(polygon.material)) != RT_NONE;
        }
        case ItemKind::triangle: {
            const size_t first = at - 1;
            while (at < document_.items.size() && document_.items[at].kind == ItemKind::triangle) ++at;
            return triangles(item.index, at - first);
        }
        case ItemKind::shape:
            return shape(document_.shapes[item.index]);
        case ItemKind::load:
            return load(document_.loads[item.index]);
    }
    return false;
}

}  // namespace

int32_t emit(const Document& document, std::string_view file, const rt_host& host, const rt_scene_sink& sink) {
    Emitter emitter(document, file, sink);
    emitter.info();
    bool ok = emitter.motion() && emitter.materials() && emitter.lights_and_cameras() && emitter.sky(), names_place = false;
    constexpr size_t items_between_reports = 1024;
    for (size_t at = 0, reported = 0; ok && at < document.items.size();) {
        const ItemKind kind = document.items[at].kind;
        names_place = kind == ItemKind::load || kind == ItemKind::shape;
        if (kind == ItemKind::load || at >= reported) {
            const float fraction = 0.5f + 0.5f * static_cast<float>(at) / static_cast<float>(document.items.size());
            if (host.progress(host.ctx, fraction) == 0) return RT_CANCELLED;
            reported = at + items_between_reports;
        }
        ok = emitter.item(at);
    }
    ok = ok && emitter.edits();
    if (ok) return RT_OK;
    if (!names_place) {  // otherwise the error does already
        const std::string where = located(file, {emitter.position(), "the import stopped at this statement"});
        host.log(host.ctx, RT_LOG_WARNING, where.c_str());
    }
    return RT_FAILED;
}

}  // namespace scene_format
