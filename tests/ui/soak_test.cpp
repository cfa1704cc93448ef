// Random actions on a window for a while: no crash, memory flat, the right picture at rest, no process left, a quick end.
// CLARITY_SOAK_MINUTES says how long (otherwise it is two rounds), CLARITY_SOAK_SEED (1) which actions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "ui/driver/window_fixture.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// A place in a kernel for a loop without end, which reads and writes a float4 array of that name.
struct Kernel {
    const char *file, *place, *array;
};
constexpr Kernel kKernels[] = {{"iterative/iterative.cl", "rt_put_pixels(frame, origin, sums, film);", "sums"},
                               {"path/path.cl", "RT_FOR_PACKETS(frame, packet)", "film"}};
constexpr const char* kMovingScene = "tests/farm/moving.scene";

double number_from(const char* variable, double otherwise) {
    const char* text = std::getenv(variable);
    return text && std::atof(text) > 0 ? std::atof(text) : otherwise;
}

// Processes that have this text in their environment.
size_t processes_with(const std::string& mark) {
    size_t count = 0;
    for (const auto& process : fs::directory_iterator("/proc")) {
        std::ifstream file(process.path() / "environ", std::ios::binary);
        const std::string text(std::istreambuf_iterator<char>(file), {});
        count += text.find(mark) != std::string::npos;
    }
    return count;
}

class Soak : public WindowTest {
 protected:
    void SetUp() override {
        WindowTest::SetUp();
        fs::copy(source_path("cl"), folder.path() + "/cl", fs::copy_options::recursive);
        for (const Kernel& kernel : kKernels) {
            std::ifstream in(path_of(kernel), std::ios::binary);
            good.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
            ASSERT_NE(good.back().find(kernel.place), std::string::npos)
                << kernel.file << " has changed: edit something else of it here";
        }
    }
    std::string path_of(const Kernel& kernel) const { return folder.path() + "/cl/tracers/" + kernel.file; }
    void save(const Kernel& kernel, const std::string& text) const {
        const std::string path = path_of(kernel);
        std::ofstream(path + "~", std::ios::binary) << text;
        fs::rename(path + "~", path);
    }
    std::string chosen(const std::vector<std::string>& among) { return among[random() % among.size()]; }
    // One action; returns what it was.
    std::string act(WindowDriver& window, int number) {
        const std::string structures[] = {"bvh2", "bvh4", "bvh8",   "cwbvh",  "spheres",
                                          "lbvh", "ploc", "linear", "kdtree", "grid"};
        switch (random() % 20) {
            case 0:
                return say(window, "accel " + structures[random() % std::size(structures)]);
            case 1:
                return say(window, "set size " + chosen({"64x48", "160x120", "320x240", "97x31"}));
            case 2:
                return say(window, "set depth " + std::to_string(1 + random() % 8));
            case 3:
                return say(window, "set aov " + chosen({"color", "t", "normal", "steps"}));
            case 4:
                return say(window,
                           "open " + source_path(chosen({"scenes/primitives.scene", "scenes/cornell.scene", kMovingScene})));
            case 5:
                return say(window, "cancel");
            case 6:
                return say(window, "compare " + chosen({"a", "off"}));
            case 7:
                return say(window, "undo");
            case 8:
                return say(window, "redo");
            case 9:
                window.key(chosen({"Left", "Right", "Up", "Down", "Home"}));
                return "key";
            case 10:
                return say(window, "turntable 3 " + folder.path() + "/turn_####.png");
            case 11:
                return say(window, chosen({"play 1", "play 0", "time 1.5", "time 3", "step 1", "speed 2"}));
            case 12:
                return say(window, chosen({"inspect 20 20", "pick 30 20", "inspect 5 40"}));
            case 13:
                return say(window,
                           chosen({"level 2", "level bottom", "level off", "continuous 1", "continuous 0", "handles 1"}));
            case 14:
                return say(window, "save " + folder.path() + "/saved." + chosen({"png", "pfm"}));
            case 15:
            case 16:
                return say(window, "set tracer " + chosen({"path", "path", "auto", "iterative"}));
            case 17:
                return say(window, "set " + chosen({"strategy nee", "strategy bsdf", "strategy mis", "sampler independent",
                                                    "sampler sobol", "denoise on", "denoise off", "denoise moving",
                                                    "adaptive 0.1", "adaptive 0", "aov variance", "aov mis",
                                                    "light-sampling tree", "light-sampling table"}));
            default:
                return edit_kernel(number);
        }
    }
    std::string edit_kernel(int number) {
        const size_t i = random() % std::size(kKernels);
        const Kernel& kernel = kKernels[i];
        const std::string name = kernel.file;
        if (random() % 2 == 0) {
            save(kernel, good[i] + "\n// " + std::to_string(number) + "\n");
            return "a harmless edit of " + name;
        }
        if (random() % 2 == 0) {
            save(kernel, good[i] + "\nthis is no OpenCL C\n");
            return "a mistake in " + name;
        }
        const std::string array = kernel.array;
        std::string endless = good[i];
        endless.insert(endless.find(kernel.place), "while (" + array + "[0].x < 1e30f) " + array + "[0].y += 1.0f;\n");
        save(kernel, endless);
        return "a loop without end in " + name;
    }
    static std::string say(WindowDriver& window, const std::string& line) {
        window.command(line);  // some are refused now and then, such as `undo` at the beginning
        return line;
    }
    TemporaryFolder folder;
    std::vector<std::string> good;  // texts of kKernels
    std::mt19937 random{static_cast<unsigned>(number_from("CLARITY_SOAK_SEED", 1))};
};

