// Faulty scene files and their messages: where the error is, what was read, and what was expected.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "recorder.hpp"
#include "scene/light_kinds.hpp"
#include "scene/material_keys.hpp"

namespace {

struct Case {
    const char* text;
    const char* message;  // the part after "test.scene:"
};

#define STATEMENTS                                                                                                             \
    " (statements: camera, light, background, ambient, material, sphere, plane, polygon, triangle, load, animate, edit, sky, " \
    "texture)"

// Stands for the kinds of lights.
#define LIGHTS "@"

const Case kCases[] = {
    {"sphere radious 2", "1:8: unknown key `radious`; did you mean `radius`? (keys of sphere: center, radius, material)"},
    {"spere", "1:1: unknown statement `spere`; did you mean `sphere`?" STATEMENTS},
    {"Sphere", "1:1: unknown statement `Sphere`; did you mean `sphere`?" STATEMENTS},
    {"\"sphere\"", "1:1: text in quotes, `sphere`; expected a statement, without quotes"},
    {"12 34", "1:1: unknown statement `12`" STATEMENTS},
    {"sphere radius", "1:14: the line ends here; expected a number for `radius`"},
    {"sphere radius big", "1:15: `big` is no number; expected a number for `radius`"},
    {"sphere radius 1.5x", "1:15: `1.5x` goes on behind a number; expected a number for `radius`"},
    {"sphere radius 1e999", "1:15: `1e999` is out of range; expected a number for `radius`, finite and of size 1e+15 at most"},
    {"sphere radius nan", "1:15: `nan` is out of range; expected a number for `radius`, finite and of size 1e+15 at most"},
    {"sphere radius -inf", "1:15: `-inf` is out of range; expected a number for `radius`, finite and of size 1e+15 at most"},
    {"sphere radius 0x10", "1:15: `0x10` goes on behind a number; expected a number for `radius`"},
    {"sphere radius 1,5", "1:15: `1,5` goes on behind a number; expected a number for `radius` (the decimal sign is a point)"},
    {"sphere radius 0", "1:15: a radius is positive; expected a number greater than 0 for `radius`"},
    {"sphere radius \"1\"", "1:15: text in quotes, `1`; expected a number for `radius`"},
    {"sphere center 1 2", "1:18: the line ends here; expected number 3 of 3 for `center` (x y z)"},
    {"sphere center 1 2 3 4",
     "1:21: number `4` is one too many; expected a key or the line's end (keys of sphere: center, radius, material)"},
    {"sphere radius 1 radius 2", "1:17: key `radius` for the second time; the first is in column 8"},
    {"sphere center 0 0 0 material", "1:29: the line ends here; expected a material's name"},
    {"sphere material gless\nmaterial glass",
     "1:17: unknown material `gless`; did you mean `glass`? (defined in this file: `glass`)"},
    {"sphere material 3", "1:17: number `3`; expected a material's name (in quotes, if it looks like a number)"},
    {"sphere material radius", "1:17: key `radius`; expected a material's name (in quotes, if that is what it is)"},
    {"plane normal 0 0 0", "1:14: the zero vector has no direction; expected another for `normal` (x y z)"},
    {"camera", "1:7: the line ends here; expected the camera's name"},
    {"camera eye 0 0 1", "1:8: key `eye`; expected the camera's name (in quotes, if that is what it is)"},
    {"camera a eye 0 0 0 target 0 0 0", "1:8: `eye` and `target` are the same point; expected different ones"},
    {"camera a eye 0 5 0 target 0 0 0",
     "1:8: the camera looks along its `up` vector; expected another `up` (0 0 -1, say, to look down)"},
    {"camera a fov 180", "1:14: `180` is out of range; expected `fov` (vertical, degrees) between 0.1 and 179"},
    {"camera a\ncamera a", "2:8: camera `a` for the second time; the first is in line 1"},
    {"texture", "1:8: the line ends here; expected the texture's name"},
    {"texture a", "1:10: the line ends here; expected the picture's file"},
    {"texture a a.png space sRGB",
     "1:23: `sRGB` is no colour space; did you mean `srgb`? (expected: srgb, linear, height, alpha, clearness)"},
    {"texture a a.png scale 0", "1:23: expected one or two numbers other than 0 for `scale` (of u and v, or one for both)"},
    {"texture a a.png scale 1 2 3", "1:23: expected one or two numbers other than 0 for `scale` (of u and v, or one for both)"},
    {"texture a a.png offset 1", "1:25: the line ends here; expected number 2 of 2 for `offset` (u v)"},
    {"texture a a.png uv 2", "1:20: `2` is no set of texture coordinates (expected: 0, 1)"},
    {"texture a a.png\ntexture a b.png", "2:9: texture `a` for the second time; the first is in line 1"},
    {"texture planks a.png\nmaterial m color_map plank",
     "2:22: unknown texture `plank`; did you mean `planks`? (defined in this file: `planks`)"},
    {"texture a a.png\nmaterial m texture b.png color_map a",
     "2:36: `texture` and `color_map` are two textures of the colour; expected one of them"},
    {"light", "1:6: the line ends here; expected kind of light: " LIGHTS},
    {"light torch", "1:7: `torch` is no kind of light (expected: " LIGHTS ")"},
    {"light pont", "1:7: `pont` is no kind of light; did you mean `point`? (expected: " LIGHTS ")"},
    {"light point direction 0 0 1",
     "1:13: unknown key `direction` (keys of light: position, color, falloff, range, intensity, name)"},
    {"light spot angle 190", "1:18: `190` is out of range; expected `angle` (degrees) between 0 and 180"},
    {"light rect u 0 0 0", "1:14: the zero vector has no direction; expected another for `u` (x y z, half an edge)"},
    {"light disc radius 0", "1:19: `0` is out of range; expected `radius` (greater than 0) of 1e-12 at least"},
    {"light point falloff cubic", "1:21: `cubic` is no falloff (expected: none, square)"},
    {"light sun two_sided",
     "1:11: unknown key `two_sided` (keys of light: direction, irradiance, color, angle, intensity, name)"},
    {"material m model wood", "1:18: `wood` is no model (expected: whitted, lambert, conductor, dielectric, gltf, unlit)"},
    {"material m compensate maybe", "1:23: `maybe` is no value of `compensate` (expected: false, true)"},
    {"material m roughness 2",
     "1:22: `2` is out of range; expected `roughness` (of a conductor, dielectric or `gltf`) between 0 and 1"},
    {"camera a aperture -1", "1:19: `-1` is out of range; expected `aperture` (diameter of the lens) of 0 at least"},
    {"light point color 1 -1 1", "1:21: `-1` is out of range; expected `color` (r g b) in linear light, 0 or more"},
    {"background 0.2 0.3", "1:19: the line ends here; expected number 3 of 3 for `background` (r g b)"},
    {"background 0 0 0 0", "1:18: `0` is one word too many; expected the line's end"},
    {"background 1\nbackground 0", "2:1: statement `background` for the second time; the first is in line 1"},
    {"sky", "1:4: the line ends here; expected the path of a picture, `constant` or `gradient`"},
    {"sky constant 1 1", "1:17: the line ends here; expected number 3 of 3 for the sky's radiance (r g b)"},
    {"sky constant 1 zenith 1", "1:16: unknown key `zenith` (keys of sky: color, strength, rotate, visible)"},
    {"sky a.hdr visible no", "1:19: `no` is no value of `visible` (expected: false, true)"},
    {"sky a.hdr strength -1", "1:20: `-1` is out of range; expected `strength` (factor of all radiance) between 0 and 1e+12"},
    {"sky a.hdr\nsky b.hdr", "2:1: statement `sky` for the second time; the first is in line 1"},
    {"material m color 255 0 0", "1:18: `255` is out of range; expected `color` (r g b) in linear light, 0 to 100"},
    {"material m reflect 1.5", "1:20: `1.5` is out of range; expected `reflect` (share that is mirrored) between 0 and 1"},
    {"material m ior 0", "1:16: `0` is out of range; expected `ior` (index of refraction) between 0.001 and 100"},
    {"material m texture", "1:19: the line ends here; expected the texture's file"},
    {"material m texture t.png wrap", "1:30: the line ends here; expected wrap mode: repeat, clamp, mirror"},
    {"material m texture t.png wrap clam",
     "1:31: `clam` is no wrap mode; did you mean `clamp`? (expected: repeat, clamp, mirror)"},
    {"material m texture t.png wrap clamp 2", "1:37: `2` is no wrap mode along v (expected: repeat, clamp, mirror)"},
    {"material m texture \"\"", "1:20: empty quotes; expected the texture's file"},
    {"material m\nmaterial m", "2:10: material `m` for the second time; the first is in line 1"},
    {"polygon material m\nmaterial m", "1:1: a polygon without `vertices`; expected x y z of 3 corners or more"},
    {"polygon vertices 0 0 0 1 0 0", "1:18: 2 corners for `vertices` (x y z of each corner); expected at least 3"},
    {"polygon vertices 0 0 0 1 0 0 1 1",
     "1:33: 8 numbers for `vertices` (x y z of each corner); expected three for each corner"},
    {"polygon vertices 0 0 0 1 0 0 1 1 0 0 1 .1",
     "1:9: corner 2 lies 0.0249 off the plane of the polygon; expected at most 0.0001 (0.0001 of its size)"},
    {"polygon vertices 0 0 0 1 1 1 2 2 2",
     "1:9: the polygon has no area (its corners lie on a line or cancel out); expected a surface"},
    {"polygon vertices 0 0 0 1 0 0 1 1 zero",
     "1:34: `zero` is no number; expected number 3 of 3 for `vertices` (x y z of each corner)"},
    {"triangle vertices 0 0 0 1 0 0 1 1 0 0 1 0", "1:10: 4 corners; a triangle has 3 (`polygon` takes more)"},
    {"triangle", "1:1: a triangle without `vertices`; expected x y z of 3 corners"},
    {"load", "1:5: the line ends here; expected the file to load"},
    {"load translate 1 0 0", "1:6: key `translate`; expected the file to load (in quotes, if that is what it is)"},
    {"load \"car.fbx", "1:6: the line ends inside the quotes that open here; expected `\"`"},
    {"load \"car.fbx\"translate 1 0 0", "1:15: text right behind closing quotes; expected a space"},
    {"load \"car\t.fbx\"", "1:10: a tab inside quotes; expected a space"},
    {"load car\".fbx\"", "1:9: quotes inside a word; expected them around it"},
    {"load car.fbx scale 0", "1:20: zero flattens the object; expected another number for `scale` (one factor, or x y z)"},
    {"load car.fbx scale 1 2", "1:23: the line ends here; expected number 3 of 3 for `scale` (one factor, or x y z)"},
    {"load car.fbx rotate 0 0 0 45",
     "1:21: the zero vector has no direction; expected another for `rotate` (axis x y z, then degrees)"},
    {"load car.fbx rotate 0 1 0", "1:26: the line ends here; expected a number for `rotate`'s angle (degrees)"},
    {"load car.fbx translate 1 0 0 translate 1 0 0", "1:30: key `translate` for the second time; the first is in column 14"},
    {"load a.obj name x\nload b.obj name x", "2:17: name `x` for the second time; the first is in line 1"},
    {"animate", "1:8: the line ends here; expected the name of a loaded object, a camera or a light"},
    {"animate car translate 0 0 0 0", "1:9: unknown name `car` (defined in this file: none)"},
    {"load car.fbx name car\nanimate car fly 0 0 0 0", "2:13: `fly` is no motion (expected: translate, rotate, scale, fov)"},
    {"load car.fbx name car\nanimate car fov 0 45", "2:9: `car` is no camera; only cameras have a `fov`"},
    {"camera c\nanimate c fov 0 180", "2:17: a field of view is between 0 and 180 degrees"},
    {"load car.fbx name car\nanimate car translate 0 0 0",
     "2:28: the line ends here; expected number 4 of 4 for `translate` (time x y z)"},
    {"load car.fbx name car\nanimate car translate 1 0 0 0 1 1 0 0",
     "2:31: times must grow; expected a later time than the one before"},
    {"load car.fbx name car\nanimate car rotate 0 0 1 0 45 1 0 1 0",
     "2:38: the line ends here; expected number 5 of 5 for `rotate` (time, axis x y z, degrees)"},
    {"load car.fbx name car\nanimate car rotate 0 0 0 0 45",
     "2:28: the zero vector has no direction; expected another axis for `rotate`"},
    {"light point name lamp\nanimate lamp scale 0 1 1 1", "2:9: `lamp` is no loaded object; only those can be scaled"},
    {"load car.fbx name car\nanimate car scale 0 1 1 1\nanimate car scale 0 1 1 1",
     "3:9: the same motion of `car` for the second time; put all its keys into one line"},
    {"\n\n   \t sphere\tradius x", "3:20: `x` is no number; expected a number for `radius`"},
    {"\xC3\xA9"
     " sphere",
     "1:1: unknown statement `\xC3\xA9"
     "`" STATEMENTS},
    {"sphere material \xC3\xA9"
     " radius x",
     "1:26: `x` is no number; expected a number for `radius`"},
    {"sphere \x01", "1:8: byte 0x01 is a control character; expected text (is this a scene file?)"},
    {"sphere \xff", "1:8: byte 0xFF is not UTF-8; save the file as UTF-8"},
    {"sphere material \xc3", "1:17: byte 0xC3 is not UTF-8; save the file as UTF-8"},
    {"", "1:1: the file holds no statement; expected at least one, like `sphere center 0 0 0 radius 1`"},
    {"# only a comment", "1:1: the file holds no statement; expected at least one, like `sphere center 0 0 0 radius 1`"},
};

std::string kinds_of_lights() {
    std::string kinds;
    for (const clarity::LightKind& kind : clarity::light_kinds()) kinds += (kinds.empty() ? "" : ", ") + std::string(kind.name);
    return kinds;
}

TEST(SceneFormatErrors, NameLineColumnWhatWasReadAndWhatWasExpected) {
    for (const Case& c : kCases) {
        const Recording r = import_text(c.text);
        EXPECT_EQ(r.status, RT_FAILED) << c.text;
        std::string message = std::string("test.scene:") + c.message;
        if (const size_t at = message.find(LIGHTS); at != std::string::npos) message.replace(at, 1, kinds_of_lights());
        EXPECT_EQ(r.why, message) << c.text;
        EXPECT_TRUE(r.order.empty() && r.materials.empty() && r.cameras.empty()) << "half-loaded: " << c.text;
    }
}

// Numbers of lights and materials go up to what the message about a greater one names, and down to what that about a lesser one
// does.
TEST(SceneFormatErrors, NameTheLimitsOfNumbers) {
    std::vector<std::pair<std::string, const std::vector<clarity::Key>*>> statements = {
        {"material m model gltf", &clarity::material_keys()}};
    for (const clarity::LightKind& kind : clarity::light_kinds())
        statements.emplace_back("light " + std::string(kind.name), &kind.keys);
    for (const auto& [statement, keys] : statements)
        for (const clarity::Key& key : *keys) {
            if (key.kind == RT_KEY_WORD || key.kind == RT_KEY_FLAG || key.kind == RT_KEY_VECTOR) continue;
            const auto why = [&, begin = statement + " " + key.name](double number) {
                char digits[40];
                std::snprintf(digits, sizeof digits, " %.9g", number);
                std::string text = begin;
                for (size_t k = 0; k < clarity::count_of(key); ++k) text += digits;
                return import_text(text + "\nsphere").why;
            };
            EXPECT_EQ(why(key.min), "") << statement;
            EXPECT_EQ(why(key.max), "") << statement;
            for (const double limit : {key.min, key.max}) {
                const double beyond = limit == key.min ? key.min - std::max(1.0, std::fabs(key.min)) : 2 * key.max;
                char named[40];
                std::snprintf(named, sizeof named, "%g", std::fabs(limit));
                EXPECT_NE(why(beyond).find(named), std::string::npos) << statement << " " << key.name << ": " << why(beyond);
            }
        }
}

TEST(SceneFormatErrors, SeveralAreReportedAtOnceInFileOrder) {
    const Recording r = import_text("sphere material gone\nsphere radious 1\nsphere\nplane normal 0 0 0\n");
    EXPECT_EQ(r.status, RT_FAILED);
    EXPECT_EQ(r.why,
              "test.scene:1:17: unknown material `gone` (defined in this file: none) [and 2 further errors, in the log]");
    ASSERT_EQ(r.log.size(), 2u);
    EXPECT_EQ(r.log[0],
              "test.scene:2:8: unknown key `radious`; did you mean `radius`? (keys of sphere: center, radius, material)");
    EXPECT_EQ(r.log[1], "test.scene:4:14: the zero vector has no direction; expected another for `normal` (x y z)");
}

TEST(SceneFormatErrors, AtMostTenAreReported) {
    std::string text;
    for (int i = 0; i < 1000; ++i) text += "spere\n";
    const Recording r = import_text(text);
    EXPECT_EQ(r.log.size(), 9u);
    EXPECT_NE(r.why.find("test.scene:1:1: unknown statement `spere`"), std::string::npos) << r.why;
    EXPECT_NE(r.why.find("[and 9 or more further errors, in the log]"), std::string::npos) << r.why;
}

TEST(SceneFormatErrors, AFaultyLineDoesNotHideNamesItDefines) {
    // One mistake gives one error: the material is known although its line has an error.
    const Recording r = import_text("material glass radious 1\nsphere material glass\n");
    EXPECT_TRUE(r.log.empty()) << r.log[0];
    EXPECT_NE(r.why.find("test.scene:1:16: unknown key `radious`"), std::string::npos) << r.why;
}

TEST(SceneFormatErrors, ReadingStopsAtBinaryContent) {
    const Recording r = import_text("sphere material late\nsphere \x01\nsphere \x02\nmaterial late\n");
    EXPECT_TRUE(r.log.empty()) << r.log[0];
    EXPECT_EQ(r.why, "test.scene:2:8: byte 0x01 is a control character; expected text (is this a scene file?)");
}

TEST(SceneFormatErrors, LongWordsAreCut) {
    const Recording r = import_text("sphere " + std::string(100000, 'x') + "\n");
    EXPECT_EQ(r.why,
              "test.scene:1:8: unknown key `" + std::string(40, 'x') + "...` (keys of sphere: center, radius, material)");
    // A character is never cut.
    std::string umlauts;
    for (int i = 0; i < 100; ++i) umlauts += "\xC3\xBC";
    const Recording cut = import_text("sphere x" + umlauts + "\n");
    EXPECT_NE(cut.why.find("\xC3\xBC...`"), std::string::npos) << cut.why;
}

TEST(SceneFormatErrors, LinesNamesAndPathsAreBounded) {
    const Recording line = import_text("sphere\npolygon vertices " + std::string(2u << 20, ' ') + "0\n");
    EXPECT_EQ(line.why, "test.scene:2:1: the line has 2097170 bytes; expected at most 1048576");
    const Recording name = import_text("material " + std::string(300, 'm') + "\n");
    EXPECT_EQ(name.why, "test.scene:1:10: 300 bytes; expected the material's name of at most 255");
    const Recording path = import_text("load " + std::string(5000, 'p') + "\n");
    EXPECT_EQ(path.why, "test.scene:1:6: 5000 bytes; expected the file to load of at most 4096");
}

TEST(SceneFormatErrors, AFileThatCannotBeReadIsNamed) {
    rt_host host{};
    std::string why;
    host.struct_bytes = sizeof host;
    host.ctx = &why;
    host.fail = [](void* ctx, const char* text) -> int32_t {
        *static_cast<std::string*>(ctx) = text;
        return RT_FAILED;
    };
    const rt_scene_sink sink{};
    EXPECT_EQ(rt_plugin_v1.importer->load(&host, "no_such.scene", nullptr, &sink), RT_FAILED);
    EXPECT_EQ(why, "no_such.scene: cannot open the file: No such file or directory");
    EXPECT_EQ(rt_plugin_v1.importer->load(&host, ".", nullptr, &sink), RT_FAILED);
    EXPECT_EQ(why, ".: cannot read the file: Is a directory");
}

}  // namespace
