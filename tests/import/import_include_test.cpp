// Files that load other files and name pictures: which ones are found, which are refused, and how parts are placed.
#include <cmath>
#include <filesystem>
#include <fstream>

#include "import_case.hpp"
#include "support/clock.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

class Include : public ImportCase, public ::testing::WithParamInterface<bool> {
 protected:
    void SetUp() override {
        ImportCase::SetUp();
        options_.in_process = GetParam();
    }
    // An uncompressed 24-bit TGA of one colour, as a simple valid picture.
    static std::string tga(int width, int height, char blue, char green, char red) {
        std::string text(18, '\0');
        text[2] = 2;
        text[12] = static_cast<char>(width & 255);
        text[13] = static_cast<char>(width >> 8);
        text[14] = static_cast<char>(height & 255);
        text[15] = static_cast<char>(height >> 8);
        text[16] = 24;
        for (int i = 0; i < width * height; ++i) text += {blue, green, red};
        return text;
    }
};
INSTANTIATE_TEST_SUITE_P(Ways, Include, ::testing::Bool(),
                         [](const auto& way) { return way.param ? std::string("in_process") : std::string("in_worker"); });

TEST_P(Include, a_part_is_imported_once_and_placed_often) {
    file("part.cltest", "triangles good 4");
    const Scene scene = import_text("load part.cltest 1 0\nload part.cltest 2 100\nload ./part.cltest 1 200");
    EXPECT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 3u);
    EXPECT_EQ(scene.instances[1].name, "part");
    EXPECT_EQ(scene.instances[1].world_from_object[3], 100.f);
    EXPECT_NEAR(scene.surface_area(), 2 + 4 * 2 + 2, 1e-5);
    EXPECT_EQ(scene.bounds().max[0], 207.f);
}

TEST_P(Include, everything_in_a_part_is_transformed) {
    file("part.cltest",
         "sphere 1 0 0 1\nplane 1 0 0 1\npolygon 0 0 0 1 0 0 0 1 0\nlight 1 0 0\nlight 0 1 0 1\n"
         "camera 1 0 0  0 0 0  0 1 0 .7");
    const Scene scene = import_text("camera 9 0 0 0 0 0 0 1 0 .7\nmaterial .5\nload part.cltest 2 10\nlight 7 7 7");
    ASSERT_EQ(scene.spheres.size(), 1u);
    EXPECT_EQ(scene.spheres[0].center[0], 12.f);
    EXPECT_EQ(scene.spheres[0].radius, 2.f);
    EXPECT_EQ(scene.spheres[0].material, 1u) << "the load's material is for all of the part";
    ASSERT_EQ(scene.planes.size(), 1u);
    EXPECT_EQ(scene.planes[0].normal[0], 1.f);
    EXPECT_NEAR(scene.planes[0].offset, 12.f, 1e-5f);
    EXPECT_NEAR(scene.surface_area(), 4 * 3.14159265 * 4 + 2, 1e-4);
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].values.position[0], 7.f) << "the file's own come first";
    EXPECT_EQ(scene.lights[1].values.position[0], 12.f);
    EXPECT_EQ(scene.lights[2].values.position[1], 1.f) << "a direction is not moved";
    ASSERT_EQ(scene.cameras.size(), 2u);
    EXPECT_EQ(scene.cameras[0].eye[0], 9.f);
    EXPECT_EQ(scene.cameras[1].eye[0], 12.f);
    EXPECT_EQ(scene.cameras[1].target[0], 10.f);
}

TEST_P(Include, paths_start_at_the_file_that_names_them) {
    file("parts/wheel.cltest", "triangles good 1");
    file("parts/car.cltest", "load wheel.cltest\nload ..\\parts\\wheel.cltest 1 5");
    const Scene scene = import_text("load parts/car.cltest");
    EXPECT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.meshes.size(), 1u);
}

TEST_P(Include, cycles_and_depth_are_bounded) {
    file("a.cltest", "load b.cltest");
    file("b.cltest", "load c.cltest");
    const std::string c = file("c.cltest", "load a.cltest");
    EXPECT_TRUE(contains(failure({c}), "in a circle: c.cltest -> a.cltest -> b.cltest -> c.cltest"));
    EXPECT_TRUE(contains(failure_of_text("load case.cltest"), "case.cltest -> case.cltest"));
    for (int i = 0; i < 40; ++i) file("d" + std::to_string(i) + ".cltest", "load d" + std::to_string(i + 1) + ".cltest");
    EXPECT_TRUE(contains(failure({path("d0.cltest")}), "more than 16 deep"));
    file("d15.cltest", "triangles good 1");
    EXPECT_EQ(import({path("d0.cltest")}).placed_triangle_count(), 1u) << "16 files deep is allowed";
}

