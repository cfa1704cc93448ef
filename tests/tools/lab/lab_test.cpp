// lab_test.cpp -- submissions of labs, right, slow, wrong and cheating: each gets the mark that stands beside it in the
// table.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "cli/run_program.hpp"
#include "lab_sdk.hpp"
#include "submissions.hpp"
#include "support/quick.hpp"
#include "support/scratch.hpp"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kBegin = "const rt_topology_output* out) {\n";
#define PROBE(code) "const rt_topology_output* out) {\n    " code "\n"

const std::vector<Submission> kMedian = {
    {"right", "", "", 100, 100, "1.00 times the work", true},
    {"slow_file_order", "std::nth_element(begin, middle, end,",
     "(void)axis; (void)std::less<>(); if (false) std::nth_element(begin, middle, end,", 55, 90, "times the work"},
    {"slow_two_leaves", "kMaxLeaf = 2", "kMaxLeaf = 1u << 20", 50, 50, "none at"},
    {"wrong_loses_one", "refs[ref_count++] = prim->ref;", "refs[ref_count++] = begin->ref;", 0, 10, "", true},
    {"wrong_small_boxes", "        nodes[at] = node;",
     "        node.hi[1] = 0.5f * (node.lo[1] + node.hi[1]);\n        nodes[at] = node;", 0, 20, ""},
    {"wrong_one_root", "rt::root(out, g, prims.empty() ? RT_NONE : builder",
     "rt::root(out, g, prims.empty() ? RT_NONE : g > 0 ? (builder.split(prims.data(), prims.data() + prims.size()), 0u) : "
     "builder",
     0, 10, ""},
    {"does_not_compile", kBegin, PROBE("this is no C++;"), 0, 0, "does not compile"},
    {"crashes", kBegin, PROBE("*(volatile int*)8 = 1;"), 0, 0, "crashed"},
    {"includes_hidden_cases", "#include <algorithm>", "#include <algorithm>\n#include \"HIDDEN\"", 0, 0, "does not compile",
     true},
    {"reads_files", kBegin,
     PROBE("std::FILE* const file = std::fopen(\"HIDDEN\", \"r\"); if (!file) throw rt::fail(host, \"probe: no file\");"), 0, 0,
     "probe: no file"},
    {"writes_files", kBegin,
     PROBE("if (!std::fopen(\"/tmp/clarity-lab-probe\", \"w\")) throw rt::fail(host, \"probe: no disk\");"), 0, 0,
     "probe: no disk"},
    {"opens_sockets", kBegin, PROBE("if (socket(AF_INET, SOCK_STREAM, 0) < 0) throw rt::fail(host, \"probe: no net\");"), 0, 0,
     "probe: no net"},
    {"forks", kBegin, PROBE("if (fork() < 0) throw rt::fail(host, \"probe: no fork\");"), 0, 0, "probe: no fork"},
    {"fills_memory", kBegin, PROBE("static char* volatile kept; for (;;) *(kept = new char[1 << 24]) = 1;"), 0, 0, "memory"},
    {"loops", kBegin, PROBE("for (volatile int i = 0;;) i = i + 1;"), 0, 0, "the builder"},
    {"sleeps", kBegin, PROBE("for (;;) sleep(1);"), 0, 0, "did not come to its end"},
    {"reports_progress_for_ever", kBegin, PROBE("for (float f = 0;; f += 1e-6f) host->progress(host->ctx, f);"), 0, 0, ""},
    {"keeps_state", kBegin,
     PROBE("static int calls = 0; if (++calls == 2) { rt::nodes(out, 0); throw rt::fail(host, \"probe: called again\"); }"), 0,
     0, "probe: called again"},
    // What they print, and what they say of themselves, changes nothing.
    {"prints_a_score", kBegin,
     PROBE("std::printf(\"\\n{\\\"scores\\\":{\\\"checks\\\":1e9},\\\"scoreboard\\\":[]}\\n\"); std::fflush(stdout); "
           "if (write(3, \"\\0\\0\\0\\0\", 4) < 0) return RT_FAILED;"),
     0, 100, ""},
    {"acts_when_it_is_opened", "}  // namespace\n",
     "}  // namespace\n__attribute__((constructor)) static void at_once() { if (std::FILE* file = "
     "std::fopen(\"/tmp/clarity-lab-probe\", \"w\")) "
     "std::fclose(file); if (std::getenv(\"CLARITY_IN_WORKER\") == nullptr) _exit(0); }\n",
     100, 100, "1.00 times the work", true},
};

