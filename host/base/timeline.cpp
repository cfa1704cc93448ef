#include "base/timeline.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"

namespace clarity::timeline {
namespace detail {
std::atomic<bool> recording{false};
}
namespace {

constexpr size_t kMostSpans = 1000000;

// Never destroyed: threads of drivers may still be at work when the program ends.
struct Recorder {
    std::mutex mutex;
    std::string path;
    double begin_us = 0;
    std::vector<std::string> tracks;  // by number
    std::map<std::string, size_t> number_of_track;
    std::vector<std::pair<size_t, Span>> spans;
    std::vector<std::function<void()>> before_writing;
    size_t left_out = 0;

    size_t track(const std::string& name) {
        const auto [at, fresh] = number_of_track.emplace(name, tracks.size());
        if (fresh) tracks.push_back(name);
        return at->second;
    }
};

Recorder& recorder() {
    static Recorder* const the = new Recorder;
    return *the;
}

std::string& name_of_thread() {
    thread_local std::string name;
    return name;
}

const std::string& track_of_thread() {
    static std::atomic<unsigned> count{0};
    std::string& name = name_of_thread();
    if (name.empty()) name = "thread " + std::to_string(++count);
    return name;
}

constexpr size_t kPiece_bytes = 1 << 20;  // of text that is collected before it is written

// One line for each event, so that a person can read and search the file.
void write_events(const Recorder& r, OutputFile& file) {
    std::string text = "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n";
    auto line = [&, first = true](nlohmann::json event) mutable {
        event["pid"] = 1;
        text += (first ? "" : ",\n") + event.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
        first = false;
        if (text.size() < kPiece_bytes) return;
        file.write(text.data(), text.size());
        text.clear();
    };
    line({{"ph", "M"}, {"name", "process_name"}, {"args", {{"name", "clarity"}}}});
    for (size_t t = 0; t < r.tracks.size(); ++t) {
        line({{"ph", "M"}, {"name", "thread_name"}, {"tid", t}, {"args", {{"name", r.tracks[t]}}}});
        line({{"ph", "M"}, {"name", "thread_sort_index"}, {"tid", t}, {"args", {{"sort_index", t}}}});
    }
    for (const auto& [track, span] : r.spans) {
        nlohmann::json event = {{"ph", "X"},
                                {"tid", track},
                                {"name", span.name},
                                {"cat", span.kind},
                                {"ts", span.begin_us - r.begin_us},
                                {"dur", std::max(0.0, span.end_us - span.begin_us)}};
        if (span.bytes > 0) event["args"] = {{"bytes", span.bytes}};
        line(std::move(event));
    }
    text += "\n]}\n";
    file.write(text.data(), text.size());
}

}  // namespace

void record(const std::string& path) {
    try {
        check_writable(path);
    } catch (const Error& e) {
        throw Error(e.code(), std::string("--trace: ") + e.what());
    }
    Recorder& r = recorder();
    r.path = path;
    r.begin_us = now_us();
    name_of_thread() = "program";
    r.track(name_of_thread());
    detail::recording = true;
}

void write() {
    if (!recording()) return;
    Recorder& r = recorder();
    for (const auto& more : r.before_writing) more();
    detail::recording = false;
    const std::lock_guard lock(r.mutex);
    OutputFile file(r.path);
    write_events(r, file);
    file.commit();
    if (r.left_out > 0)
        log(LogLevel::warning,
            "--trace " + r.path + ": " + std::to_string(r.left_out) +
                " spans are left out: they are beyond the first million, or the driver does not know their times");
}

void add(Span span) {
    add(track_of_thread(), std::move(span));
}

void add(const std::string& track, Span span) {
    Recorder& r = recorder();
    const std::lock_guard lock(r.mutex);
    if (!recording()) return;
    if (r.spans.size() < kMostSpans)
        r.spans.emplace_back(r.track(track), std::move(span));
    else
        ++r.left_out;
}

void before_writing(std::function<void()> more) {
    Recorder& r = recorder();
    const std::lock_guard lock(r.mutex);
    r.before_writing.push_back(std::move(more));
}

void leave_out(size_t count) {
    Recorder& r = recorder();
    const std::lock_guard lock(r.mutex);
    r.left_out += count;
}

}  // namespace clarity::timeline
