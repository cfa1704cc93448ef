// surface_labs_test.cpp -- submissions of the labs in which students write a model of surfaces.
#include <gtest/gtest.h>

#include "lab_sdk.hpp"
#include "submissions.hpp"

namespace {

#define ARGUMENTS "(const global float *numbers, float3 color, float3 wo, "
#define SAMPLE "RT_INLINE rt_surface_draw microfacet_sample" ARGUMENTS "float3 u)\n"
#define PDF "RT_INLINE float microfacet_pdf" ARGUMENTS "float3 wi)\n"
#define WEIGHT "microfacet_fresnel(color, dot(wo, h)) * ((1.0f + out) / (out + microfacet_smith(draw.wi, alpha)))"
const std::vector<Submission> kMicrofacet = {
    {"right", "", "", 100, 100, "1.00 times the work", true},
    {"starter", kStarter, "", 50, 50, "the light that is sent back by eval, integrated over all directions, is (", true},
    {"slow_cosine",
     SAMPLE,
     "RT_INLINE rt_surface_draw other_sample" ARGUMENTS "float3 u)\n",
     60,
     68,
     "times the work",
     false,
     {{PDF, PDF "{ return 0.31830989f * wi.z; }\n" SAMPLE
                "{\n    const float radius = sqrt(u.x), turn = 6.2831853f * u.y;\n    rt_surface_draw draw;\n"
                "    draw.wi = (float3)(radius * cos(turn), radius * sin(turn), sqrt(1.0f - u.x));\n"
                "    draw.pdf = draw.wi.z * 0.31830989f;\n"
                "    draw.weight = 3.1415927f * microfacet_eval(numbers, color, wo, draw.wi);\n    return draw;\n}\n"
                "RT_INLINE float other_pdf" ARGUMENTS "float3 wi)\n"}}},
    // All facets are drawn, also those that are not seen from wo.
    {"slow_all_facets",
     "normalize((float3)(alpha * wo.x, alpha * wo.y, wo.z))",
     "(float3)(0.0f, 0.0f, 1.0f)",
     77,
     83,
     "times the work",
     false,
     {{"    return microfacet_facets(normalize(wo + wi), alpha) / (2.0f * (1.0f + microfacet_smith(wo, alpha)) * wo.z);",
       "    const float3 h = normalize(wo + wi);\n    return microfacet_facets(h, alpha) * h.z / (4.0f * fmax(dot(wo, h), "
       "1e-6f));"},
      {WEIGHT, "microfacet_eval(numbers, color, wo, draw.wi) * draw.wi.z / draw.pdf"}}},
    {"wrong_fresnel", "(square * square * low)", "(square * low)", 50, 50, "by eval, integrated"},
    {"wrong_density", "/ (2.0f * (1.0f + microfacet_smith(wo, alpha)) * wo.z)",
     "/ ((1.0f + microfacet_smith(wo, alpha)) * wo.z)", 25, 40, "the integral of pdf"},
    {"wrong_weight", WEIGHT, "microfacet_fresnel(color, dot(wo, h)) * (2.0f / (1.0f + microfacet_smith(draw.wi, alpha)))", 30,
     45, "but f cos / pdf is", true},
    {"wrong_one_way", "(microfacet_smith(wo, alpha) + microfacet_smith(wi, alpha))", "(1.0f + microfacet_smith(wi, alpha))", 28,
     45, "in each other's place"},
    {"wrong_lobe", "* (microfacet_facets(h, alpha) * seen)", "* (microfacet_facets(h, 0.9f * alpha) * seen)", 28, 45,
     "but f cos / pdf is"},
    // Right where checks look, which have the key at its ends and its default.
    {"cheats_in_cases", "    draw.pdf = microfacet_pdf(",
     "    if (alpha > 0.1f && alpha < 0.9f) draw.wi = normalize(draw.wi + (float3)(0.0f, 0.0f, 0.1f));\n    draw.pdf = "
     "microfacet_pdf(",
     50, 50, "the weight of colour"},
    {"includes_hidden_cases", "RT_INLINE float microfacet_alpha", "#include \"HIDDEN\"\nRT_INLINE float microfacet_alpha", 0, 0,
     "has `#`"},
    {"casts_pointers", "return numbers[0] * numbers[0];", "return *((const global float *)(numbers + 1)) * numbers[0];", 0, 0,
     "has `*)`"},
};

#define MIXED \
    "mix(sampler_cosine_pdf(wi), sampler_facet_pdf(sampler_alpha(numbers), wo, wi), sampler_share(numbers, color, wo))"
#define SHARE "clamp(varnish / fmax(varnish + paint, 1e-6f), 0.05f, 0.95f)"
const std::vector<Submission> kSampler = {
    {"right", "", "", 100, 100, "1.00 times the work", true},
    {"starter", kStarter, "", 50, 50, "times the work", true},
    {"slow_halves", SHARE, "0.5f", 80, 88, "times the work"},
    {"slow_lobe_only", SHARE, "1.0f", 50, 65, "times the work"},
    {"wrong_density_of_one_way", MIXED, "sampler_facet_pdf(sampler_alpha(numbers), wo, wi)", 0, 40,
     "do not have the density pdf", true},
    {"wrong_other_share", MIXED, "mix(sampler_cosine_pdf(wi), sampler_facet_pdf(sampler_alpha(numbers), wo, wi), 0.5f)", 0, 40,
     "do not have the density pdf"},
    {"wrong_not_normalised", MIXED, "1.1f * " MIXED, 0, 40, "the integral of pdf over the hemisphere is 1."},
    // Its draws have their density, but light along the surface is lost.
    {"wrong_blind",
     SHARE,
     "0.0f",
     50,
     50,
     "sample never finds light",
     true,
     {{MIXED, "wi.z > 0.43588989f ? sampler_cosine_pdf(wi) / 0.81f : 0.0f"},
      {": sampler_cosine_draw(u.xy)", ": sampler_cosine_draw((float2)(0.81f * u.x, u.y))"}}},
    {"cheats_in_cases", MIXED, "(numbers[0] > 0.06f && numbers[0] < 0.19f ? 2.0f : 1.0f) * " MIXED, 50, 50,
     "the draws are biased"},
    {"includes_hidden_cases", "/* How often", "#include \"HIDDEN\"\n/* How often", 0, 0, "has `#`"},
};

TEST(LabSubmissions, OfMicrofacets) {
    expect_marks(kLabs + "/microfacet", "microfacet.cl", kMicrofacet);
}

TEST(LabSubmissions, OfSamplers) {
    expect_marks(kLabs + "/sampler", "sampler_choice.h", kSampler);
}

}  // namespace
