#include "import/sink/scene_sink.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/numbers.hpp"
#include "import/sink/shape_parts.hpp"
#include "import/sink/texture.hpp"
#include "plugin/abi_struct.hpp"
#include "scene/bright_texture.hpp"
#include "scene/camera.hpp"
#include "scene/light_kinds.hpp"
#include "scene/map_uses.hpp"
#include "scene/material_keys.hpp"
#include "scene/sky_kinds.hpp"
#include "scene/usable.hpp"

namespace clarity::import {
namespace {

double squared_length(const float* v) {
    return double(v[0]) * v[0] + double(v[1]) * v[1] + double(v[2]) * v[2];
}

}  // namespace

std::string clean_name(const char* name) {
    std::string text;
    for (const char* c = name ? name : ""; *c && text.size() < 256; ++c) {
        text += static_cast<unsigned char>(*c) < 0x20 || *c == 0x7f ? ' ' : *c;
    }
    return text;
}

rt_u32 SceneSink::fail(const std::string& why, Failure failure) {
    services_.fail(why, failure);
    return kFailed;
}

bool SceneSink::scene_material(rt_u32 id, const char* of, rt_u32 if_none, rt_u32& material) {
    if (id != RT_NONE && id >= materials_.size()) {
        fail(std::string(of) + ": material id " + std::to_string(id) + " of " + std::to_string(materials_.size()) +
             " is unknown: pass an id that the sink returned");
        return false;
    }
    material = id == RT_NONE ? if_none : materials_[id];
    return true;
}

rt_u32 SceneSink::texture(const rt_texture_desc& d) {
    if (!d.path && !d.bytes) return fail("a texture has neither a path nor bytes");
    if (d.wrap_u > RT_WRAP_MIRROR || d.wrap_v > RT_WRAP_MIRROR)
        return fail("a texture has the wrap modes " + std::to_string(d.wrap_u) + " and " + std::to_string(d.wrap_v) +
                    ": expected RT_WRAP_ values");
    if (d.space > RT_SPACE_CLEARNESS || d.filter > RT_FILTER_NEAREST)
        return fail("a texture has the space " + std::to_string(d.space) + " and the filter " + std::to_string(d.filter) +
                    ": expected RT_SPACE_ and RT_FILTER_ values");
    const rt_u32 index = d.bytes ? builder_.texture_of_bytes(path_, d) : builder_.texture_of_file(path_, d);
    if (index == RT_NONE) return RT_NONE;
    name_texture(index, d);
    textures_.push_back(index);
    return static_cast<rt_u32>(textures_.size() - 1);
}

void SceneSink::name_texture(rt_u32 texture, const rt_texture_desc& d) {
    std::vector<std::string>& names = builder_.scene().texture_names;
    names.resize(builder_.scene().textures.size());
    if (!names[texture].empty()) return;
    const std::string path = d.path ? d.path : "";
    names[texture] = clean_name(d.name ? d.name : path.substr(path.find_last_of("/\\") + 1).c_str());
}

rt_u32 SceneSink::material(const rt_material_desc& d) {
    std::string problem;
    Material material;
    material.name = clean_name(d.name);
    material.values = material_of(d, problem);
    if (d.texture != RT_NONE && !scene_texture(d.texture, material, material.values.texture)) return kFailed;
    if (!take_maps(d, material, problem)) return kFailed;
    if (problem.empty()) problem = lost_light(material);
    if (!problem.empty()) builder_.warn(path_, "material '" + material.name + "' " + problem);
    Scene& scene = builder_.scene();
    materials_.push_back(static_cast<rt_u32>(scene.materials.size()));
    scene.materials.push_back(std::move(material));
    return static_cast<rt_u32>(materials_.size() - 1);
}

// What a material does not show of a colour that is a picture of floats.
std::string SceneSink::lost_light(const Material& material) {
    const Scene& scene = builder_.scene();
    const rt_u32 map = material.maps[RT_MAP_COLOR], number = map == RT_NONE ? material.values.texture : scene.maps[map].texture;
    if (number == RT_NONE || !is_bright(scene.textures[number])) return {};
    const rt_texture& texture = scene.textures[number];
    const uint32_t* const texels = scene.texels.data() + texture.first;
    const auto is_above_1 = [&](uint32_t texel) {
        const std::array<float, 3> light = bright_light(texture, texel);
        return std::max({light[0], light[1], light[2]}) > 1;
    };
    if (material.values.model != RT_MODEL_UNLIT &&
        std::any_of(texels, texels + size_t(texture.width) * texture.height, is_above_1))
        return "has a picture of its colour with light above 1, which counts as 1: a surface sends no more than it gets; as "
               "picture of the emission it is kept";
    if (material.values.alpha != RT_ALPHA_OPAQUE)
        return "has no alpha of the picture of its colour, which is one of floats: they have none here";
    return {};
}

bool SceneSink::scene_texture(rt_u32 id, const Material& material, rt_u32& texture) {
    if (id >= textures_.size()) {
        fail("material '" + material.name + "': texture id " + std::to_string(id) + " of " + std::to_string(textures_.size()) +
             " is unknown: pass an id that the sink returned");
        return false;
    }
    texture = textures_[id];
    return true;
}

// Uses that only a later host knows are left out.
bool SceneSink::take_maps(const rt_material_desc& d, Material& material, std::string& problem) {
    constexpr rt_u32 kLeast = 40;
    if (d.maps && d.map_count > 0 && (d.map_bytes < kLeast || d.map_bytes % 4 != 0)) {
        fail("material '" + material.name + "': map_bytes is " + std::to_string(d.map_bytes) +
             ": write sizeof(rt_map_desc) there");
        return false;
    }
    const auto* from = reinterpret_cast<const char*>(d.maps);
    for (rt_u32 i = 0; d.maps && i < d.map_count; ++i, from += d.map_bytes) {
        const auto desc = copied<rt_map_desc>(from, d.map_bytes);
        if (desc.texture == RT_NONE || desc.use >= RT_MAP_USES) continue;
        rt_map map{};
        if (!scene_texture(desc.texture, material, map.texture)) return false;
        if (desc.set > 1) {
            fail("material '" + material.name + "': the set of texture coordinates " + std::to_string(desc.set) +
                 " is unknown: expected 0 or 1");
            return false;
        }
        const std::array<float, 6> identity = {1, 0, 0, 0, 1, 0};
        std::array<float, 6> matrix{};
        std::copy_n(desc.matrix, 6, matrix.begin());
        if (matrix == std::array<float, 6>{}) matrix = identity;
        map.set = desc.set;
        map.scale = desc.scale;
        if (!are_usable(matrix) || !is_usable(map.scale)) {
            problem = "places a texture by numbers that are not finite; the texture lies as the coordinates say";
            matrix = identity;
            map.scale = is_usable(map.scale) ? map.scale : 1;
        }
        std::copy(matrix.begin(), matrix.end(), map.matrix);
        const bool is_plain = desc.use == RT_MAP_COLOR && map.set == 0 && matrix == identity;
        if (desc.use == RT_MAP_COLOR) material.values.texture = is_plain ? map.texture : RT_NONE;
        if (is_plain) continue;
        material.maps[desc.use] = static_cast<rt_u32>(builder_.scene().maps.size());
        builder_.scene().maps.push_back(map);
    }
    return true;
}

rt_u32 SceneSink::mesh(const rt_mesh& d) {
    Scene& scene = builder_.scene();
    if (const Problem why = copy_mesh(d, materials_, scene, builder_.triangulator(), faces_))
        return fail("mesh '" + clean_name(d.name) + "': " + why.text());
    scene.meshes.back().name = clean_name(d.name);
    if (!are_usable(d.origin)) return fail("mesh '" + clean_name(d.name) + "': its origin is not a finite number");
    origins_.push_back({d.origin[0], d.origin[1], d.origin[2]});
    content_.has_mesh_origins |= origins_.back() != Vec{};
    meshes_.push_back(static_cast<rt_u32>(scene.meshes.size() - 1));
    return static_cast<rt_u32>(meshes_.size() - 1);
}

rt_u32 SceneSink::instance(const rt_instance_desc& d) {
    Instance instance;
    instance.name = clean_name(d.name);
    if (d.mesh >= meshes_.size()) {
        return fail("instance '" + instance.name + "': mesh id " + std::to_string(d.mesh) + " of " +
                    std::to_string(meshes_.size()) + " is unknown: pass an id that the sink returned");
    }
    if (!scene_material(d.material, "instance", RT_NONE, instance.material)) return kFailed;
    instance.mesh = instance.moving_mesh = meshes_[d.mesh];
    std::copy(std::begin(d.world_from_object), std::end(d.world_from_object), instance.world_from_object.begin());
    Matrix placed = to_matrix(instance.world_from_object);
    for (int k = 0; d.translation && k < 3; ++k) placed[4 * k + 3] = d.translation[k];
    const Vec at = point(placed, origins_[d.mesh]);  // the mesh's positions count from its origin
    for (int k = 0; k < 3; ++k) placed[4 * k + 3] = at[k];
    instance.node = motion_.node_of(d.node, "instance");
    if (instance.node != RT_NONE) {
        const PlacedNode& node = motion_.at_rest(instance.node);
        instance.node_from_object = to_affine(placed);
        placed = node.world * placed;
        instance.visible = node.visible;
    }
    instance.world_from_object = to_affine(placed);
    for (int k = 0; k < 3; ++k) instance.rounded_off[k] = placed[4 * k + 3] - double(instance.world_from_object[4 * k + 3]);
    const rt_u32 id = static_cast<rt_u32>(content_.instances.size() + lost_instances_);
    if (are_usable(d.world_from_object) && are_usable(instance.world_from_object.data(), 12)) {
        content_.instances.push_back(std::move(instance));
    } else {
        ++lost_instances_;
    }
    return id;
}

rt_u32 SceneSink::sphere(const float* center, float radius, rt_u32 material) {
    Sphere sphere;
    if (!are_usable(center, 3) || !is_usable(radius) || !(radius > 0)) {
        return fail("sphere " + std::to_string(content_.spheres.size()) + ": needs a finite centre and a radius above 0");
    }
    if (!scene_material(material, "sphere", 0, sphere.material)) return kFailed;
    std::copy(center, center + 3, sphere.center.begin());
    sphere.radius = radius;
    content_.spheres.push_back(sphere);
    return static_cast<rt_u32>(content_.spheres.size() - 1);
}

rt_u32 SceneSink::plane(const float* normal, float offset, rt_u32 material) {
    Plane plane;
    const double length = are_usable(normal, 3) ? std::sqrt(squared_length(normal)) : 0;
    if (!(length > 0) || !is_usable(offset) || !is_usable(static_cast<float>(offset / length))) {
        return fail("plane " + std::to_string(content_.planes.size()) +
                    ": needs a finite normal that is not zero, and an offset");
    }
    if (!scene_material(material, "plane", 0, plane.material)) return kFailed;
    for (int i = 0; i < 3; ++i) plane.normal[i] = static_cast<float>(normal[i] / length);
    // The plane dot(normal, x) = offset keeps its points if both sides are divided by the length.
    plane.offset = static_cast<float>(offset / length);
    content_.planes.push_back(plane);
    return static_cast<rt_u32>(content_.planes.size() - 1);
}

rt_u32 SceneSink::polygon(const float* corners, rt_u32 corner_count, rt_u32 material) {
    const std::string what = "polygon " + std::to_string(content_.polygons.size());
    FileContent::PolygonCorners polygon;
    if (corner_count < 3) return fail(what + ": " + std::to_string(corner_count) + " corners, expected at least 3");
    if (corner_count > 1u << 24)
        return fail(what + ": " + std::to_string(corner_count) + " corners are more than a polygon can have");
    if (!are_usable(corners, 3 * size_t(corner_count))) return fail(what + ": a corner is not a finite number");
    if (!scene_material(material, what.c_str(), 0, polygon.material)) return kFailed;
    polygon.corners.assign(corners, corners + 3 * size_t(corner_count));
    content_.polygons.push_back(std::move(polygon));
    return static_cast<rt_u32>(content_.polygons.size() - 1);
}

rt_u32 SceneSink::light(const rt_light_desc& d) {
    Light light;
    light.name = clean_name(d.name);
    if (d.kind >= RT_LIGHT_KINDS) return fail("light '" + light.name + "': kind " + std::to_string(d.kind) + " is unknown");
    std::string problem;
    bool good = light_of(d, light.at_node, problem);
    if (!problem.empty()) builder_.warn(path_, "light '" + light.name + "' " + problem);
    light.node = motion_.node_of(d.node, "light");
    light.values = light.at_node;
    good = good && move_light(light.values, light.node == RT_NONE ? kIdentityMatrix : motion_.at_rest(light.node).world);
    light_sources_.push_back(good ? builder_.next_source() : RT_NONE);
    light.source = light_sources_.back();
    if (good) {
        content_.lights.push_back(std::move(light));
    } else {
        ++lost_views_;
    }
    return static_cast<rt_u32>(light_sources_.size() - 1);
}

rt_u32 SceneSink::camera(const rt_camera& d) {
    Camera camera;
    camera.name = clean_name(d.name);
    std::copy(d.eye, d.eye + 3, camera.eye.begin());
    std::copy(d.target, d.target + 3, camera.target.begin());
    std::copy(d.up, d.up + 3, camera.up.begin());
    camera.fov_y_rad = d.fov_y_rad;
    const auto length = [](float x) { return is_usable(x) && x > 0 ? x : 0; };
    camera.aperture = length(d.aperture);
    camera.focus = length(d.focus);
    camera.node = motion_.node_of(d.node, "camera");
    camera.node_eye = camera.eye;
    camera.node_target = camera.target;
    camera.node_up = camera.up;
    if (camera.node != RT_NONE) camera = moved_by(camera, motion_.at_rest(camera.node).world);
    const bool good = make_sound(camera);
    camera_sources_.push_back(good ? builder_.next_source() : RT_NONE);
    camera.source = camera_sources_.back();
    if (good) {
        content_.cameras.push_back(std::move(camera));
    } else {
        ++lost_views_;
    }
    return static_cast<rt_u32>(camera_sources_.size() - 1);
}

void SceneSink::info(const rt_scene_info& d) {
    builder_.set_info(path_, d);
}

int32_t SceneSink::load(const rt_load& d) {
    if (!d.path) {
        fail("a load has no path");
        return RT_FAILED;
    }
    Placement placement;
    placement.name = clean_name(d.name);
    if (!are_usable(d.world_from_object)) {
        fail("load '" + clean_name(d.path) + "': its transform is not finite");
        return RT_FAILED;
    }
    std::copy(std::begin(d.world_from_object), std::end(d.world_from_object), placement.world_from_object.begin());
    if (!scene_material(d.material, "load", RT_NONE, placement.material)) return RT_FAILED;
    placement.node = motion_.node_of(d.node, "load");
    if (placement.node != RT_NONE) {
        placement.node_from_object = placement.world_from_object;
        placement.world_from_object = to_affine(motion_.at_rest(placement.node).world * to_matrix(placement.node_from_object));
    }
    const Problem why = builder_.include(path_, d.path, placement, content_);
    if (!why) return RT_OK;
    fail((d.where ? std::string(d.where) + ": " : "") + why.text(), why.failure());
    return RT_FAILED;
}

rt_u32 SceneSink::primitive(const rt_primitive_desc& d) {
    const std::string kind = clean_name(d.kind), speaker = (d.where ? std::string(d.where) + ": " : "") + kind;
    const rt_plugin* plugin = builder_.plugins().primitive(kind);
    if (!plugin) return fail(speaker + ": no plugin of this kind of shapes is loaded; `clarity plugins` lists those that are");
    Shape shape;
    if (!scene_material(d.material, speaker.c_str(), 0, shape.material)) return kFailed;
    shape.kind = builder_.shape_kind(kind);
    add_shape_parts(*plugin->primitive, d, speaker, builder_.progress(), builder_.scene(), shape);
    content_.shapes.push_back(shape);
    return static_cast<rt_u32>(content_.shapes.size() - 1);
}

int32_t SceneSink::edit(const char* key, const char* value, const char* where) {
    SceneEdit edit = {clean_name(key), clean_name(value), clean_name(where)};
    rt_u32 number = 0, id = 0;
    if (edit_number(edit.key, number) == EditOf::nothing) {
        fail((edit.where.empty() ? "" : edit.where + ": ") + "no edit `" + edit.key +
             "`; there are instance.N, material.N, light.N, sky");
        return RT_FAILED;
    }
    if (find_map_use(edit.key.substr(edit.key.find_last_of('.') + 1)) != RT_NONE && edit.value.rfind("#", 0) == 0 &&
        read_number(edit.value.substr(1), id)) {
        if (id >= textures_.size()) {
            fail(edit.where + ": `" + edit.key + "`: texture id " + edit.value.substr(1) +
                 " is unknown: pass an id that the sink returned");
            return RT_FAILED;
        }
        edit.value = std::to_string(textures_[id]);
    }
    content_.edits.push_back(std::move(edit));
    return RT_OK;
}

int32_t SceneSink::sky(const rt_sky_desc& d) {
    const Problem why = builder_.set_sky(path_, d);
    if (!why) return RT_OK;
    fail("the sky: " + why.text());
    return RT_FAILED;
}

Problem SceneSink::finish() {
    const uint64_t lost = faces_.not_finite + faces_.out_of_range;
    const std::string of_all = " of " + std::to_string(faces_.all) + " faces have corners that ";
    const std::string not_finite = std::to_string(faces_.not_finite) + of_all + "are not finite numbers";
    const std::string out_of_range = std::to_string(faces_.out_of_range) + of_all + "name vertices which do not exist";
    std::string what = faces_.not_finite > 0 ? not_finite : "";
    if (faces_.out_of_range > 0) what += (what.empty() ? "" : ", ") + out_of_range;
    if (lost > 0 && lost == faces_.all) return "nothing of it can be used: " + what;
    if (lost > 0) builder_.warn(path_, what + (lost == 1 ? " and was left out" : " and were left out"));
    if (lost_instances_ > 0 && content_.instances.empty()) return "the transforms of all its objects are not finite numbers";
    if (lost_instances_ > 0) {
        builder_.warn(path_, std::to_string(lost_instances_) + " of " +
                                 std::to_string(lost_instances_ + content_.instances.size()) +
                                 " objects have a transform that is not finite and were left out");
    }
    for (const Skin& skin : content_.skins)
        for (const Instance& instance : content_.instances)
            if (instance.mesh == skin.mesh && instance.node == RT_NONE)
                return "the plugin has placed a mesh with a skin without a node: set rt_instance_desc::node";
    for (const std::string& loss : motion_.losses()) builder_.warn(path_, loss);
    if (lost_views_ > 0) {
        builder_.warn(path_, std::to_string(lost_views_) + " cameras or lights hold no finite numbers and were left out");
    }
    return {};
}

}  // namespace clarity::import
