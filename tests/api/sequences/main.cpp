// main.cpp -- sequences of calls of the library, drawn by a seed, with right and wrong arguments, on one to four threads.
//   library_sequences [--seed N] [--calls N | --seconds S | --steps A-B[,A-B...]] [--accels "bvh8 linear"] [--program FILE]
//   [--shrink]
// A fault ends the process with a line that repeats it. --shrink runs the given steps again and again in processes of their
// own, leaves out what the fault does not need, and prints the steps that remain. --program: as of clarity_set_program().
#include <dlfcn.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>
#include <thread>

#include "call_lists.hpp"

namespace sequences {
namespace {

// A sequence begins with nothing, and ends with nothing.
constexpr uint64_t kSteps = 4000;
// A call that takes longer hangs; compilers of kernels take seconds each.
constexpr int kPatienceS = 600;

struct Range {
    uint64_t begin, end;  // [begin, end)
};

const bool quick = std::getenv("CLARITY_QUICK_TESTS") != nullptr;
struct Options {
    uint64_t seed = 1, calls = quick ? 8000 : 60000;
    double seconds = 0;         // 0: `calls` say when it ends
    std::vector<Range> ranges;  // empty: all steps from 0 on
    std::string accels = quick ? "bvh8 linear" : "bvh8 linear bvh2,max_leaf=2 grid", program;
    bool shrink = false;
};

// What threads do, for the line that tells of a fault, and for the watchdog.
struct Doing {
    std::atomic<uint64_t> step{0}, since_s{0};
    std::atomic<const char*> call{nullptr};
};
constexpr int kMostThreads = 4;
Doing doing[kMostThreads];
Options options;
thread_local const char* this_call = "";
thread_local uint64_t this_step = 0;

uint64_t now_s() {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::seconds>(now).count());
}

// Also from signals and sanitizers: no memory is allocated.
void tell_where() {
    const uint64_t last = std::max(this_step, doing[0].step.load()), first = last / kSteps * kSteps;
    fprintf(stderr, "sequences: repeat with --seed %llu --steps %llu-%llu\n", static_cast<unsigned long long>(options.seed),
            static_cast<unsigned long long>(first), static_cast<unsigned long long>(last + kMostThreads));
    for (const Doing& one : doing)
        if (const char* call = one.call.load())
            fprintf(stderr, "sequences:   step %llu is in %s\n", static_cast<unsigned long long>(one.step.load()), call);
}

void on_signal(int number) {
    tell_where();
    signal(number, SIG_DFL);
    raise(number);
}

void catch_faults() {
    // AddressSanitizer handles signals by itself, and calls this before it ends the process.
    const auto set = reinterpret_cast<void (*)(void (*)())>(dlsym(RTLD_DEFAULT, "__sanitizer_set_death_callback"));
    if (set) set(tell_where);
    for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
        if (!set || number == SIGABRT) signal(number, on_signal);
}

// Of one call: how often and how long.
struct Cost {
    std::atomic<uint64_t> count{0}, ns{0};
};

class Run {
 public:
    explicit Run(Common common) : common_(std::move(common)) {
        for (const auto* list : {&kSceneCalls, &kTracerCalls, &kRayCalls, &kOtherCalls})
            for (const Call& call : *list)
                weights_.push_back((weights_.empty() ? 0 : weights_.back()) + call.weight), calls_.push_back(call);
        costs_ = std::make_unique<Cost[]>(calls_.size());
    }

    // The steps of one sequence that are among those that were asked for.
    void sequence(uint64_t first) {
        std::vector<uint64_t> steps;
        for (uint64_t step = first; step < first + kSteps; ++step)
            if (is_asked(step)) steps.push_back(step);
        if (steps.empty()) return;
        State state;
        Draw draw(options.seed, ~first);
        state.threads = draw.chance(0.5) ? 1 : 2 + static_cast<int>(draw.below(kMostThreads - 1));
        std::vector<std::thread> threads;
        for (int t = 0; t < state.threads; ++t)
            threads.emplace_back([&, t] {
                for (const uint64_t step : steps)
                    if (step % static_cast<uint64_t>(state.threads) == static_cast<uint64_t>(t)) run(state, step, doing[t]);
                doing[t].call = nullptr;
            });
        for (std::thread& thread : threads) thread.join();
    }

