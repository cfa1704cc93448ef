// maps_test.cpp -- textures of all uses against closed forms: sets of coordinates, transforms, light of textures, smaller
// pictures and maps of normals.
#include <gtest/gtest.h>

#include <cmath>

#include "images/map_scenes.hpp"
#include "import/sink/texture.hpp"
#include "kernels/scene_features.hpp"
#include "launch/emitters/sky_table.hpp"
#include "scene/tangents.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

void expect_same(const FloatImage& a, const FloatImage& b, double room, const char* what) {
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    for (size_t i = 0; i < a.pixels.size(); ++i) ASSERT_NEAR(a.pixels[i], b.pixels[i], room) << what << " " << i;
}

TEST(Maps, ATextureOfOneColourIsTheFactor) {
    const auto byte = uint32_t(188);  // 0.5029 in linear light
    Scene mapped = white_square(), plain = white_square();
    mapped.uvs2 = mapped.uvs;
    add_map(mapped, 0, RT_MAP_COLOR, add_texture(mapped, 1, {0xff000000u | byte | byte << 8 | byte << 16}), 1);
    plain.materials[0].values = diffuse(0.50289f, 0.50289f, 0.50289f);
    const auto seen = pictures(mapped), wanted = pictures(plain);
    for (size_t i = 0; i < seen.size(); ++i) expect_same(seen[i], wanted[i], 0.004, "colour");
}

// Coordinates of the second set are those of the first, turned by a half.
TEST(Maps, NameTheirSetOfCoordinates) {
    for (const rt_u32 set : {0u, 1u}) {
        Scene scene = white_square();
        scene.uvs2 = {1, 1, 0, 1, 0, 0, 1, 0};
        scene.textures.clear();
        rt_map& map = add_map(scene, 0, RT_MAP_COLOR, add_texture(scene, 2, {kRed, kGreen, kBlue, kWhite}), set);
        map.matrix[2] = 1e-7f;  // no plain texture
        for (const FloatImage& image : pictures(scene)) {
            expect_color(image, 15, 15, set == 0 ? std::array{1.f, 0.f, 0.f} : std::array{1.f, 1.f, 1.f}, 0.06, "top left");
            expect_color(image, 48, 15, set == 0 ? std::array{0.f, 1.f, 0.f} : std::array{0.f, 0.f, 1.f}, 0.06, "top right");
        }
    }
}

// A quarter of a turn counter-clockwise of the coordinates, and half a picture to the right.
TEST(Maps, TransformTheirCoordinates) {
    Scene scene = white_square();
    rt_map& map = add_map(scene, 0, RT_MAP_COLOR, add_texture(scene, 2, {kRed, kGreen, kBlue, kWhite}));
    const float matrix[6] = {0, -1, 0.5f, 1, 0, 0};
    std::copy_n(matrix, 6, map.matrix);
    // The lower left quarter of the square, (1/4, 1/4), is at (1/4, 1/4) of the picture: blue. The lower right one, (3/4, 1/4),
    // is at (1/4, 3/4): red. The upper left one, (1/4, 3/4), is at (-1/4, 1/4), that is (3/4, 1/4): white.
    for (const FloatImage& image : pictures(scene)) {
        expect_color(image, 15, 48, {0, 0, 1}, 0.06, "bottom left");
        expect_color(image, 48, 48, {1, 0, 0}, 0.06, "bottom right");
        expect_color(image, 15, 15, {1, 1, 1}, 0.06, "top left");
    }
}

TEST(Maps, ANearestTextureHasEdges) {
    Scene scene = white_square();
    scene.materials[0].values.texture = add_texture(scene, 2, {kRed, kGreen, kBlue, kWhite}, RT_TEXTURE_NEAREST);
    const FloatImage image = trace(scene, flat_view(), 64, 64, 1, {{"lanes", "8"}}).image;
    expect_color(image, 31, 10, {1, 0, 0}, 1e-4, "left of the edge");
    expect_color(image, 32, 10, {0, 1, 0}, 1e-4, "right of it");
}

