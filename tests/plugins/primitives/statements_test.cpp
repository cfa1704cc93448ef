// Statements of shapes in text scenes: what they become, and what is said about wrong ones.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "import/import.hpp"
#include "support/scratch.hpp"
#include "support/workbench.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

Scene import_text(const Scratch& scratch, const std::string& text, bool in_process = false) {
    import::ImportOptions options;
    options.in_process = in_process;
    Progress progress;
    return import::import_scene(Workbench::get().plugins(), {scratch.write("a.scene", text)}, options, progress);
}

// The message without the folder.
std::string error_of(const std::string& text) {
    const Scratch scratch;
    try {
        import_text(scratch, text);
    } catch (const Error& e) {
        const std::string why = e.what(), path = scratch.path("");
        return why.compare(0, path.size(), path) == 0 ? why.substr(path.size()) : why;
    }
    return "no error";
}

class Places : public ::testing::TestWithParam<bool> {};

TEST_P(Places, AStatementBecomesAShape) {
    const Scratch scratch;
    const Scene scene = import_text(scratch,
                                    "material red color 1 0 0\n"
                                    "cylinder material red radius .5 to 0 3 0 from 0 1 0\n"
                                    "box from 1 1 1 to 0 2 3\n"
                                    "cylinder from 0 0 0 to 1 0 0 radius 2 caps 0\n",
                                    GetParam());
    ASSERT_EQ(scene.shapes.size(), 3u);
    ASSERT_EQ(scene.shape_kinds.size(), 2u);
    EXPECT_EQ(scene.shape_kinds[scene.shapes[0].kind].id, "cylinder");
    EXPECT_EQ(scene.shape_kinds[scene.shapes[0].kind].plugin, Workbench::get().plugins().primitive("cylinder"));
    EXPECT_EQ(scene.shapes[0].material, 1u);
    EXPECT_EQ(scene.shapes[1].material, 0u);
    const ShapePart& first = scene.shape_parts[scene.shapes[0].first_part];
    EXPECT_EQ(first.numbers[1], 1);
    EXPECT_EQ(first.numbers[4], 1);
    EXPECT_EQ(first.numbers[6], 2);
    EXPECT_EQ(first.numbers[8], 1) << "caps by default";
    EXPECT_EQ(first.min[0], -0.5f);
    EXPECT_EQ(first.max[1], 3);
    const ShapePart& box = scene.shape_parts[scene.shapes[1].first_part];
    EXPECT_EQ(box.numbers[0], 1) << "a shape without `prepare` gets its values";
    EXPECT_EQ(box.numbers[5], 3);
    EXPECT_EQ(box.min[0], 0);
    const Bounds bounds = scene.bounds();
    EXPECT_EQ(bounds.max[2], 3);
    EXPECT_EQ(place_of_prim(scene, 1).kind, PrimPlace::Kind::shape);
    EXPECT_EQ(place_of_prim(scene, 1).index, 1u);
}
INSTANTIATE_TEST_SUITE_P(All, Places, testing::Bool(), [](const auto& info) { return info.param ? "InProcess" : "InWorker"; });

TEST(ShapeStatements, PlacedFilesShareTheirParts) {
    const Scratch scratch;
    scratch.write("part.scene",
                  "nurbs points 0 0 0  1 0 0  2 0 1  3 0 0  0 1 0  1 1 2  2 1 0  3 1 0  0 2 0  1 2 0  2 2 0  3 2 0  "
                  "0 3 0  1 3 0  2 3 -1  3 3 0\n");
    const Scene scene = import_text(scratch,
                                    "material red color 1 0 0\nload \"part.scene\"\n"
                                    "load \"part.scene\" translate 5 0 0 material red\n");
    ASSERT_EQ(scene.shapes.size(), 2u);
    EXPECT_EQ(scene.shapes[0].first_part, scene.shapes[1].first_part);
    EXPECT_GT(scene.shapes[0].part_count, 1u);
    EXPECT_EQ(scene.shape_parts.size(), scene.shapes[0].part_count);
    EXPECT_EQ(scene.shapes[1].world_from_object[3], 5);
    EXPECT_EQ(scene.shapes[1].material, 1u);
}

