// watch_test.cpp -- `clarity render --watch` as a user experiences it: save, look, save an error, repair it, Ctrl-C.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstring>
#include <thread>

#include "cli/run_program.hpp"
#include "support/clock.hpp"
#include "support/scratch.hpp"

namespace fs = std::filesystem;

namespace {

// The program in the background, with its stderr in a file.
class Watcher {
 public:
    Watcher(const std::vector<std::string>& words, const std::string& kernels, const std::string& said) : said_(said) {
        std::vector<std::string> all = {getenv("CLARITY_WORKER")};
        all.insert(all.end(), words.begin(), words.end());
        std::vector<char*> argv;
        for (std::string& word : all) argv.push_back(word.data());
        argv.push_back(nullptr);
        child_ = fork();
        if (child_ != 0) return;
        const int err = open(said.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
        dup2(err, STDERR_FILENO);
        for (const int number : {SIGINT, SIGTERM}) signal(number, SIG_DFL);
        setenv("CLARITY_KERNEL_PATH", kernels.c_str(), 1);
        execv(argv[0], argv.data());
        _exit(127);
    }
    ~Watcher() {
        if (child_ > 0) kill(child_, SIGKILL), waitpid(child_, nullptr, 0);
    }
    std::string said() const {
        std::ifstream in(said_);
        return std::string(std::istreambuf_iterator<char>(in), {});
    }
    // Waits until stderr contains the text n times. Returns false if the program ends first, or hangs.
    bool says(const std::string& text, int times = 1) {
        bool found = false;
        const auto is_over = [&] {
            const std::string all = said();
            int count = 0;
            for (size_t at = all.find(text); at != std::string::npos; at = all.find(text, at + 1)) ++count;
            found = count >= times;
            if (!found && waitpid(child_, &status_, WNOHANG) == child_) child_ = -1;
            return found || child_ < 0;
        };
        return clarity::test::comes(is_over) && found;
    }
    int interrupt() {
        if (child_ <= 0) return -1;
        kill(child_, SIGINT);
        waitpid(child_, &status_, 0);
        child_ = -1;
        return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
    }

 private:
    std::string said_;
    pid_t child_ = -1;
    int status_ = 0;
};

class Watch : public ::testing::Test {
 protected:
    void SetUp() override {
        if (run_program({"devices"}).exit_code == 3) GTEST_SKIP() << "no OpenCL device on this machine";
        fs::copy(fs::path(CLARITY_SOURCE_DIR) / "cl", scratch_.path("cl"), fs::copy_options::recursive);
        scene_ = scratch_.write("a.scene", scene_text("1 0 0"));
    }
    static std::string scene_text(const std::string& background) {
        return "camera main eye 0 1 6 target 0 1 0 fov 40\nbackground " + background + "\nsphere center 0 1 0 radius 1\n";
    }
    std::string picture() const { return scratch_.path("a.pfm"); }
    std::vector<std::string> words() const { return {"render", scene_, "-o", picture(), "--size", "32x24", "--watch"}; }
    // The first pixel, which shows the background: R, G, B.
    std::array<float, 3> corner() const {
        const std::string file = scratch_.read("a.pfm");
        std::array<float, 3> pixel{-1, -1, -1};
        const size_t bytes = 32 * 24 * 3 * sizeof(float);
        if (file.size() > bytes) std::memcpy(pixel.data(), file.data() + file.size() - bytes, sizeof pixel);
        return pixel;
    }

