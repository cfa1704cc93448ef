#include "cli/render/frame_range.hpp"

#include <charconv>
#include <filesystem>

#include "base/error.hpp"
#include "base/files/frame_path.hpp"

namespace clarity {

FrameRange parse_frame_range(const std::string& text) {
    const char *at = text.data(), *const end = at + text.size();
    // Accepts digits only, because from_chars would accept a sign.
    const auto number = [&](int& value) {
        if (at == end || *at < '0' || *at > '9') return false;
        const auto [next, error] = std::from_chars(at, end, value);
        at = next;
        return error == std::errc();
    };
    const auto sign = [&](char c) { return at != end && *at == c ? (++at, true) : false; };
    FrameRange range;
    bool good = number(range.first);
    range.last = range.first;
    if (good && sign('-')) good = number(range.last);
    if (good && sign('/')) good = number(range.step);
    if (!good || at != end) throw Error(Exit::usage, "--frames " + text + ": expected A-B or A-B/STEP, as in 1-24 or 1-24/2");
    if (range.last < range.first)
        throw Error(Exit::usage,
                    "--frames " + text + ": the last frame comes before the first; write the smaller number first");
    if (range.step < 1) throw Error(Exit::usage, "--frames " + text + ": the step must be at least 1");
    return range;
}

std::optional<int> next_frame(const FrameRange& range, long from, const std::string& skip) {
    for (long number = from; number <= range.last; number += range.step) {
        const int frame = static_cast<int>(number);
        std::error_code error;
        if (skip.empty() || !std::filesystem::is_regular_file(frame_path(skip, frame), error)) return frame;
    }
    return std::nullopt;
}

}  // namespace clarity
