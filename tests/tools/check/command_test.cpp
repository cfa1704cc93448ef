// command_test.cpp -- how `clarity check` says what it found: causes, verdict, lists, limits, and lines that repeat a check.
#include <gtest/gtest.h>

#include <cstdlib>

#include "support/clock.hpp"
#include "support/scratch.hpp"
#include "tools/check/causes.hpp"
#include "tools/check/run_check.hpp"

namespace {

using clarity::check::Asked;
using clarity::check::CheckResult;
using clarity::check::Outcome;
using nlohmann::json;

CheckResult result(const char* name, Outcome outcome) {
    CheckResult result;
    result.name = name;
    result.outcome = std::move(outcome);
    return result;
}

// Answers are wrong; the words do not matter.
Outcome wrong(Asked asked, const char* found = "3 are wrong") {
    Outcome outcome = Outcome::failed(found);
    outcome.asked = asked;
    return outcome;
}

TEST(Causes, TheFirstStageThatFailsStandsForTheOthers) {
    const std::vector<CheckResult> results = {
        result("builds.sound", Outcome::passed("")),
        result("hits.octants", wrong(Asked::any_one_lane)),
        result("hits.random", wrong(Asked::nearest_one_lane)),
        result("builds.leaks", Outcome::failed("it leaks memory")),
        result("builds.cancel", Outcome::failed("a box is too small")),
        result("hits.axes", wrong(Asked::nearest_lanes, "crashed")),
        result("builds.bounds", Outcome::failed("a box is too small")),
        result("builds.refit", Outcome::failed("wrong")),
    };
    const auto causes = clarity::check::causes_of(results);
    ASSERT_EQ(causes.size(), 2u);
    EXPECT_EQ(causes[0].stage, "bounds");
    EXPECT_EQ(causes[0].results, (std::vector<size_t>{6, 2, 1, 5, 7, 4}));
    EXPECT_EQ(causes[1].results, (std::vector<size_t>{3}));
    EXPECT_EQ(clarity::check::stage_of(results[5]), "nearest hits of several lanes");
    EXPECT_EQ(clarity::check::stage_of(result("hits.large", wrong(Asked::any_lanes))), "any-hit queries of several lanes");
    EXPECT_EQ(clarity::check::stage_of(result("hits.large", wrong(Asked::nothing))), "hits");
    EXPECT_EQ(clarity::check::stage_of(result("hits.lanes", wrong(Asked::any_lanes))), "several lanes");
}

TEST(Causes, WithoutFailuresThereAreNone) {
    EXPECT_TRUE(clarity::check::causes_of({result("builds.sound", Outcome::passed(""))}).empty());
}

class CheckCommand : public testing::Test {
 protected:
    CheckCommand() {
        scratch_.write("with blank's.tri", "2\n0 0 0  1 0 0  0 1 0\n0 0 0  0 0 1  0 1 0\n");
        scratch_.write("with blank's.tri.json", R"({"triangles": 2, "corners": [{"at": [1, 0, 0], "facing": [0, 0, 1]}]})");
    }
    ProgramResult run(const std::string& library, std::vector<std::string> words) {
        words.insert(words.begin(), {"check", std::string(BROKEN_PLUGINS) + "/" + library + ".so", "--quick"});
        return run_program(words);
    }
    const Scratch scratch_;
    const std::string sample_ = scratch_.path("with blank's.tri");
};

TEST_F(CheckCommand, FailuresAreOneGroupAndTheVerdictIsTheLastLine) {
    const ProgramResult all =
        run("importer_no_instance", {"--samples", sample_, "--only", "imports.read", "--only", "imports.truth"});
    EXPECT_EQ(all.exit_code, 1);
    EXPECT_EQ(all.out.rfind("FAILED  tri imports.read: ", 0), 0u) << all.out;
    EXPECT_NE(all.out.find("\n        imports.truth fails, too: "), std::string::npos) << all.out;
    EXPECT_NE(all.out.find("\nverdict  tri: wrong: 2 of 2 checks failed, likely of 1 fault: imports.read (reading)"),
              std::string::npos)
        << all.out;
}

TEST_F(CheckCommand, JsonHasCausesVerdictAndSeed) {
    const json results = check("importer_no_instance", {"--samples", sample_, "--seed", "18446744073709551615"}, 1);
    ASSERT_TRUE(results.is_array() && results.size() == 8) << results;
    for (const json& one : results) {
        EXPECT_EQ(one["seed"], 18446744073709551615u);
        EXPECT_NE(one["verdict"].get<std::string>().find("seed 18446744073709551615"), std::string::npos);
        if (one["check"] == "imports.truth") {
            EXPECT_EQ(one["cause"], "imports.read");
            EXPECT_EQ(one["stage"], "truth");
        }
    }
}

// A line for the shell, with names that need quotes.
TEST_F(CheckCommand, RepeatLinesWork) {
    const json results = check("importer_flips_winding", {"--samples", sample_, "--only", "imports.truth", "--seed", "7"}, 1);
    ASSERT_EQ(results.size(), 1u) << results;
    std::string line = results[0]["repeat"];
    ASSERT_EQ(line.rfind("clarity check ", 0), 0u) << line;
    EXPECT_NE(line.find("--seed 7"), std::string::npos) << line;
    const std::string log = scratch_.path("log");
    line = std::string(std::getenv("CLARITY_WORKER")) + line.substr(7) + " > '" + log + "'";
    EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 1) << line;
    std::ifstream file(log);
    const std::string said((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    EXPECT_NE(said.find("FAILED  tri imports.truth"), std::string::npos) << said;
}

TEST_F(CheckCommand, ListsWithoutChecking) {
    const ProgramResult list = run("importer_crashes", {"--list", "--samples", sample_});
    EXPECT_EQ(list.exit_code, 0) << list.err;
    EXPECT_NE(list.out.find("tri imports.hostile: "), std::string::npos) << list.out;
    EXPECT_EQ(list.out.find("verdict"), std::string::npos) << list.out;
    const ProgramResult structure = run_program({"check", "linear", "--list"});
    for (const char* name : {"builds.sound: ", "builds.pack: ", "hits.random: ", "accesses.oclgrind: "})
        EXPECT_NE(structure.out.find(std::string("linear ") + name), std::string::npos) << structure.out;
    const ProgramResult wrong = run_program({"check", "linear", "--only", "hits.nothing"});
    EXPECT_NE(wrong.err.find("`clarity check linear --list` lists them"), std::string::npos) << wrong.err;
}

TEST_F(CheckCommand, StopsAtTheFirstFailure) {
    const ProgramResult all = run("importer_no_instance", {"--samples", sample_, "--stop-at-first"});
    EXPECT_EQ(all.exit_code, 1);
    EXPECT_EQ(all.out.find("imports.hostile"), std::string::npos) << all.out;
    EXPECT_NE(all.out.find("--stop-at-first"), std::string::npos) << all.out;
}

TEST_F(CheckCommand, WhatTheTimeLimitCutsIsNotRight) {
    const ProgramResult cut = run_program({"check", "linear", "--time-limit", "1"});
    EXPECT_EQ(cut.exit_code, 1) << cut.out;
    EXPECT_LT(cut.seconds, clarity::test::at_most(20));
    EXPECT_NE(cut.out.find("undecided"), std::string::npos) << cut.out;
    EXPECT_NE(cut.out.find("cut by --time-limit: 1 s are over"), std::string::npos) << cut.out;
}

// A cut before anything was traced says so; it is not taken for a name that no check has.
TEST_F(CheckCommand, OclgrindIsCutBeforeItBegins) {
    const ProgramResult cut = run_program({"check", "bvh2", "--only", "accesses", "--oclgrind-time", "0.01"});
    if (cut.out.find("oclgrind is not installed") != std::string::npos) GTEST_SKIP() << "no oclgrind";
    EXPECT_EQ(cut.exit_code, 1) << cut.out << cut.err;
    EXPECT_NE(cut.out.find("while the simulated device was made"), std::string::npos) << cut.out << cut.err;
}

// A cut is no fault, and the line says what was done last.
TEST_F(CheckCommand, OclgrindIsCutAfterItsTime) {
    const ProgramResult cut = run_program({"check", "bvh2", "--only", "accesses", "--oclgrind-time", "1"});
    if (cut.out.find("oclgrind is not installed") != std::string::npos) GTEST_SKIP() << "no oclgrind";
    const bool begun = cut.out.find("while the simulated device was made") == std::string::npos;  // not on a very busy machine
    EXPECT_EQ(cut.exit_code, begun ? 0 : 1) << cut.out << cut.err;
    const char* const expected =
        begun ? "no access outside of a buffer so far; cut after 1 s, while " : "cut after 1 s, while ";
    EXPECT_NE(cut.out.find(expected), std::string::npos) << cut.out;
}

TEST_F(CheckCommand, NothingThatWasCheckedIsNotRight) {
    const ProgramResult none = run("importer_none", {"--only", "imports.truth"});
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_NE(none.out.find("verdict  tri: undecided: nothing was checked"), std::string::npos) << none.out;
}

TEST_F(CheckCommand, WritesJUnit) {
    const std::string file = scratch_.path("out.xml");
    EXPECT_EQ(run("importer_flips_winding", {"--samples", sample_, "--only", "imports.t", "--junit", file}).exit_code, 1);
    std::ifstream in(file);
    const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    EXPECT_NE(text.find("<testsuite name=\"tri\" tests=\"2\" failures=\"1\" skipped=\"0\""), std::string::npos) << text;
    EXPECT_NE(text.find("<testcase classname=\"tri\" name=\"imports.truth\""), std::string::npos) << text;
    EXPECT_NE(text.find("<failure message=\""), std::string::npos) << text;
    EXPECT_NE(text.find("with blank's"), std::string::npos) << text;
}

TEST_F(CheckCommand, ATruthThatIsWrittenWronglySaysWhichKey) {
    const auto complaint = [&](const char* text) {
        scratch_.write("with blank's.tri.json", text);
        return run("importer_none", {"--samples", sample_, "--only", "imports.truth"});
    };
    EXPECT_EQ(complaint(R"({"triangles": 2, "bbox": [[0, 0, 0], [1, 1, 1]]})").exit_code, 0);  // no area: that is not compared
    for (const auto& [text, words] :
         {std::pair<const char*, const char*>{R"({"volumes": 1})", "states nothing about the file"},
          {R"({"triangles": "two"})", "the key 'triangles' must be a number"},
          {R"({"corners": [{"uv": [0, 0]}]})", "the key 'corners' must be"},
          {R"({"corners": [{"at": [0, 0, 0], "nromal": [0, 0, 1]}]})", "not 'nromal'"},
          {R"({"instances": [{"triangles": 2}]})", "the key 'instances' must be of objects with the key name"},
          {R"({"material_triangles": 2})", "the key 'material_triangles' must be an object"},
          {R"({"bbox": [0, 1]})", "the key 'bbox' must be"},
          {"[", "must hold a JSON object"}}) {
        const ProgramResult said = complaint(text);
        EXPECT_NE(said.exit_code, 0) << text;
        EXPECT_NE((said.out + said.err).find(words), std::string::npos) << text << "\n" << said.out << said.err;
    }
}

TEST_F(CheckCommand, TracesRaysOfYourOwn) {
    scratch_.write("a.scene", "sphere center 0 0 0 radius 1\npolygon vertices -2 -1 -2  -2 -1 2  2 -1 2  2 -1 -2\n");
    scratch_.write("a.rays", "0 0 5 0 0 0 -1 inf\n0 5 0 0 0 -1 0 inf\n0 5 0 0 0 nan 0 inf\n");
    const auto run_own = [&](const std::string& id) {
        return run_program(
            {"check", id, "--scene", scratch_.path("a.scene"), "--rays", scratch_.path("a.rays"), "--lanes", "1"});
    };
    const ProgramResult own = run_own("linear");
    EXPECT_EQ(own.exit_code, 0) << own.out << own.err;
    EXPECT_EQ(own.out.rfind("ok  linear hits.own: your rays in your scene: 2 rays", 0), 0u) << own.out;
    EXPECT_NE(own.out.find("1 rays were left out"), std::string::npos) << own.out;
    EXPECT_EQ(run_own("torus").exit_code, 2);
    EXPECT_EQ(run_program({"check", "linear", "--scene", scratch_.path("a.scene")}).exit_code, 2);
}

}  // namespace