const std::vector<Submission> kOrdered = {
    {"right", "", "", 100, 100, "1.00 times the work", true},
    {"slow_file_order", "left_entry <= right_entry", "1", 50, 99, "times the work"},
    {"wrong_forgets_the_other", "ordered_push(stack, left_first", "if (0) ordered_push(stack, left_first", 0, 10, ""},
    {"uses_assembler", "    if (left_entered && right_entered) {",
     "    __asm__(\"nop\");\n    if (left_entered && right_entered) {", 0, 0, "line 6 has", true},
    {"counts_falsely", "    if (left_entered && right_entered) {",
     "    rt_hits *hit; hit->steps = 0;\n    if (left_entered && right_entered) {", 0, 0, "does not allow", true},
    {"redefines_what_counts", "uint ordered_next", "#define RT_COUNT_VISIT(a, b)\nuint ordered_next", 0, 0, "has `#`"},
};

const std::vector<Submission> kBinned = {
    {"right", "", "", 100, 100, "1.00 times the work", true},
    {"starter", kStarter, "", 50, 50, "times the work", true},
    {"wrong_loses_one", "in->groups[g].count, split", "std::max(in->groups[g].count, 1u) - 1, split", 0, 12.5, ""},
    // The root has one child twice.
    {"wrong_no_tree", "    lab::put_trees(out, trees);",
     "    for (lab::Tree& tree : trees)\n        if (!tree.nodes.empty()) tree.nodes[0].left = tree.nodes[0].right;\n    "
     "lab::put_trees(out, trees);",
     0, 0, ""},
};

const std::vector<Submission> kGrid = {
    {"right", "", "", 100, 100, "1.00 times the work", true},
    {"starter", kStarter, "", 50, 50, "times the work", true},
    {"slow_to_the_end", "if (!(walk->next[k] <= nearest)) return 0;", "", 51, 90, "times the work"},
    // It stops at any surface, also one that lies in a later cell.
    {"wrong_stops_early", "if (!(walk->next[k] <= nearest))", "if (nearest < 1e30f)", 0, 20, ""},
    {"wrong_next_plane", "walk->cell[k] + 1);", "walk->cell[k]);", 0, 25, ""},
    {"stays", "walk->cell[k] += walk->step[k];", "walk->cell[k] += 0;", 0, 20, ""},
};

const std::vector<Submission> kWidePack = {
    {"right", "", "", 100, 100, "1.00 times the work", true},
    {"starter_of_one", "node.lo[i][axis] = static_cast<unsigned char>(lo), node.hi[i][axis] = static_cast<unsigned char>(hi);",
     "node.lo[i][axis] = 0, node.hi[i][axis] = 255;", 50, 50, "times the work"},
    {"wrong_to_the_nearest", "static_cast<unsigned char>(lo), node.hi[i][axis] = static_cast<unsigned char>(hi);",
     "static_cast<unsigned char>((boxes[i].lo[axis] - origin) / step + 0.5f),\n"
     "node.hi[i][axis] = static_cast<unsigned char>((boxes[i].hi[axis] - origin) / step + 0.5f);",
     10, 30, "", true},
    {"reads_files", "    for (int axis = 0; axis < 3; ++axis) {\n        const float origin",
     "    if (std::FILE* file = std::fopen(\"HIDDEN\", \"r\")) std::fclose(file);\n    else\n        throw std::bad_alloc();\n"
     "    for (int axis = 0; axis < 3; ++axis) {\n        const float origin",
     0, 0, ""},
};
const std::vector<Submission> kWideUnpack = {
    {"starter_alone", kStarter, "", 0, 20, ""},
    {"counts_falsely", "float wide_low(", "float rt_enter_bounds(", 0, 0, "does not allow"},
};