TEST_P(Include, files_that_double_their_parts_end_in_an_error) {
    file("e0.cltest", "triangles good 1");
    for (int i = 1; i < 15; ++i) {
        std::string text;
        for (int k = 0; k < 8; ++k) text += "load e" + std::to_string(i - 1) + ".cltest 1 1\n";
        file("e" + std::to_string(i) + ".cltest", text);
    }
    const std::string message = failure({path("e14.cltest")});
    // A worker on a busy machine may be stopped by its limit of time first. In this process there is none.
    const bool is_late = !test::clocks_count() && contains(message, "made no progress");
    EXPECT_TRUE(is_late || contains(message, kThreadSanitizer ? ": " : "objects of loaded files are placed")) << message;
}

TEST_P(Include, nothing_outside_the_scene_folder_is_read) {
    file("elsewhere/secret.cltest", "triangles good 1");
    const std::string scene = file("inside/scene.cltest", "load ../elsewhere/secret.cltest");
    EXPECT_TRUE(contains(failure({scene}), "outside of the scene's own folder"));
    EXPECT_TRUE(contains(failure({file("inside/absolute.cltest", "load " + path("elsewhere/secret.cltest"))}), "outside"));
    fs::create_symlink(path("elsewhere"), path("inside/link"));
    EXPECT_TRUE(contains(failure({file("inside/linked.cltest", "load link/secret.cltest")}), "outside"));
    EXPECT_TRUE(
        contains(failure({file("inside/none.cltest", "load nothing.cltest")}), "cannot load 'nothing.cltest': no such file"));
    options_.search_paths = {path("elsewhere")};
    EXPECT_EQ(import({scene}).placed_triangle_count(), 1u) << "a search path opens it";
    EXPECT_EQ(import({file("inside/by_name.cltest", "load secret.cltest")}).placed_triangle_count(), 1u);
}

TEST_P(Include, a_link_that_the_user_names_is_followed) {
    file("store/model.cltest", "triangles good 1");
    fs::create_directory(path("desk"));
    fs::create_symlink(path("store/model.cltest"), path("desk/model.cltest"));
    EXPECT_EQ(import({path("desk/model.cltest")}).placed_triangle_count(), 1u);
}

TEST_P(Include, a_failing_part_fails_the_scene_and_names_both) {
    file("part.cltest", "fail the axle is bent");
    const std::string message = failure_of_text("triangles good 1\nload part.cltest");
    EXPECT_EQ(message, path("case.cltest") + ": cannot load 'part.cltest': the axle is bent");
    file("empty.cltest", "");
    EXPECT_TRUE(contains(failure_of_text("load empty.cltest"), "cannot load 'empty.cltest': the file is empty"));
    file("odd.abc", "?");
    EXPECT_TRUE(contains(failure_of_text("load odd.abc"), "no importer reads this kind of file"));
}

TEST_P(Include, pictures_are_decoded_once) {
    file("red.tga", tga(3, 2, 0, 0, '\xff'));
    const Scene scene = import_text("material 1 red.tga\nmaterial 1 ./red.tga\ntriangles good 1");
    ASSERT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(scene.textures[0].width, 3u);
    EXPECT_EQ(scene.textures[0].height, 2u);
    ASSERT_EQ(scene.texels.size(), 7u) << "six, and one of the smaller picture";
    EXPECT_EQ(scene.texels[0], 0xff0000ffu) << "R in the low byte, opaque";
    EXPECT_EQ(scene.materials.at(1).values.texture, 0u);
    EXPECT_EQ(scene.materials.at(2).values.texture, 0u);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_P(Include, pictures_are_found_under_the_paths_of_other_machines) {
    file("wood.tga", tga(1, 1, 1, 2, 3));
    file("textures/stone.tga", tga(1, 1, 4, 5, 6));
    const Scene scene = import_text("material 1 C:\\Users\\x\\maps\\wood.tga\nmaterial 1 /home/y/stone.tga\ntriangles good 1");
    EXPECT_EQ(scene.textures.size(), 2u);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST_P(Include, a_missing_or_broken_picture_is_a_warning) {
    file("broken.tga", tga(3, 2, 0, 0, 0).substr(0, 10));
    file("huge.tga", tga(1, 1, 0, 0, 0).replace(12, 4, "\xff\xff\xff\xff"));
    const Scene scene = import_text("material 1 gone.png\nmaterial 1 broken.tga\nmaterial 1 huge.tga\ntriangles good 1");
    EXPECT_EQ(scene.textures.size(), 0u);
    EXPECT_EQ(scene.materials.size(), 4u);
    for (const Material& material : scene.materials) EXPECT_EQ(material.values.texture, RT_NONE);
    ASSERT_EQ(scene.warnings.size(), 3u);
    EXPECT_TRUE(contains(scene.warnings[0], "texture 'gone.png': no such file"));
    EXPECT_TRUE(contains(scene.warnings[1], "texture 'broken.tga'"));
    EXPECT_TRUE(contains(scene.warnings[2], "texture 'huge.tga'"));
}

}  // namespace
}  // namespace clarity