// The picture is on the lower left quarter. Beyond it is the border, where others show it again.
TEST(Maps, AClampedTextureEndsInItsBorder) {
    Scene scene = white_square();
    rt_map& map = add_map(scene, 0, RT_MAP_COLOR, add_texture(scene, 2, {kRed, kGreen, kBlue, kWhite}, RT_TEXTURE_NEAREST));
    map.matrix[0] = map.matrix[4] = 2;
    scene.textures.back().wrap = RT_WRAP_CLAMP + RT_WRAP_ALONG_V * RT_WRAP_CLAMP;
    const FloatImage image = trace(scene, flat_view(), 64, 64, 1, {{"lanes", "8"}}).image;
    expect_color(image, 8, 56, {0, 0, 1}, 1e-4, "in the picture");
    expect_color(image, 36, 56, {1, 1, 1}, 1e-4, "on the right of it");
    expect_color(image, 8, 4, {1, 0, 0}, 1e-4, "above it");
}

TEST(Maps, TexelsOfNumbersAreLinear) {
    Scene scene = white_square();
    scene.materials[0].values.texture = add_texture(scene, 1, {0xff808080u}, RT_TEXTURE_LINEAR);
    for (const FloatImage& image : pictures(scene)) expect_color(image, 30, 30, {.50196f, .50196f, .50196f}, 1e-3, "grey");
}

TEST(Maps, OcclusionDimsAmbientLightAlone) {
    Scene scene = white_square();
    add_map(scene, 0, RT_MAP_OCCLUSION, add_texture(scene, 1, {0xffffff00u}, RT_TEXTURE_LINEAR)).scale = 0.75f;
    expect_color(trace(scene, flat_view(), 64, 64, 1).image, 30, 30, {.25f, .25f, .25f}, 1e-4, "ambient");
    const PathPicture path = trace_paths(scene, flat_view(), 16, {{"strategy", "bsdf"}});
    EXPECT_NEAR(path.average(), 1, 1e-3) << "paths find what hides the sky themselves";
}

// Maps of the surface model of glTF: one texel of half a factor is half the factor.
TEST(Maps, MultiplyTheSurfaceModel) {
    const auto model = [](float factor) {
        Scene scene = white_square();
        MaterialValues& values = scene.materials[0].values;
        values.model = RT_MODEL_GLTF;
        values.roughness = 0.8f * factor;
        values.layers.metallic = 0.6f * factor;
        return scene;
    };
    View view = flat_view();
    view.background = {0, 0, 0};
    view.lights = {whitted_light(RT_LIGHT_POINT, {1, 1, 2}, {2, 2, 2})};
    const Pairs settings = {{"depth", "1"}, {"strategy", "nee"}};
    Scene mapped = model(1);
    add_map(mapped, 0, RT_MAP_METALLIC_ROUGHNESS, add_texture(mapped, 1, {0xff808000u}, RT_TEXTURE_LINEAR));
    const FloatImage seen = trace_paths(mapped, view, 4, settings).mean;
    expect_same(seen, trace_paths(model(128 / 255.f), view, 4, settings).mean, 1e-3, "half");
    // Pictures of one number each, in red: they count, and not the picture of both.
    Scene apart = model(1);
    add_map(apart, 0, RT_MAP_METALLIC_ROUGHNESS, add_texture(apart, 1, {0xff3355ccu}, RT_TEXTURE_LINEAR));
    const rt_u32 red = add_texture(apart, 1, {0xff112280u}, RT_TEXTURE_LINEAR);
    add_map(apart, 0, RT_MAP_ROUGHNESS, red);
    add_map(apart, 0, RT_MAP_METALLIC, red);
    expect_same(trace_paths(apart, view, 4, settings).mean, seen, 1e-6, "a picture for each");
    const FloatImage whole = trace_paths(model(1), view, 4, settings).mean;
    EXPECT_GT(std::fabs(whole.pixels[3 * (32 * 64 + 32)] - seen.pixels[3 * (32 * 64 + 32)]), 0.02) << "the factor counts";
}

// ---- light of textures

