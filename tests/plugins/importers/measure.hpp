// measure.hpp -- imports files for tests, and measures scenes.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "support/scratch.hpp"

namespace clarity::test {

// Imports through the built plugins, in the worker process. undeformed: as the option --undeformed does. Throws what
// import_scene() throws.
Scene import_file(const std::string& path, bool undeformed = false);

// Returns the folder of the shared test scenes with a slash at its end, or an empty string if there is none.
std::string shared_scenes();
// Returns the sorted names of the files in a folder that end with `ending`.
std::vector<std::string> files_in(const std::string& folder, const std::string& ending);
nlohmann::json read_json(const std::string& path);

// What an import of a hostile file may take.
constexpr double kSecondsAtMost = 10;

// True if the importer plugin for this file's extension was built.
bool has_importer_for(const std::string& path);

struct InstanceMeasure {
    std::string name;
    uint64_t triangles = 0;
    double area = 0;
    Bounds bounds;
};
// Measures the instances in world space.
std::vector<InstanceMeasure> measure_instances(const Scene& scene);

// Returns the largest difference of any coordinate, divided by the diagonal of the truth. truth: [[min], [max]].
double bounds_error(const Bounds& bounds, const nlohmann::json& truth);

// Their bytes, as in a file.
inline std::string floats(const std::vector<float>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

// Makes a name for a parameterised test: letters and digits only.
std::string test_name(const std::string& text);

}  // namespace clarity::test
