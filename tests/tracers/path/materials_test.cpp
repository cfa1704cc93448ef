// materials_test.cpp -- what cl/shading/bsdf_of.h makes of materials and textures.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "kernels/kernel_row.hpp"
#include "scene/scene.hpp"
#include "support/planted_faults.hpp"
#include "tracers/path/lane_kernel.hpp"

using namespace clarity;
using namespace clarity::test;

namespace {

constexpr unsigned kWords = 24;  // of a material, and so of a row
static_assert(sizeof(rt_material) == 4 * kWords);

// The first rows are materials; the next one is a texture and its texels, and the next one the layers of the last material. The
// others ask for a material, at texture coordinates.
LaneKernel& loader() {
    static const std::vector<std::string> parts = [] {
        std::vector<std::string> all = {"#define RT_HAS_TEXTURES 1\n",
                                        "rt_shared.h",
                                        "rt_types.h",
                                        "lanes/lanes.h",
                                        "lanes/vec.h",
                                        "typedef struct rt_ctx { const global rt_material *materials; const global rt_layers "
                                        "*layers; const global rt_texture "
                                        "*textures; const global uint "
                                        "*texels; } rt_ctx;\n"
                                        "typedef struct rt_surface { vint material; vfloat tex_u, tex_v; } rt_surface;\n",
                                        "sampling/math.h",
                                        "sampling/warps.h",
                                        "shading/power.h",
                                        "shading/textures.h",
                                        "shading/maps.h",
                                        "shading/material.h"};
        all.insert(all.end(), surface_headers().begin(), surface_headers().end());
        return all;
    }();
    static LaneKernel compiled(
        parts, kWords, 22,
        "rt_ctx ctx; ctx.materials = (const global rt_material *)given; ctx.layers = (const global rt_layers *)(given + 10 * "
        "READS) - 8; "
        "ctx.textures = (const global rt_texture *)(given + 9 * READS);"
        "ctx.texels = (const global uint *)(given + 9 * READS + 7);"
        "rt_surface s; s.material = min(max(rt_to_int(in[0]), rt_vint(0)), rt_vint(8)); s.tex_u = in[1]; s.tex_v = in[2];"
        "const rt_bsdf b = rt_bsdf_of(&ctx, &s, RT_MASK(in[3] > 0.5f), rt_vfloat(1.0f), RT_ALL_LANES, rt_vec_of(in[4], in[5], "
        "in[6]));"
        "out[0] = b.color.x; out[1] = b.color.y; out[2] = b.color.z; out[3] = b.diffuse; out[4] = b.mirror; out[5] = b.metal; "
        "out[6] = b.glass;"
        "out[7] = b.facets.alpha; out[8] = b.eta; out[9] = rt_select(b.compensate, rt_vfloat(1.0f), rt_vfloat(0.0f));"
        "const rt_layered *l = &b.layered; out[10] = rt_select(l->lanes, rt_vfloat(1.0f), rt_vfloat(0.0f)); out[11] = "
        "l->facets.alpha;"
        "out[12] = l->metal; out[13] = l->gloss; out[14] = l->diffuse; out[15] = l->thin; out[16] = l->straight.x; out[17] = "
        "l->grazing;"
        "out[18] = l->coat; out[19] = l->coat_alpha; out[20] = l->sheen.y; out[21] = l->sheen_roughness;",
        8);
    return compiled;
}

rt_material material(rt_u32 model, float roughness = 0, rt_u32 flags = 0) {
    rt_material m = default_material();
    m.model = model;
    m.roughness = roughness;
    m.flags = flags;
    m.reflect = 0.25f;
    m.refract = 0.5f;
    m.ior = 1.25f;
    m.color[0] = 0.5f;
    return m;
}

}  // namespace

