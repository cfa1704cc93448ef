// map_faults_test.cpp -- faults that textures may have, each planted into the text of a kernel: the tests of maps find all.
#include <gtest/gtest.h>

#include "support/planted_faults.hpp"

using namespace clarity::test;

namespace {

const PlantedFault kMapFaults[] = {
    {"HandOfTheCoordinates", "shading/surface.h", "(stored[0] & 1u) != 0u ? -1.0f : 1.0f", "1.0f", "NormalMaps.FollowTurned*"},
    {"HandOfTheInstance", "shading/surface.h", "determinant < 0.0f ? -1.0f : 1.0f", "1.0f", "NormalMaps.FollowAnInstance"},
    {"FirstSetAlways", "shading/maps.h", "if (map->set != 0u) u = s->tex_u2, v = s->tex_v2;", "", "Maps.NameTheirSet*"},
    {"MatrixIsTransposed", "shading/maps.h", "rt_vfloat(m[1]), v, rt_vfloat(m[2])", "rt_vfloat(m[3]), v, rt_vfloat(m[2])",
     "Maps.Transform*"},
    {"WrapIsAlwaysRepeat", "shading/textures.h", "if (mode == RT_CLAMPS) return", "if (0) return", "Maps.AClamped*"},
    {"NumbersAreReadAsSrgb", "shading/textures.h", "if (texture.flags & RT_TEXTURE_LINEAR)", "if (0)",
     "Maps.TexelsOfNumbersAreLinear"},
    {"ColoursAreReadAsNumbers", "shading/textures.h", "if (texture.flags & RT_TEXTURE_LINEAR)", "if (1)",
     "Maps.ATextureOfOne*"},
    {"NearestIsSmooth", "shading/textures.h", "if (texture->flags & RT_TEXTURE_NEAREST)", "if (0)", "Maps.ANearest*"},
    {"ColourIsLost", "shading/material.h",
     "color = rt_mul(color, RT_REFLECTANCE(m->model, rt_sample_map(ctx, rt_map_of(ctx, m, RT_MAP_COLOR), s, mine)));", "",
     "Maps.ATextureOfOne*"},
    {"GreenOfNormalsIsFlipped", "shading/maps.h", "y = scale * fma(two, color.y, -one)", "y = scale * -fma(two, color.y, -one)",
     "NormalMaps.FollowTheTransform*"},
    {"NormalsHaveNoScale", "shading/maps.h", "one = rt_vfloat(1.0f), scale = rt_vfloat(map->scale);",
     "one = rt_vfloat(1.0f), scale = one;", "NormalMaps.HaveAScale"},
    {"NormalsIgnoreTheTransform", "shading/maps.h",
     "rt_vec_of(fma(rt_vfloat(m[4] * to_right), x, rt_vfloat(-m[1] * upwards) * y)", "rt_vec_of(x",
     "NormalMaps.FollowTheTransform*"},
    {"NormalsAreNotApplied", "shading/maps.h", "s->normal = rt_choose(turns, rt_normalize(turned), s->normal);", "",
     "NormalMaps.HaveAScale"},
    {"OcclusionIsNotInRed", "shading/maps.h", "rt_sample_map_channel(ctx, map, s, lanes, 0) - one",
     "rt_sample_map_channel(ctx, map, s, lanes, 1) - one", "Maps.Occlusion*"},
    {"OcclusionHasNoStrength", "shading/maps.h", "return fma(rt_vfloat(map->scale), rt_sample", "return fma(one, rt_sample",
     "Maps.Occlusion*"},
    {"DrawnLightIsNotThatOfTheTexture", "shading/emitters.h",
     "light = rt_mul(light, rt_drawn_map(ctx, &lit, lit.u1, u2, flat));", ";", "EmissionMaps.Half*"},
    {"FoundLightIsNotThatOfTheTexture", "shading/material.h", "    if (map) {\n        const rt_texture_point",
     "    if (0) {\n        const rt_texture_point", "EmissionMaps.Half*"},
    {"CornersOfMirroredLamps", "shading/emitter_table.h", "const int first = swapped ? 2 : 1;", "const int first = 1;",
     "EmissionMaps.FollowAM*"},
    {"SmallerPicturesAreNotShown", "shading/textures.h", "if (at[l] == 0) continue;", "continue;", "SmallerPictures.AreWhat*"},
    {"SmallerPicturesAreBiased", "shading/maps.h", "spread * spread * rt_vfloat(size)",
     "spread * spread * rt_vfloat(4.0f * size)", "SmallerPictures.HaveTexels*"},
    {"ConesBeginAnewAtMirrors", "shading/maps.h", "((ray)->travelled + (t))", "(t)", "SmallerPictures.FollowM*"},
    {"SpreadIgnoresTheInstance", "shading/surface.h", "area * sqrt(grown) / rt_vfloat(fabs(determinant))", "area",
     "SmallerPictures.AreNotShown*"},
    {"RoughnessIsInRed", "shading/matter_maps.h",
     "rt_multiply(ctx, rough ? rough : both, s, mine, rough ? 0 : 1, &m->roughness);",
     "rt_multiply(ctx, rough ? rough : both, s, mine, 0, &m->roughness);", "Maps.MultiplyTheSurfaceModel"},
    {"BrightColoursReflectMore", "shading/textures.h", "rt_min(color.x, most)", "color.x", "BrightTextures.ReflectNo*"},
    {"BrightTexelsHaveNoExponent", "shading/textures.h", "rt_vint(127 - 24);", "rt_vint(0) * texel + rt_vint(119);",
     "BrightTextures.Shine*"},
    {"MetalOfItsOwnIsInBlue", "shading/matter_maps.h", "metal ? 0 : 2", "2", "Maps.MultiplyTheSurfaceModel"},
};

TEST(MapTexts, HaveTheirTexts) {
    expect_plantable(kMapFaults);
}

class MapFaults : public testing::TestWithParam<PlantedFault> {};

TEST_P(MapFaults, IsFound) {
    EXPECT_EQ(why_not_found(GetParam()), "");
}

INSTANTIATE_TEST_SUITE_P(All, MapFaults, testing::ValuesIn(kMapFaults),
                         [](const testing::TestParamInfo<PlantedFault>& info) { return info.param.name; });

}  // namespace