TEST(EmissionMaps, HalfAWhitePictureLightsHalf) {
    const double whole = lit_floor(lamp({}), "nee").average();
    EXPECT_GT(whole, 0.3);
    for (const char* strategy : {"nee", "bsdf", "mis"}) {
        const PathPicture half = lit_floor(lamp({kWhite, kBlack, kWhite, kBlack}), strategy);
        EXPECT_NEAR(half.average(), whole / 2, 4 * half.average_error() + 0.002) << strategy;
        const PathPicture white = lit_floor(lamp({kWhite, kWhite, kWhite, kWhite}), strategy);
        EXPECT_NEAR(white.average(), whole, 4 * white.average_error() + 0.002) << strategy;
    }
}

// The lit half is on the left, so the floor below it is brighter.
TEST(EmissionMaps, LightComesFromWhereItIs) {
    for (const char* strategy : {"nee", "bsdf", "mis"}) {
        Scene scene = lamp({kWhite, kBlack, kWhite, kBlack});
        View view = view_from({0, 0.9f, 0}, {0, 0, 0}, 90);
        view.camera.up = {0, 0, 1};
        view.background = {0, 0, 0};
        const PathPicture p =
            trace_paths(scene, view, 64, {{"strategy", strategy}, {"depth", "1"}, {"sampler", "independent"}});
        double left = 0, right = 0;
        for (unsigned y = 0; y < p.mean.height; ++y)
            for (unsigned x = 0; x < p.mean.width; ++x)
                (x < p.mean.width / 2 ? left : right) += p.mean.pixels[3 * (size_t(y) * p.mean.width + x) + 1];
        // With `up` = +z, +x is on the left of the picture.
        EXPECT_GT(right, 1.2 * left) << strategy;
    }
}

// As the surface of a mesh that is mirrored: the drawn point and its coordinates belong together.
TEST(EmissionMaps, FollowAMirroredInstance) {
    const double plain = lit_floor(lamp({kWhite, kBlack, kBlack, kBlack}), "nee").average();
    for (const char* strategy : {"nee", "bsdf"}) {
        Scene scene = lamp({kWhite, kBlack, kBlack, kBlack});
        scene.instances[0].world_from_object = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        const PathPicture mirrored = lit_floor(scene, strategy);
        EXPECT_NEAR(mirrored.average(), plain, 4 * mirrored.average_error() + 0.01 * plain) << strategy;
    }
}

TEST(EmissionMaps, TheMeanOfATriangleIsThatOfItsTexels) {
    Scene scene = lamp({kWhite, kBlack, kWhite, kBlack});
    EXPECT_NEAR(mean_of_map(scene, 0, 0), 0.5, 0.26);
    scene.uvs = {0.01f, 0.1f, 0.2f, 0.1f, 0.2f, 0.9f, 0.01f, 0.9f, 0, 0, 0, 0, 0, 0, 0, 0};
    EXPECT_NEAR(mean_of_map(scene, 0, 0), 1, 0.51);
    Scene dark = lamp({kBlack, kBlack, kBlack, kBlack});
    EXPECT_EQ(mean_of_map(dark, 0, 0), 0);
    EXPECT_EQ(lit_floor(dark, "mis").average(), 0);
}

// ---- smaller pictures

TEST(SmallerPictures, AreMeansInLinearLight) {
    Texels texels = {kWhite, 0x00000000u, 0x00000000u, kWhite};
    rt_texture texture = {0, 2, 2, 0, 0, 0, 0};
    import::add_smaller_pictures(texels, texture);
    ASSERT_EQ(texture.levels, 1u);
    ASSERT_EQ(texels.size(), 5u);
    EXPECT_EQ(texels[4], 0x80bcbcbcu) << "0.5 is 188 in sRGB; alpha is a plain number";
    texels.resize(4);
    texture = {0, 2, 2, 0, RT_TEXTURE_LINEAR, 0, 0};
    import::add_smaller_pictures(texels, texture);
    EXPECT_EQ(texels[4], 0x80808080u);
}

// Sides that are no powers of two: the mean of each level is that of the picture.
TEST(SmallerPictures, KeepTheMeanOfAnySize) {
    for (const auto& [width, height] : {std::pair(3u, 1u), std::pair(5u, 7u), std::pair(13u, 64u), std::pair(1u, 9u)}) {
        Texels texels;
        double mean = 0;
        for (rt_u32 i = 0; i < width * height; ++i) {
            const rt_u32 value = i * 7919 % 251;
            texels.push_back(0xff000000u | value);
            mean += double(value) / (width * height);
        }
        rt_texture texture = {0, width, height, 0, RT_TEXTURE_LINEAR, 0, 0};
        import::add_smaller_pictures(texels, texture);
        EXPECT_EQ(texel_count(texture), texels.size());
        EXPECT_NEAR(texels.back() & 255u, mean, 1 + texture.levels) << width << " x " << height;
    }
}

