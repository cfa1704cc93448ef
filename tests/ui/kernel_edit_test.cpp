// Kernels edited while the window runs. No key is pressed: the watch on the files compiles and swaps them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

class KernelEdit : public WindowTest {
 protected:
    void SetUp() override {
        WindowTest::SetUp();
        fs::copy(source_path("cl"), folder.path() + "/cl", fs::copy_options::recursive);
        kernel = folder.path() + "/cl/tracers/iterative/iterative.cl";
        good = text_of(kernel);
    }
    std::map<std::string, std::string> environment() const { return {{"CLARITY_KERNEL_PATH", folder.path() + "/cl"}}; }
    // Writes as editors do: a complete second file, which is then renamed.
    static void write(const fs::path& path, const std::string& text) {
        const std::string beside = path.string() + "~";
        std::ofstream(beside, std::ios::binary) << text;
        fs::rename(beside, path);
    }
    void write(const std::string& text) const { write(kernel, text); }
    // A visible edit: red and blue are swapped.
    std::string swapped() const {
        const std::string from = "rt_put_pixels(frame, origin, sums, film);",
                          to = "for (uint i = 0; i < RT_MAX_PIXELS; ++i) sums[i] = sums[i].zyxw; " + from;
        std::string text = good;
        const size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << "cl/tracers/iterative/iterative.cl has changed: edit something else of it here";
        return at == std::string::npos ? text : text.replace(at, from.size(), to);
    }
    static Pixels blue_for_red(Pixels pixels) {
        for (size_t i = 0; i + 2 < pixels.rgb.size(); i += 3) std::swap(pixels.rgb[i], pixels.rgb[i + 2]);
        return pixels;
    }
    TemporaryFolder folder;
    fs::path kernel;
    std::string good;
};

TEST_F(KernelEdit, IsCompiledAndShownAutomatically) {
    const auto window = open(environment());
    const Pixels before = window->picture();
    const int revision = window->state()["kernel_revision"];
    write(swapped());
    ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["kernel_revision"] > revision; }));
    window->settle();
    EXPECT_EQ(difference(blue_for_red(before), window->picture(), 0), 0);
    EXPECT_GT(difference(before, window->picture()), 0.1);
    EXPECT_EQ(window->state()["message"], "");
}

TEST_F(KernelEdit, TheKernelThatInspectsPixelsIsTriedFirst) {
    const fs::path file = folder.path() + "/cl/tracers/inspect/inspect.cl";
    std::string text = text_of(file);
    const std::string from = "if (packet != packet_wanted) continue;";
    ASSERT_NE(text.find(from), std::string::npos) << file << " has changed: edit something else of it here";
    write(file, text.replace(text.find(from), from.size(), "while (packet == packet_wanted) summary[0] += 1u;"));
    auto variables = environment();
    variables["CLARITY_COMPILE"] = "worker";
    const auto window = open(variables);
    window->command("set lanes 1");
    window->settle();
    window->command("inspect 8 8");
    window->settle();
    const std::string failure = window->command("inspection");
    EXPECT_NE(failure.find("did not come to an end within"), std::string::npos) << failure;
    EXPECT_NE(failure.find("while they recorded the rays of some pixels"), std::string::npos) << failure;
    EXPECT_NE(failure.find(file.string() + ", changed from line"), std::string::npos) << failure;
    window->key("Left");  // pictures go on
    window->settle();
    EXPECT_EQ(window->state()["message"], "");
}

TEST_F(KernelEdit, AMistakeIsReportedUntilItIsRepaired) {
    const auto window = open(environment());
    const Pixels before = window->picture();
    const auto lines = std::count(good.begin(), good.end(), '\n');
    write(good + "\nthis is no OpenCL C\n");
    ASSERT_TRUE(window->reaches([](const nlohmann::json& state) { return state["messages"] == 1; }));
    window->settle();
    const std::string message = window->state()["message"];
    // The message names the file as its author knows it, and the line of the error.
    EXPECT_NE(message.find("iterative.cl:" + std::to_string(lines + 2)), std::string::npos) << message;
    EXPECT_TRUE(window->state()["behind"]);
    EXPECT_EQ(difference(before, window->picture(), 0), 0);
    // The last good program goes on.
    window->key("Left");
    window->settle();
    EXPECT_GT(difference(before, window->picture()), 0.01);
    window->key("Home");
    EXPECT_EQ(window->state()["messages"], 1);

    write(swapped());
    ASSERT_TRUE(window->reaches([](const nlohmann::json& state) { return state["message"] == "" && !state["behind"]; }));
    window->settle();
    EXPECT_EQ(difference(blue_for_red(before), window->picture(), 0), 0);
    // Settings that need compilation use the new text too.
    ASSERT_EQ(window->command("set packet 8x8"), "");
    window->settle();
    EXPECT_LT(difference(blue_for_red(before), window->picture(), 1), 1e-3);
    window->quit();
    EXPECT_EQ(window->exit_code(), 0);
}

