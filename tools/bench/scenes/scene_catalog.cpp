#include "tools/bench/scenes/scene_catalog.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/files/packed_file.hpp"
#include "tools/bench/scenes/zoo_scenes.hpp"
#include "view/edit/edit.hpp"

namespace clarity::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

std::string beside_program() {
    const fs::path program = program_file();
    return program.empty() ? std::string() : (program.parent_path().parent_path() / "share/clarity/scenes").string();
}

// Splits "scenes/models/a.ply.gz + scenes/models/b.ply.gz (gunzip; faces of part 2 after part 1)" into the two paths.
std::vector<std::string> files_of(std::string text, const std::string& folder) {
    text = text.substr(0, text.find(" ("));
    std::vector<std::string> files;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find(" + ", at), text.size());
        files.push_back(folder + "/" + text.substr(at, end - at));
        at = end + 3;
    }
    return files;
}

std::string numbers_text(const Json& list) {
    std::string text;
    char number[32];
    for (const Json& value : list) {
        std::snprintf(number, sizeof number, "%s%.9g", text.empty() ? "" : ",", value.get<double>());
        text += number;
    }
    return text;
}

std::string existing(const BenchScene& scene) {
    for (const std::string& file : scene.files)
        if (!fs::exists(file)) return file + " is not there";
    return {};
}

}  // namespace

SceneCatalog::SceneCatalog() : SceneCatalog(environment("CLARITY_SCENES"), environment("CLARITY_SHARED")) {
    if (project_.empty()) project_ = beside_program();
}

SceneCatalog::SceneCatalog(std::string project_folder, std::string shared_folder)
    : project_(std::move(project_folder)), shared_(std::move(shared_folder)) {}

BenchScene SceneCatalog::project(const std::string& name) const {
    BenchScene scene;
    scene.name = fs::path(name).filename().string();
    std::error_code error;
    for (const char* extension : {".scene", ".obj", ".ply"}) {
        // A scene's relative paths start at the folder of the real file, not of a link to it.
        const fs::path real = fs::canonical(fs::path(project_) / (name + extension), error);
        if (error) continue;
        scene.files = {real.string()};
        return scene;
    }
    scene.missing = name + " was not found in " + (project_.empty() ? "any folder" : project_) +
                    ": set CLARITY_SCENES to the folder scenes/ of a checkout";
    return scene;
}

std::vector<BenchScene> SceneCatalog::thesis() const {
    std::vector<BenchScene> scenes;
    for (const char* name : {"thesis/1_two_triangles", "thesis/2_two_spheres", "thesis/3_triangle_two_spheres",
                             "thesis/4_35_triangles", "thesis/5_36_spheres", "thesis/6_2406_triangles"})
        scenes.push_back(project(name));
    return scenes;
}

std::vector<BenchScene> SceneCatalog::shared() const {
    BenchScene none;
    none.name = "shared models";
    if (shared_.empty()) {
        none.missing = "CLARITY_SHARED is not set: larger models (bunny, dragon ...) are left out";
        return {none};
    }
    const std::string path = shared_ + "/bench/cameras.json";
    std::vector<BenchScene> scenes;
    try {
        std::ifstream file(path);
        if (!file) throw std::runtime_error("cannot be opened");
        const Json json = Json::parse(file);
        for (const auto& [name, entry] : json.at("scenes").items()) {
            BenchScene scene;
            scene.name = name;
            scene.files = files_of(entry.at("file").get<std::string>(), shared_);
            scene.camera = numbers_text(entry.at("position")) + "," + numbers_text(entry.at("look_at")) + "," +
                           numbers_text(Json::array({entry.at("vfov_deg")}));
            scene.light = numbers_text(entry.at("light"));
            if (const std::string what = existing(scene); !what.empty()) scene.missing = what + ": named by " + path;
            scenes.push_back(scene);
        }
    } catch (const std::exception& e) {
        none.missing = path + ": " + e.what() + "; CLARITY_SHARED should name a folder with bench/cameras.json";
        return {none};
    }
    // Small files first: a run which is interrupted then has more rows.
    const auto bytes = [](const BenchScene& scene) {
        uint64_t sum = 0;
        std::error_code error;
        for (const std::string& file : scene.files) sum += fs::file_size(file, error);
        return sum;
    };
    std::stable_sort(scenes.begin(), scenes.end(),
                     [&](const BenchScene& a, const BenchScene& b) { return bytes(a) < bytes(b); });
    return scenes;
}

