#include "cli/progress_bar.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "base/log.hpp"
#include "base/text.hpp"

namespace clarity {
namespace {

constexpr auto kFirstAfter = std::chrono::milliseconds(150);  // so that short work shows no bar
constexpr auto kEvery = std::chrono::milliseconds(80);

bool stderr_is_terminal() {
    const char* term = std::getenv("TERM");
    return isatty(STDERR_FILENO) && term && *term && std::strcmp(term, "dumb") != 0;
}

bool color_wanted() {
    const char* no_color = std::getenv("NO_COLOR");
    return !(no_color && *no_color);
}

size_t terminal_columns() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

ProgressBar::ProgressBar(bool quiet) : shown_(!quiet && stderr_is_terminal()), color_(color_wanted()) {
    begun_ = last_ = Clock::now();
}

ProgressBar::~ProgressBar() {
    clear();
}

void ProgressBar::stage(const std::string& name) {
    log(LogLevel::debug, name);
    const std::lock_guard<std::mutex> lock(mutex_);
    name_ = printable_line(name);
    begun_ = Clock::now();
    if (drawn_) draw(-1, begun_);
}

bool ProgressBar::report(float fraction) {
    if (shown_) {
        const std::lock_guard<std::mutex> lock(mutex_);
        const auto now = Clock::now();
        if (now - begun_ >= kFirstAfter && now - last_ >= kEvery) draw(fraction, now);
    }
    return !cancelled();
}

void ProgressBar::clear() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (drawn_) std::fputs("\r\033[K", stderr);
    drawn_ = false;
}

void ProgressBar::draw(float fraction, Clock::time_point now) {
    constexpr size_t kBar = 24, kNumbers = 16;
    const size_t columns = terminal_columns();
    // A line which wraps cannot be erased. Long names are cut to make room for the bar.
    const size_t others = kNumbers + 1 + (columns >= 60 ? kBar + 4 : 0);
    std::string line = name_.substr(0, columns > others ? columns - others : 0);
    const size_t left = columns - std::min(columns, line.size() + kNumbers + 1);
    char numbers[32];
    const double seconds = std::chrono::duration<double>(now - begun_).count();
    if (fraction >= 0) {
        const float share = std::min(fraction, 1.0f);
        std::snprintf(numbers, sizeof numbers, "%4.0f %% %6.1f s", 100.0 * double(share), seconds);
        if (left > kBar + 3) {
            const auto full = static_cast<size_t>(share * float(kBar));
            const char* begin = color_ ? "\033[36m" : "";
            const char* end = color_ ? "\033[0m" : "";
            line += " [" + (begin + std::string(full, '#')) + end + std::string(kBar - full, '.') + "]";
        }
    } else {
        std::snprintf(numbers, sizeof numbers, " ... %6.1f s", seconds);
    }
    line = "\r\033[K" + line + numbers;
    std::fwrite(line.data(), 1, line.size(), stderr);
    drawn_ = true;
    last_ = now;
}

}  // namespace clarity
