// lab_test.cpp -- submissions of labs, right, slow, wrong and cheating: each gets the mark that stands beside it in the
// table.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <thread>

#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "lab/board.hpp"
#include "lab/build.hpp"
#include "lab/grade.hpp"
#include "support/scratch.hpp"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string kLabs = std::string(CLARITY_SOURCE_DIR) + "/labs";
const std::string kSdk = std::string(CLARITY_BUILD_DIR) + "/tests/lab/sdk";

// The SDK as it is installed: plugins of submissions are built against it.
void install_sdk() {
    static const bool done = [] {
        const std::string command =
            "cmake --install '" CLARITY_BUILD_DIR "' --component sdk --prefix '" + kSdk + "' >/dev/null";
        return std::system(command.c_str()) == 0;
    }();
    ASSERT_TRUE(done) << kSdk;
}

// A submission is our solution with one edit. Its mark, of 100 without times: 50 of checks and 50 of counts.
constexpr const char* kStarter = "starter";
struct Submission {
    const char* name;
    const char* from;  // the first place of this text ...
    const char* to;    // ... becomes this. kStarter: the file is that of the handout
    double least, most;
    const char* found;  // stands in what some line found; "": anything
    bool quick = false;
    std::vector<std::pair<const char*, const char*>> more = {};  // edits
};

constexpr const char* kBegin = "const rt_topology_output* out) {\n";
#define PROBE(code) "const rt_topology_output* out) {\n    " code "\n"

