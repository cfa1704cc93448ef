// truth_test.cpp -- compares the import of every readable shared scene with the measurements of independent importers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>

#include "measure.hpp"

namespace clarity::test {
namespace {

using nlohmann::json;

// Returns the truth files except those of invalid models.
std::vector<std::string> truth_names() {
    std::vector<std::string> names;
    if (shared_scenes().empty()) return names;
    for (const std::string& name : files_in(shared_scenes() + "truth", ".json")) {
        if (name.rfind("invalid__", 0) != 0) names.push_back(name);
    }
    return names;
}

// The file to import. A gzipped file is unpacked to a temporary folder.
class ModelFile {
 public:
    explicit ModelFile(const std::string& file) : path_(shared_scenes() + file) {
        if (std::filesystem::path(file).extension() != ".gz") return;
        folder_.emplace();
        const std::string unpacked = folder_->path(std::filesystem::path(file).stem().string());
        if (std::system(("gzip -dc '" + path_ + "' > '" + unpacked + "'").c_str()) != 0)
            throw std::runtime_error("gzip failed");
        path_ = unpacked;
    }
    ModelFile(const ModelFile&) = delete;
    ModelFile& operator=(const ModelFile&) = delete;
    const std::string& path() const { return path_; }

 private:
    std::string path_;
    std::optional<Scratch> folder_;
};

class Truth : public testing::TestWithParam<std::string> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Truth);

void expect_area(const Scene& scene, const json& truth) {
    const double area = truth.contains("area") ? truth["area"] : truth["area_fan"];
    const double error = area > 0 ? std::abs(scene.surface_area() - area) / area : scene.surface_area();
    EXPECT_LE(error, 1e-3) << "surface area " << scene.surface_area() << ", not " << area;
}

// Compares node by node where names are unique. This finds errors that cancel out in the whole scene.
void expect_nodes(const Scene& scene, const json& nodes) {
    std::map<std::string, std::vector<const json*>> by_name;
    for (const json& node : nodes) {
        const std::string path = node["node"];
        by_name[path.substr(path.find_last_of('/') + 1)].push_back(&node);
    }
    std::map<std::string, int> uses;
    const std::vector<InstanceMeasure> measures = measure_instances(scene);
    for (const InstanceMeasure& measure : measures) ++uses[measure.name];
    size_t compared = 0;
    for (const InstanceMeasure& measure : measures) {
        const auto found = by_name.find(measure.name);
        if (found == by_name.end() || found->second.size() != 1 || uses[measure.name] != 1) continue;
        const json& node = *found->second[0];
        EXPECT_EQ(measure.triangles, node["triangles"].get<uint64_t>()) << measure.name;
        if (node["area"].get<double>() > 0) {
            EXPECT_LE(bounds_error(measure.bounds, node["bbox"]), 1e-4) << measure.name;
        }
        ++compared;
    }
    if (by_name.size() > 1) {
        EXPECT_GT(compared, 0u) << "no node was compared";
    }
}

void expect_fbx(const Scene& scene, const json& truth) {
    static const std::map<char, rt_u32> axes = {{'x', 0}, {'y', 1}, {'z', 2}};
    const std::string up = truth["axes"]["up"];
    const auto axis = axes.find(up.back());
    if (axis != axes.end()) {
        EXPECT_EQ(scene.up_axis, axis->second);
    }
    EXPECT_NEAR(scene.unit_scale, truth["unit_meters"].get<double>(), 1e-6 * truth["unit_meters"].get<double>());
    const json& counts = truth["counts"];
    EXPECT_EQ(scene.lights.size(), counts["lights"].get<size_t>());
    EXPECT_EQ(scene.cameras.size(), counts["cameras"].get<size_t>());
    EXPECT_EQ(scene.instances.size(), truth["static"]["mesh_instances"].get<size_t>());
    expect_nodes(scene, truth["mesh_nodes"]);
}

TEST_P(Truth, ImportMatchesTheRecord) {
    const json record = read_json(shared_scenes() + "truth/" + GetParam());
    const std::string file = record["file"];
    const ModelFile model(file);
    if (!has_importer_for(model.path())) GTEST_SKIP() << "SKIPPED: the importer for " << file << " was not built";
    const json& truth = record["truth"];
    ASSERT_TRUE(truth["ok"].get<bool>());
    const bool is_fbx = truth.value("format", "") == "fbx";

    // The records have the geometry as files store it, without what skins and morphs do.
    const Scene scene = import_file(model.path(), true);
    const json& expected = truth.contains("static") ? truth["static"] : truth;
    EXPECT_EQ(scene.placed_triangle_count(), expected["triangles"].get<uint64_t>());
    if (expected["triangles"] > 0) {
        EXPECT_LE(bounds_error(scene.bounds(), expected["bbox"]), 1e-4);
    } else {
        EXPECT_FALSE(scene.warnings.empty()) << "nothing was imported, and nothing said so";
    }
    expect_area(scene, expected);
    if (is_fbx) expect_fbx(scene, truth);
}

INSTANTIATE_TEST_SUITE_P(Shared, Truth, testing::ValuesIn(truth_names()),
                         [](const auto& about) { return test_name(about.param.substr(0, about.param.size() - 5)); });

TEST(TruthSet, HasMoreThan90Records) {
    if (shared_scenes().empty()) GTEST_SKIP() << "SKIPPED: no shared scenes; CLARITY_SHARED names their folder";
    EXPECT_GT(truth_names().size(), 90u);
}

}  // namespace
}  // namespace clarity::test