TEST(ShapeStatements, OfALoadedFileThatMovesStayAtRest) {
    const Scratch scratch;
    scratch.write("part.scene", "sphere\nbox from 1 1 1 to 0 2 3\n");
    const std::string load = "load \"part.scene\" name part\n";
    EXPECT_TRUE(import_text(scratch, load).warnings.empty());
    const Scene scene = import_text(scratch, load + "animate part translate 0 0 0 0  1 5 0 0\n");
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("2 of its objects stay where they are at rest"), std::string::npos) << scene.warnings[0];
}

TEST(ShapeStatements, ErrorsNameThePlace) {
    EXPECT_EQ(error_of("\n cylindre from 0 0 0"),
              "a.scene:2:2: unknown statement `cylindre`; did you mean `cylinder`? (statements: camera, light, background, "
              "ambient, material, sphere, plane, polygon, triangle, load, animate, edit, sky, texture, box, cone, cylinder, "
              "disc, nurbs, "
              "torus)");
    EXPECT_EQ(error_of("cylinder from 0 0 0 to 0 1 0 radus .5"),
              "a.scene:1:30: unknown key `radus`; did you mean `radius`? (keys of cylinder: from, to, radius, caps, material)");
    EXPECT_EQ(error_of("cylinder from 0 0 0 to 0 1 0"),
              "a.scene:1:1: cylinder without `radius`; expected distance of the side from the axis");
    EXPECT_EQ(error_of("cylinder from 0 0 0 to 0 1 0 radius -1"),
              "a.scene:1:37: `-1` is out of range; expected `radius` (distance of the side from the axis) of 1e-12 at least");
    EXPECT_EQ(error_of("cylinder from 0 0 0 to 0 1 0 radius 1 caps .5"),
              "a.scene:1:44: expected a whole number for `caps` (1: with discs at both ends, 0: open)");
    EXPECT_EQ(
        error_of("disc normal 0 0 0"),
        "a.scene:1:13: the zero vector has no direction; expected another for `normal` (x y z of the direction that it faces)");
    EXPECT_EQ(error_of("box from 0 0 to 1 1 1"),
              "a.scene:1:14: `to` is no number; expected number 3 of 3 for `from` (x y z of a corner)");
    EXPECT_EQ(error_of("box from 0 0 0 to 1 1 1 material red"),
              "a.scene:1:34: unknown material `red` (defined in this file: none)");
    EXPECT_EQ(error_of("nurbs points 0 0 0 1 1"),
              "a.scene:1:23: 5 numbers for `points` (x y z of all points, row after row along u); expected 3 for each point");
}

// What only the shape's plugin knows.
TEST(ShapeStatements, PluginsRefuseValues) {
    EXPECT_EQ(error_of("plane normal 0 1 0\ncylinder from 1 1 1 to 1 1 1 radius 1"),
              "a.scene:2:1: cylinder: `from` and `to` are the same point; expected the two ends of its axis");
    EXPECT_EQ(error_of("torus radius 1 tube 2"),
              "a.scene:1:1: torus: `tube` is not below `radius`; expected a ring with a hole");
    EXPECT_EQ(error_of("nurbs points 0 0 0 1 0 0 0 1 0"), "a.scene:1:1: nurbs: 3 `points` are no full rows of `columns` 4");
    EXPECT_EQ(error_of("nurbs columns 2 degree_u 1 degree_v 1 points 0 0 0 1 0 0 0 1 0 1 1 0 knots_u 0 1 0 1"),
              "a.scene:1:1: nurbs: `knots_u` do not ascend; expected each knot at least as large as the one before");
    EXPECT_EQ(error_of("nurbs columns 2 degree_u 1 degree_v 1 points 0 0 0 1 0 0 0 1 0 1 1 0 weights 1 1 0 1"),
              "a.scene:1:1: nurbs: weight 3 is not above 0");
}

}  // namespace
