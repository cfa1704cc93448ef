// measure.hpp -- imports for tests, and what can be measured of a scene.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace clarity::test {

// Through the built plugins, in the worker process. Throws what import_scene throws.
Scene import_file(const std::string& path);

// In the system's folder for temporary files; removed with all that is in it.
class TemporaryFolder {
 public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::string path(const std::string& name) const { return path_ + "/" + name; }
    // The new file's path.
    std::string write(const std::string& name, const std::string& bytes) const;

 private:
    std::string path_;
};

// The shared test scenes' folder, with a slash at its end; empty where there are none.
std::string shared_scenes();
// Names of a folder's files that end so, sorted.
std::vector<std::string> files_in(const std::string& folder, const std::string& ending);
nlohmann::json read_json(const std::string& path);

// Whether the plugin for a file of this extension was built.
bool has_importer_for(const std::string& path);

struct InstanceMeasure {
    std::string name;
    uint64_t triangles = 0;
    double area = 0;
    Bounds bounds;
};
// World space.
std::vector<InstanceMeasure> measure_instances(const Scene& scene);

// Largest difference of any coordinate, in parts of the truth's diagonal. truth: [[min], [max]].
double bounds_error(const Bounds& bounds, const nlohmann::json& truth);

// For names of parameterised tests: letters and digits only.
std::string test_name(const std::string& text);

}  // namespace clarity::test
