#include "import/scene_builder.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/error.hpp"
#include "base/read_file.hpp"
#include "import/mesh_copy.hpp"
#include "import/scene_sink.hpp"
#include "import/texture.hpp"
#include "plugin/host_services.hpp"
#include "plugin/parameters.hpp"

namespace clarity::import {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxDepth = 16;
// Bounds the number of placed objects: a few files that each load another one twice could place more than any machine can hold.
constexpr uint64_t kMaxPlaced = 1u << 22;
constexpr size_t kMaxWarnings = 100;

std::string file_name(const std::string& path) {
    return fs::path(path).filename().string();
}

[[noreturn]] void fail(const std::string& path, const std::string& why) {
    throw Error(Exit::import_failed, path + ": " + why);
}

std::string known_extensions(const PluginRegistry& plugins) {
    std::set<std::string> known;
    for (const rt_plugin* plugin : plugins.importers()) {
        for (const char* const* e = plugin->importer->extensions; *e; ++e) known.insert(*e);
    }
    std::string list;
    for (const std::string& extension : known) list += (list.empty() ? "" : ", ") + extension;
    return list;
}

// The message without the prefix "PATH: ". A plugin may have written it itself, to add line and column.
std::string without_path(const std::string& why, const std::string& path) {
    return why.compare(0, path.size() + 2, path + ": ") == 0 ? why.substr(path.size() + 2) : why;
}

}  // namespace

SceneBuilder::SceneBuilder(const PluginRegistry& plugins, ImporterParameters parameters, const FileAccess& access,
                           Progress& progress, ImportObserver* observer)
    : plugins_(plugins), parameters_(std::move(parameters)), access_(access), progress_(progress), observer_(observer) {
    scene_.materials.push_back({"default", default_material()});
}

void SceneBuilder::warn(const std::string& file, const std::string& text) {
    if (scene_.warnings.size() >= kMaxWarnings) {
        ++warnings_left_out_;
        return;
    }
    const bool named = text.compare(0, file.size() + 1, file + ":") == 0;
    scene_.warnings.push_back(named ? text : file + ": " + text);
}

void SceneBuilder::add_root(const std::string& path) {
    std::error_code error;
    const fs::path canonical = fs::canonical(path, error);
    if (error) fail(path, "cannot be read: " + error.message());
    const FileContent& content = content_of(path, canonical.string());
    place(path, content, {}, world_);
    const bool hollow = std::all_of(content.instances.begin(), content.instances.end(),
                                    [&](const Instance& i) { return scene_.meshes[i.mesh].triangle_count == 0; });
    if (hollow && content.spheres.empty() && content.planes.empty() && content.polygons.empty() && content.shapes.empty()) {
        warn(path, "holds no surface that could be rendered");
    }
}

void SceneBuilder::set_info(const rt_scene_info& info) {
    if (open_.size() != 1) return;
    const auto take_color = [](const float* from, std::array<float, 3>& to, bool& known) {
        if (!from || known || !std::all_of(from, from + 3, is_usable)) return;
        std::copy(from, from + 3, to.begin());
        known = true;
    };
    take_color(info.background, scene_.background, knows_background_);
    take_color(info.ambient, scene_.ambient, knows_ambient_);
    if (knows_axes_) return;
    knows_axes_ = true;
    scene_.up_axis = info.up_axis <= 2 ? info.up_axis : 1;
    scene_.unit_scale = std::isfinite(info.unit_scale) && info.unit_scale > 0 ? info.unit_scale : 0;
}