std::vector<BenchView> SceneCatalog::views() const {
    struct Row {
        const char *name, *project, *shared;  // one of the two is set: the file's path in the project or in the shared folder
        const char *camera, *light;
        uint64_t subdivide_to;
    };
    static const Row rows[] = {
        {"fandisk", nullptr, "fandisk.obj", "1.3,1,1.9,0,-0.03,0,40", "2,3,2", 0},
        {"legocar near", nullptr, "legocar.obj", "0.2,0.16,0.33,0,0.01,0.09,40", "0.4,0.6,0.5", 0},
        {"mountain", nullptr, "mountain.obj", "-16,22,24,2,14,0,50", "-40,60,20", 0},
        {"armadillo far", nullptr, "armadillo.obj", "-1.3,0.6,-4.3,0,-0.07,0,45", "-4,5,-4", 0},
        {"lucy near", nullptr, "lucy_100k.ply", "1200,160,1000,750,-150,650,38", "2500,900,2500", 0},
        {"lucy far", nullptr, "lucy_100k.ply", "2900,900,2900,690,-120,190,45", "2500,2900,2500", 0},
        {"skull near", "thesis/models/skull", nullptr, "5,9.5,13,0.3,7.2,2,32", "12,22,18", 0},
        {"spot far", "models/spot", nullptr, "1.4,0.9,-3.4,0,0.1,0,45", "3,5,-4", 1'000'000},
    };
    std::vector<BenchView> views;
    for (const Row& row : rows) {
        BenchView view;
        if (row.project) {
            view.scene = project(row.project);
        } else {
            view.scene.files = {shared_ + "/scenes/models/" + row.shared};
            if (shared_.empty())
                view.scene.missing = std::string(row.name) + ": CLARITY_SHARED is not set, so " + row.shared + " is left out";
            else
                view.scene.missing = existing(view.scene);
        }
        view.scene.name = row.name;
        view.scene.camera = row.camera;
        view.scene.light = row.light;
        view.subdivide_to = row.subdivide_to;
        views.push_back(view);
    }
    return views;
}

std::vector<BenchScene> SceneCatalog::zoo(uint64_t triangles) const {
    struct Computed {
        const char *name, *computed, *with, *camera, *light;
    };
    static const Computed kComputed[] = {
        {"teapot in a stadium", "stadium", "thesis/models/teapot", "7,4.5,9,0.2,1.4,0,40", "10,20,15"},
        {"hair", "hair", nullptr, "0,0.3,4.2,0,-0.1,0,45", "4,6,5"},
        {"city", "city", nullptr, "-24,9,20,0,0.5,0,45", "-20,40,30"},
        {"height field", "height field", nullptr, "-1.9,1.6,2.6,0,-0.1,0,50", "-3,5,1"},
        {"soup", "soup", nullptr, "1.4,1.1,3.6,0,0,0,45", "3,5,4"},
    };
    static const struct {
        const char* name;
        bool is_view;  // of views(), else of shared()
        uint64_t triangles;
    } kScans[] = {{"bunny", false, 69'451}, {"lucy near", true, 100'000}, {"dragon_871k", false, 871'414}};
    constexpr uint64_t kUsual = 200'000;
    std::vector<BenchScene> scenes;
    for (const Computed& row : kComputed) {
        BenchScene scene = row.with ? project(row.with) : BenchScene();
        scene.name = row.name;
        scene.computed = row.computed;
        scene.triangles = std::min(triangles, kUsual);
        scene.camera = row.camera;
        scene.light = row.light;
        scenes.push_back(scene);
    }
    std::vector<BenchScene> views_too = shared();
    for (const BenchView& view : views()) views_too.push_back(view.scene);
    for (const auto& scan : kScans) {
        const auto found =
            std::find_if(views_too.begin(), views_too.end(), [&](const BenchScene& s) { return s.name == scan.name; });
        BenchScene scene = found != views_too.end() ? *found : BenchScene();
        if (found == views_too.end())
            scene.missing = std::string(scan.name) + ": CLARITY_SHARED names no such model, so it is left out";
        if (scan.triangles > triangles)
            scene.missing =
                std::string(scan.name) + " has " + std::to_string(scan.triangles) + " triangles: beyond --max-triangles";
        scenes.push_back(scene);
    }
    return scenes;
}

std::vector<BenchScene> SceneCatalog::shapes() const {
    std::vector<BenchScene> scenes;
    for (const MeshedShape& kind : meshed_shapes()) {
        BenchScene shape = project(std::string("shapes/") + kind.name);
        shape.name = kind.name;
        scenes.push_back(shape);
        for (const unsigned parts : kind.parts) {
            BenchScene mesh;
            mesh.name = shape_mesh_name(kind.name, parts);
            mesh.shape = kind.name;
            mesh.parts = parts;
            mesh.camera = "1.6,1.9,2.6,0,0.7,0,40";  // those of the files
            mesh.light = "6,9,7";
            scenes.push_back(mesh);
        }
    }
    return scenes;
}

BenchScene scene_of_file(const std::string& path) {
    BenchScene scene;
    scene.name = fs::path(name_without_gz(path)).stem().string();
    scene.files = {path};
    return scene;
}

LoadedScene load_scene(const PluginRegistry& plugins, const BenchScene& scene, float aspect,
                       const import::ImportOptions& options, Progress& progress) {
    LoadedScene loaded;
    const auto begin = std::chrono::steady_clock::now();
    Scene made;
    if (!scene.files.empty()) made = with_scene_edits(import::import_scene(plugins, scene.files, options, progress));
    if (!scene.shape.empty()) add_shape_mesh(scene.shape, scene.parts, made);
    if (!scene.computed.empty()) add_zoo_scene(scene.computed, scene.triangles, made);
    loaded.scene = std::make_shared<const Scene>(std::move(made));
    loaded.import_ms = ms_since(begin);
    loaded.view = make_view(*loaded.scene, aspect, scene.camera, scene.light);
    return loaded;
}

}  // namespace clarity::bench
