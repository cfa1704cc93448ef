#include "submissions.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>

#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"
#include "lab_sdk.hpp"
#include "support/quick.hpp"
#include "support/scratch.hpp"

namespace fs = std::filesystem;
using clarity::test::quick;
using nlohmann::json;

namespace {

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
        // Its other files are ours.
        fs::create_directories(scratch.path(lab));
        fs::copy(folder + "/reference", scratch.path(lab + "/" + one.name));
        scratch.write(lab + "/" + one.name + "/" + file, text);
        words.push_back(scratch.path(lab + "/" + one.name));
    }
    // These must not reach the build.
    for (const Submission& one : submissions) {
        scratch.write(lab + "/" + one.name + "/CMakeLists.txt", "message(FATAL_ERROR \"a student's CMake is run\")\n");
        scratch.write(lab + "/" + one.name + "/rt_plugin.hpp", "#error a student's header is used\n");
    }
    const std::string work = std::string(CLARITY_BUILD_DIR) + "/tests/tools/lab/work_" + lab;
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

}  // namespace

void expect_marks(const std::string& folder, const std::string& file, const std::vector<Submission>& all) {
    install_sdk();
    std::vector<Submission> chosen;
    for (const Submission& one : all)
        if (one.quick || !quick()) chosen.push_back(one);
    const auto records = grade(folder, file, chosen);
    // Hidden seeds as whole numbers: digits of a fraction may be the same.
    std::string seeds = "no seed";
    if (std::ifstream hidden(folder + "/hidden/cases.json"); hidden)
        for (const json& one : json::parse(hidden)) seeds += "|" + one["seed"].dump();
    const std::regex secrets("(^|[^0-9.])(" + seeds + ")([^0-9]|$)");
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
            EXPECT_FALSE(std::regex_search(text, secrets)) << one.name << " shows a hidden seed: " << text;
        }
        EXPECT_TRUE(found) << one.name << ": no line has '" << one.found << "'" << record.dump(1);
    }
    EXPECT_FALSE(fs::exists("/tmp/clarity-lab-probe"));
}
