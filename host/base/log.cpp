// A log of our own, because the core should need no compiled library besides the OpenCL loader.
#include "base/log.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>
#include <mutex>

#include "base/error.hpp"
#include "base/text.hpp"

namespace clarity {
namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

struct LogState {
    std::mutex mutex;
    LogLevel least = LogLevel::info;
    bool to_stderr = true;
    std::unique_ptr<std::FILE, CloseFile> file;
    std::string file_path;
    bool file_is_new = false;  // made by set_log_file()
    bool file_failed = false;
    // Shared, so that a listener may log or replace itself while it is being called.
    std::shared_ptr<const std::function<void(LogLevel, const std::string&)>> listener;
};

// Never destroyed, because threads that outlive main may still log.
LogState& state() {
    static LogState* const only = new LogState;
    return *only;
}

const char* level_name(LogLevel level) {
    switch (level) {
        case LogLevel::debug:
            return "debug";
        case LogLevel::info:
            return "info";
        case LogLevel::warning:
            return "warning";
        case LogLevel::error:
            return "error";
    }
    return "log";
}

const char* level_color(LogLevel level) {
    switch (level) {
        case LogLevel::debug:
            return "\033[2m";
        case LogLevel::info:
            return "";
        case LogLevel::warning:
            return "\033[33m";
        case LogLevel::error:
            return "\033[31m";
    }
    return "";
}

// True if stderr is a terminal that understands escape sequences. "dumb" terminals (an editor's shell buffer) show them as
// text.
bool stderr_is_terminal() {
    const char* term = std::getenv("TERM");
    return isatty(STDERR_FILENO) && term && *term && std::strcmp(term, "dumb") != 0;
}

bool stderr_has_color() {
    const char* no_color = std::getenv("NO_COLOR");
    return stderr_is_terminal() && !(no_color && *no_color);
}

std::string stderr_line(LogLevel level, const std::string& text) {
    static const bool terminal = stderr_is_terminal(), color = stderr_has_color();
    std::string line;
    if (terminal) line += "\r\033[K";  // clears the row: a progress bar may stand there
    if (level != LogLevel::info) {
        if (color) line += level_color(level);
        line += level_name(level);
        line += ": ";
        if (color) line += "\033[0m";
    }
    return line + printable(text) + "\n";
}

std::string file_line(LogLevel level, const std::string& text) {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    tm utc{};
    gmtime_r(&now.tv_sec, &utc);
    char stamp[64], line_head[96];
    std::strftime(stamp, sizeof stamp, "%Y-%m-%dT%H:%M:%S", &utc);
    std::snprintf(line_head, sizeof line_head, "%s.%03ldZ %-7s ", stamp, now.tv_nsec / 1000000, level_name(level));
    return line_head + printable(text) + "\n";
}

// A file that was made here and got nothing goes.
void end_file(LogState& s) {
    struct stat status{};
    const bool got_nothing = fstat(fileno(s.file.get()), &status) == 0 && S_ISREG(status.st_mode) && status.st_size == 0;
    if (s.file_is_new && got_nothing) unlink(s.file_path.c_str());
    s.file.reset();
    s.file_failed = true;
}

}  // namespace

void log(LogLevel level, const std::string& text) {
    LogState& s = state();
    std::shared_ptr<const std::function<void(LogLevel, const std::string&)>> listener;
    {
        const std::lock_guard<std::mutex> lock(s.mutex);
        listener = s.listener;
        if (level >= s.least && s.to_stderr) {
            const std::string line = stderr_line(level, text);
            std::fwrite(line.data(), 1, line.size(), stderr);
        }
        if (s.file) {
            const std::string line = file_line(level, text);
            const bool written = std::fwrite(line.data(), 1, line.size(), s.file.get()) == line.size();
            if (!written || std::fflush(s.file.get()) != 0) {
                const std::string why = s.file_path + ": cannot write the log: " + std::strerror(errno) +
                                        "; free some space or write it elsewhere; it ends here";
                const std::string last = stderr_line(LogLevel::warning, why);
                if (s.to_stderr) std::fwrite(last.data(), 1, last.size(), stderr);
                end_file(s);
            }
        }
    }
    if (listener && *listener) (*listener)(level, text);
}

void set_log_level(LogLevel least) {
    const std::lock_guard<std::mutex> lock(state().mutex);
    state().least = least;
}

void set_log_to_stderr(bool on) {
    const std::lock_guard<std::mutex> lock(state().mutex);
    state().to_stderr = on;
}

void set_log_file(const std::string& path) {
    const bool is_new = access(path.c_str(), F_OK) != 0;
    std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "ae"));
    if (!file)
        throw Error(Exit::usage, path + ": cannot open it as the log file: " + std::strerror(errno) +
                                     "; name a file in a folder that exists and can be written");
    const std::lock_guard<std::mutex> lock(state().mutex);
    state().file = std::move(file);
    state().file_path = path;
    state().file_is_new = is_new;
    state().file_failed = false;
}

bool log_file_failed() {
    const std::lock_guard<std::mutex> lock(state().mutex);
    return state().file_failed;
}

void set_log_listener(std::function<void(LogLevel, const std::string&)> listener) {
    auto shared = std::make_shared<const std::function<void(LogLevel, const std::string&)>>(std::move(listener));
    const std::lock_guard<std::mutex> lock(state().mutex);
    state().listener = std::move(shared);
}

}  // namespace clarity