const Submission kMedian[] = {
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
    {"fills_memory", kBegin, PROBE("for (;;) std::memset(new char[1 << 24], 1, 1 << 24);"), 0, 0, "memory"},
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

const Submission kOrdered[] = {
    {"right", "", "", 100, 100, "1.00 times the work", true},
    {"slow_file_order", "left_entry <= right_entry", "1", 50, 99, "times the work"},
    {"wrong_forgets_the_other", "ordered_push(stack, left_first", "if (0) ordered_push(stack, left_first", 0, 10, ""},
    {"uses_assembler", "    if (left_entered && right_entered) {",
     "    __asm__(\"nop\");\n    if (left_entered && right_entered) {", 0, 0, "line 6 has", true},
    {"counts_falsely", "    if (left_entered && right_entered) {",
     "    rt_hits *hit; hit->steps = 0;\n    if (left_entered && right_entered) {", 0, 0, "does not allow", true},
    {"redefines_what_counts", "uint ordered_next", "#define RT_COUNT_VISIT(a, b)\nuint ordered_next", 0, 0, "has `#`"},
};

const Submission kBinned[] = {
    {"right", "", "", 100, 100, "1.00 times the work", true},
    {"starter", kStarter, "", 50, 50, "times the work", true},
    {"wrong_loses_one", "in->groups[g].count, split", "std::max(in->groups[g].count, 1u) - 1, split", 0, 12.5, ""},
    // The root has one child twice.
    {"wrong_no_tree", "    lab::put_trees(out, trees);",
     "    for (lab::Tree& tree : trees)\n        if (!tree.nodes.empty()) tree.nodes[0].left = tree.nodes[0].right;\n    "
     "lab::put_trees(out, trees);",
     0, 0, ""},
};

#define ARGUMENTS "(const global float *numbers, float3 color, float3 wo, "
#define SAMPLE "RT_INLINE rt_surface_draw microfacet_sample" ARGUMENTS "float3 u)\n"
#define PDF "RT_INLINE float microfacet_pdf" ARGUMENTS "float3 wi)\n"
#define WEIGHT "microfacet_fresnel(color, dot(wo, h)) * ((1.0f + out) / (out + microfacet_smith(draw.wi, alpha)))"
const Submission kMicrofacet[] = {
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
const Submission kSampler[] = {
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
const Submission kWholeTraversal[] = {
    {"own_slabs", "#include \"ordered_visit.h\"\n", OWN_SLABS "#define rt_enter_box own_enter\n", 50, 50,
     "the host has counted 0 boxes, so it tests them by arithmetic of its own, or none: test each by rt_enter_box", true},
    {"own_slabs_that_are_reported", "#include \"ordered_visit.h\"\n",
     OWN_SLABS "#define rt_enter_box(box, ray, hit, entry) (RT_COUNT_BOXES(hit, 1), own_enter(box, ray, hit, entry))\n", 50, 50,
     "it tests boxes by arithmetic of its own: test each by rt_enter_box"},
};

bool is_quick() {
    return std::getenv("CLARITY_QUICK_TESTS") != nullptr;
}

// The records of all submissions of a lab, which one run grades; in quick tests of some.
std::map<std::string, json> grade(const std::string& folder, const std::string& file,
                                  const std::vector<Submission>& submissions) {
    const Scratch scratch;
    const std::string lab = fs::path(folder).filename().string();
    const auto text_in = [&](const char* part) {
        std::ifstream in(folder + "/" + part + "/" + file);
        return std::string(std::istreambuf_iterator<char>(in), {});
    };
    const std::string solution = text_in("reference"), starter = text_in("handout");
    std::vector<std::string> words = {"lab", "grade", folder};
    for (const Submission& one : submissions) {
        std::string text = one.from == kStarter ? starter : solution;
        if (*one.from && one.from != kStarter) {
            const size_t at = text.find(one.from);
            EXPECT_NE(at, std::string::npos) << one.name;
            text.replace(at, std::string(one.from).size(), one.to);
        }
        for (const auto& [from, to] : one.more) {
            const size_t at = text.find(from);
            EXPECT_NE(at, std::string::npos) << one.name;
            text.replace(at, std::string(from).size(), to);
        }
        const std::string hidden = folder + "/hidden/cases.json";
        for (size_t at = text.find("HIDDEN"); at != std::string::npos; at = text.find("HIDDEN")) text.replace(at, 6, hidden);
        if (lab == "median") {
            text.replace(text.find("build(const rt_host*, "), 22, "build([[maybe_unused]] const rt_host* host, ");
            text =
                "#include <sys/socket.h>\n#include <unistd.h>\n#include <cstdio>\n#include <cstdlib>\n#include "
                "<cstring>\n#include <functional>\n" +
                text;
        }
        scratch.write(lab + "/" + one.name + "/" + file, text);
        words.push_back(scratch.path(lab + "/" + one.name));
    }
    // These must not reach the build.
    for (const Submission& one : submissions) {
        scratch.write(lab + "/" + one.name + "/CMakeLists.txt", "message(FATAL_ERROR \"a student's CMake is run\")\n");
        scratch.write(lab + "/" + one.name + "/rt_plugin.hpp", "#error a student's header is used\n");
    }
    const std::string work = std::string(CLARITY_BUILD_DIR) + "/tests/lab/work_" + lab;
    words.insert(words.end(), {"-o", scratch.path("marks"), "--sdk", kSdk, "--work", work, "--counts-only", "--autolab"});
    RunOptions options;
    options.limit_s = 800;
    const ProgramResult result = run_program(words, options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    // Each line of stdout is the grader's own.
    std::istringstream lines(result.out);
    size_t count = 0;
    for (std::string line; std::getline(lines, line); ++count)
        EXPECT_NE(line.find("{\"scores\":{\"checks\":"), std::string::npos) << line;
    EXPECT_EQ(count, submissions.size() + 1);
    EXPECT_EQ(result.out.find("{\"scores\":{\"checks\":0.0,"), 0u) << "the first line has no points";
    EXPECT_EQ(result.out.find("1000000000"), std::string::npos);
    std::map<std::string, json> records;
    for (const Submission& one : submissions)
        records[one.name] = json::parse(scratch.read(std::string("marks/") + one.name + ".json"), nullptr, false);
    return records;
}

template <size_t N>
void expect_marks(const std::string& folder, const std::string& file, const Submission (&all)[N]) {
    install_sdk();
    std::vector<Submission> chosen;
    for (const Submission& one : all)
        if (one.quick || !is_quick()) chosen.push_back(one);
    const auto records = grade(folder, file, chosen);
    const std::regex secrets("(^|[^0-9.])(7301|4117|9241|5003|6133|3907|6229|3571|7523|2819)([^0-9]|$)");
    for (const Submission& one : chosen) {
        const json& record = records.at(one.name);
        ASSERT_TRUE(record.is_object()) << one.name;
        const double total = record["total"];
        EXPECT_GE(total, one.least) << one.name << record.dump(1);
        EXPECT_LE(total, one.most) << one.name << record.dump(1);
        bool found = false;
        for (const json& line : record["lines"]) {
            const std::string text = line["found"];
            found |= text.find(one.found) != std::string::npos;
            if (line["hidden"] == true) {
                EXPECT_EQ(text.find("probe"), std::string::npos) << "a hidden line quotes the submission";
            }
            // As a whole number: digits of a fraction may be the same.
            EXPECT_FALSE(std::regex_search(text, secrets)) << one.name << " shows a hidden seed: " << text;
        }
        EXPECT_TRUE(found) << one.name << ": no line has '" << one.found << "'" << record.dump(1);
    }
    EXPECT_FALSE(fs::exists("/tmp/clarity-lab-probe"));
}

TEST(LabSubmissions, OfMedianSplit) {
    expect_marks(kLabs + "/median", "median.cpp", kMedian);
}
TEST(LabSubmissions, OfOrderedChildren) {
    expect_marks(kLabs + "/ordered", "ordered_visit.h", kOrdered);
}

TEST(LabSubmissions, OfMicrofacets) {
    expect_marks(kLabs + "/microfacet", "microfacet.cl", kMicrofacet);
}

TEST(LabSubmissions, OfSamplers) {
    expect_marks(kLabs + "/sampler", "sampler_choice.h", kSampler);
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

// A shared file that is nowhere, and a name that leads elsewhere, are refused.
TEST(Lab, SharedFilesComeWithTheHandoutAndWithACopy) {
    const Scratch scratch;
    const auto has = [&](const std::string& file) { return fs::exists(scratch.path(file)); };
    clarity::lab::copy_lab(kLabs + "/binned", scratch.path("copy"));
    EXPECT_TRUE(has("copy/handout/lab_tree.hpp"));
    clarity::lab::write_handout(clarity::lab::read_lab(scratch.path("copy"), true), scratch.path("mine"), {});
    for (const char* file : {"mine/lab_tree.hpp", "mine/binned.cpp", "mine/page.md", "mine/lab.json", "mine/CMakeLists.txt"})
        EXPECT_TRUE(has(file)) << file;
    EXPECT_FALSE(has("mine/reference") || has("mine/hidden"));
    fs::remove(scratch.path("copy/handout/lab_tree.hpp"));
    EXPECT_THROW(clarity::lab::read_lab(scratch.path("copy"), true).given(), clarity::Error);
    json lab = json::parse(scratch.read("copy/lab.json"));
    lab["shared"] = {"../lab.json"};
    scratch.write("copy/lab.json", lab.dump());
    EXPECT_THROW(clarity::lab::read_lab(scratch.path("copy"), true), clarity::Error);
}

TEST(Lab, LinksAndLargeFilesAreRefused) {
    const Scratch scratch;
    const clarity::lab::Lab lab = clarity::lab::read_lab(kLabs + "/median", true);
    scratch.write("large/median.cpp", std::string(70000, ' '));
    fs::create_directories(scratch.path("link"));
    fs::create_symlink(kLabs + "/median/hidden/cases.json", scratch.path("link/median.cpp"));
    fs::create_directories(scratch.path("none"));
    for (const char* name : {"large", "link", "none"})
        EXPECT_THROW(clarity::lab::collect(lab, scratch.path(name), scratch.path("to")), clarity::lab::Refused) << name;
}

TEST(Lab, ForbiddenWordsAreNamedWithTheirLine) {
    using clarity::lab::forbidden_word;
    EXPECT_EQ(forbidden_word("int a;\nint b = rt_bits(c);", {"rt_"}), "line 2 has `rt_`");
    EXPECT_EQ(forbidden_word("int start_rt;", {"rt_"}), "");
    EXPECT_EQ(forbidden_word("int hits;", {"hit"}), "");
    EXPECT_EQ(forbidden_word("/* hit */ int a; // hit\n", {"hit"}), "");
    EXPECT_EQ(forbidden_word("/* */ hit /* */", {"hit"}), "line 1 has `hit`");
    EXPECT_EQ(forbidden_word("a \\\n b", {"\\"}), "line 1 has `\\`");
}

TEST(Lab, PointsOfCountsAreOnALogScale) {
    clarity::lab::Lab lab;
    lab.full = 1, lab.none = 4;
    EXPECT_DOUBLE_EQ(clarity::lab::counts_points(lab, 0.5), 1);
    EXPECT_DOUBLE_EQ(clarity::lab::counts_points(lab, 2), 0.5);
    EXPECT_DOUBLE_EQ(clarity::lab::counts_points(lab, 5), 0);
    EXPECT_DOUBLE_EQ(clarity::lab::counts_points(lab, 0), 0);
}

// What students get has no reference, but its figures; they see the public lines of the grader, and each says how to see it
// alone.
TEST(Lab, AHandoutIsCheckedByTheGradersCode) {
    install_sdk();
    const Scratch scratch;
    const std::string folder = scratch.path("mine"), work = std::string(CLARITY_BUILD_DIR) + "/tests/lab/work_median";
    const ProgramResult made = run_program({"lab", "handout", kLabs + "/median", folder, "--sdk", kSdk, "--work", work});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    EXPECT_FALSE(fs::exists(folder + "/hidden")) << "students have the hidden cases";
    EXPECT_FALSE(fs::exists(folder + "/reference"));
    const ProgramResult starter = run_program({"lab", "check", folder, "--sdk", kSdk, "--work", work, "--only", "city"});
    EXPECT_EQ(starter.exit_code, 1);
    EXPECT_NE(starter.out.find("the builder is not written yet"), std::string::npos) << starter.out;
    EXPECT_NE(starter.out.find("alone: clarity lab check . --only city"), std::string::npos) << starter.out;
    fs::copy(kLabs + "/median/reference/median.cpp", folder + "/median.cpp", fs::copy_options::overwrite_existing);
    const ProgramResult solved = run_program({"lab", "check", folder, "--sdk", kSdk, "--work", work, "--only", "city"});
    EXPECT_EQ(solved.exit_code, 0) << solved.out << solved.err;
    EXPECT_NE(solved.out.find("1.00 times the work of the reference"), std::string::npos) << solved.out;
}

// Two processes share a night. One is killed in it; when the other has come to its end, no record is missing and none was made
// twice.
TEST(Lab, ANightIsSharedAndSurvives) {
    install_sdk();
    const Scratch scratch;
    std::vector<std::string> words = {"lab", "night", kLabs + "/median"};
    for (const char* name : {"a", "b", "c"}) {
        fs::create_directories(scratch.path(name));
        fs::copy(kLabs + "/median/handout/median.cpp", scratch.path(std::string(name) + "/median.cpp"));
        words.push_back(scratch.path(name));
    }
    words.insert(words.end(), {"-o", scratch.path("marks"), "--sdk", kSdk, "--counts-only"});
    RunOptions killed;
    killed.signal = SIGKILL;
    killed.signal_when_made = scratch.path("marks/a.json");
    ProgramResult first, second;
    std::thread other([&] { first = run_program(words, killed); });
    second = run_program(words);
    other.join();
    ProgramResult last = second;
    for (int tries = 0; last.exit_code != 0 && tries < 100; ++tries) last = run_program(words);
    EXPECT_EQ(last.exit_code, 0) << last.err;
    for (const char* name : {"a", "b", "c"}) {
        EXPECT_TRUE(json::parse(scratch.read(std::string("marks/") + name + ".json"), nullptr, false).is_object()) << name;
        const std::string line = std::string(name) + "  0.0\n";
        const size_t at = second.out.find(line);
        EXPECT_TRUE(at == std::string::npos || first.out.find(line) == std::string::npos) << name << " was graded twice";
    }
    const ProgramResult again = run_program(words);
    EXPECT_EQ(again.out, "") << "what has a record is graded again";
    scratch.write("a/median.cpp", "another one\n");
    EXPECT_EQ(run_program(words).out, "a  0.0\n") << "what was handed in again is not graded again";
}

TEST(Lab, TheBoardRanksByWork) {
    const Scratch scratch;
    const auto record = [&](const std::string& name, double work, double total) {
        scratch.write(name + ".json", json{{"submission", name}, {"work", work}, {"total", total}}.dump());
    };
    record("slow", 2, 70), record("best", 1, 100), record("alike", 1.015, 99), record("third", 1.03, 98),
        record("<wrong>", 0, 20);
    const auto rows = clarity::lab::read_board(scratch.path(""));
    const std::pair<const char*, unsigned> expected[] = {{"best", 1}, {"alike", 1}, {"third", 3}, {"slow", 4}, {"<wrong>", 0}};
    ASSERT_EQ(rows.size(), 5u);
    for (size_t i = 0; i < rows.size(); ++i) {
        EXPECT_EQ(rows[i].name, expected[i].first);
        EXPECT_EQ(rows[i].rank, expected[i].second) << rows[i].name;
    }
    const std::string page = clarity::lab::board_html("A lab", rows);
    EXPECT_EQ(page.find("<wrong>"), std::string::npos);
    EXPECT_NE(page.find("&lt;wrong&gt;"), std::string::npos);
    EXPECT_THROW(clarity::lab::read_board(scratch.path("none")), clarity::Error);
}

// Before grading has come to its end there is a score of 0; a lab that cannot be graded keeps it.
TEST(Lab, ATimeLimitIsNoOtherScore) {
    install_sdk();
    const Scratch scratch;
    fs::copy(kLabs + "/median", scratch.path("lab"), fs::copy_options::recursive);
    scratch.write("lab/reference/median.cpp", "no C++\n");
    const ProgramResult result = run_program({"lab", "grade", scratch.path("lab"), kLabs + "/median/reference", "--sdk", kSdk,
                                              "--gradescope", scratch.path("results.json"), "--autolab"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("the reference solution: it does not compile"), std::string::npos) << result.err;
    EXPECT_EQ(json::parse(scratch.read("results.json"))["score"], 0);
    EXPECT_NE(result.out.find("{\"scores\":{\"checks\":0.0,"), std::string::npos) << result.out;
}

}  // namespace
