#include "cli/render/frame_range.hpp"

#include <charconv>

#include "base/error.hpp"

namespace clarity {
namespace {

// Reads numbers and signs from left to right.
struct Reader {
    const char *at, *const end;
    explicit Reader(const std::string& text) : at(text.data()), end(at + text.size()) {}
    // Accepts digits only, because from_chars would accept a sign.
    bool number(int& value) {
        if (at == end || *at < '0' || *at > '9') return false;
        const auto [next, error] = std::from_chars(at, end, value);
        at = next;
        return error == std::errc();
    }
    bool sign(char c) { return at != end && *at == c ? (++at, true) : false; }
    bool done() const { return at == end; }
};

}  // namespace

FrameRange parse_frame_range(const std::string& text) {
    Reader reader(text);
    FrameRange range;
    bool good = reader.number(range.first);
    range.last = range.first;
    if (good && reader.sign('-')) good = reader.number(range.last);
    int step = 1;
    if (good && reader.sign('/')) good = reader.number(step);
    range.step = step;
    if (!good || !reader.done())
        throw Error(Exit::usage, "--frames " + text + ": expected A-B or A-B/STEP, as in 1-24 or 1-24/2");
    if (range.last < range.first)
        throw Error(Exit::usage,
                    "--frames " + text + ": the last frame comes before the first; write the smaller number first");
    if (range.step < 1) throw Error(Exit::usage, "--frames " + text + ": the step must be at least 1");
    return range;
}

FrameRange share_of_frames(const FrameRange& all, const std::string& text) {
    Reader reader(text);
    int which = 0, of = 0;
    if (!reader.number(which) || !reader.sign('/') || !reader.number(of) || !reader.done())
        throw Error(Exit::usage, "--frames-of " + text + ": expected K/N, as in 2/8 for the second of eight shares");
    if (which < 1 || of < 1 || which > of)
        throw Error(Exit::usage, "--frames-of " + text + ": K counts from 1 to N, the number of shares");
    const long first = all.first + (which - 1L) * all.step;
    if (first > all.last) return {1, 0, 1};
    return {static_cast<int>(first), all.last, of * all.step};
}

}  // namespace clarity
