#include "measure.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "import/import.hpp"
#include "import/importer_choice.hpp"

namespace clarity::test {
using namespace import;
namespace fs = std::filesystem;

Scene import_file(const std::string& path, bool undeformed) {
    static const PluginRegistry plugins = PluginRegistry::discover();
    Progress progress;
    ImportOptions options;
    if (undeformed) options.importers.push_back(kUndeformed);
    return import_scene(plugins, {path}, options, progress);
}

std::string shared_scenes() {
    const char* shared = std::getenv("CLARITY_SHARED");
    const std::string folder = (shared ? std::string(shared) : std::string(CLARITY_SOURCE_DIR "/../shared")) + "/scenes/";
    return fs::exists(folder + "truth") ? folder : std::string();
}

std::vector<std::string> files_in(const std::string& folder, const std::string& ending) {
    std::vector<std::string> names;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none)) {
        const std::string name = entry.path().filename().string();
        if (name.size() >= ending.size() && name.substr(name.size() - ending.size()) == ending) names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    return names;
}

nlohmann::json read_json(const std::string& path) {
    std::ifstream file(path);
    return nlohmann::json::parse(file);
}

bool has_importer_for(const std::string& path) {
    const std::string extension = fs::path(path).extension().string();
    if (extension == ".gltf" || extension == ".glb" || extension == ".fbx") return true;
    for (const char* ours : {".obj", ".ply", ".stl", ".off"})
        if (extension == ours) return true;
#ifdef CLARITY_HAVE_OPENMESH
    if (extension == ".om") return true;
#endif
#ifdef CLARITY_HAVE_ASSIMP
    return true;
#else
    return false;
#endif
}

std::vector<InstanceMeasure> measure_instances(const Scene& scene) {
    std::vector<InstanceMeasure> measures;
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        InstanceMeasure measure;
        measure.name = instance.name;
        measure.triangles = mesh.triangle_count;
        for (rt_u32 t = mesh.first_triangle; t < mesh.first_triangle + mesh.triangle_count; ++t) {
            std::array<float, 3> p[3];
            for (int i = 0; i < 3; ++i) {
                p[i] = transform_point(instance.world_from_object,
                                       &scene.positions[3 * size_t(scene.triangles[3 * size_t(t) + i])]);
                float in_file[3];
                for (int k = 0; k < 3; ++k) in_file[k] = static_cast<float>(p[i][k] + scene.origin[k]);
                measure.bounds.add(in_file);
            }
            double e[3], f[3];
            for (int k = 0; k < 3; ++k) {
                e[k] = double(p[1][k]) - p[0][k];
                f[k] = double(p[2][k]) - p[0][k];
            }
            measure.area += 0.5 * std::hypot(e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]);
        }
        measures.push_back(measure);
    }
    return measures;
}

double bounds_error(const Bounds& bounds, const nlohmann::json& truth) {
    double diagonal = 0, error = 0;
    for (int k = 0; k < 3; ++k) {
        const double low = truth[0][k], high = truth[1][k];
        diagonal += (high - low) * (high - low);
        error = std::max({error, std::abs(low - bounds.min[k]), std::abs(high - bounds.max[k])});
    }
    return error / std::sqrt(diagonal);
}

std::string test_name(const std::string& text) {
    std::string name = text;
    for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    return name;
}

}  // namespace clarity::test
