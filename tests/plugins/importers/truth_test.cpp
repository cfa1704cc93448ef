// truth_test.cpp -- compares the import of every readable shared scene with the measurements of independent importers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>

#include "base/error.hpp"
#include "measure.hpp"

namespace clarity::test {
namespace {

using nlohmann::json;

// Files that differ from the truth, with the reasons. The test asserts that each of them differs, so an entry must go when its
// file is read correctly.
enum class Differs { area, lights_or_cameras, instances };
const std::map<std::string, std::pair<Differs, const char*>> kDeviations = {
    {"fbx/maya_node_attribute_zoo_7500_binary.fbx",
     {Differs::lights_or_cameras, "the two halves of a stereo camera are left out"}},
    {"fbx/motionbuilder_cube_7700_binary.fbx",
     {Differs::lights_or_cameras, "MotionBuilder's own viewport cameras hang from nothing"}},
    {"fbx/motionbuilder_lights_7700_ascii.fbx",
     {Differs::lights_or_cameras, "MotionBuilder's own viewport cameras hang from nothing"}},
    {"fbx/blender_293_barbarian_7400_binary.fbx", {Differs::instances, "one of its meshes has no polygons"}},
};

bool deviates(const std::string& file, Differs how) {
    const auto found = kDeviations.find(file);
    return found != kDeviations.end() && found->second.first == how;
}

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
    std::optional<TemporaryFolder> folder_;
};

class Truth : public testing::TestWithParam<std::string> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Truth);

// A file that assimp 5.2 cannot read must be refused with its version and byte order.
void expect_clear_refusal(const std::string& path, const json& truth) {
    const bool is_big_endian = truth["big_endian"];
    try {
        import_file(path);
        FAIL() << "was imported, though FBX " << truth["version"] << (is_big_endian ? ", big-endian" : "");
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_EQ(error.code(), Exit::import_failed);
        EXPECT_NE(message.find(std::filesystem::path(path).filename().string()), message.npos) << message;
        const int version = truth["version"];
        const std::string name =
            version < 5800 ? "FBX 5" : "FBX " + std::to_string(version / 1000) + "." + std::to_string(version / 100 % 10);
        EXPECT_NE(message.find(name), message.npos) << message;
        if (is_big_endian) {
            EXPECT_NE(message.find("big-endian"), message.npos) << message;
        }
        EXPECT_EQ(message.find('\n'), message.npos) << message;
    }
}

void expect_area(const std::string& file, const Scene& scene, const json& truth) {
    const double area = truth.contains("area") ? truth["area"] : truth["area_fan"];
    const double error = area > 0 ? std::abs(scene.surface_area() - area) / area : scene.surface_area();
    if (!deviates(file, Differs::area)) {
        EXPECT_LE(error, 1e-3) << "surface area " << scene.surface_area() << ", not " << area;
        return;
    }
    EXPECT_GT(error, 1e-3) << "no longer differs: take it from the list";
    // The area must lie between those of the flattest and the most folded triangulation, except for rounding.
    EXPECT_GE(scene.surface_area(), 0.999 * truth["area_newell"].get<double>());
    EXPECT_LE(scene.surface_area(), 1.001 * std::max(area, truth["area_fan"].get<double>()));
}

void expect_same_or_listed(const std::string& file, Differs how, bool is_same, const std::string& what) {
    if (!deviates(file, how)) {
        EXPECT_TRUE(is_same) << what;
    }
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

void expect_fbx(const std::string& file, const Scene& scene, const json& truth) {
    static const std::map<char, rt_u32> axes = {{'x', 0}, {'y', 1}, {'z', 2}};
    const std::string up = truth["axes"]["up"];
    const auto axis = axes.find(up.back());
    if (axis != axes.end()) {
        EXPECT_EQ(scene.up_axis, axis->second);
    }
    EXPECT_NEAR(scene.unit_scale, truth["unit_meters"].get<double>(), 1e-6 * truth["unit_meters"].get<double>());
    const json& counts = truth["counts"];
    const bool same_lights = scene.lights.size() == counts["lights"].get<size_t>();
    const bool same_cameras = scene.cameras.size() == counts["cameras"].get<size_t>();
    expect_same_or_listed(file, Differs::lights_or_cameras, same_lights && same_cameras,
                          std::to_string(scene.lights.size()) + " lights, " + std::to_string(scene.cameras.size()) +
                              " cameras, not " + counts["lights"].dump() + " and " + counts["cameras"].dump());
    if (deviates(file, Differs::lights_or_cameras)) {
        EXPECT_FALSE(same_lights && same_cameras) << "no longer differs: take it from the list";
    }
    const bool same_instances = scene.instances.size() == truth["static"]["mesh_instances"].get<size_t>();
    expect_same_or_listed(
        file, Differs::instances, same_instances,
        std::to_string(scene.instances.size()) + " instances, not " + truth["static"]["mesh_instances"].dump());
    if (deviates(file, Differs::instances)) {
        EXPECT_FALSE(same_instances) << "no longer differs: take it from the list";
    }
    if (!deviates(file, Differs::area)) expect_nodes(scene, truth["mesh_nodes"]);
}

TEST_P(Truth, ImportMatchesTheRecord) {
    const json record = read_json(shared_scenes() + "truth/" + GetParam());
    const std::string file = record["file"];
    const ModelFile model(file);
    if (!has_importer_for(model.path())) GTEST_SKIP() << "SKIPPED: the importer for " << file << " was not built";
    const json& truth = record["truth"];
    ASSERT_TRUE(truth["ok"].get<bool>());
    const bool is_fbx = truth.value("format", "") == "fbx";
    if (is_fbx && (truth["version"] < 7100 || truth["big_endian"])) {
        expect_clear_refusal(model.path(), truth);
        return;
    }

    const Scene scene = import_file(model.path());
    const json& expected = truth.contains("static") ? truth["static"] : truth;
    EXPECT_EQ(scene.placed_triangle_count(), expected["triangles"].get<uint64_t>());
    if (expected["triangles"] > 0) {
        EXPECT_LE(bounds_error(scene.bounds(), expected["bbox"]), 1e-4);
    } else {
        EXPECT_FALSE(scene.warnings.empty()) << "nothing was imported, and nothing said so";
    }
    expect_area(file, scene, expected);
    if (is_fbx) expect_fbx(file, scene, truth);
}

INSTANTIATE_TEST_SUITE_P(Shared, Truth, testing::ValuesIn(truth_names()),
                         [](const auto& about) { return test_name(about.param.substr(0, about.param.size() - 5)); });

TEST(TruthSet, HasMoreThan90Records) {
    if (shared_scenes().empty()) GTEST_SKIP() << "SKIPPED: no shared scenes; CLARITY_SHARED names their folder";
    EXPECT_GT(truth_names().size(), 90u);
    for (const auto& [file, why] : kDeviations) {
        EXPECT_TRUE(std::filesystem::exists(shared_scenes() + file)) << file << " is listed to differ, and is not there";
    }
}

}  // namespace
}  // namespace clarity::test
