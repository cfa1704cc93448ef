// While a large model loads, keys are answered and the newest request counts.
#include <gtest/gtest.h>

#include <algorithm>

#include "ui/driver/models.hpp"
#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

using Clock = std::chrono::steady_clock;

class Loading : public WindowTest {
 protected:
    // Whether this stage is seen before the work ends.
    static bool sees_stage(WindowDriver& window, const std::string& word) {
        return window.reaches(
            [&](const nlohmann::json& state) { return std::string(state["stage"]).find(word) != std::string::npos; });
    }
};

// Presses keys while a large model is imported and built. Measures the time from the press to the line that F prints.
TEST_F(Loading, AnswersWhileImportingAndBuilding) {
    const auto window = open();
    const TemporaryFolder folder;
    const std::string model = large_model(folder);
    ASSERT_EQ(window->command("state reset"), "");
    window->line("{", 1);
    ASSERT_EQ(window->command("open " + model), "");
    ASSERT_EQ(window->command("wait busy 20"), "");
    std::vector<double> answers;
    const auto begin = Clock::now();
    bool arrived = false;
    while (!arrived && seconds_since(begin) < 120) {
        const auto press = Clock::now();
        window->key("f");
        ASSERT_NE(window->line("fps ", 10), "");
        answers.push_back(seconds_since(press) * 1e3);
        if (answers.size() % 5 == 0) arrived = !window->state()["busy"];
    }
    window->settle(180);
    const auto now = window->state();
    EXPECT_GT(now["triangles"], 800000);
    std::sort(answers.begin(), answers.end());
    const double median = answers[answers.size() / 2], most = answers[answers.size() * 95 / 100], last = answers.back();
    std::printf(
        "%zu keys answered while %s came in: median %.0f ms, 95 %% %.0f ms, longest %.0f ms (xdotool's start included)\n",
        answers.size(), model.c_str(), median, most, last);
    std::printf("inside the window: longest answer %.0f ms, longest frame %.0f ms\n", double(now["slowest_answer_ms"]),
                double(now["slowest_frame_ms"]));
    EXPECT_GE(answers.size(), 5u);
    EXPECT_LT(median, 100);
    // A busy machine may delay us for a moment. A window that waits for the work takes longer than this.
    EXPECT_LT(last, 1000);
}

TEST_F(Loading, EscapeCancelsAnImport) {
    const auto window = open();
    const TemporaryFolder folder;
    const std::string model = large_model(folder);
    const auto was = window->state();
    const Pixels before = window->picture();
    ASSERT_EQ(window->command("open " + model), "");
    ASSERT_EQ(window->command("wait busy 20"), "");
    window->key("Escape");
    window->settle();
    const auto now = window->state();
    EXPECT_EQ(now["files"], was["files"]);
    EXPECT_EQ(now["message"], "");
    EXPECT_EQ(difference(before, window->picture(), 0), 0);
    // Settings still work on the old scene, and the file can still be opened later.
    ASSERT_EQ(window->command("accel spheres"), "");
    window->settle();
    EXPECT_EQ(window->state()["files"], was["files"]);
    EXPECT_EQ(window->state()["accel"], "spheres");
}

// While the large model is built: another structure, a cancel, another file.
TEST_F(Loading, ANewChangeCancelsARunningBuild) {
    const auto window = open();
    const TemporaryFolder folder;
    const std::string model = large_model(folder);
    const auto was = window->state();
    ASSERT_EQ(window->command("open " + model), "");
    ASSERT_TRUE(sees_stage(*window, "build"));
    ASSERT_EQ(window->command("accel spheres"), "");
    ASSERT_EQ(window->command("accel bvh2,max_leaf=2"), "");
    window->settle(300);
    auto now = window->state();
    EXPECT_EQ(now["accel"], "bvh2");
    EXPECT_GT(int(now["triangles"]), 800000);
    EXPECT_NE(desired(*window).find("max_leaf=2"), std::string::npos);
    EXPECT_EQ(now["message"], "");
    EXPECT_FALSE(now["behind"]);
    const Pixels large = window->picture();

    // Esc sets the desired state back to what is on the screen.
    ASSERT_EQ(window->command("accel spheres"), "");
    ASSERT_TRUE(sees_stage(*window, "build"));
    window->key("Escape");
    window->settle(300);
    EXPECT_EQ(window->state()["accel"], "bvh2");
    EXPECT_FALSE(window->state()["behind"]);
    EXPECT_EQ(difference(large, window->picture(), 0), 0);

    // Another file replaces the one that is being built.
    ASSERT_EQ(window->command("accel spheres"), "");
    ASSERT_TRUE(sees_stage(*window, "build"));
    ASSERT_EQ(window->command("open " + source_path("scenes/primitives.scene")), "");
    window->settle(300);
    now = window->state();
    EXPECT_EQ(now["files"], was["files"]);
    EXPECT_EQ(now["accel"], "spheres");
    EXPECT_EQ(now["message"], "");
    EXPECT_FALSE(now["behind"]);
}

}  // namespace
}  // namespace clarity::ui