// Returns the content of a file and runs its importer on first use. The sink's `load` calls this recursively.
const FileContent& SceneBuilder::content_of(const std::string& path, const std::string& canonical) {
    const auto known = files_.find(canonical);
    if (known != files_.end()) return *known->second;
    const rt_plugin* plugin = plugins_.importer_for(path);
    if (!plugin) {
        const std::string list = known_extensions(plugins_);
        fail(path, list.empty()
                       ? "no importers are loaded; `clarity plugins` lists the libraries seen and why they were refused"
                       : "no importer reads this kind of file; the known ones are " + list);
    }
    const std::string stage = "importing " + file_name(path);
    progress_.stage(stage);
    if (observer_) observer_->running(path, plugin->id);
    open_.push_back(canonical);
    auto content = std::make_unique<FileContent>();
    HostServices services(path, progress_);
    SceneSink sink(*this, services, path, *content);
    try {
        const auto chosen = parameters_.find(plugin->id);
        const ParameterValues parameters = chosen != parameters_.end() ? chosen->second : default_parameters(*plugin);
        services.check(static_cast<int>(Exit::import_failed),
                       [&] { return plugin->importer->load(services.host(), path.c_str(), parameters.data(), sink.sink()); });
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        if (sink.cancelled()) throw Cancelled();
        const std::string why = without_path(without_path(e.what(), path), path);
        // "main.scene:3:9: ..." contains the file's name already.
        if (why.compare(0, path.size() + 1, path + ":") == 0) throw Error(Exit::import_failed, why);
        fail(path, why);
    }
    const std::string why = sink.finish();
    if (!why.empty()) fail(path, why);
    open_.pop_back();
    if (!open_.empty()) progress_.stage("importing " + file_name(open_.back()));
    return *(files_[canonical] = std::move(content));
}

std::string SceneBuilder::include(const std::string& from, const std::string& path, const Placement& placement,
                                  FileContent& into) {
    const std::string what = "cannot load '" + path + "': ";
    const FileAccess::Found found = access_.find(from, path);
    if (found.path.empty()) return what + found.why;
    if (std::find(open_.begin(), open_.end(), found.path) != open_.end()) {
        std::string cycle;
        for (auto it = std::find(open_.begin(), open_.end(), found.path); it != open_.end(); ++it)
            cycle += file_name(*it) + " -> ";
        return what + "files load each other in a circle: " + cycle + file_name(found.path);
    }
    if (open_.size() >= kMaxDepth) return what + "files load each other more than " + std::to_string(kMaxDepth) + " deep";
    // Show the path as the author wrote it: the file's own relative paths start there. If a search path was needed, show the
    // path that was found.
    const fs::path beside = fs::path(from).parent_path() / path;
    std::error_code error;
    const std::string shown = fs::equivalent(beside, found.path, error) ? beside.string() : found.path;
    const size_t depth = open_.size();
    try {
        check_model_file(shown);
        const FileContent& content = content_of(shown, found.path);
        placed_ += content.instances.size() + content.spheres.size() + content.planes.size() + content.polygons.size();
        for (const Shape& shape : content.shapes) placed_ += shape.part_count;
        if (placed_ > kMaxPlaced)
            return what + "more than " + std::to_string(kMaxPlaced) + " objects of loaded files are placed";
        place(shown, content, placement, into);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        open_.resize(depth);
        return what + without_path(e.what(), shown);
    }
    return {};
}

rt_u32 SceneBuilder::shape_kind(const std::string& id) {
    std::vector<ShapeKind>& kinds = scene_.shape_kinds;
    for (size_t i = 0; i < kinds.size(); ++i)
        if (kinds[i].id == id) return static_cast<rt_u32>(i);
    kinds.push_back({id, nullptr});
    return static_cast<rt_u32>(kinds.size() - 1);
}

rt_u32 SceneBuilder::texture_of_file(const std::string& from, const std::string& path) {
    const FileAccess::Found found = access_.find_texture(from, path);
    const auto missing = [&](const std::string& why) {
        warn(from, "texture '" + path + "': " + why + "; the material stays without it");
        return RT_NONE;
    };
    if (found.path.empty()) return missing(found.why);
    const auto known = textures_.find(found.path);
    if (known != textures_.end()) return known->second;
    std::string bytes;
    rt_texture texture{};
    std::string why = try_read_file(found.path, kMaxTexelBytes, bytes);
    if (why.empty()) why = decode_texture(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), scene_.texels, texture);
    const rt_u32 id = why.empty() ? static_cast<rt_u32>(scene_.textures.size()) : RT_NONE;
    if (why.empty()) scene_.textures.push_back(texture);
    textures_[found.path] = id;
    return why.empty() ? id : missing(why);
}

