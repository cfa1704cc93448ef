#include "window_driver.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <stb_image.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace clarity::ui {
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

Pixels read_png(const std::string& path) {
    Pixels pixels;
    int channels = 0;
    unsigned char* data = stbi_load(path.c_str(), &pixels.width, &pixels.height, &channels, 3);
    if (!data) {
        ADD_FAILURE() << path << ": no picture there";
        return {};
    }
    pixels.rgb.assign(data, data + size_t(3) * size_t(pixels.width) * size_t(pixels.height));
    stbi_image_free(data);
    return pixels;
}

double difference(const Pixels& a, const Pixels& b, int tolerance) {
    if (a.width != b.width || a.height != b.height || a.rgb.empty()) return 1;
    size_t count = 0;
    for (size_t i = 0; i < a.rgb.size(); i += 3) {
        bool differs = false;
        for (size_t c = 0; c < 3; ++c) differs = differs || std::abs(a.rgb[i + c] - b.rgb[i + c]) > tolerance;
        count += differs;
    }
    return double(count) / (double(a.rgb.size()) / 3);
}

TemporaryFolder::TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "clarity_ui_test_XXXXXX").string();
    if (!mkdtemp(pattern.data())) ADD_FAILURE() << pattern << ": " << std::strerror(errno);
    path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
}

std::string source_path(const std::string& relative) {
    return std::string(CLARITY_SOURCE_DIR) + "/" + relative;
}

std::string shared_path(const std::string& relative) {
    const char* folder = std::getenv("CLARITY_SHARED");
    const fs::path path = fs::path(folder && *folder ? folder : std::string(CLARITY_SOURCE_DIR) + "/../shared") / relative;
    return fs::exists(path) ? path.string() : std::string();
}

std::string program_path() {
    const char* worker = std::getenv("CLARITY_WORKER");
    return worker && *worker ? worker : std::string(CLARITY_BUILD_DIR) + "/bin/clarity";
}

// ---- the screen

VirtualScreen& VirtualScreen::instance() {
    static VirtualScreen screen;
    return screen;
}

VirtualScreen::VirtualScreen() {
    for (const char* tool : {"Xvfb", "xdotool"})
        if (std::system((std::string("command -v ") + tool + " >/dev/null 2>&1").c_str()) != 0)
            missing_ += std::string(tool) + " ";
    if (!missing_.empty()) return;
    int ends[2];
    if (pipe(ends) != 0) {
        missing_ = "a pipe";
        return;
    }
    pid_ = fork();
    if (pid_ == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        close(ends[0]);
        const std::string number = std::to_string(ends[1]);
        const int null = open("/dev/null", O_WRONLY);
        dup2(null, 2);
        execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", "1280x800x24", "-nolisten", "tcp", "-noreset",
               nullptr);
        _exit(127);
    }
    close(ends[1]);
    std::string text;  // Xvfb writes the number of a free display here once it is ready
    char c = 0;
    while (read(ends[0], &c, 1) == 1 && c != '\n') text += c;
    close(ends[0]);
    if (text.empty())
        missing_ = "an Xvfb that starts";
    else
        number_ = std::atoi(text.c_str());
}

VirtualScreen::~VirtualScreen() {
    if (pid_ <= 0) return;
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
}

// ---- the program

WindowDriver::WindowDriver(const std::vector<std::string>& arguments, std::map<std::string, std::string> environment) {
    const std::string pipe_path = folder() + "/script";
    if (mkfifo(pipe_path.c_str(), 0600) != 0) ADD_FAILURE() << pipe_path << ": " << std::strerror(errno);
    script_ = open(pipe_path.c_str(), O_RDWR | O_CLOEXEC);
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) ADD_FAILURE() << "no pipe";
    output_ = ends[0];
    std::vector<std::string> words = {program_path(), "view"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    environment.emplace("DISPLAY", VirtualScreen::instance().display());
    environment.emplace("WAYLAND_DISPLAY", "");
    environment.emplace("CLARITY_UI_NO_SAVE", "1");
    environment.emplace("CLARITY_UI_SCRIPT", pipe_path);
    const std::string error_path = folder() + "/stderr", work = folder() + "/started_in";
    fs::create_directory(work);
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        for (const auto& [name, value] : environment)
            if (value.empty())
                unsetenv(name.c_str());
            else
                setenv(name.c_str(), value.c_str(), 1);
        const int errors = open(error_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        dup2(ends[1], 1);
        dup2(errors, 2);
        if (chdir(work.c_str()) == 0) execv(argv[0], argv.data());
        _exit(127);
    }
    close(ends[1]);
}