// The kernel is tried in a worker first. It never runs in the window's process, where nothing could stop it.
TEST_F(KernelEdit, ALoopWithoutEndLeavesThePictureAlone) {
    auto users = environment();
    users["CLARITY_COMPILE"] = "worker";
    users["XDG_CACHE_HOME"] = folder.path() + "/cache";
    const auto window = open(users);
    for (const char* change : {"accel linear", "set lanes 1"}) ASSERT_EQ(window->command(change), "");
    window->settle();
    const Pixels before = window->picture();
    const std::string store = "rt_put_pixels(frame, origin, sums, film);";
    const size_t at = good.find(store);
    ASSERT_NE(at, std::string::npos) << "cl/tracers/iterative/iterative.cl has changed: edit something else of it here";
    write(std::string(good).insert(at, "while (sums[0].x < 1e30f) sums[0].y += 1.0f;\n"));
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_TRUE(window->reaches([](const nlohmann::json& state) { return state["messages"] == 1; }));
    EXPECT_LT(seconds_since(begin), at_most(30.0)) << "15 s where nothing else runs";
    const std::string message = window->state()["message"];
    EXPECT_NE(message.find("did not come to an end"), std::string::npos) << message;
    EXPECT_NE(message.find("iterative.cl"), std::string::npos) << message;
    window->settle();
    EXPECT_EQ(difference(before, window->picture(), 0), 0);
    write(swapped());
    ASSERT_TRUE(window->reaches([](const nlohmann::json& state) { return state["message"] == "" && !state["behind"]; }));
    window->settle();
    EXPECT_EQ(difference(blue_for_red(before), window->picture(), 0), 0);
    window->quit();
    EXPECT_EQ(window->exit_code(), 0);
}

TEST_F(KernelEdit, ABurstOfEditsShowsTheLastText) {
    const auto window = open(environment());
    const Pixels before = window->picture();
    for (int i = 0; i < 6; ++i) {
        write(good + "\nthis is no OpenCL C, " + std::to_string(i) + "\n");
        usleep(70000);
    }
    const int revision = window->state()["kernel_revision"];
    write(swapped());
    ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["kernel_revision"] > revision; }));
    window->settle();
    EXPECT_EQ(difference(blue_for_red(before), window->picture(), 0), 0);
    EXPECT_EQ(window->state()["message"], "");
    EXPECT_FALSE(window->state()["behind"]);
}

// The requirement is 200 reloads; CLARITY_RELOADS=200 runs that many. A PoCL device is reopened after 16 programs, so memory is
// compared over whole periods of 16.
TEST_F(KernelEdit, ReloadsLeaveMemoryFlat) {
    constexpr int kTurn = 16;
    const char* desired_now = std::getenv("CLARITY_RELOADS");
    const int reloads = std::max(desired_now ? std::atoi(desired_now) : 0, 2 * kTurn);
    // The smallest possible program, because the test looks for what the compiler leaves behind.
    const auto window = open_scene(source_path("scenes/cornell.scene"), "64x48", environment());
    for (const char* change : {"accel linear", "set lanes 1", "set packet 1x1", "set aov t"})
        ASSERT_EQ(window->command(change), "");
    window->settle();
    const Pixels before = window->picture();
    const fs::path aov = folder.path() + "/cl/tracers/aov/aov.cl";
    const std::string plain = text_of(aov), from = "hit->t, bits", to = "hit->t * hit->t, bits";
    ASSERT_NE(plain.find(from), std::string::npos) << "cl/tracers/aov/aov.cl has changed: edit something else of it here";
    std::string squared = plain;
    squared.replace(squared.find(from), from.size(), to);
    Pixels after;
    double first_kb = 0, later_kb = 0;
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 1; i <= reloads; ++i) {
        const int revision = window->state()["kernel_revision"];
        write(aov, (i % 2 == 1 ? squared : plain) + "\n// " + std::to_string(i) + "\n");
        ASSERT_TRUE(window->reaches([&](const nlohmann::json& state) { return state["kernel_revision"] > revision; })) << i;
        window->settle();
        const auto now = window->state();
        ASSERT_FALSE(now["behind"]) << now["message"];
        const Pixels picture = window->picture();  // shows that the new text runs
        if (i == 1) {
            after = picture;
            ASSERT_GT(difference(before, after, 1), 0.1);
        }
        ASSERT_EQ(difference(picture, i % 2 == 1 ? after : before, 0), 0) << i;
        (i <= kTurn ? first_kb : later_kb) = std::max(i <= kTurn ? first_kb : later_kb, double(now["resident_kb"]));
    }
    std::printf("%d reloads: at most %.0f MiB in the first %d, %.0f MiB after; %.1f s\n", reloads, first_kb / 1024, kTurn,
                later_kb / 1024, seconds_since(begin));
    EXPECT_LT(later_kb, 1.05 * first_kb);
}

}  // namespace
}  // namespace clarity::ui
