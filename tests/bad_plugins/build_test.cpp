// A builder that breaks its contract gets one clear error, causes no crash, and the next build works.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "plugin/parameters.hpp"
#include "plugin/registry.hpp"
#include "plugin/trust.hpp"
#include "rt_plugin.hpp"
#include "structures/accel_build.hpp"

namespace {

// A mesh of two triangles that is placed twice, which makes a second group; a mesh that is placed once; and a sphere.
clarity::Scene sample_scene() {
    clarity::Scene scene;
    scene.materials.push_back({"default", clarity::default_material()});
    scene.positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 5, 0, 0, 6, 0, 0, 6, 1, 0};
    scene.triangles = {0, 1, 2, 0, 2, 3, 4, 5, 6};
    scene.triangle_materials = {0, 0, 0};
    clarity::Mesh twice, once;
    twice.vertex_count = 4;
    twice.triangle_count = 2;
    twice.polygon_count = 2;
    once.first_vertex = 4;
    once.vertex_count = 3;
    once.first_triangle = 2;
    once.triangle_count = 1;
    once.polygon_count = 1;
    scene.meshes = {twice, once};
    clarity::Instance moved;
    moved.world_from_object[3] = 2;
    scene.instances = {{}, moved, {}};
    scene.instances[2].mesh = 1;
    scene.spheres.push_back({{0, 0, 3}, 1, 0});
    return scene;
}

const rt_plugin& builder() {
    static const clarity::PluginRecord record = clarity::load_plugin(std::string(BAD_PLUGINS) + "/bad_builder.so");
    if (!record.plugin) throw std::runtime_error(record.path + ": " + record.why);
    return *record.plugin;
}

clarity::AccelData build(const std::string& defect, clarity::Progress& progress) {
    clarity::ParameterValues params = clarity::default_parameters(builder());
    clarity::set_parameter(builder(), params, "defect", defect);
    clarity::BuildTarget target;
    if (defect == "crashes") target.place = clarity::BuildPlace::worker;
    return clarity::build_accel(sample_scene(), builder(), params, progress, target);
}

struct Breach {
    const char* defect;
    const char* says;
};
void PrintTo(const Breach& breach, std::ostream* out) {
    *out << breach.defect;
}

class BadBuilder : public testing::TestWithParam<Breach> {};

TEST_P(BadBuilder, IsOneClearError) {
    clarity::Progress progress;
    try {
        build(GetParam().defect, progress);
        FAIL() << "the build was taken";
    } catch (const clarity::Cancelled&) {
        FAIL() << "nobody cancelled";
    } catch (const clarity::Error& e) {
        const std::string what = e.what();
        EXPECT_EQ(e.code(), clarity::Exit::failed);
        EXPECT_EQ(what.find("accel bad_builder: "), 0u) << what;
        EXPECT_NE(what.find(GetParam().says), std::string::npos) << what;
        EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    }
    EXPECT_NO_THROW(build("none", progress)) << "a failed build must not spoil the next one";
}

const Breach kBreaches[] = {
    {"fails", "this builder always fails"},
    {"fails_silently", "without saying why"},
    {"ok_after_fail", "this builder failed and goes on (and then it reported success"},
    {"odd_status", "returned 77"},
    {"cancelled_by_nobody", "had not asked it to stop"},
    {"crashes", "the builder crashed (segmentation fault"},
    {"throws", "thrown by the builder"},
    {"throws_no_exception_class", "unknown type"},
    {"throws_in_loop", "thrown in iteration 7"},
    {"fails_in_loop", "one of many"},
    {"alloc_twice", "twice"},
    {"alloc_of_no_slot", "slot 1 of 1"},
    {"alloc_too_much", "slot bad_builder_runs"},
    {"no_slot", "never allocated slot bad_builder_runs"},
    {"no_leaves", "never asked for the leaves"},
    {"leaves_twice", "leaves twice"},
    {"leaves_too_many", "leaves"},
    {"ref_of_no_primitive", "ref"},
    {"ref_of_no_kind", "ref"},
    {"missing_root", "no root for group 1"},
    {"root_out_of_range", "reported root 1002 for group 0"},
    {"root_of_no_group", "root for group 2 of 2"},
    {"define_of_odd_name", "define"},
    {"define_of_no_name", "define"},
    {"stat_of_no_name", "stat"},
};
INSTANTIATE_TEST_SUITE_P(Breaches, BadBuilder, testing::ValuesIn(kBreaches),
                         [](const testing::TestParamInfo<Breach>& info) { return info.param.defect; });

// The same builder without a defect is accepted. This shows that the scene is sound and that the tests above fail because of
// the defect.
TEST(GoodBuilder, IsAccepted) {
    clarity::Progress progress;
    const clarity::AccelData accel = build("none", progress);
    EXPECT_EQ(accel.roots.size(), 2u);
    EXPECT_EQ(accel.leaf_count, 6u) << "world: a triangle, a sphere, two instances; mesh: two triangles";
    ASSERT_EQ(accel.slots.size(), 1u);
    EXPECT_EQ(accel.slots[0].count, 2u);
}

TEST(GoodBuilder, CanBeCancelled) {
    clarity::Progress progress;
    progress.cancel();
    EXPECT_THROW(build("cancelled_by_nobody", progress), clarity::Cancelled);
}

