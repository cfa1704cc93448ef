#include "import/sequence_reader.hpp"

namespace clarity::import {

SequenceReader::SequenceReader(const PluginRegistry& plugins, ImportOptions options, Progress& progress)
    : plugins_(plugins), options_(std::move(options)), progress_(progress) {
    options_.log_warnings = false;  // the first file of the sequence has said them
}

std::vector<float> SequenceReader::operator()(const std::string& file) {
    for (const auto& [known, positions] : kept_)
        if (known == file) return positions;
    constexpr size_t kMostKept = 2;
    while (kept_.size() >= kMostKept) kept_.pop_front();
    Scene scene = import_scene(plugins_, {file}, options_, progress_);
    // Back to the file's coordinates, which all files of a sequence share.
    for (const Instance& instance : scene.instances) {
        if (scene.origin == std::array<double, 3>{}) break;
        const Mesh& mesh = scene.meshes[instance.mesh];
        for (size_t i = 0; i < 3 * size_t(mesh.vertex_count); ++i) {
            float& p = scene.positions.own()[3 * size_t(mesh.first_vertex) + i];
            p = static_cast<float>(p + double(instance.world_from_object[4 * (i % 3) + 3]) + scene.origin[i % 3]);
        }
    }
    kept_.emplace_back(file, std::move(scene.positions.own()));
    return kept_.back().second;
}

}  // namespace clarity::import
