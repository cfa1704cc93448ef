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
#include "base/numbers.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/progress_bar.hpp"
#include "import/import.hpp"
#include "scene/emissive.hpp"
#include "scene/motion/pose.hpp"
#include "scene/scene_json.hpp"
#include "view/edit/edit.hpp"

namespace clarity {
namespace {

constexpr size_t kShownMaterials = 30;  // in lines; JSON has all

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
    const auto unused = static_cast<uint64_t>(
        std::count_if(scene.materials.begin(), scene.materials.end(), [](const Material& material) { return !material.used; }));
    count_row("materials", scene.materials.size(),
              (unused > 0 ? ", " + grouped(unused) + " of them on no surface" : "") +
                  (clear > 0 ? ", of " + grouped(clear) + " alpha counts" : ""));
    for (size_t i = 0; i < std::min(scene.materials.size(), kShownMaterials); ++i)
        row("", material_text(scene, scene.materials[i]));
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
        std::printf(
            "%s\n",
            scene_json(scene, animations, options.files).dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
    else
        print_scene(scene, animations, options.files);
    return static_cast<int>(Exit::done);
}

}  // namespace clarity