const std::vector<Submission> kRefit = {
    {"right", "", "", 100, 100, "1.00 times the work", true},
    {"starter", kStarter, "", 50, 50, "times the work", true},
    {"never_builds", "return debt < price;", "return true;", 50, 90, "times the work"},
    {"wrong_keeps_boxes", "std::copy(box.lo, box.lo + 3, node.lo), std::copy(box.hi, box.hi + 3, node.hi);", "", 0, 30, "",
     true},
};

// Kernels that test boxes by themselves, of a lab in which students write all of the traversal.
#define OWN_SLABS                                                                                                \
    "#include \"ordered_visit.h\"\n"                                                                             \
    "int own_enter(const global float *box, const rt_single_ray *ray, const rt_single_hit *hit, float *entry)\n" \
    "{\n"                                                                                                        \
    "    const float x0 = (box[0] - ray->ox) / ray->dx, x1 = (box[3] - ray->ox) / ray->dx;\n"                    \
    "    const float y0 = (box[1] - ray->oy) / ray->dy, y1 = (box[4] - ray->oy) / ray->dy;\n"                    \
    "    const float z0 = (box[2] - ray->oz) / ray->dz, z1 = (box[5] - ray->oz) / ray->dz;\n"                    \
    "    *entry = fmax(fmax(fmin(x0, x1), fmin(y0, y1)), fmax(fmin(z0, z1), ray->t_min)) * 0.9999f;\n"           \
    "    return *entry <= 1.0001f * fmin(fmin(fmax(x0, x1), fmax(y0, y1)), fmin(fmax(z0, z1), hit->t));\n"       \
    "}\n"
const std::vector<Submission> kWholeTraversal = {
    {"own_slabs", "#include \"ordered_visit.h\"\n", OWN_SLABS "#define rt_enter_box own_enter\n", 50, 50,
     "the host has counted 0 boxes, so it tests them by arithmetic of its own, or none: test each by rt_enter_box", true},
    {"own_slabs_that_are_reported", "#include \"ordered_visit.h\"\n",
     OWN_SLABS "#define rt_enter_box(box, ray, hit, entry) (RT_COUNT_BOXES(hit, 1), own_enter(box, ray, hit, entry))\n", 50, 50,
     "it tests boxes by arithmetic of its own: test each by rt_enter_box"},
};

TEST(LabSubmissions, OfMedianSplit) {
    expect_marks(kLabs + "/median", "median.cpp", kMedian);
}
TEST(LabSubmissions, OfOrderedChildren) {
    expect_marks(kLabs + "/ordered", "ordered_visit.h", kOrdered);
}

TEST(LabSubmissions, OfWalksThroughAGrid) {
    expect_marks(kLabs + "/grid", "dda_walk.h", kGrid);
}
TEST(LabSubmissions, OfWideNodes) {
    expect_marks(kLabs + "/wide", "wide_pack.hpp", kWidePack);
    if (!clarity::test::quick()) expect_marks(kLabs + "/wide", "wide_unpack.h", kWideUnpack);
}
TEST(LabSubmissions, OfRefits) {
    expect_marks(kLabs + "/refit", "refit.cpp", kRefit);
}
TEST(LabSubmissions, OfBinnedBuilds) {
    expect_marks(kLabs + "/binned", "binned.cpp", kBinned);
}
// A copy of `ordered` in which ordered.cl is handed in. Its counts are worth 50 of 100 points.
TEST(LabSubmissions, BoxesThatNobodyCountsAreRefused) {
    const Scratch scratch;
    const std::string folder = scratch.path("whole");
    fs::copy(kLabs + "/ordered", folder, fs::copy_options::recursive);
    fs::remove_all(folder + "/hidden");
    fs::rename(folder + "/reference/ordered_visit.h", folder + "/handout/ordered_visit.h");
    fs::copy(folder + "/handout/ordered.cl", folder + "/reference/ordered.cl");
    json lab = json::parse(scratch.read("whole/lab.json"));
    lab["files"] = {{{"name", "ordered.cl"}, {"bytes", 16384}}};
    lab["forbidden"] = json::array(), lab["checks"] = {"hits.random"};
    lab["cases"] = {{{"name", "city"}, {"scene", "city"}, {"triangles", 500}, {"rays", 200}}};
    scratch.write("whole/lab.json", lab.dump());
    expect_marks(folder, "ordered.cl", kWholeTraversal);
}

// Submissions of the labs in which students write a model of surfaces.

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