TEST_F(Soak, RandomActionsLeaveTheWindowSound) {
    const double seconds = 60 * number_from("CLARITY_SOAK_MINUTES", 0);
    constexpr size_t kLeastRounds = 2;  // so many without that variable, in the tests of each change
    const std::string mark = "CLARITY_SOAK_MARK=" + folder.path();
    const std::vector<std::string> start = {"accel bvh2",         "set lanes 1",     "set size 64x48",   "set depth 3",
                                            "set aov color",      "set tracer auto", "set strategy mis", "set sampler sobol",
                                            "set denoise moving", "set adaptive 0"};
    const auto window = open_scene(source_path("scenes/primitives.scene"), "64x48",
                                   {{"CLARITY_KERNEL_PATH", folder.path() + "/cl"},
                                    {"CLARITY_COMPILE", "worker"},
                                    {"XDG_CACHE_HOME", folder.path() + "/cache"},
                                    {"CLARITY_SOAK_MARK", folder.path()}});
    // Back to a known state: the picture must be that of the beginning.
    const auto rest = [&] {
        for (size_t i = 0; i < std::size(kKernels); ++i) save(kKernels[i], good[i]);
        for (const char* line : {"compare off", "level off", "continuous 0", "handles 0"}) window->command(line);
        window->key("Escape");  // ends a sequence
        window->command("open " + source_path("scenes/primitives.scene"));
        window->key("Home");
        for (const std::string& line : start) window->command(line);
        window->reaches([](const nlohmann::json& state) { return !state["behind"] && !state["busy"]; });
        window->settle();
    };
    rest();
    const Pixels expected = window->picture();
    const auto begin = Clock::now();
    std::vector<double> memory_kb;
    int actions = 0;
    while (memory_kb.size() < kLeastRounds || seconds_since(begin) < seconds) {
        std::string last;
        for (int i = 0; i < 25; ++i) {
            last = act(*window, ++actions);
            ASSERT_TRUE(window->running()) << "ended after action " << actions << ", " << last << ": " << window->errors();
            if (random() % 3 == 0) usleep(static_cast<useconds_t>(random() % 400000));
        }
        rest();
        ASSERT_EQ(difference(window->picture(), expected, 0), 0) << "after " << actions << " actions; last: " << last;
        memory_kb.push_back(window->state()["resident_kb"]);
    }
    // The first half fills caches.
    const auto half = memory_kb.begin() + static_cast<ptrdiff_t>((memory_kb.size() + 1) / 2);
    const double first_kb = *std::max_element(memory_kb.begin(), half);
    const double later_kb = half == memory_kb.end() ? first_kb : *std::max_element(half, memory_kb.end());
    std::printf("%d actions in %.0f s: at most %.0f MiB in the first half, %.0f MiB in the second\n", actions,
                seconds_since(begin), first_kb / 1024, later_kb / 1024);
#ifndef __SANITIZE_ADDRESS__  // which keeps what is freed
    if (memory_kb.size() >= 4) {
        EXPECT_LT(later_kb, 1.1 * first_kb);
    }
#endif
    const auto end = Clock::now();
    window->quit();
    EXPECT_LT(seconds_since(end), at_most(1.0 + 1.0))
        << "the program must end within a second; another is for a machine at work";
    EXPECT_EQ(window->exit_code(), 0) << window->errors();
    EXPECT_TRUE(comes([&] { return processes_with(mark) == 0; })) << "a worker outlived the window";
}

}  // namespace
}  // namespace clarity::ui
