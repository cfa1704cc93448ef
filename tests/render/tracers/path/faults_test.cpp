// faults_test.cpp -- the tests of surfaces find what is planted into the kernels.
#include <gtest/gtest.h>

#include "support/planted_faults.hpp"

using namespace clarity::test;

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
