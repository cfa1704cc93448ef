#include "base/files/frame_path.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>

namespace clarity {
namespace {

namespace fs = std::filesystem;

// The last run of # in the name of a file: [first, end). Empty if there is none.
struct Run {
    size_t first = 0, end = 0;
    bool empty() const { return first == end; }
};
Run run_in(const std::string& pattern) {
    const size_t last = pattern.rfind('#');
    const size_t slash = pattern.rfind('/');
    if (last == std::string::npos || (slash != std::string::npos && last < slash)) return {};
    size_t first = last;
    while (first > 0 && pattern[first - 1] == '#') --first;
    return {first, last + 1};
}

}  // namespace

std::string frame_path(const std::string& pattern, int frame) {
    const Run run = run_in(pattern);
    if (run.empty()) return pattern;
    std::string number = std::to_string(frame);
    const size_t width = run.end - run.first;
    if (number.size() < width) number.insert(frame < 0 ? 1 : 0, width - number.size(), '0');
    return pattern.substr(0, run.first) + number + pattern.substr(run.end);
}

std::vector<int> frame_numbers(const std::string& pattern) {
    std::vector<int> numbers;
    const Run run = run_in(pattern);
    if (run.empty()) return numbers;
    const size_t name = pattern.rfind('/') == std::string::npos ? 0 : pattern.rfind('/') + 1;
    const std::string before = pattern.substr(name, run.first - name), behind = pattern.substr(run.end);
    std::error_code error;
    const fs::path folder = name == 0 ? fs::path(".") : fs::path(pattern.substr(0, name));
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        const std::string file = at->path().filename().string();
        if (file.size() <= before.size() + behind.size() || file.compare(0, before.size(), before) != 0 ||
            file.compare(file.size() - behind.size(), behind.size(), behind) != 0)
            continue;
        const char *first = file.data() + before.size(), *last = file.data() + file.size() - behind.size();
        int number = 0;
        const auto [next, failure] = std::from_chars(first, last, number);
        const bool whole = failure == std::errc() && next == last && number >= 0;
        if (whole && file == frame_path(pattern.substr(name), number)) numbers.push_back(number);
    }
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

std::string first_frame(const std::string& path) {
    std::error_code error;
    if (run_in(path).empty() || fs::exists(path, error)) return path;
    const std::vector<int> numbers = frame_numbers(path);
    return numbers.empty() ? std::string() : frame_path(path, numbers.front());
}

}  // namespace clarity
