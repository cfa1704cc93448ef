// fbx_detail_test.cpp -- sets of texture coordinates, smoothing, visibility, and what moves lights and cameras in FBX files.
#include <gtest/gtest.h>

#include <cmath>

#include "fbx_model.hpp"
#include "scene/motion/pose.hpp"

namespace clarity::test {
namespace {

constexpr int64_t kSecond = 46186158000;

class FbxDetailForm : public FbxForms {};
INSTANTIATE_TEST_SUITE_P(Forms, FbxDetailForm, kFbxForms, fbx_form_name);

FbxNode uv_set(int64_t number, const std::string& name, double first) {
    Numbers uvs;
    for (int i = 0; i < 6; ++i) uvs.insert(uvs.end(), {first + i, 0});
    return node("LayerElementUV", {whole(number)},
                {node("Name", {text(name)}), node("MappingInformationType", {text("ByPolygonVertex")}),
                 node("ReferenceInformationType", {text("Direct")}), node("UV", {uvs})});
}
FbxNode material(int64_t id) {
    return node("Material", {whole(id), text("Material::M"), text("")}, {node("Version", {whole(102)})});
}
FbxNode texture(int64_t id, const std::vector<FbxNode>& properties) {
    return node("Texture", {whole(id), text("Texture::T"), text("")}, {node("Properties70", {}, properties)});
}

TEST_P(FbxDetailForm, TakesTheSetOfCoordinatesThatATextureNames) {
    const FbxNode slots = node("LayerElementMaterial", {whole(0)},
                               {node("MappingInformationType", {text("ByPolygon")}), node("Materials", {Indices{0, 1}})});
    const auto first_coordinates = [&](const std::string& of_first, const std::string& of_second) {
        const Scene scene =
            import({geometry(1, {uv_set(0, "plain", 0), uv_set(1, "detail", 10), slots}), model(2, "A"), material(3),
                    material(4), texture(5, {word("UVSet", of_first)}), texture(6, {word("UVSet", of_second)})},
                   {link(2, 0), link(1, 2), link(3, 2), link(4, 2), link(5, 3, "DiffuseColor"), link(6, 4, "DiffuseColor")});
        return std::pair(scene.uvs[2 * size_t(scene.triangles[0])], scene.uvs[2 * size_t(scene.triangles[3])]);
    };
    EXPECT_EQ(first_coordinates("plain", "plain"), std::pair(0.f, 3.f));
    EXPECT_EQ(first_coordinates("detail", "detail"), std::pair(10.f, 13.f));
    EXPECT_EQ(first_coordinates("plain", "detail"), std::pair(0.f, 13.f));
    EXPECT_EQ(first_coordinates("detail", "default"), std::pair(10.f, 3.f)) << "the first set, if there is none of the name";
}

TEST_P(FbxDetailForm, LaysTexturesAsTheyAreTransformed) {
    folder_.write("dot.ppm", "P6 1 1 255\nabc");
    const auto scene_of = [&](FbxNode moved) {
        moved.children.push_back(node("FileName", {text("dot.ppm")}));
        return import({geometry(1, {uv_set(0, "plain", 0)}), model(2, "A"), material(3), moved},
                      {link(2, 0), link(1, 2), link(3, 2), link(5, 3, "DiffuseColor")});
    };
    // Where the point (u, v) of the surface lies on the picture.
    const auto place = [&](FbxNode moved, double u, double v) {
        const Scene scene = scene_of(std::move(moved));
        EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.at(0);
        const rt_u32 map = scene.materials.back().maps[RT_MAP_COLOR];
        if (map == RT_NONE) return std::array<double, 2>{u, v};
        const float* const m = scene.maps.at(map).matrix;
        return std::array<double, 2>{m[0] * u + m[1] * v + m[2], m[3] * u + m[4] * v + m[5]};
    };
    const auto expect = [&](const std::vector<FbxNode>& properties, double u, double v) {
        const auto [x, y] = place(texture(5, properties), 0.5, 0.25);
        EXPECT_NEAR(x, u, 1e-6);
        EXPECT_NEAR(y, v, 1e-6);
    };
    expect({}, 0.5, 0.25);
    EXPECT_NE(scene_of(texture(5, {property("Scaling", {1, 1, 1})})).materials.back().values.texture, RT_NONE);
    expect({property("Scaling", {2, 3, 1})}, 1, 0.75);
    // 3ds Max: tiling 2 and 3, offset 0.1 and 0.2; the picture's middle stays where it is but for the offset.
    expect({property("Scaling", {2, 3, 1}), property("Translation", {0.5 - 0.6 * 2, 0.5 - 0.7 * 3, 0})}, (0.5 - 0.6) * 2 + 0.5,
           (0.25 - 0.7) * 3 + 0.5);
    expect({property("Rotation", {0, 0, 90})}, -0.25, 0.5);
    expect({property("Rotation", {0, 0, 90}), property("TextureRotationPivot", {0.5, 0.5, 0})}, 0.75, 0.5);
    expect({property("Scaling", {2, 2, 1}), property("TextureScalingPivot", {0.5, 0.5, 0})}, 0.5, 0);
    expect({property("Scaling", {2, 1, 1}), property("Rotation", {0, 0, 90}), property("Translation", {0.125, 0, 0})},
           -0.25 + 0.125, 1);
    expect({node("P", {text("UVSwap"), text("bool"), text(""), text(""), whole(1)})}, 0.25, 0.5);
    FbxNode blocks = texture(5, {});
    blocks.children.push_back(node("ModelUVTranslation", {0.5, 0.0}));
    blocks.children.push_back(node("ModelUVScaling", {2.0, 1.0}));
    EXPECT_EQ(place(blocks, 0.5, 0.25), (std::array<double, 2>{1.5, 0.25}));
    EXPECT_TRUE(warns_of(scene_of(texture(5, {property("Rotation", {30, 0, 0})})),
                         "'M': left out the rotation about u and v of the texture 'T'"));
}

// Two textures of one material in two sets: the mesh has both, and each use names its own.
TEST_P(FbxDetailForm, TexturesOfOneMaterialHaveSetsOfTheirOwn) {
    folder_.write("dot.ppm", "P6 1 1 255\nabc");
    const auto of_set = [](int64_t id, const std::string& set, double scale) {
        FbxNode out = texture(id, {word("UVSet", set), property("Scaling", {scale, 1, 1})});
        out.children.push_back(node("FileName", {text("dot.ppm")}));
        return out;
    };
    const std::vector<FbxNode> links = {
        link(2, 0), link(1, 2), link(3, 2), link(5, 3, "DiffuseColor"), link(6, 3, "EmissiveColor"), link(7, 3, "NormalMap")};
    const auto with = [&](const std::string& third) {
        return import({geometry(1, {uv_set(0, "plain", 0), uv_set(1, "detail", 10), uv_set(2, "more", 20)}), model(2, "A"),
                       material(3), of_set(5, "plain", 1), of_set(6, "detail", 3), of_set(7, third, 1)},
                      links);
    };
    const Scene scene = with("plain");
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.at(0);
    const Material& m = scene.materials.back();
    ASSERT_EQ(scene.uvs2.size(), scene.uvs.size());
    EXPECT_EQ(scene.uvs[2 * size_t(scene.triangles[3])], 3);
    EXPECT_EQ(scene.uvs2[2 * size_t(scene.triangles[3])], 13);
    const rt_map& emission = scene.maps.at(m.maps[RT_MAP_EMISSION]);
    EXPECT_EQ(emission.set, 1u);
    EXPECT_EQ(emission.matrix[0], 3);
    EXPECT_EQ(scene.maps.at(m.maps[RT_MAP_NORMAL]).set, 0u);
    EXPECT_TRUE(warns_of(with("more"), "the third set of coordinates, of the texture 'T'"));
}

TEST_P(FbxDetailForm, TakesWrapModesOfTextures) {
    folder_.write("dot.ppm", "P6 1 1 255\nabc");
    const auto wraps_of = [&](const std::vector<FbxNode>& properties) {
        FbxNode with_picture = texture(5, properties);
        with_picture.children.push_back(node("FileName", {text("dot.ppm")}));
        const Scene scene = import({geometry(1, {uv_set(0, "plain", 0)}), model(2, "A"), material(3), with_picture},
                                   {link(2, 0), link(1, 2), link(3, 2), link(5, 3, "DiffuseColor")});
        EXPECT_EQ(scene.textures.size(), 1u);
        return scene.textures.empty() ? std::pair<rt_u32, rt_u32>(9, 9)
                                      : std::pair<rt_u32, rt_u32>(scene.textures[0].wrap % RT_WRAP_ALONG_V,
                                                                  scene.textures[0].wrap / RT_WRAP_ALONG_V);
    };
    const auto mode = [](const std::string& name, int64_t value) {
        return node("P", {text(name), text("enum"), text(""), text(""), whole(value)});
    };
    using Modes = std::pair<rt_u32, rt_u32>;
    EXPECT_EQ(wraps_of({}), Modes(RT_WRAP_REPEAT, RT_WRAP_REPEAT));
    EXPECT_EQ(wraps_of({mode("WrapModeU", 0), mode("WrapModeV", 1)}), Modes(RT_WRAP_REPEAT, RT_WRAP_CLAMP));
    EXPECT_EQ(wraps_of({mode("WrapModeU", 1), mode("WrapModeV", 0)}), Modes(RT_WRAP_CLAMP, RT_WRAP_REPEAT));
}

TEST_P(FbxDetailForm, TakesTexturesOfEmissionAndNormals) {
    folder_.write("dot.ppm", "P6 1 1 255\nabc");
    const auto with = [&](const std::string& property) {
        FbxNode with_picture = texture(5, {});
        with_picture.children.push_back(node("FileName", {text("dot.ppm")}));
        return import({geometry(1, {uv_set(0, "plain", 0)}), model(2, "A"), material(3), with_picture},
                      {link(2, 0), link(1, 2), link(3, 2), link(5, 3, property)});
    };
    const Scene shining = with("EmissiveColor");
    EXPECT_NE(shining.materials.back().maps[RT_MAP_EMISSION], RT_NONE);
    EXPECT_EQ(shining.materials.back().values.emission[0], 1) << "the picture replaces the value";
    EXPECT_EQ(shining.materials.back().values.texture, RT_NONE);
    const Scene mapped = with("NormalMap");
    ASSERT_NE(mapped.materials.back().maps[RT_MAP_NORMAL], RT_NONE);
    EXPECT_EQ(mapped.textures.at(0).flags, RT_TEXTURE_LINEAR);
    EXPECT_EQ(mapped.texels[0] & 0xffu, 0x61u);
    EXPECT_EQ(mapped.materials.back().values.emission[0], 0);
    const Scene bumped = with("Bump");
    ASSERT_NE(bumped.materials.back().maps[RT_MAP_NORMAL], RT_NONE);
    EXPECT_EQ(bumped.texels[0] & 0xffffffu, 0xff8080u) << "heights that are all alike are a flat surface";
}

TEST_P(FbxDetailForm, TakesTheAlphaOfThePictureOfTheColour) {
    folder_.write("dot.ppm", "P6 1 1 255\nabc");
    const auto with = [&](const std::vector<FbxNode>& properties, const std::vector<FbxNode>& links) {
        std::vector<FbxNode> objects = {geometry(1, {uv_set(0, "plain", 0)}), model(2, "A"), material(3)};
        objects.back().children.push_back(node("Properties70", {}, properties));
        for (const int64_t id : {5, 6}) {
            objects.push_back(texture(id, {}));
            objects.back().children.push_back(node("FileName", {text("dot.ppm")}));
        }
        std::vector<FbxNode> all = {link(2, 0), link(1, 2), link(3, 2), link(5, 3, "DiffuseColor")};
        all.insert(all.end(), links.begin(), links.end());
        return import(objects, all);
    };
    EXPECT_EQ(with({}, {}).materials.back().values.alpha, RT_ALPHA_OPAQUE);
    const rt_material half =
        with({property("TransparentColor", {1, 1, 1}), property("TransparencyFactor", {0.5})}, {}).materials.back().values;
    EXPECT_EQ(half.alpha, RT_ALPHA_BLEND);
    EXPECT_EQ(half.opacity, 0.5f);
    EXPECT_EQ(half.refract, 0);
    const rt_material cut = with({}, {link(5, 3, "TransparentColor")}).materials.back().values;
    EXPECT_EQ(cut.alpha, RT_ALPHA_BLEND);
    EXPECT_EQ(cut.opacity, 1);
    EXPECT_TRUE(
        warns_of(with({}, {link(6, 3, "TransparentColor")}), "pictures of the transparency of 1 materials are left out"));
}

// Two triangles that meet at a right angle along the edge from vertex 0 to vertex 1.
FbxNode roof(const std::string& mapping, const Indices& smoothing) {
    return node("Geometry", {whole(1), text("Geometry::Roof"), text("Mesh")},
                {node("Vertices", {Numbers{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}}),
                 node("PolygonVertexIndex", {Indices{0, 1, -3, 1, 0, -4}}), node("Edges", {Indices{0, 1, 2, 4, 5}}),
                 node("LayerElementSmoothing", {whole(0)},
                      {node("MappingInformationType", {text(mapping)}), node("Smoothing", {smoothing})})});
}

TEST_P(FbxDetailForm, SmoothsByGroupsOfFacesAndByEdges) {
    // The normal of the first triangle's corner at vertex 0, or zeros.
    const auto normal = [&](const std::string& mapping, const Indices& smoothing) {
        const Scene scene = import({roof(mapping, smoothing), model(2, "A")}, {link(2, 0), link(1, 2)});
        const size_t at = 3 * size_t(scene.triangles[0]);
        return scene.normals.empty() ? std::array<float, 3>{}
                                     : std::array<float, 3>{scene.normals[at], scene.normals[at + 1], scene.normals[at + 2]};
    };
    const auto expect = [](const std::array<float, 3>& found, float x, float y, float z) {
        EXPECT_NEAR(found[0], x, 1e-6);
        EXPECT_NEAR(found[1], y, 1e-6);
        EXPECT_NEAR(found[2], z, 1e-6);
    };
    const float half = std::sqrt(0.5f);
    expect(normal("ByPolygon", {1, 1}), 0, half, half);
    expect(normal("ByPolygon", {3, 6}), 0, half, half);  // both are in the second group
    expect(normal("ByPolygon", {1, 2}), 0, 0, 1);
    expect(normal("ByPolygon", {0, 0}), 0, 0, 0);
    expect(normal("ByEdge", {1, 0, 0, 0, 0}), 0, half, half);
    expect(normal("ByEdge", {0, 1, 1, 1, 1}), 0, 0, 1);
    expect(normal("ByEdge", {0, 0, 0, 0, 0}), 0, 0, 0);
}

// A clip of one second whose objects `nodes` move properties: {id of the curve node, object, property, component, end value}.
struct Moved {
    int64_t object;
    std::string property, component;
    double from, to;
};
void add_clip(const std::vector<Moved>& moved, std::vector<FbxNode>& objects, std::vector<FbxNode>& links) {
    objects.push_back(node("AnimationStack", {whole(100), text("AnimStack::Move"), text("")}, {node("Properties70", {}, {})}));
    objects.push_back(node("AnimationLayer", {whole(101), text("AnimLayer::Base"), text("")}, {node("Version", {whole(1)})}));
    links.push_back(link(101, 100));
    int64_t id = 102;
    for (const Moved& m : moved) {
        objects.push_back(
            node("AnimationCurveNode", {whole(id), text("AnimCurveNode::N"), text("")}, {node("Version", {whole(1)})}));
        objects.push_back(node("AnimationCurve", {whole(id + 1), text("AnimCurve::"), text("")},
                               {node("KeyTime", {Numbers{0, double(kSecond)}}), node("KeyValueFloat", {Numbers{m.from, m.to}}),
                                node("KeyAttrFlags", {Indices{4}}), node("KeyAttrDataFloat", {Numbers{0, 0, 0, 0}}),
                                node("KeyAttrRefCount", {Indices{2}})}));
        links.push_back(link(id, 101));
        links.push_back(link(id, m.object, m.property));
        links.push_back(link(id + 1, id, "d|" + m.component));
        id += 2;
    }
}

TEST_P(FbxDetailForm, MovesColoursOfLightsAndAnglesOfCameras) {
    const auto attribute = [](int64_t id, const std::string& type, const std::vector<FbxNode>& properties) {
        return node("NodeAttribute", {whole(id), text("NodeAttribute::N"), text(type)}, {node("Properties70", {}, properties)});
    };
    std::vector<FbxNode> objects = {geometry(1),
                                    model(2, "A"),
                                    model(3, "Lamp"),
                                    attribute(4, "Light", {property("Color", {1, 0.5, 0.25}), property("Intensity", {100})}),
                                    model(5, "Sun"),
                                    attribute(6, "Light", {property("Color", {1, 1, 1}), property("Intensity", {200})}),
                                    model(7, "Eye"),
                                    attribute(8, "Camera",
                                              {property("ApertureMode", {1}), property("FieldOfView", {90}),
                                               property("AspectWidth", {2}), property("AspectHeight", {1})}),
                                    model(9, "Lens"),
                                    attribute(10, "Camera",
                                              {property("ApertureMode", {3}), property("FocalLength", {25.4}),
                                               property("FilmHeight", {2}), property("FilmWidth", {2})})};
    std::vector<FbxNode> links = {link(2, 0), link(1, 2), link(3, 0), link(4, 3), link(5, 0),
                                  link(6, 5), link(7, 0), link(8, 7), link(9, 0), link(10, 9)};
    add_clip({{4, "Intensity", "Intensity", 100, 0},
              {6, "Color", "Y", 1, 0},
              {8, "FieldOfView", "FieldOfView", 90, 60},
              {10, "FocalLength", "FocalLength", 25.4, 50.8}},
             objects, links);
    const Scene scene = import(objects, links);
    ASSERT_EQ(scene.lights.size(), 2u);
    ASSERT_EQ(scene.cameras.size(), 2u);
    // The brightest light has the intensity 2, so both are halved.
    const Pose begin = evaluate(scene, "Move", 0), middle = evaluate(scene, "Move", 0.5), end = evaluate(scene, "Move", 1);
    EXPECT_NEAR(begin.lights[0].values.color[1], 0.25, 1e-6);
    EXPECT_NEAR(middle.lights[0].values.color[0], 0.25, 1e-6);
    EXPECT_NEAR(middle.lights[0].values.color[2], 0.0625, 1e-6);
    EXPECT_NEAR(end.lights[0].values.color[0], 0, 1e-6);
    EXPECT_NEAR(middle.lights[1].values.color[0], 1, 1e-6) << "a component without a curve keeps its value";
    EXPECT_NEAR(middle.lights[1].values.color[1], 0.5, 1e-6);
    // 90 degrees across an aspect of 2; a film as high as 2 inches behind a lens of 1 and 2 inches.
    EXPECT_NEAR(begin.cameras[0].fov_y_rad, 2 * std::atan(0.5), 1e-6);
    EXPECT_NEAR(end.cameras[0].fov_y_rad, 2 * std::atan(std::tan(std::acos(-1) / 6) / 2), 1e-6);
    EXPECT_NEAR(begin.cameras[1].fov_y_rad, std::acos(0.), 1e-6);
    EXPECT_NEAR(end.cameras[1].fov_y_rad, 2 * std::atan(0.5), 1e-6);
}

TEST_P(FbxDetailForm, SpotsKeepTheirCones) {
    const FbxNode light = node(
        "NodeAttribute", {whole(4), text("NodeAttribute::N"), text("Light")},
        {node("Properties70", {}, {property("LightType", {2}), property("OuterAngle", {50}), property("InnerAngle", {20})})});
    const Scene scene =
        import({geometry(1), model(2, "A"), model(3, "Lamp"), light}, {link(2, 0), link(1, 2), link(3, 0), link(4, 3)});
    ASSERT_EQ(scene.lights.size(), 1u);
    const rt_light& spot = scene.lights[0].values;
    EXPECT_EQ(spot.kind, RT_LIGHT_SPOT);
    EXPECT_NEAR(spot.normal[1], -1, 1e-6) << "it shines along -y";
    EXPECT_NEAR(spot.angle, 50, 1e-4);
    EXPECT_NEAR(spot.inner, 20, 1e-4);
}

// What intensities mean: see meaning_of() of the importer. In units of a centimetre.
TEST_P(FbxDetailForm, LightsFadeAsTheirDecaySays) {
    Scene scene;
    const auto light = [&](const std::vector<FbxNode>& properties, const std::string& creator = "by hand") -> const rt_light& {
        const FbxNode attribute =
            node("NodeAttribute", {whole(4), text("NodeAttribute::N"), text("Light")}, {node("Properties70", {}, properties)});
        scene = import({geometry(1), model(2, "A"), model(3, "Lamp"), attribute},
                       {link(2, 0), link(1, 2), link(3, 0), link(4, 3)}, creator);
        EXPECT_EQ(scene.lights.size(), 1u);
        return scene.lights.at(0).values;
    };
    const std::string blender = "Blender (stable FBX IO) - 3.4.1 - 4.37.5";
    const double pi = std::acos(-1.0);
    const rt_light none = light({property("Intensity", {400})});
    EXPECT_EQ(none.flags, 0u);
    EXPECT_EQ(none.color[0], 1) << "scaled";
    const rt_light quadratic = light({property("Intensity", {400}), property("DecayType", {2})});
    EXPECT_EQ(quadratic.flags, RT_LIGHT_FALLOFF);
    EXPECT_NEAR(quadratic.color[0], 4 * pi, 1e-5);
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(light({property("DecayType", {3})}).flags, RT_LIGHT_FALLOFF);
    EXPECT_TRUE(warns_of(scene, "has a cubic decay"));
    // 1000 W, a metre is 100 units.
    const rt_light watts = light({property("Intensity", {100000}), property("DecayType", {2})}, blender);
    EXPECT_NEAR(watts.color[0] / (1000 / (4 * pi) * 1e4), 1, 1e-5);
    const rt_light sun = light({property("LightType", {1}), property("Intensity", {300})}, blender);
    EXPECT_EQ(sun.kind, RT_LIGHT_SUN);
    EXPECT_EQ(sun.color[0], 3);
    EXPECT_EQ(light({property("LightType", {1}), property("Intensity", {300})}).kind, RT_LIGHT_DIRECTIONAL);
    const rt_light area = light({property("LightType", {3}), property("Intensity", {300})});
    EXPECT_EQ(area.kind, RT_LIGHT_RECT);
    EXPECT_EQ(area.color[0], 3);
    EXPECT_NEAR(area.area, 4, 1e-6);
    EXPECT_NEAR(area.normal[1], -1, 1e-6) << "it shines along -y";
    EXPECT_EQ(light({property("LightType", {3})}, blender).kind, RT_LIGHT_POINT);
    EXPECT_TRUE(warns_of(scene, "became a point light, because the file does not say how large"));
}

TEST_P(FbxDetailForm, ShowsWhatItsParentHidesOnlyWhereItSays) {
    std::vector<FbxNode> objects = {geometry(1), model(2, "Hidden", {property("Visibility", {0})}), model(3, "Follows"),
                                    model(4, "Own", {property("Visibility Inheritance", {0})})};
    std::vector<FbxNode> links = {link(2, 0), link(3, 2), link(4, 2), link(1, 3), link(1, 4)};
    const Scene rest = import(objects, links);
    ASSERT_EQ(rest.instances.size(), 2u);
    EXPECT_FALSE(rest.instances[0].visible);
    EXPECT_TRUE(rest.instances[1].visible);
    add_clip({{2, "Visibility", "Visibility", 0, 1}}, objects, links);
    const Scene scene = import(objects, links);
    EXPECT_FALSE(evaluate(scene, "Move", 0.25).instances[0].visible);
    EXPECT_TRUE(evaluate(scene, "Move", 0.75).instances[0].visible) << "its parent is seen then";
}

}  // namespace
}  // namespace clarity::test
