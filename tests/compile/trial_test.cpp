// trial_test.cpp -- `clarity render` with kernels that were edited by mistake: they are tried in a worker, and never run in the
// program itself.
#include <gtest/gtest.h>

#include <filesystem>

#include "cli/run_program.hpp"
#include "support/scratch.hpp"

namespace {

namespace fs = std::filesystem;

constexpr const char* kTrialScene = "sphere center 0 0 0 radius 1\nlight point position 2 3 4\n";

class Trials : public ::testing::Test {
 protected:
    void SetUp() override {
        if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
        fs::copy(fs::path(CLARITY_SOURCE_DIR) / "cl", scratch_.path("cl"), fs::copy_options::recursive);
        fs::create_directories(scratch_.path("plugins/accel"));
        fs::create_directories(scratch_.path("plugins/primitives"));
        for (const std::string folder : {"plugins/accel/linear", "plugins/accel/bvh2", "plugins/primitives/torus"})
            fs::copy(fs::path(CLARITY_SOURCE_DIR) / folder, scratch_.path(folder), fs::copy_options::recursive);
        scratch_.write("a.scene", kTrialScene);
    }
    void edit(const std::string& file, const std::string& from, const std::string& to) {
        std::string text = scratch_.read(file);
        const size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << file << " has changed: edit something else of it here";
        scratch_.write(file, text.replace(at, from.size(), to));
    }
    ProgramResult run(const std::vector<std::string>& arguments) {
        RunOptions options;
        options.environment = {{"CLARITY_KERNEL_PATH", scratch_.path("cl")},
                               {"CLARITY_COMPILE", "worker"},
                               {"XDG_CACHE_HOME", scratch_.path("cache")}};
        return run_program(arguments, options);
    }
    ProgramResult render(const std::string& accel, const std::string& trial = "auto") {
        fs::remove(scratch_.path("a.png"));
        return run({"render", scratch_.path("a.scene"), "-o", scratch_.path("a.png"), "--size", "32x32", "--lanes", "1",
                    "--depth", "2", "--tracer", "iterative", "--device", "cpu", "--accel", accel, "--trial", trial});
    }
    ProgramResult trace(bool any_hit) {
        scratch_.write("rays", "0 0 5 0  0 0 -1 inf\n");
        std::vector<std::string> words = {"trace",    scratch_.path("a.scene"),
                                          "--rays",   scratch_.path("rays"),
                                          "-o",       scratch_.path("hits"),
                                          "--lanes",  "1",
                                          "--device", "cpu",
                                          "--accel",  "linear"};
        if (any_hit) words.push_back("--any");
        return run(words);
    }
    void expect_refused(const ProgramResult& result, const std::vector<std::string>& says) const {
        EXPECT_EQ(result.exit_code, 5) << result.err;
        for (const std::string& text : says)
            EXPECT_NE(result.err.find(text), std::string::npos) << "expected: " << text << "\nread: " << result.err;
        EXPECT_FALSE(fs::exists(scratch_.path("a.png")));
    }
    size_t kept() const {
        std::error_code error;
        size_t count = 0;
        for (fs::directory_iterator file(scratch_.path("cache/clarity/tried_kernels"), error), end; !error && file != end;
             ++file)
            ++count;
        return count;
    }
    Scratch scratch_;
    const std::string linear_ = "plugins/accel/linear/linear.cl", loop_ = "for (uint i = 0; i < count; ++i) {";
};

TEST_F(Trials, KernelsOfTheProgramAreNotTried) {
    EXPECT_EQ(render("linear").exit_code, 0);
    EXPECT_EQ(kept(), 0u);
}

TEST_F(Trials, AHarmlessEditIsTriedOnce) {
    edit(linear_, loop_, "/* harmless */\n    " + loop_);
    const ProgramResult first = render("linear");
    EXPECT_EQ(first.exit_code, 0) << first.err;
    EXPECT_EQ(kept(), 1u);
    EXPECT_EQ(render("linear").exit_code, 0);
    EXPECT_EQ(kept(), 1u);
}

TEST_F(Trials, ALoopWithoutEndIsStopped) {
    edit(linear_, loop_, "for (uint i = 0; i < count; i += 0u) {");
    expect_refused(render("linear"), {"kernels were tried in a worker first, and did not come to an end within",
                                      scratch_.path(linear_) + ", changed from line 7 on", "clarity check linear"});
    EXPECT_EQ(kept(), 0u);
    edit(linear_, "for (uint i = 0; i < count; i += 0u) {", loop_);
    EXPECT_EQ(render("linear").exit_code, 0);
}

TEST_F(Trials, AReadBehindASlotIsFound) {
    edit(linear_, "RT_LEAF(ctx, first + i, ray, hit)", "RT_LEAF(ctx, first + i + count, ray, hit)");
    expect_refused(render("linear"), {"kernels were tried in a worker first, and crashed (segmentation fault", "the leaves",
                                      "changed from line 8 on"});
    // Untried, the small scene hides it: the buffer has room behind its end.
    EXPECT_NE(render("linear", "off").exit_code, 5);
}

TEST_F(Trials, AStackThatIsTooSmallIsFound) {
    edit("plugins/accel/bvh2/bvh2.cl", "RT_STACK_OK(top + 1u, BVH2_STACK, hit)", "RT_STACK_OK(top + 1u, 2u, hit)");
    expect_refused(render("bvh2"), {"would have written beyond a traversal stack", "bvh2.cl, changed from line 44 on"});
}

TEST_F(Trials, KernelsOfAShapeAreTried) {
    scratch_.write("a.scene", "torus center 0 0 0 normal 0 1 0 radius 1 tube .3\nlight point position 2 3 4\n");
    const std::string file = "plugins/primitives/torus/torus.cl", start = "RT_INLINE void torus_surface(";
    edit(file, start, "/* harmless */ " + start);
    EXPECT_EQ(render("linear").exit_code, 0);
    EXPECT_EQ(kept(), 1u);
    edit(file, "if (!s->wants_uv) return;", "while (s->wants_uv < 2) s->tex_u = at.x;");
    expect_refused(render("linear"), {"did not come to an end within", "while they traced a frame", scratch_.path(file)});
}

TEST_F(Trials, KernelsOfTheFilmAreTried) {
    edit("cl/film.cl", "if (i < count) rt_map_tones", "while (i < count) rt_map_tones");
    expect_refused(render("linear"), {"did not come to an end within", "while they mapped tones", scratch_.path("cl/film.cl")});
    edit("cl/film.cl", "while (i < count) rt_map_tones", "if (i < count) rt_map_tones");
    edit("cl/film.cl", "const float16 sum = vload16(i, film);", "const float16 sum = vload16(i + 768u, film);");
    expect_refused(render("linear"), {"crashed (segmentation fault", "the film", "while they mapped tones"});
}

TEST_F(Trials, KernelsOfRayQueriesAreTried) {
    EXPECT_EQ(trace(false).exit_code, 0);
    EXPECT_EQ(kept(), 0u);
    edit(linear_, loop_, "/* harmless */\n    " + loop_);
    EXPECT_EQ(trace(false).exit_code, 0);
    EXPECT_EQ(kept(), 1u);
    edit(linear_, loop_, "for (uint i = 0; i < count; i += 0u) {");
    for (const bool any_hit : {false, true}) {
        const ProgramResult result = trace(any_hit);
        EXPECT_EQ(result.exit_code, 5) << result.err;
        EXPECT_NE(result.err.find("while they traced 1000 rays of a query"), std::string::npos) << result.err;
    }
}

}  // namespace