TEST(SmallerPictures, TakeAThirdOfTheirPicture) {
    Texels texels(1024 * 1024);
    rt_texture texture = {0, 1024, 1024, 0, 0, 0, 0};
    import::add_smaller_pictures(texels, texture);
    EXPECT_EQ(texture.levels, 10u);
    EXPECT_NEAR(double(texels.size()) / (1024 * 1024), 4.0 / 3, 1e-5);
}

// The only texture: black and white texels by turns, side x side, with its smaller pictures.
void put_checker(Scene& scene, rt_u32 side) {
    Texels texels;
    for (rt_u32 y = 0; y < side; ++y)
        for (rt_u32 x = 0; x < side; ++x) texels.push_back((x + y) % 2 ? kWhite : kBlack);
    rt_texture texture = {0, side, side, 0, 0, 0, 0};
    import::add_smaller_pictures(texels, texture);
    scene.texels.own() = texels;
    scene.textures = {texture};
    scene.materials[0].values.texture = 0;
}

// A checker of 256 x 256 texels in 7 x 7 pixels is grey: the mean of linear light. Where 8 pixels are hit, four texels meet,
// and the picture itself is as grey.
TEST(SmallerPictures, AreWhatDistantSurfacesShow) {
    Scene scene = white_square();
    put_checker(scene, 256);
    for (const auto& [tracer, lanes] : {std::pair("iterative", "8"), std::pair("wavefront", "1")}) {
        if (few_ways() && lanes == std::string("1")) continue;
        const FloatImage image =
            trace(scene, flat_view(), 7, 7, 1, {{"tracer", tracer}, {"lanes", lanes}, {"mips", "nearest"}}).image;
        for (const float channel : image.pixels) EXPECT_NEAR(channel, 0.5, 0.01) << tracer;
    }
    scene.textures[0].levels = 0;
    const FloatImage sharp =
        trace(scene, flat_view(), 7, 7, 1, {{"lanes", "8"}}).image;  // 8 pixels would each hit where four texels meet
    EXPECT_TRUE(std::any_of(sharp.pixels.begin(), sharp.pixels.end(), [](float c) { return std::fabs(c - 0.5f) > 0.02f; }))
        << "without them the picture depends on which texels rays hit";
}

// The only texture: 64 x 64 red texels, whose smaller pictures are green, blue and black.
void put_colored_levels(Scene& scene) {
    Texels texels;
    for (const auto& [side, color] :
         {std::pair(64, kRed), {32, kGreen}, {16, kBlue}, {8, kBlack}, {4, kBlack}, {2, kBlack}, {1, kBlack}})
        texels.insert(texels.end(), size_t(side) * size_t(side), color);
    scene.texels.own() = texels;
    scene.textures = {{0, 64, 64, 0, 0, 6, 0}};
    scene.materials[0].values.texture = 0;
}

// 64 x 64 texels in 32 x 32 pixels are the first of the smaller pictures, in 16 x 16 the second.
TEST(SmallerPictures, HaveTexelsAsWideAsPixels) {
    Scene scene = white_square();
    put_colored_levels(scene);
    const auto seen = [&](int side, const char* mips) {
        return pixel(trace(scene, flat_view(), side, side, 1, {{"mips", mips}}).image, side / 2, side / 2);
    };
    const auto expect_seen = [&](int side, const char* mips, const std::array<float, 3>& wanted) {
        const std::array<float, 3> color = seen(side, mips);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(color[k], wanted[k], 1e-5) << side << " pixels, mips " << mips << ", " << k;
    };
    expect_seen(64, "nearest", {1, 0, 0});
    expect_seen(32, "nearest", {0, 1, 0});
    expect_seen(16, "nearest", {0, 0, 1});
    for (const char* mips : {"off", "auto"}) expect_seen(16, mips, {1, 0, 0});  // the tracer is Whitted's
    const std::array<float, 3> between = seen(45, "smooth");                    // 1.4 texels a pixel
    EXPECT_NEAR(between[0], 0.5, 0.15);
    EXPECT_NEAR(between[1], 1 - between[0], 1e-3);
    // `path` mixes two, too. Its cones are half as wide, because a pixel is the mean of its samples.
    const auto of_paths = pixel(trace_paths(scene, flat_view(), 4, {{"strategy", "bsdf"}, {"size", "23x23"}}).mean, 11, 11);
    EXPECT_NEAR(of_paths[1], 0.5, 0.15);
    EXPECT_NEAR(of_paths[0], 1 - of_paths[1], 0.03);
}