    void print(std::ostream& to) const {
        char line[128];
        for (size_t i = 0; i < calls_.size(); ++i) {
            const double count = double(costs_[i].count), us = double(costs_[i].ns) / 1e3;
            snprintf(line, sizeof line, "%-26s %10.0f steps, %9.1f us each\n", calls_[i].name, count,
                     count > 0 ? us / count : 0);
            to << line;
        }
    }

 private:
    static bool is_asked(uint64_t step) {
        return options.ranges.empty() || std::any_of(options.ranges.begin(), options.ranges.end(),
                                                     [&](const Range& r) { return step >= r.begin && step < r.end; });
    }
    void run(State& state, uint64_t number, Doing& here) {
        Step step{state, common_, Draw(options.seed, number)};
        // The first steps of a sequence make something to work with.
        const bool first = number % kSteps < 4;
        const double at = step.draw.real(0, weights_.back());
        const auto i = first ? (number % kSteps < 2 ? 0 : kSceneCalls.size())
                             : static_cast<size_t>(std::upper_bound(weights_.begin(), weights_.end(), at) - weights_.begin());
        this_call = calls_[i].name, this_step = number;
        here.call = calls_[i].name;
        here.step = number;
        here.since_s = now_s();
        const auto begin = std::chrono::steady_clock::now();
        calls_[i].run(step);
        costs_[i].ns += static_cast<uint64_t>(std::chrono::nanoseconds(std::chrono::steady_clock::now() - begin).count());
        ++costs_[i].count;
        here.since_s = 0;
    }
    const Common common_;
    std::vector<Call> calls_;
    std::vector<double> weights_;  // summed up
    std::unique_ptr<Cost[]> costs_;
};

// A model of few triangles, placed twice, and a sphere.
Common common() {
    Common common;
    char folder[] = "/tmp/clarity_sequences_XXXXXX";
    if (!mkdtemp(folder))
        throw std::runtime_error("no folder for files of this run: /tmp/clarity_sequences_XXXXXX cannot be made");
    common.folder = folder;
    common.scene_file = common.folder + "/two.scene";
    std::ofstream model(common.folder + "/soup.obj");
    Draw draw(7, 7);
    for (uint32_t i = 0; i < 12; ++i) {
        Point middle;
        for (double& x : middle) x = draw.real();
        for (uint32_t k = 0; k < 3; ++k) {
            Point corner;
            for (size_t c = 0; c < 3; ++c) corner[c] = float(middle[c] + draw.real(-0.3, 0.3));
            model << "v " << std::to_string(corner[0]) << ' ' << std::to_string(corner[1]) << ' ' << std::to_string(corner[2])
                  << '\n';
            common.file_positions.push_back(corner);
            common.file_triangles.push_back(3 * i + k);
        }
        model << "f " << 3 * i + 1 << ' ' << 3 * i + 2 << ' ' << 3 * i + 3 << '\n';
    }
    std::ofstream(common.scene_file) << "load soup.obj translate 0.25 0 0\nload soup.obj translate 0 1.5 0\n"
                                        "sphere center 0.5 0.5 2 radius 0.75\n";
    std::istringstream accels(options.accels);
    for (std::string accel; accels >> accel;) common.accels.push_back(accel);
    if (common.accels.empty()) throw std::runtime_error("--accels names no structure");
    return common;
}

double megabytes() {
    std::ifstream file("/proc/self/statm");
    double pages = 0, resident = 0;
    file >> pages >> resident;
    return resident * double(sysconf(_SC_PAGESIZE)) / 1e6;
}

// What ctest takes for a skipped test.
constexpr int kSkipped = 77;

// False: there is no OpenCL device. All else is found by the sequences.
bool has_device(const Common& files) {
    const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t triangle[] = {0, 1, 2};
    const clarity_mesh mesh = {sizeof mesh, CLARITY_FLOAT32, 3, 1, corners, triangle};
    clarity_options options{};
    options.struct_bytes = sizeof options;
    options.accel = files.accels[0].c_str();
    clarity_scene* scene = nullptr;
    clarity_tracer* tracer = nullptr;
    if (clarity_scene_from_mesh(&mesh, nullptr, &scene)) return true;
    const bool none = clarity_tracer_new(scene, &options, nullptr, &tracer) == CLARITY_NO_DEVICE;
    if (none) std::cerr << "skipped: " << clarity_error_text() << '\n';
    clarity_tracer_free(tracer);
    clarity_scene_free(scene);
    return !none;
}

int run_all() {
    const Common files = common();
    Run run(files);
    catch_faults();
    if (!options.program.empty() && clarity_set_program(options.program.c_str()))
        throw std::runtime_error(clarity_error_text());
    if (!has_device(files)) return kSkipped;
    std::thread([] {
        for (;; sleep(1))
            for (const Doing& one : doing)
                if (const uint64_t since = one.since_s; since && now_s() > since + kPatienceS) {
                    fprintf(stderr, "sequences: a call takes more than %d s\n", kPatienceS);
                    tell_where();
                    _exit(1);
                }
    }).detach();
    const auto begin = std::chrono::steady_clock::now();
    const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
    double told = 0, early_mb = 0;
    const auto tell = [&](uint64_t first) {
        std::cout << calls_made << " calls in " << seconds() << " s, " << double(calls_made) / seconds() << " a second, "
                  << megabytes() << " MB; seed " << options.seed << ", step " << first << std::endl;
        told = seconds();
    };
    uint64_t last = options.ranges.empty() ? UINT64_MAX : 0;
    for (const Range& range : options.ranges) last = std::max(last, range.end);
    uint64_t first = options.ranges.empty() ? 0 : options.ranges.front().begin / kSteps * kSteps;
    const auto goes_on = [&] {
        if (!options.ranges.empty()) return first < last;
        return options.seconds > 0 ? seconds() < options.seconds : calls_made < options.calls;
    };
    for (; goes_on(); first += kSteps) {
        run.sequence(first);
        if (early_mb == 0 && first >= 100 * kSteps) early_mb = megabytes();
        if (seconds() > told + 30) tell(first);
    }
    run.print(std::cout);
    tell(first);
    // All that sequences have made is gone. AddressSanitizer keeps what was freed, up to 256 MB; kernels and drivers stay.
    if (early_mb > 0 && megabytes() > early_mb + 600) {
        std::cerr << "sequences: memory has grown from " << early_mb << " to " << megabytes() << " MB\n";
        return 1;
    }
    for (const char* name : {"/two.scene", "/soup.obj"}) unlink((files.folder + name).c_str());
    rmdir(files.folder.c_str());
    return 0;
}

// Whether these steps, in a process of their own, end with a fault.
bool fails(const std::vector<Range>& ranges, bool silent) {
    std::string steps;
    for (const Range& r : ranges) steps += (steps.empty() ? "" : ",") + std::to_string(r.begin) + "-" + std::to_string(r.end);
    std::cout << "trying --steps " << steps << std::endl;
    const pid_t child = fork();
    if (child == 0) {
        if (silent && (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr))) _exit(0);
        const std::string seed = std::to_string(options.seed);
        execl("/proc/self/exe", "library_sequences", "--seed", seed.c_str(), "--steps", steps.c_str(), "--accels",
              options.accels.c_str(), options.program.empty() ? nullptr : "--program", options.program.c_str(), nullptr);
        _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return status != 0;
}

// Leaves out halves, quarters, ... of the steps (Zeller, Hildebrandt 2002, Simplifying and Isolating Failure-Inducing Input).
int shrink() {
    std::vector<Range> ranges = options.ranges;
    if (ranges.empty() || !fails(ranges, true)) {
        std::cerr << "sequences: these steps work: nothing to shrink\n";
        return 1;
    }
    uint64_t all = 0;
    for (const Range& r : ranges) all += r.end - r.begin;
    for (uint64_t piece = (all + 1) / 2;; piece = (piece + 1) / 2) {
        for (size_t i = 0; i < ranges.size();) {
            const Range whole = ranges[i];
            bool shorter = false;
            for (uint64_t begin = whole.begin; begin < whole.end && !shorter; begin += piece) {
                std::vector<Range> fewer(ranges.begin(), ranges.begin() + long(i));
                const uint64_t end = std::min(begin + piece, whole.end);
                if (whole.begin < begin) fewer.push_back({whole.begin, begin});
                if (end < whole.end) fewer.push_back({end, whole.end});
                fewer.insert(fewer.end(), ranges.begin() + long(i) + 1, ranges.end());
                if (!fewer.empty() && fails(fewer, true)) ranges = fewer, shorter = true;
            }
            if (!shorter) ++i;
        }
        if (piece == 1) break;
    }
    fails(ranges, false);
    return 0;
}

std::vector<Range> ranges_of(const std::string& text) {
    std::vector<Range> ranges;
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        Range range{};
        char dash = 0;
        std::istringstream numbers(part);
        if (!(numbers >> range.begin >> dash >> range.end) || dash != '-' || range.begin >= range.end)
            throw std::runtime_error("--steps " + text + ": expected A-B, with A less than B, and more of them behind commas");
        ranges.push_back(range);
    }
    return ranges;
}

