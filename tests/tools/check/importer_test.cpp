// importer_test.cpp -- `clarity check` of importers: each defect is found by its check, and ours are accused of nothing.
#include <gtest/gtest.h>

#include "support/scratch.hpp"
#include "tools/check/run_check.hpp"

namespace {

using nlohmann::json;

class ImporterCheck : public testing::Test {
 protected:
    void SetUp() override {
        std::string text = "40\n";
        for (int i = 0; i < 40; ++i)
            text += std::to_string(2 * i) + " 0 0  " + std::to_string(2 * i + 1) + " 0 0  " + std::to_string(2 * i) + " 1 0\n";
        scratch_.write("row.tri", text);
        scratch_.write("one.tri", "1\n0 0 0  1 0 0  0 1 0\n");
        scratch_.write("row.tri.json", R"({"triangles": 40, "area": 20, "bbox": [[0, 0, 0], [79, 1, 0]]})");
        // A closed surface, and all that can be known of it.
        scratch_.write("tetrahedron.tri",
                       "4\n0 0 0  0 1 0  1 0 0\n0 0 0  1 0 0  0 0 1\n0 0 0  0 0 1  0 1 0\n1 0 0  0 1 0  0 0 1\n");
        scratch_.write("tetrahedron.tri.json",
                       R"({"triangles": 4, "volume": 0.16666667, "instance_count": 1, "material_count": 2,
            "material_triangles": {"first": 2, "second": 2},
            "instances": [{"name": "triangles", "triangles": 4, "bbox": [[0, 0, 0], [1, 1, 1]]}],
            "corners": [{"at": [1, 0, 0], "normal": [0, 0, -1], "facing": [0, 0, -1], "uv": [1, 0]}, {"at": [0, 1, 0], "uv": [0, 1]}]})");
    }
    json results_of(const std::string& library, int exit_code, std::vector<std::string> words = {}) {
        words.insert(words.end(), {"--samples", scratch_.path("")});
        return check(library, words, exit_code);
    }
    Scratch scratch_;
};

class BrokenImporter : public ImporterCheck, public testing::WithParamInterface<Defect> {};

TEST_P(BrokenImporter, IsFound) {
    const Defect& defect = GetParam();
    expect_found(results_of(std::string("importer_") + defect.library, 1, {"--only", defect.check}), defect);
}

const Defect kImporterDefects[] = {
    {"drops_last", "imports.truth", {"has 39 triangles, not 40"}},
    {"trusts_count", "imports.hostile", {"crashed"}},
    {"crashes", "imports.hostile", {"crashed (segmentation fault"}},
    {"endless", "imports.hostile", {"did not come to an end within"}},
    {"keeps_state", "imports.state", {"keeps state"}},
    {"ignores_cancel", "imports.cancel", {"must return RT_CANCELLED soon"}},
    {"leaks", "imports.leaks", {"it leaks memory"}},
    {"sure_of_all", "imports.table", {"it would take files of other importers"}},
    // what is in the world
    {"no_instance", "imports.read", {"places none of its", "sink->instance"}},
    {"mesh_left_over", "imports.read", {"a mesh without an instance, number 1"}},
    {"singular", "imports.read", {"1 instances with a singular transform"}},
    // what only a truth tells
    {"swaps_uv", "imports.truth", {"uv 0 1", "there should be", "uv 1 0"}},
    {"turns_uv_over", "imports.truth", {"uv 1 1", "uv 1 0"}},
    {"flips_winding", "imports.truth", {"wind the other way round"}},
    {"winds_last_back", "imports.truth", {"encloses a volume of"}},
    {"flips_normals", "imports.truth", {"the normal", "0 0 1", "there should be the normal 0 0 -1"}},
    {"turns_normals", "imports.truth", {"there should be the normal 0 0 -1"}},
    {"forgets_normals", "imports.truth", {"the normal none"}},
    {"material_again", "imports.truth", {"has 3 materials, not 2"}},
    {"last_material", "imports.truth", {"has 3 triangles of the material 'first', not 2", "1 of 'second'"}},
    {"loses_name", "imports.truth", {"has no instance with the name 'triangles'"}},
    {"moves_instance", "imports.truth", {"has an instance 'triangles' that goes from 0.25 to 1.25 along x"}},
    // memory that nobody has written, and state
    {"border_normals", "imports.memory", {"memory that it has not written", "the normal of vertex"}},
    {"uv_of_stack", "imports.memory", {"memory that it has not written", "a texture coordinate of vertex 2"}},
    {"first_differs", "imports.state", {"in a process that has read nothing before"}},
};
INSTANTIATE_TEST_SUITE_P(Plugins, BrokenImporter, testing::ValuesIn(kImporterDefects), name_of);

TEST_F(ImporterCheck, SoundOnePasses) {
    const json results = results_of("importer_none", 0);
    ASSERT_TRUE(results.is_array());
    EXPECT_EQ(results.size(), 8u);
    for (const json& result : results) EXPECT_EQ(result["status"], "passed") << result.dump(2);
}

TEST_F(ImporterCheck, AccusesNoneOfOurOwn) {
    const std::string cube =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
        "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    scratch_.write("cube.obj", cube);
    scratch_.write("cube.obj.json", R"({"triangles": 12, "area": 6, "bbox": [[0, 0, 0], [1, 1, 1]]})");
    for (const char* id : {"openmesh", "scene"}) {
        const std::string samples =
            std::string(id) == "scene" ? std::string(CLARITY_SOURCE_DIR) + "/scenes" : scratch_.path("");
        const ProgramResult result = run_program({"check", id, "--quick", "--samples", samples});
        EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
        EXPECT_NE(result.out.find("ok  " + std::string(id) + " imports.hostile"), std::string::npos) << result.out;
    }
}

}  // namespace