TEST(PathMaterials, BecomeLobes) {
    rt_material checker = material(RT_MODEL_LAMBERT, 0, RT_MATERIAL_CHECKER), textured = material(RT_MODEL_LAMBERT);
    textured.texture = 0;
    for (float& c : textured.color) c = 1;
    rt_material air = material(RT_MODEL_DIELECTRIC, 0.5f);
    air.ior = 1;
    const rt_material materials[9] = {material(RT_MODEL_WHITTED),
                                      material(RT_MODEL_LAMBERT),
                                      material(RT_MODEL_CONDUCTOR, 0.5f),
                                      material(RT_MODEL_DIELECTRIC, 0.001f, RT_MATERIAL_SINGLE_SCATTER),
                                      material(RT_MODEL_DIELECTRIC),
                                      checker,
                                      textured,
                                      air,
                                      material(RT_MODEL_GLTF, 0.5f)};
    std::vector<float> rows(9 * kWords);
    std::memcpy(rows.data(), materials, sizeof materials);
    // A texture of 16 texels in a row; texel k has k, 16 + k, and 255 - k.
    rt_u32 texture[kWords] = {0, 16, 1, 0, 0, 0, 0};
    for (rt_u32 k = 0; k < 16; ++k) texture[7 + k] = k | (16 + k) << 8 | (255 - k) << 16;
    rows.resize(11 * kWords);
    std::memcpy(&rows[9 * kWords], texture, sizeof texture);
    rt_layers layers = default_material().layers;
    layers.metallic = 0.25f, layers.transmission = 0.5f, layers.specular_weight = 0.75f, layers.specular_color[0] = 0.5f;
    layers.clearcoat = 0.375f, layers.clearcoat_roughness = 0.75f, layers.sheen_color[1] = 0.625f,
    layers.sheen_roughness = 0.875f;
    std::memcpy(&rows[10 * kWords], &layers, sizeof layers);
    struct Asked {
        float material, u, v, entering, x, y, z;
    };
    std::vector<Asked> asked;
    for (int i = 0; i < 5; ++i)
        for (const float entering : {1.0f, 0.0f}) asked.push_back({float(i), 0, 0, entering, 0.5f, 0, 0.5f});
    asked.push_back({5, 0, 0, 1, 0.5f, 0, 0.5f});
    asked.push_back({5, 0, 0, 1, 1.5f, 0, 0.5f});
    for (int k = 0; k < 16; ++k) asked.push_back({6, (float(k) + 0.5f) / 16, 0.5f, 1, 0, 0, 0});
    asked.push_back({7, 0, 0, 1, 0, 0, 0});
    asked.push_back({8, 0, 0, 1, 0, 0, 0});
    for (const Asked& a : asked) {
        rows.resize(rows.size() + kWords);
        std::memcpy(&rows[rows.size() - kWords], &a, sizeof a);
    }
    const std::vector<float> found = loader().run(rows);
    const auto lobe = [&](size_t i) { return &found[(11 + i) * 22]; };
    const float expected[10][7] = {// diffuse, mirror, metal, glass, alpha, eta, compensate
                                   {0.25f, 0.25f, 0, 0.5f, 0, 1.25f, 1},
                                   {0.25f, 0.25f, 0, 0.5f, 0, 0.8f, 1},
                                   {1, 0, 0, 0, 0, 1.25f, 1},
                                   {1, 0, 0, 0, 0, 0.8f, 1},
                                   {0, 0, 1, 0, 0.25f, 1.25f, 1},
                                   {0, 0, 1, 0, 0.25f, 0.8f, 1},
                                   {0, 0, 0, 1, 1e-4f, 1.25f, 0},
                                   {0, 0, 0, 1, 1e-4f, 0.8f, 0},
                                   {0, 0, 0, 1, 0, 1.25f, 1},
                                   {0, 0, 0, 1, 0, 0.8f, 1}};
    for (size_t i = 0; i < 10; ++i) {
        EXPECT_EQ(lobe(i)[0], 0.5f) << i;
        EXPECT_EQ(lobe(i)[1], 0.7f) << i;
        for (size_t k = 0; k < 7; ++k) EXPECT_FLOAT_EQ(lobe(i)[3 + k], expected[i][k]) << "question " << i << ", number " << k;
    }
    EXPECT_EQ(lobe(28)[7], 0) << "facets that refract nothing";
    EXPECT_EQ(lobe(28)[8], 1);
    // A sheet: lanes, alpha, metal, gloss, diffuse, thin, straight, grazing, coat and its alpha, sheen and its roughness
    const float layered[12] = {1, 0.25f, 0.25f, 0.75f, 0.375f, 0.375f, 0.375f / 81, 0.75f, 0.375f, 0.5625f, 0.625f, 0.875f};
    for (size_t k = 0; k < 12; ++k) EXPECT_FLOAT_EQ(lobe(29)[10 + k], layered[k]) << k;
    EXPECT_EQ(lobe(29)[6], 0) << "no glass";
    EXPECT_EQ(lobe(29)[8], 1) << "the same medium on both sides";
    EXPECT_EQ(lobe(28)[10], 0) << "another model";
    EXPECT_FLOAT_EQ(lobe(10)[0], 0.5f);
    EXPECT_FLOAT_EQ(lobe(11)[0], 0.5f / 3);
    for (int k = 0; k < 16; ++k) {
        EXPECT_NEAR(lobe(size_t(12 + k))[0], srgb_to_linear(k / 255.0), 5e-7) << k;
        EXPECT_NEAR(lobe(size_t(12 + k))[1], srgb_to_linear((16 + k) / 255.0), 5e-7) << k;
        EXPECT_NEAR(lobe(size_t(12 + k))[2], srgb_to_linear((255 - k) / 255.0), 5e-7) << k;
    }
}

