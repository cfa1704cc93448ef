// truth_motion_test.cpp -- compares poses of every shared scene that moves with the measurements of independent programs.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "measure.hpp"
#include "scene/motion/pose.hpp"

namespace clarity::test {
namespace {

using nlohmann::json;

std::vector<std::string> motion_names() {
    return shared_scenes().empty() ? std::vector<std::string>() : files_in(shared_scenes() + "motion", ".json");
}

class MotionTruth : public testing::TestWithParam<std::string> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(MotionTruth);

// Distance from a point to the nearest vertex of the instances with a name, or of all if none has it.
double distance_to_vertices(const Scene& scene, const std::string& name, const json& truth) {
    const bool named = std::any_of(scene.instances.begin(), scene.instances.end(),
                                   [&](const Instance& instance) { return instance.name == name; });
    double least = std::numeric_limits<double>::infinity();
    for (const Instance& instance : scene.instances) {
        if (named && instance.name != name) continue;
        const Mesh& mesh = scene.meshes[instance.mesh];
        for (size_t v = mesh.first_vertex; v < size_t(mesh.first_vertex) + mesh.vertex_count; ++v) {
            const std::array<float, 3> p = transform_point(instance.world_from_object, &scene.positions[3 * v]);
            double squared = 0;
            for (int i = 0; i < 3; ++i) squared += (p[i] - truth[i].get<double>()) * (p[i] - truth[i].get<double>());
            least = std::min(least, squared);
        }
    }
    return std::sqrt(least);
}

void expect_pose(const Scene& scene, const json& truth) {
    EXPECT_EQ(scene.placed_triangle_count(), truth["triangles"].get<uint64_t>());
    const json box = {truth["bounds"]["min"], truth["bounds"]["max"]};
    EXPECT_LE(bounds_error(scene.bounds(), box), 1e-4);
    // A bent quad has two areas, and both are right.
    const double area = scene.surface_area(), one = truth["area"];
    const json range = truth.value("area_range", json{one, one});
    EXPECT_GE(area, (1 - 1e-3) * range[0].get<double>());
    EXPECT_LE(area, (1 + 1e-3) * range[1].get<double>());
    double diagonal = 0, worst = 0;
    for (int i = 0; i < 3; ++i) {
        const double side = box[1][i].get<double>() - box[0][i].get<double>();
        diagonal += side * side;
    }
    std::string where;
    for (const json& p : truth["points"]) {
        const double distance = distance_to_vertices(scene, p["node"], p["position"]);
        if (distance <= worst) continue;
        worst = distance;
        where = p["node"].dump() + " vertex " + p["vertex"].dump();
    }
    EXPECT_LE(worst, 1e-4 * std::sqrt(diagonal)) << where;
}

void expect_clips(const Scene& scene, const json& truth) {
    const std::vector<ClipInfo> infos = clips(scene);
    ASSERT_EQ(infos.size(), truth.size());
    for (size_t i = 0; i < infos.size(); ++i) {
        const std::string name = truth[i]["name"];
        const bool unnamed = !name.empty() && name.front() == '#';  // "#0": the file gives no name
        EXPECT_EQ(infos[i].name, unnamed ? infos[i].name : name);
        EXPECT_NEAR(infos[i].begin_s, truth[i]["begin_s"].get<double>(), 1e-6) << name;
        EXPECT_NEAR(infos[i].end_s, truth[i]["end_s"].get<double>(), 1e-6) << name;
        const double fps = truth[i]["fps"].is_number() ? truth[i]["fps"].get<double>() : infos[i].fps;
        EXPECT_NEAR(infos[i].fps, fps, 1e-3) << name;
    }
}

TEST_P(MotionTruth, PosesMatchTheRecord) {
    const json record = read_json(shared_scenes() + "motion/" + GetParam());
    const std::string file = shared_scenes() + record["file"].get<std::string>();
    if (!has_importer_for(file)) GTEST_SKIP() << "SKIPPED: the importer for " << file << " was not built";
    const Scene scene = import_file(file);
    expect_clips(scene, record["animations"]);
    if (record["animations"].empty()) {
        SCOPED_TRACE("at rest, as imported");
        expect_pose(scene, record["times"][0]);
    }
    for (const json& time : record["times"]) {
        SCOPED_TRACE("at " + time["t"].dump() + " s");
        expect_pose(posed(scene, evaluate(scene, "", time["t"])), time);
    }
}

INSTANTIATE_TEST_SUITE_P(Shared, MotionTruth, testing::ValuesIn(motion_names()),
                         [](const auto& about) { return test_name(about.param.substr(0, about.param.size() - 5)); });

TEST(MotionTruthSet, Has48Records) {
    if (shared_scenes().empty()) GTEST_SKIP() << "SKIPPED: no shared scenes; CLARITY_SHARED names their folder";
    EXPECT_GE(motion_names().size(), 48u);
}

}  // namespace
}  // namespace clarity::test