namespace {

// The geometric mean of the scale factors along the three axes. uniform: they are equal.
float mean_scale(const Affine& m, bool& uniform) {
    double lengths[3];
    for (int j = 0; j < 3; ++j) {
        lengths[j] = std::sqrt(double(m[j]) * m[j] + double(m[4 + j]) * m[4 + j] + double(m[8 + j]) * m[8 + j]);
    }
    const double scale = std::cbrt(lengths[0] * lengths[1] * lengths[2]);
    uniform = std::abs(lengths[0] - lengths[1]) <= 1e-4 * scale && std::abs(lengths[1] - lengths[2]) <= 1e-4 * scale;
    return static_cast<float>(scale);
}

std::array<float, 3> transform_direction(const Affine& m, const float* d) {
    return {m[0] * d[0] + m[1] * d[1] + m[2] * d[2], m[4] * d[0] + m[5] * d[1] + m[6] * d[2],
            m[8] * d[0] + m[9] * d[1] + m[10] * d[2]};
}

bool normalize(std::array<float, 3>& v) {
    const double length = std::sqrt(double(v[0]) * v[0] + double(v[1]) * v[1] + double(v[2]) * v[2]);
    if (!(length > 0) || !std::isfinite(length)) return false;
    for (float& x : v) x = static_cast<float>(x / length);
    return true;
}

template <class Array>
bool usable(const Array& values) {
    return std::all_of(std::begin(values), std::end(values), is_usable);
}

}  // namespace

void SceneBuilder::place(const std::string& from, const FileContent& content, const Placement& placement, FileContent& into) {
    const Affine& m = placement.world_from_object;
    const auto material_of = [&](rt_u32 own) { return placement.material == RT_NONE ? own : placement.material; };
    const auto name_of = [&](const std::string& own, bool alone) {
        if (placement.name.empty()) return own;
        return alone || own.empty() ? placement.name : placement.name + "/" + own;
    };
    size_t lost = 0;
    for (const Instance& own : content.instances) {
        Instance instance = own;
        instance.name = name_of(own.name, content.instances.size() == 1);
        instance.material = material_of(own.material);
        instance.world_from_object = multiply(m, own.world_from_object);
        if (usable(instance.world_from_object)) {
            into.instances.push_back(std::move(instance));
        } else {
            ++lost;
        }
    }
    for (const Sphere& own : content.spheres) {
        bool uniform = true;
        const float scale = mean_scale(m, uniform);
        Sphere sphere = {transform_point(m, own.center.data()), own.radius * scale, material_of(own.material)};
        if (!uniform) warn(from, "a sphere is scaled differently along its axes; it stays a sphere, of the mean radius");
        if (usable(sphere.center) && is_usable(sphere.radius) && sphere.radius > 0) {
            into.spheres.push_back(sphere);
        } else {
            ++lost;
        }
    }
    Affine inverse;
    const bool invertible = invert(m, inverse);
    for (const Plane& own : content.planes) {
        // dot(n, x) = d with x = M^-1 y, so the normal is transformed by the inverse transpose.
        Plane plane = own;
        plane.material = material_of(own.material);
        float offset = own.offset;
        std::array<float, 3> normal{};
        for (int j = 0; j < 3 && invertible; ++j) {
            for (int i = 0; i < 3; ++i) normal[j] += own.normal[i] * inverse[4 * i + j];
            offset -= own.normal[j] * inverse[4 * j + 3];
        }
        const float length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        plane.normal = normal;
        plane.offset = offset / length;
        if (normalize(plane.normal) && is_usable(plane.offset)) {
            into.planes.push_back(plane);
        } else {
            ++lost;
        }
    }
    for (const FileContent::PolygonCorners& own : content.polygons) {
        FileContent::PolygonCorners polygon = {own.corners, material_of(own.material)};
        for (size_t i = 0; i < polygon.corners.size(); i += 3) {
            const std::array<float, 3> p = transform_point(m, &own.corners[i]);
            std::copy(p.begin(), p.end(), polygon.corners.begin() + static_cast<std::ptrdiff_t>(i));
        }
        if (usable(polygon.corners) && invertible) {
            into.polygons.push_back(std::move(polygon));
        } else {
            ++lost;
        }
    }
    for (Shape shape : content.shapes) {
        shape.material = material_of(shape.material);
        shape.world_from_object = multiply(m, shape.world_from_object);
        Affine back;
        if (usable(shape.world_from_object) && invert(shape.world_from_object, back)) {
            into.shapes.push_back(shape);
        } else {
            ++lost;
        }
    }
    const bool is_root = &into == &world_;
    for (const auto* list : {&content.lights, &content.included_lights}) {
        for (Light light : *list) {
            light.name = name_of(light.name, false);
            float* p = light.values.position;
            std::array<float, 3> moved =
                light.values.kind == RT_LIGHT_POINT ? transform_point(m, p) : transform_direction(m, p);
            const bool good = usable(moved) && (light.values.kind == RT_LIGHT_POINT || normalize(moved));
            std::copy(moved.begin(), moved.end(), p);
            if (good) (is_root ? into.lights : into.included_lights).push_back(std::move(light));
        }
    }
    for (const auto* list : {&content.cameras, &content.included_cameras}) {
        for (Camera camera : *list) {
            camera.name = name_of(camera.name, false);
            camera.up = transform_direction(m, camera.up.data());
            camera.eye = transform_point(m, camera.eye.data());
            camera.target = transform_point(m, camera.target.data());
            if (make_sound(camera)) (is_root ? into.cameras : into.included_cameras).push_back(std::move(camera));
        }
    }
    if (lost > 0) {
        warn(from, std::to_string(lost) + " objects are left out: their transform is not finite, too large or without volume");
    }
}

