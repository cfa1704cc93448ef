// What importers deliver, good and bad, with both kinds of import: in this process and in the worker.
#include <fstream>

#include "import_case.hpp"

namespace clarity {
namespace {

class Sink : public ImportCase, public ::testing::WithParamInterface<bool> {
 protected:
    void SetUp() override {
        ImportCase::SetUp();
        options_.in_process = GetParam();
    }
};
INSTANTIATE_TEST_SUITE_P(Ways, Sink, ::testing::Bool(),
                         [](const auto& way) { return way.param ? std::string("in_process") : std::string("in_worker"); });

TEST_P(Sink, triangles_arrive_as_they_are) {
    const Scene scene = import_text("material .25\ntriangles good 3");
    EXPECT_EQ(scene.placed_triangle_count(), 3u);
    EXPECT_NEAR(scene.surface_area(), 1.5, 1e-6);
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].name, "row");
    EXPECT_EQ(scene.meshes[0].polygon_count, 3u);
    EXPECT_EQ(scene.instances.at(0).name, "placed");
    EXPECT_EQ(scene.triangles, (std::vector<rt_u32>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
    ASSERT_EQ(scene.materials.size(), 2u);
    EXPECT_EQ(scene.materials[1].values.color[0], 0.25f);
    EXPECT_EQ(scene.triangle_materials, (std::vector<rt_u32>{1, 1, 1}));
    EXPECT_EQ(scene.positions[3 * 4], 3.f) << "x of the second triangle's second corner";
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(validate(scene), "");
}

TEST_P(Sink, strided_attributes_are_unpacked_and_padded) {
    const Scene scene = import_text("triangles good 1\nface 0 0 1 0 1 1 0 1");
    ASSERT_EQ(scene.vertex_count(), 7u);
    ASSERT_EQ(scene.normals.size(), 21u);
    ASSERT_EQ(scene.uvs.size(), 14u);
    EXPECT_EQ(scene.normals[2], 0.f) << "the first mesh has none";
    EXPECT_EQ(scene.normals[3 * 5 + 2], 1.f);
    EXPECT_EQ(scene.uvs[2 * 5], 1.f);
    EXPECT_EQ(scene.uvs[2 * 5 + 1], 1.f);
    ASSERT_EQ(scene.colors.size(), 28u);
    for (size_t i = 0; i < 12; ++i) EXPECT_EQ(scene.colors[i], 1.f) << "the first mesh has none";
    const std::vector<float> last(scene.colors.begin() + 20, scene.colors.begin() + 24);
    EXPECT_EQ(last, (std::vector<float>{1, 0.5f, 100, 0})) << "what is out of range is limited";
    EXPECT_EQ(scene.meshes.at(1).polygon_count, 1u);
    EXPECT_EQ(scene.meshes.at(1).triangle_count, 2u);
}

TEST_P(Sink, bad_faces_are_left_out_with_one_warning) {
    for (const char* fault : {"nan", "infinite", "huge"}) {
        const Scene scene = import_text(std::string("triangles ") + fault + " 12 5");
        EXPECT_EQ(scene.placed_triangle_count(), 7u) << fault;
        ASSERT_EQ(scene.warnings.size(), 1u) << fault;
        EXPECT_TRUE(contains(scene.warnings[0], "case.cltest: 5 of 12 faces have corners that are not finite numbers"))
            << fault;
        EXPECT_EQ(scene.bounds().min[0], 10.f) << "what is left out counts for nothing";
    }
    const Scene scene = import_text("triangles index 4 1");
    EXPECT_EQ(scene.placed_triangle_count(), 3u);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(contains(scene.warnings[0], "1 of 4 faces have corners that name vertices which do not exist"));
}

TEST_P(Sink, a_file_of_bad_faces_fails) {
    EXPECT_TRUE(contains(failure_of_text("triangles nan 3 3"), "case.cltest: nothing of it can be used: 3 of 3 faces"));
    EXPECT_TRUE(contains(failure_of_text("triangles index 3 3"), "name vertices which do not exist"));
}

TEST_P(Sink, broken_descriptions_are_refused) {
    const std::pair<const char*, const char*> cases[] = {{"struct", "rt_mesh has struct_bytes 8"},
                                                         {"stride", "position_stride 4"},
                                                         {"positions", "no positions"},
                                                         {"count", "absurd"},
                                                         {"faces", "not three for each of 2 triangles"},
                                                         {"material", "material id 77 of 0"},
                                                         {"face_material", "material id 77 of 0"},
                                                         {"sizes", "3 corners, but there are 2 indices"},
                                                         {"instance_mesh", "mesh id 9 of 1"},
                                                         {"instance_material", "material id 3 of 0"}};
    for (const auto& [what, why] : cases) {
        EXPECT_TRUE(contains(failure_of_text(std::string("broken ") + what), why)) << what;
    }
}

TEST_P(Sink, analytic_primitives_and_views_arrive) {
    const Scene scene = import_text(
        "material .5\nsphere 1 2 3 4\nplane 0 2 0 2\npolygon 0 0 0  1 0 0  1 1 0  0 1 0\n"
        "light 1 2 3\nlight 0 5 0 1\ncamera 0 0 5  0 0 0  0 1 0  .5");
    ASSERT_EQ(scene.spheres.size(), 1u);
    EXPECT_EQ(scene.spheres[0].radius, 4.f);
    EXPECT_EQ(scene.spheres[0].material, 1u);
    ASSERT_EQ(scene.planes.size(), 1u);
    EXPECT_EQ(scene.planes[0].normal, (std::array<float, 3>{0, 1, 0}));
    EXPECT_EQ(scene.planes[0].offset, 1.f) << "2 y = 2 is the plane y = 1";
    ASSERT_EQ(scene.polygons.size(), 1u);
    EXPECT_EQ(scene.polygons[0].corner_count, 4u);
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(scene.lights[1].values.kind, RT_LIGHT_DIRECTIONAL);
    EXPECT_EQ(scene.lights[1].values.position[1], 1.f) << "made a unit vector";
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].name, "view");
    EXPECT_EQ(scene.cameras[0].fov_y_rad, 0.5f);
}