WindowDriver::~WindowDriver() {
    if (running()) quit();
    if (running()) {
        kill(pid_, SIGKILL);
        reap(true);
        ADD_FAILURE() << "the window did not close";
    }
    close(script_);
    close(output_);
}

bool WindowDriver::reap(bool wait) {
    int status = 0;
    if (pid_ <= 0 || waitpid(pid_, &status, wait ? 0 : WNOHANG) != pid_) return false;
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    pid_ = -1;
    return true;
}

bool WindowDriver::running() {
    reap(false);
    return pid_ > 0;
}

void WindowDriver::quit() {
    send("quit");
    const auto begin = Clock::now();
    while (running() && seconds_since(begin) < test::kHangs_s) read_more(0.05);
}

void WindowDriver::quit_by(int signal) {
    if (running()) kill(pid_, signal);
    const auto begin = Clock::now();
    while (running() && seconds_since(begin) < test::kHangs_s) read_more(0.05);
}

void WindowDriver::send(const std::string& text) {
    const std::string whole = text + "\n";
    if (write(script_, whole.data(), whole.size()) != static_cast<ssize_t>(whole.size()))
        ADD_FAILURE() << "script: " << std::strerror(errno);
}

bool WindowDriver::read_more(double seconds) {
    pollfd ready{output_, POLLIN, 0};
    if (poll(&ready, 1, static_cast<int>(seconds * 1e3) + 1) <= 0) return false;
    char buffer[4096];
    const ssize_t bytes = read(output_, buffer, sizeof buffer);
    if (bytes <= 0) {
        usleep(10000);
        return false;
    }
    pending_.append(buffer, static_cast<size_t>(bytes));
    for (size_t end; (end = pending_.find('\n')) != std::string::npos; pending_.erase(0, end + 1))
        lines_.push_back(pending_.substr(0, end));
    return true;
}

std::string WindowDriver::line(const std::string& prefix, double seconds) {
    const auto begin = Clock::now();
    for (;;) {
        for (size_t i = 0; i < lines_.size(); ++i)
            if (lines_[i].rfind(prefix, 0) == 0) {
                const std::string found = lines_[i];
                lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(i));
                return found;
            }
        const double left = seconds - seconds_since(begin);
        if (left <= 0) return {};
        if (!read_more(std::min(left, 0.2)) && !running()) {
            ADD_FAILURE() << "the program ended with " << exit_code_ << " while `" << prefix << "` was expected\n" << errors();
            return {};
        }
    }
}

std::string WindowDriver::command(const std::string& text, double seconds) {
    send(text);
    const auto begin = Clock::now();
    while (seconds_since(begin) < seconds && running()) {
        for (const bool good : {true, false}) {
            const std::string answer = line((good ? "ok " : "error ") + text, good ? 0.02 : 0);
            if (!answer.empty()) return good ? std::string() : answer;
        }
    }
    return "no answer to `" + text + "`: " + errors();
}

void WindowDriver::settle(double seconds) {
    const std::string error = command("wait idle " + std::to_string(seconds), seconds + 10);
    ASSERT_EQ(error, "") << errors();
}

nlohmann::json WindowDriver::query(const std::string& text) {
    const std::string error = command(text);
    EXPECT_EQ(error, "");
    const std::string answer = line("{");
    return answer.empty() ? nlohmann::json::object() : nlohmann::json::parse(answer);
}

nlohmann::json WindowDriver::state() {
    return query("state");
}

bool WindowDriver::reaches(const Condition& condition, double seconds) {
    const auto begin = Clock::now();
    while (running()) {
        if (condition(state())) return true;
        if (seconds_since(begin) > seconds) return false;
        read_more(0.02);
    }
    return false;
}

Pixels WindowDriver::picture() {
    const std::string path = folder() + "/picture" + std::to_string(pictures_++) + ".png";
    EXPECT_EQ(command("picture " + path), "");
    return read_png(path);
}

Pixels WindowDriver::screenshot() {
    const std::string path = folder() + "/screen" + std::to_string(pictures_++) + ".png";
    EXPECT_EQ(command("screenshot " + path), "");
    EXPECT_EQ(command("wait ready"), "");  // the screenshot is written at the end of that frame
    return read_png(path);
}

std::string WindowDriver::errors() const {
    std::ifstream in(folder() + "/stderr");
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

}  // namespace clarity::ui