// A tree of one leaf a group.
int32_t one_leaf_each(const rt_host*, const rt_build_input* in, const rt_topology_output* out) {
    uint64_t total = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) total += in->groups[g].count;
    rt_topology_node* nodes = rt::nodes(out, in->group_count);
    rt_u32* refs = rt::refs(out, total);
    rt_u32 next = 0;
    for (rt_u32 g = 0; g < in->group_count; ++g) {
        nodes[g].left = next;
        nodes[g].right = RT_TOPOLOGY_LEAF | in->groups[g].count;
        for (rt_u32 i = 0; i < in->groups[g].count; ++i) refs[next++] = in->prims[in->groups[g].first + i].ref;
        rt::root(out, g, g);
    }
    return RT_OK;
}

// Packing is a stranger's code as much as building is: the first time it runs in a worker process.
TEST(BadPacker, CrashIsOneClearError) {
    constexpr rt_accel accel = rt::topology("bad_packer", one_leaf_each, {});
    const rt_plugin leaves = rt::accel_plugin("one_leaf_each", "One leaf a group", "1.0", nullptr, accel);
    const clarity::PluginRecord packer = clarity::load_plugin(std::string(BAD_PLUGINS) + "/bad_packer.so");
    ASSERT_NE(packer.plugin, nullptr) << packer.why;
    clarity::BuildTarget target;
    target.layout = packer.plugin;
    target.place = clarity::BuildPlace::worker;
    clarity::Progress progress;
    try {
        clarity::build_accel(sample_scene(), leaves, {}, progress, target);
        FAIL() << "the build was taken";
    } catch (const clarity::Error& e) {
        const std::string what = e.what();
        EXPECT_EQ(what.find("accel bad_packer, which packs the tree of one_leaf_each: the builder crashed (segmentation fault"),
                  0u)
            << what;
    }
    clarity::Scene one_group = sample_scene();
    one_group.instances.erase(one_group.instances.begin() + 1);  // each mesh is placed once
    const clarity::AccelData packed = clarity::build_accel(one_group, leaves, {}, progress, target);
    EXPECT_EQ(packed.leaf_count, 4u) << "three triangles and a sphere";
    ASSERT_EQ(packed.slots.size(), 1u);
    const auto* run = static_cast<const rt_u32*>(packed.slots[0].memory.data());
    EXPECT_EQ(run[0], 0u);
    EXPECT_EQ(run[1], 4u);
}

// One rule says where the code of a library runs.
TEST(Trust, IsEarnedAndCanBeRefused) {
    using clarity::Trust;
    namespace fs = std::filesystem;
    std::string cache = (fs::temp_directory_path() / "clarity-trust-XXXXXX").string();
    ASSERT_TRUE(mkdtemp(cache.data()));
    const char* const before = std::getenv("XDG_CACHE_HOME");
    const std::string kept = before ? before : "";
    setenv("XDG_CACHE_HOME", cache.c_str(), 1);
    const fs::path program = std::getenv("CLARITY_WORKER");
    const std::string own = (program.parent_path() / "../lib/clarity/plugins/accel/linear.so").string();
    // A copy with another content, because other tests may have made the library proven.
    const std::string other = cache + "/bad_packer.so";
    fs::copy_file(std::string(BAD_PLUGINS) + "/bad_packer.so", other);
    std::ofstream(other, std::ios::app) << ' ';
    EXPECT_EQ(clarity::trust_of(own), Trust::own);
    EXPECT_EQ(clarity::trust_of(other), Trust::none);
    clarity::remember_library(other);
    EXPECT_EQ(clarity::trust_of(other), Trust::proven);

    setenv("CLARITY_PLUGINS", "worker", 1);
    EXPECT_EQ(clarity::trust_of(own), Trust::none);
    EXPECT_EQ(clarity::trust_of(other), Trust::none);
    // The crash of a library that was proven stays in a worker.
    constexpr rt_accel accel = rt::topology("bad_packer", one_leaf_each, {});
    const rt_plugin leaves = rt::accel_plugin("one_leaf_each", "One leaf a group", "1.0", nullptr, accel);
    const clarity::PluginRecord packer = clarity::load_plugin(other);
    ASSERT_NE(packer.plugin, nullptr) << packer.why;
    clarity::BuildTarget target;
    target.layout = packer.plugin;
    clarity::Progress progress;
    try {
        clarity::build_accel(sample_scene(), leaves, {}, progress, target);
        ADD_FAILURE() << "the build was taken";
    } catch (const clarity::Error& e) {
        EXPECT_NE(std::string(e.what()).find("the builder crashed (segmentation fault"), std::string::npos) << e.what();
    }
    unsetenv("CLARITY_PLUGINS");
    before ? setenv("XDG_CACHE_HOME", kept.c_str(), 1) : unsetenv("XDG_CACHE_HOME");
    fs::remove_all(cache);
}

TEST(BadBuilders, AllAreTested) {
    std::set<std::string> declared, tested = {"none"};
    tested.insert("deep_stack");  // a fault of its kernel: tests/api/python_rows_test.py
    for (const char* const* choice = builder().params[0].choices; *choice; ++choice) declared.insert(*choice);
    for (const Breach& breach : kBreaches) tested.insert(breach.defect);
    EXPECT_EQ(declared, tested);
}

}  // namespace