// The tests of surfaces find what is planted into the kernels.

const char* const kBsdf = "shading/bsdf.h";
const PlantedFault kFaults[] = {
    {"no cosine", kBsdf, "const vfloat cosine = rt_vfloat(RT_INVERSE_PI) * wi.z;",
     "const vfloat cosine = rt_vfloat(RT_INVERSE_PI);", "PathLobes.Directions*"},
    {"density off by 2", kBsdf, "*pdf = rt_select(above, p.diffuse * cosine, zero);",
     "*pdf = rt_select(above, rt_vfloat(2.0f) * p.diffuse * cosine, zero);", "PathLobes.WhiteSurfaces*"},
    {"eta^2 missing, smooth", kBsdf, "bent_share = glass_share / (b->eta * b->eta)", "bent_share = glass_share",
     "PathLobes.WhiteSurfaces*"},
    {"eta^2 missing, rough", kBsdf, "(one - mirror.chance) * bent * eta * eta * two", "(one - mirror.chance) * bent * two",
     "PathLobes.Directions*"},
    {"eta^2 missing between facets", kBsdf, "g.through / (g.mean_there * eta * eta)", "g.through / g.mean_there",
     "PathLobes.ValuesAreRec*"},
    {"losses unnormalised", kBsdf, "RT_SWING_OF_LOSS)) / mean;", "RT_SWING_OF_LOSS));", "PathLobes.WhiteSurfaces*"},
    {"shadows by the other form of Smith", kBsdf, "rt_scale(seen / (smith_o + smith_i), fresnel)",
     "rt_scale(seen * rt_vfloat(2.0f) / ((one + smith_o) * (one + smith_i)), fresnel)", "PathLobes.SingleScattering*"},
    {"alpha squared twice", "shading/microfacets.h", "const vfloat alpha2 = f->alpha * f->alpha, across",
     "const vfloat alpha2 = f->alpha * f->alpha * f->alpha * f->alpha, across", "PathLobes.Directions*"},
    {"roughness squared twice", "shading/bsdf_of.h", "alpha = m->roughness * m->roughness;",
     "alpha = m->roughness * m->roughness * m->roughness * m->roughness;", "PathMaterials.*"},
    {"the inside is the outside", "shading/bsdf_of.h", "rt_select(entering, ior / around, around / ior)",
     "rt_select(entering, around / ior, ior / around)", "PathMaterials.*"},
    {"a lane's choice depends on others", kBsdf, "*u = rt_select(of, rt_min(rest, rt_vfloat(0.99999994f)), *u);",
     "*u = rt_min(rest, rt_vfloat(0.99999994f));", "PathLobes.LanesAgree"},
    {"sheen unnormalised", "shading/sheen.h", "return rt_from_pair(rt_sheen_kept, r.low, r.share) * facing", "return facing",
     "PathLobes.WhiteLayers*"},
    {"a layer dims one way only", "shading/layers.h", "(one - x_o) * (one - x_i)", "(one - x_o) * (one - x_o)",
     "PathLobes.ValuesAreRec*"},
    {"varnish leaves all to what is below", "shading/layers.h", "return rt_below(o->coat, i->coat, l->coat_mean, spread);",
     "return rt_vfloat(1.0f);", "PathLobes.WhiteLayers*"},
    {"the density of varnish is left out", "shading/layer_lobes.h", "fma(p->coat, density, *pdf)", "*pdf",
     "PathLobes.Directions*"},
    {"a sheet lets through what facets mirror", "shading/layer_lobes.h",
     "value = rt_choose(above, value, rt_scale(l->thin, rt_mul(l->color, rt_rest(gloss))))",
     "value = rt_choose(above, value, rt_scale(l->thin, l->color))", "PathLobes.WhiteLayers*"},
    {"the strength of a grain is not squared", "shading/microfacets.h", "fma(strength * strength, one - rough, rough)",
     "fma(strength, one - rough, rough)", "PathLobes.AGrain*"},
    {"a grain lies across", "shading/microfacets.h", "x = g.x / f->along, y = g.y / f->across",
     "x = g.x / f->across, y = g.y / f->along", "PathLobes.Directions*"},
    {"shadows of a grain are even", "shading/microfacets.h", "alpha2 = rt_select(RT_MASK(f->uneven == zero), alpha2, wide);",
     "", "PathLobes.Directions*"},
    {"an even surface is turned", "shading/microfacets.h", "f.grain_x = rt_select(grained, grain_x, f.grain_x);",
     "f.grain_x = grain_x;", "PathLobes.AGrain*"},
    {"what a grain loses is that of its mean", "shading/microfacets.h", "return rt_min(f->alpha * rt_exp",
     "return f->alpha; rt_min(f->alpha * rt_exp", "PathLobes.WhiteGrains*"},
    {"the disc is an ellipse", "sampling/warps.h", "*y = radius * sine;", "*y = rt_vfloat(0.97f) * radius * sine;",
     "PathMath.Warps*"},
    {"sums drift", "tracers/path/sum.h", "const float4 total = rough + lost;", "const float4 total = rough;", "PathSums.OfAM*"},
    {"a wrong digit of Sobol's", "sampling/sobol.h",
     "{0x00000001u, 0x00000003u, 0x00000005u, 0x0000000fu, 0x00000011u, 0x00000033u,",
     "{0x00000001u, 0x00000003u, 0x00000005u, 0x00000007u, 0x00000011u, 0x00000033u,", "PathSamplers.Sobol*"},
    {"a seed that counts for nothing", "sampling/dimensions.h", "rt_vuint(s->seed)", "rt_vuint(0u)", "PathSamplers.Seeds*"},
    {"a sine with a wrong digit", "sampling/math.h", "-1.666666664e-1f", "-1.666566664e-1f", "PathMath.Functions*"},
};

TEST(PathTexts, HaveTheirTexts) {
    expect_plantable(kFaults);
}

TEST(PathFaults, AreFound) {
    expect_found(kFaults);
}
