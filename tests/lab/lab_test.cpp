// lab_test.cpp -- submissions of two labs, right, slow, wrong and cheating: each gets the mark that stands beside it in the
// table.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
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
struct Submission {
    const char* name;
    const char* from;  // the first place of this text ...
    const char* to;    // ... becomes this; "": the file is this text
    double least, most;
    const char* found;  // stands in what some line found; "": anything
    bool quick = false;
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

bool is_quick() {
    return std::getenv("CLARITY_QUICK_TESTS") != nullptr;
}

// The records of all submissions of a lab, which one run grades; in quick tests of some.
std::map<std::string, json> grade(const std::string& lab, const std::string& file, const std::vector<Submission>& submissions) {
    const Scratch scratch;
    const std::string solution = [&] {
        std::ifstream in(kLabs + "/" + lab + "/reference/" + file);
        return std::string(std::istreambuf_iterator<char>(in), {});
    }();
    std::vector<std::string> words = {"lab", "grade", kLabs + "/" + lab};
    for (const Submission& one : submissions) {
        std::string text = solution;
        if (*one.from) {
            const size_t at = text.find(one.from);
            EXPECT_NE(at, std::string::npos) << one.name;
            text.replace(at, std::string(one.from).size(), one.to);
        }
        const std::string hidden = kLabs + "/" + lab + "/hidden/cases.json";
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
void expect_marks(const std::string& lab, const std::string& file, const Submission (&all)[N]) {
    install_sdk();
    std::vector<Submission> chosen;
    for (const Submission& one : all)
        if (one.quick || !is_quick()) chosen.push_back(one);
    const auto records = grade(lab, file, chosen);
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
            for (const char* secret : {"7301", "4117", "9241", "5003"})
                EXPECT_EQ(text.find(secret), std::string::npos) << one.name << " shows a hidden seed: " << text;
        }
        EXPECT_TRUE(found) << one.name << ": no line has '" << one.found << "'" << record.dump(1);
    }
    EXPECT_FALSE(fs::exists("/tmp/clarity-lab-probe"));
}

TEST(LabSubmissions, OfMedianSplit) {
    expect_marks("median", "median.cpp", kMedian);
}
TEST(LabSubmissions, OfOrderedChildren) {
    expect_marks("ordered", "ordered_visit.h", kOrdered);
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