// Instances need an invertible transform. If a transform flattens its mesh, the mesh is copied and transformed here.
void SceneBuilder::bake_flattened_instances() {
    Affine inverse;
    for (Instance& instance : world_.instances) {
        if (invert(instance.world_from_object, inverse)) continue;
        const Mesh source = scene_.meshes[instance.mesh];
        if (uint64_t(scene_.vertex_count()) + source.vertex_count >= RT_NONE ||
            uint64_t(scene_.triangle_count()) + source.triangle_count > RT_REF_INDEX_MAX) {
            throw Error(Exit::import_failed, "the scene has more vertices or triangles than it can hold");
        }
        Mesh baked = source;
        baked.first_vertex = scene_.vertex_count();
        baked.first_triangle = scene_.triangle_count();
        const auto repeat = [](auto& values, size_t first, size_t count) {
            values.reserve(values.size() + count);
            for (size_t i = first; i < first + count; ++i) values.push_back(values[i]);
        };
        for (size_t v = source.first_vertex; v < size_t(source.first_vertex) + source.vertex_count; ++v) {
            const std::array<float, 3> p = transform_point(instance.world_from_object, &scene_.positions[3 * v]);
            scene_.positions.insert(scene_.positions.end(), p.begin(), p.end());
        }
        // The copy has no vertex normals; it is shaded with the normals of its triangles.
        if (!scene_.normals.empty()) scene_.normals.resize(scene_.positions.size(), 0.f);
        if (!scene_.uvs.empty()) repeat(scene_.uvs, 2 * size_t(source.first_vertex), 2 * size_t(source.vertex_count));
        repeat(scene_.triangle_materials, source.first_triangle, source.triangle_count);
        const size_t first = 3 * size_t(source.first_triangle), count = 3 * size_t(source.triangle_count);
        for (size_t i = first; i < first + count; ++i) {
            scene_.triangles.push_back(scene_.triangles[i] - source.first_vertex + baked.first_vertex);
        }
        instance.mesh = static_cast<rt_u32>(scene_.meshes.size());
        instance.world_from_object = kIdentity;
        scene_.meshes.push_back(std::move(baked));
    }
}

Scene SceneBuilder::take() {
    bake_flattened_instances();
    scene_.instances = std::move(world_.instances);
    scene_.spheres = std::move(world_.spheres);
    scene_.planes = std::move(world_.planes);
    scene_.shapes = std::move(world_.shapes);
    scene_.lights = std::move(world_.lights);
    scene_.cameras = std::move(world_.cameras);
    for (const FileContent::PolygonCorners& polygon : world_.polygons) {
        const rt_u32 corner_count = static_cast<rt_u32>(polygon.corners.size() / 3);
        scene_.polygons.push_back({static_cast<rt_u32>(scene_.polygon_corners.size() / 3), corner_count, polygon.material});
        scene_.polygon_corners.insert(scene_.polygon_corners.end(), polygon.corners.begin(), polygon.corners.end());
    }
    if (triangulator_.given_up() > 0) {
        scene_.warnings.push_back(std::to_string(triangulator_.given_up()) +
                                  " faces with very many corners cross themselves; parts of them are cut as fans");
    }
    if (warnings_left_out_ > 0) scene_.warnings.push_back("and " + std::to_string(warnings_left_out_) + " warnings more");
    return std::move(scene_);
}

}  // namespace clarity::import