    Scratch scratch_;
    std::string scene_;
};

constexpr const char* kWaiting = "waiting for a change";

}  // namespace

TEST_F(Watch, RendersAgainAfterAnEditAMistakeAndItsRepair) {
    const std::string kernel = "cl/tracers/iterative/iterative.cl", sound = scratch_.read(kernel);
    const std::string store = "rt_put_pixels(frame, origin, sums, film);",
                      swapped = "for (uint i = 0; i < RT_MAX_PIXELS; ++i) sums[i] = sums[i].zyxw;\n" + store;
    ASSERT_NE(sound.find(store), std::string::npos) << "the line that this test edits";
    Watcher watcher(words(), scratch_.path("cl"), scratch_.path("said"));
    ASSERT_TRUE(watcher.says(kWaiting)) << watcher.said();
    EXPECT_EQ(corner(), (std::array<float, 3>{1, 0, 0})) << watcher.said();

    std::string edited = sound;
    edited.replace(edited.find(store), store.size(), swapped);
    scratch_.write(kernel, edited);
    ASSERT_TRUE(watcher.says(kWaiting, 2)) << watcher.said();
    EXPECT_EQ(corner(), (std::array<float, 3>{0, 0, 1})) << watcher.said();
    EXPECT_NE(watcher.said().find("changed: " + scratch_.path(kernel)), std::string::npos) << watcher.said();

    scratch_.write(kernel, "mistake here;\n" + sound);
    ASSERT_TRUE(watcher.says(kWaiting, 3)) << watcher.said();
    EXPECT_NE(watcher.said().find(scratch_.path(kernel) + ":1:1: "), std::string::npos) << watcher.said();
    EXPECT_EQ(corner(), (std::array<float, 3>{0, 0, 1})) << "the last good picture stays";

    fs::rename(scratch_.write("cl/tracers/.swp", sound), scratch_.path(kernel));
    ASSERT_TRUE(watcher.says(kWaiting, 4)) << watcher.said();
    EXPECT_EQ(corner(), (std::array<float, 3>{1, 0, 0})) << watcher.said();

    scratch_.write("a.scene", scene_text("0 1 0"));
    ASSERT_TRUE(watcher.says(kWaiting, 5)) << watcher.said();
    EXPECT_EQ(corner(), (std::array<float, 3>{0, 1, 0})) << watcher.said();
    EXPECT_EQ(watcher.interrupt(), 0) << watcher.said();
}

TEST_F(Watch, ALoopWithoutEndNeverRunsHere) {
    Environment environment;  // as users have it; most tests compile in their own process
    environment.set("CLARITY_COMPILE", "worker");
    environment.set("XDG_CACHE_HOME", scratch_.path("cache"));
    const std::string kernel = "cl/tracers/iterative/iterative.cl", sound = scratch_.read(kernel);
    const std::string store = "rt_put_pixels(frame, origin, sums, film);";
    ASSERT_NE(sound.find(store), std::string::npos) << "the line that this test edits";
    std::vector<std::string> all = words();
    all.insert(all.end(), {"--device", "cpu", "--tracer", "iterative", "--lanes", "1", "--accel", "linear"});
    Watcher watcher(all, scratch_.path("cl"), scratch_.path("said"));
    ASSERT_TRUE(watcher.says(kWaiting)) << watcher.said();
    const auto save = [&](const std::string& before_store) {
        std::string edited = sound;
        scratch_.write(kernel, edited.replace(edited.find(store), 0, before_store));
    };
    save("while (sums[0].x < 2.0f) sums[0].y += 1.0f;\n");
    ASSERT_TRUE(watcher.says(kWaiting, 2)) << watcher.said();
    EXPECT_NE(watcher.said().find("did not come to an end"), std::string::npos) << watcher.said();
    EXPECT_NE(watcher.said().find(scratch_.path(kernel) + ", changed from line"), std::string::npos) << watcher.said();
    EXPECT_EQ(corner(), (std::array<float, 3>{1, 0, 0})) << "the last good picture stays";
    save("for (uint i = 0; i < RT_MAX_PIXELS; ++i) sums[i] = sums[i].zyxw;\n");
    ASSERT_TRUE(watcher.says(kWaiting, 3)) << watcher.said();
    EXPECT_EQ(corner(), (std::array<float, 3>{0, 0, 1})) << watcher.said();
    EXPECT_EQ(watcher.interrupt(), 0) << watcher.said();
}

TEST_F(Watch, StartsWithABrokenSceneAndExitsWithTheLastError) {
    scratch_.write("a.scene", "sphere of nothing\n");
    Watcher watcher(words(), scratch_.path("cl"), scratch_.path("said"));
    ASSERT_TRUE(watcher.says(kWaiting)) << watcher.said();
    EXPECT_FALSE(fs::exists(picture()));
    scratch_.write("a.scene", scene_text("1 0 0"));
    ASSERT_TRUE(watcher.says(kWaiting, 2)) << watcher.said();
    EXPECT_EQ(corner(), (std::array<float, 3>{1, 0, 0})) << watcher.said();
    scratch_.write("cl/tracers/camera.h", "mistake\n");
    ASSERT_TRUE(watcher.says(kWaiting, 3)) << watcher.said();
    EXPECT_EQ(watcher.interrupt(), 5) << "the last attempt failed: " << watcher.said();
}

TEST_F(Watch, ASaveCancelsTheCurrentRender) {
    std::vector<std::string> slow = words();
    slow.insert(slow.end(), {"--spp", "65536", "--size", "256x192", "-v"});
    Watcher watcher(slow, scratch_.path("cl"), scratch_.path("said"));
    ASSERT_TRUE(watcher.says("rendering a.pfm")) << watcher.said();
    scratch_.write("a.scene", scene_text("0 1 0"));
    ASSERT_TRUE(watcher.says("rendering a.pfm", 2)) << watcher.said();
    EXPECT_FALSE(fs::exists(picture())) << "a partial picture of the old scene was written";
    std::this_thread::sleep_for(std::chrono::milliseconds(500));  // for some samples
    EXPECT_EQ(watcher.interrupt(), 130) << watcher.said();
    // A busy machine may have none yet.
    const bool any = watcher.said().find("no sample was complete") == std::string::npos;
    EXPECT_EQ(fs::exists(picture()), any) << "the accumulated samples must be written: " << watcher.said();
}

#ifdef TEST_PLUGINS
TEST_F(Watch, RendersAgainWithAPluginThatIsBuiltAgain) {
    const std::string folder = std::string(TEST_PLUGINS) + "/", library = scratch_.path("sound.so");
    const auto build = [&](const char* from) {  // as a linker: a new file under the same name
        fs::remove(library);
        fs::copy_file(folder + from, library);
    };
    build("sound.so");
    std::vector<std::string> all = words();
    all.insert(all.end(), {"--plugin", library});
    Watcher watcher(all, scratch_.path("cl"), scratch_.path("said"));
    ASSERT_TRUE(watcher.says(kWaiting)) << watcher.said();
    build("sound_again.so");
    ASSERT_TRUE(watcher.says("sound.so: was built again and is in force now")) << watcher.said();
    ASSERT_TRUE(watcher.says(kWaiting, 2)) << watcher.said();
    build("wrong_abi.so");
    ASSERT_TRUE(watcher.says("sound.so: was built again and is refused: ABI version")) << watcher.said();
    ASSERT_TRUE(watcher.says("stays in force")) << watcher.said();
    ASSERT_TRUE(watcher.says(kWaiting, 3)) << watcher.said();
    EXPECT_EQ(watcher.interrupt(), 0) << watcher.said();
}

// A private copy is loaded, but the message names the file that the user built.
TEST_F(Watch, ACrashNamesTheLibraryThatWasBuilt) {
    const std::string folder = std::string(TEST_PLUGINS) + "/", library = scratch_.path("sound.so");
    fs::copy_file(folder + "sound.so", library);
    std::vector<std::string> all = words();
    all.insert(all.end(), {"--plugin", library, "--accel", "sound"});
    Watcher watcher(all, scratch_.path("cl"), scratch_.path("said"));
    ASSERT_TRUE(watcher.says(kWaiting)) << watcher.said();
    fs::remove(library);
    fs::copy_file(folder + "sound_crashes.so", library);
    ASSERT_TRUE(watcher.says("the builder crashed")) << watcher.said();
    ASSERT_TRUE(watcher.says(kWaiting, 2)) << watcher.said();
    EXPECT_NE(watcher.said().find("`clarity check " + library + "` looks for it"), std::string::npos) << watcher.said();
    EXPECT_EQ(watcher.said().find("clarity-plugins-"), std::string::npos) << watcher.said();
    watcher.interrupt();
}
#endif