// A camera next to a square looks at a plane half as far away as another square, which half mirrors the first one and half lets
// the second one through. Both are as far away along the rays as in the test above. A cone that began anew at the plane would
// be half as wide.
TEST(SmallerPictures, FollowMirrorsAndGlass) {
    Scene scene = white_square();
    put_colored_levels(scene);
    scene.instances.push_back(scene.instances[0]);
    scene.instances[1].world_from_object = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 5};
    MaterialValues half = diffuse(1, 1, 1);
    half.reflect = half.refract = 0.5f;
    half.ior = 1;
    scene.planes.push_back({{0, 0, -1}, -2.5f, add_material(scene, half)});
    View view = flat_view();
    view.background = {0, 0, 0};
    view.camera.eye = {1, 1, 1e-3f};
    view.camera.target = {1, 1, 5};
    for (const auto& [tracer, lanes] : {std::pair("iterative", "8"), {"iterative", "1"}, {"wavefront", "1"}}) {
        const auto seen =
            trace(scene, view, 32, 32, 2, {{"tracer", tracer}, {"lanes", lanes}, {"mips", "nearest"}, {"packet", "4x4"}}).image;
        expect_color(seen, 16, 16, {0, 1, 0}, 1e-3, tracer);
    }
}

// Seen as large as it is, the picture itself is shown. An instance of the same size, at any scale of its mesh, shows the same.
TEST(SmallerPictures, AreNotShownUpClose) {
    const auto checker = [](const Affine& placed) {
        Scene scene = white_square(placed);
        scene.instances[0].apart = true;
        for (float& p : scene.positions.own()) p /= placed[0];
        put_checker(scene, 8);
        return scene;
    };
    for (const float scale : {1.f, 0.01f, 300.f}) {
        const FloatImage image =
            trace(checker({scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, scale, 0}), flat_view(), 64, 64, 1, {{"mips", "nearest"}})
                .image;
        expect_color(image, 3, 3, {0, 0, 0}, 0.13, "a texel, but for a sixteenth along each axis");
        expect_color(image, 11, 3, {1, 1, 1}, 0.13, "the next one");
    }
}

TEST(SmallerPictures, OnlyScenesThatHaveThemPayForThem) {
    Scene scene = white_square();
    scene.materials[0].values.texture = add_texture(scene, 1, {kWhite});
    EXPECT_FALSE(features_of(scene, {}).mips);
    EXPECT_FALSE(features_of(scene, {}).maps);
    scene.textures[0].levels = 1;
    EXPECT_TRUE(features_of(scene, {}).mips);
    add_map(scene, 0, RT_MAP_EMISSION, 0);
    EXPECT_TRUE(features_of(scene, {}).maps);
}

// ---- maps of normals