int main_of(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
        const std::string name = argv[i];
        if (name == "--shrink") {
            options.shrink = true;
            continue;
        }
        if (++i == argc) throw std::runtime_error(name + ": expected a value behind it");
        const std::string value = argv[i];
        if (name == "--seed")
            options.seed = std::stoull(value);
        else if (name == "--seconds")
            options.seconds = std::stod(value);
        else if (name == "--calls")
            options.calls = std::stoull(value);
        else if (name == "--steps")
            options.ranges = ranges_of(value);
        else if (name == "--accels")
            options.accels = value;
        else if (name == "--program")
            options.program = value;
        else
            throw std::runtime_error(
                name + ": unknown; --seed, --seconds, --calls, --steps, --accels, --program and --shrink are known");
    }
    return options.shrink ? shrink() : run_all();
}

}  // namespace

void Step::fail(const std::string& why) const {
    fprintf(stderr, "sequences: %s: %s\n", this_call, why.c_str());
    tell_where();
    _exit(1);
}

void Step::ended(int32_t code, int32_t expected, const char* words, bool or_ok) const {
    const std::string text = clarity_error_text(), details = clarity_error_details();
    const auto fail_with = [&](const std::string& why) {
        fail(why + "; the code is " + std::to_string(code) + ", the text '" + text.substr(0, 500) + "'");
    };
    if (code != expected && !(or_ok && code == CLARITY_OK))
        fail_with("expected the code " + std::to_string(expected) + " and `" + words + "`");
    if ((code == CLARITY_OK) != text.empty()) fail_with("a text without an error, or the reverse");
    if (code == CLARITY_OK && !details.empty()) fail_with("details without an error");
    if (text.find("unexpected failure") != std::string::npos) fail_with("nobody has thought of this error");
    if (code == expected && text.find(words) == std::string::npos)
        fail_with(std::string("expected '") + words + "' in the text");
}

}  // namespace sequences

int main(int argc, char** argv) {
    try {
        return sequences::main_of(argc, argv);
    } catch (const std::exception& error) {
        std::cerr << "sequences: " << error.what() << '\n';
        return 2;
    }
}
