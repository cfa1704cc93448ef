// clarity info: shows what the importer read from a file, in the file's units and axes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "base/angle.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/memory_text.hpp"
#include "base/numbers.hpp"
#include "base/plural.hpp"
#include "base/printable.hpp"
#include "cli/commands.hpp"
#include "cli/info_materials.hpp"
#include "cli/interrupt.hpp"
#include "cli/progress_bar.hpp"
#include "import/sequence_reader.hpp"
#include "render/edit/edit.hpp"
#include "scene/emissive.hpp"
#include "scene/light_kinds.hpp"
#include "scene/motion/pose.hpp"

namespace clarity {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kShownMaterials = 30;  // in lines; JSON has all

Json vector_json(const std::array<float, 3>& v) {
    return {short_double(v[0]), short_double(v[1]), short_double(v[2])};
}

// A point of the scene in the coordinates of its files.
Json point_json(const std::array<float, 3>& p, const Scene& scene) {
    if (scene.origin == std::array<double, 3>{}) return vector_json(p);
    return {p[0] + scene.origin[0], p[1] + scene.origin[1], p[2] + scene.origin[2]};
}

uint64_t face_count(const Scene& scene) {
    uint64_t count = 0;
    for (const Instance& instance : scene.instances) count += scene.meshes[instance.mesh].polygon_count;
    return count;
}

// How many shapes of each kind there are.
std::map<std::string, uint64_t> shape_counts(const Scene& scene) {
    std::map<std::string, uint64_t> counts;
    for (const Shape& shape : scene.shapes) ++counts[scene.shape_kinds[shape.kind].id];
    return counts;
}

// How many lights there are of each kind, by its name.
std::map<std::string, uint64_t> light_counts(const Scene& scene) {
    std::map<std::string, uint64_t> counts;
    for (const Light& light : scene.lights) ++counts[light_kind_of(light.values).name];
    return counts;
}

std::string sky_text(const Sky& sky) {
    switch (sky.values.kind) {
        case RT_SKY_CONSTANT:
            return "constant";
        case RT_SKY_GRADIENT:
            return "gradient";
        case RT_SKY_PICTURE:
            return sky.file + ", " + std::to_string(sky.values.width) + " x " + std::to_string(sky.values.height);
    }
    return "background";
}

Json camera_json(const Camera& camera, const Scene& scene) {
    Json json = {{"name", camera.name},
                 {"eye", point_json(camera.eye, scene)},
                 {"target", point_json(camera.target, scene)},
                 {"up", vector_json(camera.up)},
                 {"fov_deg", short_double(camera.fov_y_rad * 57.29578f)}};
    if (camera.aperture > 0) json["aperture"] = short_double(camera.aperture), json["focus"] = short_double(camera.focus);
    return json;
}

Json clip_json(const ClipInfo& clip) {
    return {{"name", clip.name},    {"begin_s", clip.begin_s},
            {"end_s", clip.end_s},  {"fps", clip.fps > 0 ? Json(clip.fps) : Json()},
            {"nodes", clip.nodes},  {"skins", clip.skins},
            {"morphs", clip.morphs}};
}

uint64_t materials_with_alpha(const Scene& scene) {
    return static_cast<uint64_t>(std::count_if(scene.materials.begin(), scene.materials.end(),
                                               [](const Material& m) { return m.values.alpha != RT_ALPHA_OPAQUE; }));
}

Json scene_json(const Scene& scene, const std::vector<ClipInfo>& animations, const std::vector<std::string>& files) {
    Json json;
    json["files"] = files;
    json["meshes"] = scene.meshes.size();
    json["instances"] = scene.instances.size();
    json["triangles"] = scene.placed_triangle_count();
    json["unique_triangles"] = scene.triangle_count();
    json["vertices"] = scene.vertex_count();
    json["vertex_colors"] = !scene.colors.empty();
    json["faces"] = face_count(scene);
    json["polygons"] = scene.polygons.size();
    json["spheres"] = scene.spheres.size();
    json["planes"] = scene.planes.size();
    json["shapes"] = Json::object();
    for (const auto& [id, count] : shape_counts(scene)) json["shapes"][id] = count;
    json["materials"] = scene.materials.size();
    json["materials_with_alpha"] = materials_with_alpha(scene);
    json["textures"] = scene.textures.size();
    json["texture_bytes"] = scene.texels.size() * sizeof(uint32_t);
    json["lights"] = scene.lights.size();
    json["light_kinds"] = Json::object();
    for (const auto& [kind, count] : light_counts(scene)) json["light_kinds"][kind] = count;
    const EmissiveCounts emissive = count_emissive(scene);
    json["emissive"] = {
        {"triangles", emissive.triangles},           {"spheres", emissive.spheres}, {"polygons", emissive.polygons},
        {"by_rays_alone", emissive.by_rays_alone()}, {"planes", emissive.planes},   {"shapes", emissive.shapes},
        {"bent_polygons", emissive.bent_polygons},   {"cut_out", emissive.cut_out}};
    json["sky"] = sky_text(scene.sky);
    json["cameras"] = scene.cameras.size();
    const Bounds bounds = scene.bounds();
    json["bounds"] =
        bounds.empty ? Json() : Json{{"min", point_json(bounds.min, scene)}, {"max", point_json(bounds.max, scene)}};
    if (scene.origin != std::array<double, 3>{}) json["origin"] = scene.origin;
    json["surface_area"] = scene.surface_area();
    json["up_axis"] = std::string(1, "xyz"[scene.up_axis % 3]);
    json["unit_scale"] = scene.unit_scale > 0 ? Json(scene.unit_scale) : Json();
    json["camera_list"] = Json::array();
    for (const Camera& camera : scene.cameras) json["camera_list"].push_back(camera_json(camera, scene));
    json["material_list"] = Json::array();
    for (const Material& material : scene.materials) json["material_list"].push_back(material_json(material));
    json["animations"] = Json::array();
    for (const ClipInfo& clip : animations) json["animations"].push_back(clip_json(clip));
    json["warnings"] = scene.warnings;
    return json;
}

// 871414 -> "871 414", the same in every locale.
std::string grouped(uint64_t number) {
    std::string text = std::to_string(number);
    for (size_t at = text.size(); at > 3;) text.insert(at -= 3, 1, ' ');
    return text;
}

void row(const char* label, const std::string& value) {
    print_text("  %-14s%s\n", label, value.c_str());
}

// Prints a count; prints nothing for 0.
void count_row(const char* label, uint64_t count, const std::string& more = {}) {
    if (count > 0) row(label, grouped(count) + more);
}

std::string vector_text(const std::array<float, 3>& v, const std::array<double, 3>& origin) {
    char text[96];
    const char* const format = origin == std::array<double, 3>{} ? "%12.6g %12.6g %12.6g" : "%16.12g %16.12g %16.12g";
    std::snprintf(text, sizeof text, format, v[0] + origin[0], v[1] + origin[1], v[2] + origin[2]);
    return text;
}

void print_scene(const Scene& scene, const std::vector<ClipInfo>& animations, const std::vector<std::string>& files) {
    for (const std::string& file : files) print_text("%s\n", printable_line(file).c_str());
    const uint64_t placed = scene.placed_triangle_count(), faces = face_count(scene);
    std::string more;
    if (placed != scene.triangle_count()) more += ", " + grouped(scene.triangle_count()) + " of them different";
    if (faces != placed) more += ", from " + grouped(faces) + " " + noun(faces, "face");
    count_row("triangles", placed, more);
    count_row("vertices", scene.vertex_count(), scene.colors.empty() ? "" : ", with colours");
    count_row("meshes", scene.meshes.size());
    count_row("instances", scene.instances.size());
    count_row("spheres", scene.spheres.size());
    count_row("planes", scene.planes.size());
    count_row("polygons", scene.polygons.size());
    std::string kinds;
    for (const auto& [id, count] : shape_counts(scene)) kinds += ", " + grouped(count) + ' ' + id;
    count_row("shapes", scene.shapes.size(), kinds);
    const uint64_t clear = materials_with_alpha(scene);
    count_row("materials", scene.materials.size(), clear > 0 ? ", of " + grouped(clear) + " alpha counts" : "");
    for (size_t i = 0; i < std::min(scene.materials.size(), kShownMaterials); ++i) row("", material_text(scene.materials[i]));
    if (scene.materials.size() > kShownMaterials)
        row("", "and " + grouped(scene.materials.size() - kShownMaterials) + " more, which --json lists");
    count_row("textures", scene.textures.size(), ", " + memory_text(scene.texels.size() * sizeof(uint32_t)));
    kinds.clear();
    for (const auto& [kind, count] : light_counts(scene)) kinds += ", " + grouped(count) + ' ' + kind;
    count_row("lights", scene.lights.size(), kinds);
    const EmissiveCounts emissive = count_emissive(scene);
    count_row("emissive", emissive.triangles + emissive.spheres + emissive.polygons,
              " triangles, spheres and polygons that `path` draws light from");
    std::string apart;
    const auto add_apart = [&](uint64_t count, const std::string& one, const std::string& many) {
        if (count > 0) apart += (apart.empty() ? "" : ", ") + grouped(count) + " " + noun(count, one, many);
    };
    add_apart(emissive.planes, "plane", "planes");
    add_apart(emissive.shapes, "shape", "shapes");
    add_apart(emissive.bent_polygons, "polygon that is not convex", "polygons that are not convex");
    add_apart(emissive.cut_out, "surface that is cut out or has textures of varnish",
              "surfaces that are cut out or have textures of varnish");
    if (!apart.empty()) row("emissive too", apart + ": `path` finds their light only where a ray hits them by chance");
    if (scene.sky.values.kind != RT_NONE) row("sky", sky_text(scene.sky));
    count_row("cameras", scene.cameras.size());
    for (const Camera& camera : scene.cameras) {
        char fov[32];
        std::snprintf(fov, sizeof fov, "  fov %.4g deg", double(camera.fov_y_rad) / kRadPerDegree);
        row("", (camera.name.empty() ? "(no name)" : printable_line(camera.name)) + fov);
    }
    count_row("animations", animations.size());
    for (size_t i = 0; i < animations.size(); ++i) {
        const ClipInfo& clip = animations[i];
        char span[96];
        std::snprintf(span, sizeof span, "  %.6g to %.6g s, ", clip.begin_s, clip.end_s);
        row("", std::to_string(i) + ' ' + (clip.name.empty() ? "(no name)" : printable_line(clip.name)) + span +
                    plural(clip.nodes, "node") + ", " + plural(clip.skins, "skin") + ", " + plural(clip.morphs, "morph"));
    }
    const Bounds bounds = scene.bounds();
    if (bounds.empty) {
        row("bounds", "none: the scene is empty or has planes only");
    } else {
        row("bounds", vector_text(bounds.min, scene.origin));
        row("", vector_text(bounds.max, scene.origin));
        if (scene.origin != std::array<double, 3>{}) row("origin", vector_text({}, scene.origin));
    }
    char number[64];
    std::snprintf(number, sizeof number, "%.7g", scene.surface_area());
    row("surface area", number);
    row("up axis", std::string(1, "XYZ"[scene.up_axis % 3]));
    std::snprintf(number, sizeof number, "%.7g m", scene.unit_scale);
    row("unit", scene.unit_scale > 0 ? number : "not said");
    for (const std::string& warning : scene.warnings) row("warning", warning);
}

}  // namespace

int run_info(const PluginRegistry& plugins, const SceneOptions& options, const PoseOptions& pose, bool json, bool quiet) {
    check_pose(pose);
    check_scene(plugins, options);
    ProgressBar progress(quiet);
    const CancelOnSignal cancel(progress);
    import::ImportOptions import = options.import;
    import.log_warnings = false;  // because they are printed with the rest
    Scene scene = with_scene_edits(import::import_scene(plugins, options.files, import, progress));
    const std::vector<ClipInfo> animations = clips(scene);
    scene = at_pose(std::move(scene), pose, import::SequenceReader(plugins, import, progress));
    progress.clear();
    if (json)  // names in files may not be UTF-8, but JSON must be
        std::printf("%s\n",
                    scene_json(scene, animations, options.files).dump(2, ' ', false, Json::error_handler_t::replace).c_str());
    else
        print_scene(scene, animations, options.files);
    return static_cast<int>(Exit::done);
}

}  // namespace clarity