// A square whose map of normals is one texel: the direction (x, y, z) in its frame.
Scene bent(double x, double y, double z, const std::vector<float>& uvs = {0, 0, 1, 0, 1, 1, 0, 1},
           const Affine& placed = kIdentity) {
    Scene scene = white_square(placed);
    scene.uvs.own() = uvs;
    const auto byte = [](double c) { return static_cast<uint32_t>(std::lround((c + 1) / 2 * 255)); };
    const uint32_t texel = 0xff000000u | byte(x) | byte(y) << 8 | byte(z) << 16;
    add_map(scene, 0, RT_MAP_NORMAL, add_texture(scene, 1, {texel}, RT_TEXTURE_LINEAR));
    make_tangents(scene);
    return scene;
}
// The light of a sun of Whitted's model from `towards`, on a white square: the cosine to the normal that is seen.
double cosine_seen(const Scene& scene, const Point& towards, const std::string& tracer = "iterative") {
    View view = flat_view();
    view.background = view.ambient = {0, 0, 0};
    view.lights = {whitted_light(RT_LIGHT_DIRECTIONAL, towards, {1, 1, 1})};
    if (tracer == "path") return trace_paths(scene, view, 1, {{"depth", "1"}}).average();
    return trace(scene, view, 16, 16, 1, {{"tracer", tracer}}).at(7, 7)[1];
}
// That of the normal with these components, which 8 bits have rounded.
double cosine_of(std::array<double, 3> n, const Point& towards) {
    double length = 0, sum = 0;
    for (double& c : n) c = 2 * std::lround((c + 1) / 2 * 255) / 255.0 - 1;
    for (int k = 0; k < 3; ++k) length += n[k] * n[k], sum += n[k] * towards[k];
    return sum / std::sqrt(length);
}

constexpr Point kSun = {0.36f, 0.48f, 0.8f};

// No normal is so steep that a mirrored ray would go below the square, seen from any pixel: `path` bends those.
TEST(NormalMaps, TurnTheNormalAlongTheCoordinates) {
    for (const std::string tracer : {"iterative", "wavefront", "path"}) {
        if (few_ways() && tracer == "wavefront") continue;
        EXPECT_NEAR(cosine_seen(bent(0.5, 0, 0.8), kSun, tracer), cosine_of({0.5, 0, 0.8}, kSun), 1e-3) << tracer;
        EXPECT_NEAR(cosine_seen(bent(-0.2, 0.5, 0.8), kSun, tracer), cosine_of({-0.2, 0.5, 0.8}, kSun), 1e-3) << tracer;
    }
}

// x follows u and y follows v, however they lie on the square.
TEST(NormalMaps, FollowTurnedAndMirroredCoordinates) {
    const std::array<double, 3> n = {0.5, 0.3, 0.75};
    const double x = n[0], y = n[1], z = n[2];
    // u along -y, v along x: turned.
    EXPECT_NEAR(cosine_seen(bent(x, y, z, {0, 0, 0, 1, -1, 1, -1, 0}), kSun), cosine_of({y, -x, z}, kSun), 1e-2);
    // u along -x, v along y: mirrored.
    EXPECT_NEAR(cosine_seen(bent(x, y, z, {0, 0, -1, 0, -1, 1, 0, 1}), kSun), cosine_of({-x, y, z}, kSun), 1e-2);
    // u along x, v along -y.
    EXPECT_NEAR(cosine_seen(bent(x, y, z, {0, 0, 1, 0, 1, -1, 0, -1}), kSun), cosine_of({x, -y, z}, kSun), 1e-2);
}

TEST(NormalMaps, FollowAnInstance) {
    const double x = 0.5, y = 0.3, z = 0.75;
    const std::vector<float> uvs = {0, 0, 1, 0, 1, 1, 0, 1};
    // A quarter of a turn about z, and larger: still one mesh, which is flattened into the world or kept apart.
    for (const bool apart : {false, true}) {
        Scene scene = bent(x, y, z, uvs, {0, -3, 0, 3, 3, 0, 0, -2, 0, 0, 3, 0});
        scene.instances[0].apart = apart;
        EXPECT_NEAR(cosine_seen(scene, kSun), cosine_of({-y, x, z}, kSun), 1e-2) << apart;
    }
    // Mirrored in x: the square's front stays in front, and its u goes along -x.
    EXPECT_NEAR(cosine_seen(bent(x, y, z, uvs, {-1, 0, 0, 2, 0, 1, 0, 0, 0, 0, 1, 0}), kSun), cosine_of({-x, y, z}, kSun),
                1e-2);
}