TEST_P(Sink, unusable_primitives_are_errors_and_unusable_views_warnings) {
    for (const char* text : {"sphere 0 0 0 0", "sphere 0 nan 0 1", "sphere 0 0 0 -1", "plane 0 0 0 1", "plane 0 inf 0 1",
                             "polygon 0 0 0 1 1 1", "polygon 0 0 0 1 0 0 nan 1 1"}) {
        EXPECT_FALSE(failure_of_text(text).empty()) << text;
    }
    const Scene scene =
        import_text("triangles good 1\ncamera 1 1 1 1 1 1 0 1 0 .5\nlight nan 0 0\ncamera 0 9 0 0 0 0 0 1 0 -1");
    EXPECT_TRUE(scene.lights.empty());
    ASSERT_EQ(scene.cameras.size(), 1u) << "the one that looks straight down gets another up vector and a field of view";
    EXPECT_NE(scene.cameras[0].up[1], 1.f);
    EXPECT_GT(scene.cameras[0].fov_y_rad, 0.1f);
    EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST_P(Sink, an_unknown_up_axis_is_y_with_a_warning) {
    EXPECT_EQ(import_text("triangles good 1\nup_axis 2").up_axis, 2u);
    const Scene scene = import_text("triangles good 1\nup_axis 3");
    EXPECT_EQ(scene.up_axis, 1u);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(contains(scene.warnings[0], "case.cltest: its importer says up axis 3 of 0, 1 and 2"));
}

TEST_P(Sink, transforms_that_are_not_finite_lose_the_instance) {
    const Scene scene = import_text("triangles good 1\ninstance 1 0 0 nan 0 1 0 0 0 0 1 0");
    EXPECT_EQ(scene.instances.size(), 1u);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(contains(scene.warnings[0], "1 of 2 objects have a transform that is not finite"));
}

TEST_P(Sink, a_flattened_instance_becomes_a_mesh_of_its_own) {
    const Scene scene = import_text("triangles good 1\ninstance 2 0 0 0  0 3 0 0  0 0 0 5");
    ASSERT_EQ(scene.instances.size(), 2u);
    Affine inverse;
    for (const Instance& instance : scene.instances) EXPECT_TRUE(invert(instance.world_from_object, inverse));
    EXPECT_EQ(scene.meshes.size(), 2u);
    EXPECT_NEAR(scene.surface_area(), 0.5 + 3.0, 1e-6);
    EXPECT_EQ(scene.bounds().max[2], 5.f);
}

TEST_P(Sink, plugin_failures_name_the_file) {
    const std::string file_path = path("case.cltest");
    EXPECT_EQ(failure_of_text("fail the roof leaks"), file_path + ": the roof leaks");
    EXPECT_TRUE(contains(failure_of_text("fail_silently"), file_path + ": failed without saying why"));
    EXPECT_TRUE(contains(failure_of_text("throw a tantrum"), "an exception escaped it: a tantrum"));
    EXPECT_TRUE(contains(failure_of_text("throw_number"), "an exception of unknown type"));
    EXPECT_TRUE(contains(failure_of_text("say_cancelled"), "had not asked it to stop"));
    EXPECT_EQ(failure_of_text("fail " + file_path + ":3:7: expected a comma"), file_path + ":3:7: expected a comma")
        << "a plugin that names file, line and column itself is not named twice";
}

TEST_P(Sink, warnings_are_bounded_and_logged) {
    std::string text = "triangles good 1\n";
    for (int i = 0; i < 250; ++i) text += "warn number " + std::to_string(i) + "\n";
    const Scene scene = import_text(text);
    ASSERT_EQ(scene.warnings.size(), 101u);
    EXPECT_EQ(scene.warnings[100], "and 150 warnings more");
    EXPECT_TRUE(contains(scene.warnings[7], "case.cltest: number 7"));
    size_t lines = 0;
    for (const std::string& line : logged()) lines += contains(line, "number ") || contains(line, "warnings more");
    EXPECT_EQ(lines, 101u) << "each once, whichever process it was found in";
}

TEST_P(Sink, files_that_no_importer_can_read) {
    const std::pair<std::string, const char*> cases[] = {{path("nowhere.cltest"), "no such file"},
                                                         {path(""), "is a folder"},
                                                         {file("empty.cltest", ""), "the file is empty"},
                                                         {file("packed.ply.gz", "\x1f\x8b\x08"), "gzip"},
                                                         {file("hidden.ply", "\x1f\x8b\x08"), "gzip"},
                                                         {file("picture.abc", "abc"), "the known ones are cltest"},
                                                         {"/dev/null", "no regular file"}};
    for (const auto& [name, why] : cases) {
        const std::string message = failure({name});
        EXPECT_TRUE(contains(message, why));
        EXPECT_EQ(message.compare(0, name.size(), name), 0) << message;
    }
}

TEST_P(Sink, a_file_without_surfaces_is_a_scene_with_a_warning) {
    const Scene scene = import_text("light 0 1 0");
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_TRUE(contains(scene.warnings[0], "no surface"));
}

TEST_P(Sink, several_files_make_one_scene) {
    const std::string a = file("a.cltest", "material .5\ntriangles good 2"),
                      b = file("b.cltest", "material .9\ntriangles good 3");
    const Scene scene = import({a, b});
    EXPECT_EQ(scene.placed_triangle_count(), 5u);
    EXPECT_EQ(scene.triangle_materials, (std::vector<rt_u32>{1, 1, 2, 2, 2}));
    EXPECT_EQ(import({a, a}).meshes.size(), 1u) << "the same file twice is one mesh, placed twice";
    EXPECT_TRUE(contains(failure({a, path("gone.cltest")}), "gone.cltest: no such file"));
}

}  // namespace
}  // namespace clarity