// A map that turns the picture turns what it says of directions.
TEST(NormalMaps, FollowTheTransformOfTheirTexture) {
    Scene scene = bent(0.5, 0.3, 0.75);
    const float matrix[6] = {0, 2, 0, -2, 0, 0};  // the picture's right is along the surface's v, its top along -u
    std::copy_n(matrix, 6, scene.maps[0].matrix);
    EXPECT_NEAR(cosine_seen(scene, kSun), cosine_of({-0.3, 0.5, 0.75}, kSun), 1e-2);
}

// The mirrored ray of a steep normal would go below the square. It stays above, so that a white mirror shows all of an even
// sky.
TEST(NormalMaps, AMirrorLosesNoLight) {
    Scene scene = bent(0.8, 0, 0.6);
    scene.materials[0].values.reflect = 1;
    const PathPicture p = trace_paths(scene, flat_view(), 4, {{"depth", "2"}});
    EXPECT_NEAR(p.average(), 1, 1e-3);
}

TEST(NormalMaps, HaveAScale) {
    Scene scene = bent(0.5, 0.2, 0.8);
    scene.maps[0].scale = 0.5f;
    EXPECT_NEAR(cosine_seen(scene, kSun), cosine_of({0.25, 0.1, 0.8}, kSun), 5e-3);
    scene.maps[0].scale = 0;
    EXPECT_NEAR(cosine_seen(scene, kSun), 0.8, 1e-3);
}

TEST(NormalMaps, AFlatOneChangesNothing) {
    Scene flat = white_square(), plain = white_square();
    add_map(flat, 0, RT_MAP_NORMAL, add_texture(flat, 1, {0xffff8080u}, RT_TEXTURE_LINEAR));  // 128, 128, 255
    make_tangents(flat);
    for (const Point& sun : {kSun, Point{0, 0.6f, 0.8f}, Point{0.8f, 0, 0.6f}})
        EXPECT_NEAR(cosine_seen(flat, sun), cosine_seen(plain, sun), 1.0 / 255);
}

// A smooth sphere of triangles with a seam: made tangents are those along its parallels.
TEST(NormalMaps, TangentsAreThoseOfTheCoordinates) {
    Scene scene = white_square();
    add_map(scene, 0, RT_MAP_NORMAL, add_texture(scene, 1, {0xffff8080u}, RT_TEXTURE_LINEAR));
    make_tangents(scene);
    Scene given = scene;
    given.tangents.own().assign(6, 0);
    const std::vector<float> tangents = {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1};
    for (const rt_u32 triangle : {0u, 1u}) store_tangents(given, triangle, tangents, 0);
    EXPECT_EQ(given.tangents.copy(), scene.tangents.copy());
    EXPECT_NE(scene.tangents[0], 0u);
    // Those of the file stay.
    given.tangents.own().assign(6, 0);
    for (const rt_u32 triangle : {0u, 1u}) store_tangents(given, triangle, {0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1}, 0);
    const std::vector<rt_u32> before = given.tangents.copy();
    make_tangents(given);
    EXPECT_EQ(given.tangents.copy(), before);
    EXPECT_NE(before, scene.tangents.copy());
}

// Where a mirrored half meets the other one, each triangle has the tangent of its own side.
TEST(NormalMaps, AVertexBetweenMirroredHalvesHasTwoTangents) {
    TriangleMesh mesh;
    for (const double x : {-1.0, 0.0, 1.0})
        for (const double y : {0.0, 1.0}) mesh.add_vertex(x, y, 0);
    mesh.add_triangle(0, 2, 1), mesh.add_triangle(2, 4, 3);
    Scene scene = scene_of(mesh);
    scene.uvs = {1, 0, 1, 1, 0, 0, 0, 1, 1, 0, 1, 1};
    add_map(scene, 0, RT_MAP_NORMAL, add_texture(scene, 1, {0xffff8080u}, RT_TEXTURE_LINEAR));
    make_tangents(scene);
    EXPECT_EQ(scene.tangents[0] & 1u, 1u) << "mirrored";
    EXPECT_EQ(scene.tangents[3] & 1u, 0u);
    const auto along_edge = [&](size_t corner) { return static_cast<int16_t>(scene.tangents[corner]) >> 1; };
    EXPECT_EQ(along_edge(1), -16383) << "against the edge from -1 to 0";
    EXPECT_EQ(along_edge(3), 16383) << "along the edge from 0 to 1";
}

}  // namespace
