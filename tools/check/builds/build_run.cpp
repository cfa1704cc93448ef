#include "tools/check/builds/build_run.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <ctime>
#include <exception>
#include <mutex>
#include <random>
#include <thread>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/scoped_fp_mode.hpp"
#include "structures/judging.hpp"

namespace clarity::check {
namespace {

using Body = void (*)(void*, rt_u32);
thread_local bool inside_loop = false;  // nested loops run on the thread of their caller

void run_in_order(const std::vector<rt_u32>& order, unsigned threads, Body body, void* user) {
    std::atomic<size_t> next{0};
    std::mutex mutex;
    std::exception_ptr thrown;
    const auto work = [&](unsigned thread) {
        const ScopedFpMode floats;
        const bool before = inside_loop;
        inside_loop = true;
        std::minstd_rand random(thread + 1);
        for (size_t i = next++; i < order.size(); i = next++) {
            if (threads > 1 && random() % 8 == 0) std::this_thread::yield();
            try {
                body(user, order[i]);
            } catch (...) {
                const std::lock_guard<std::mutex> lock(mutex);
                if (!thrown) thrown = std::current_exception();
            }
        }
        inside_loop = before;
    };
    std::vector<std::thread> others;
    for (unsigned t = 1; t < threads; ++t) others.emplace_back(work, t);
    work(0);
    for (std::thread& thread : others) thread.join();
    if (thrown) std::rethrow_exception(thrown);
}

template <Schedule S>
void scheduled_for(void*, rt_u32 count, Body body, void* user) {
    if (!body || count == 0) return;
    std::vector<rt_u32> order(count);
    for (rt_u32 i = 0; i < count; ++i) order[i] = i;
    if (S == Schedule::backward) std::reverse(order.begin(), order.end());
    if (S == Schedule::shuffled2 || S == Schedule::shuffled7) {
        std::mt19937 random(count + static_cast<unsigned>(S));
        std::shuffle(order.begin(), order.end(), random);
    }
    const unsigned threads = S == Schedule::shuffled2 ? 2 : S == Schedule::shuffled7 ? 7 : 1;
    run_in_order(order, inside_loop ? 1 : std::min<unsigned>(threads, count), body, user);
}

}  // namespace

const char* schedule_text(Schedule schedule) {
    switch (schedule) {
        case Schedule::program:
            return "with the program's threads";
        case Schedule::forward:
            return "with one thread";
        case Schedule::backward:
            return "with one thread that runs loops backwards";
        case Schedule::shuffled2:
            return "with two threads";
        case Schedule::shuffled7:
            return "with seven threads";
    }
    return "";
}

rt_host scheduled(const rt_host& host, Schedule schedule) {
    rt_host own = host;
    switch (schedule) {
        case Schedule::program:
            break;
        case Schedule::forward:
            own.parallel_for = scheduled_for<Schedule::forward>;
            break;
        case Schedule::backward:
            own.parallel_for = scheduled_for<Schedule::backward>;
            break;
        case Schedule::shuffled2:
            own.parallel_for = scheduled_for<Schedule::shuffled2>;
            break;
        case Schedule::shuffled7:
            own.parallel_for = scheduled_for<Schedule::shuffled7>;
            break;
    }
    return own;
}

BuildCase::BuildCase(std::string name, const Scene& scene) : name_(std::move(name)) {
    Progress progress;
    build_ = make_build_scene(scene, progress);
    input_ = std::make_unique<BuilderInput>(
        build_.prims.data(), build_.prims.size(), build_.groups.data(), static_cast<rt_u32>(build_.groups.size()),
        build_.triangles.data(), build_.triangles.size(), std::vector<double>{},
        rt_device{sizeof(rt_device), RT_DEVICE_CPU, 8, 4, 64, 32u << 10, 1u << 20, 8u << 20, uint64_t(1) << 32});
}

template <class Call>
BuildRun BuildCase::execute(const rt_plugin& plugin, const ParameterValues& params, Schedule schedule, unsigned cancel_after,
                            Call&& call) const {
    BuildRun run;
    CancelAt progress(cancel_after);
    HostServices services({}, progress);
    GuardedOutput output(plugin, static_cast<rt_u32>(build_.groups.size()), services);
    const rt_host host = scheduled(*services.host(), schedule);
    input_->params = params;
    const rt_build_input input = input_->table();
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t worked = std::clock();
    try {
        services.check(static_cast<int>(Exit::failed), [&] {
            const ScopedFpMode floats;
            return run.status = call(&host, &input, output.table());
        });
    } catch (const Cancelled&) {
        run.cancelled = true;
    } catch (const Error& e) {
        run.why = Problem(e.what(), e.failure());
    }
    // On a busy machine a build waits for others; with several threads it works for longer than it lasts.
    run.ms = std::min(ms_since(start), 1e3 * double(std::clock() - worked) / CLOCKS_PER_SEC);
    run.reports = progress.reports();
    run.result = std::move(output.result());
    if (!run.why && !run.cancelled) {
        run.why = run.result.breach(plugin);
        const std::string overrun = overrun_of(run.result);
        if (!run.why && !overrun.empty()) run.why = "wrote beyond the end of " + overrun;
        if (!run.why && plugin.accel->topology) run.why = topology_fault(topology_of(run.result), build_);
        if (run.why) run.why = "the builder " + run.why.text();
    }
    return run;
}

BuildRun BuildCase::run(const rt_plugin& plugin, const ParameterValues& params, Schedule schedule,
                        unsigned cancel_after) const {
    return execute(plugin, params, schedule, cancel_after,
                   [&](const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
                       return run_builder(plugin, host, input, nullptr, out);
                   });
}

BuildRun BuildCase::pack(const rt_plugin& layout, const rt_topology& tree) const {
    return execute(layout, default_parameters(layout), Schedule::program, 0,
                   [&](const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
                       return run_builder(layout, host, input, &tree, out);
                   });
}

Problem difference(const BuilderResult& a, const BuilderResult& b, const rt_accel& accel) {
    for (size_t s = 0; s < a.slots.size(); ++s) {
        const std::string name = std::string("slot ") + accel.slots[s].name;
        if (a.slots[s].count != b.slots[s].count)
            return name + " has " + std::to_string(a.slots[s].count) + " elements or " + std::to_string(b.slots[s].count);
        const auto *x = static_cast<const unsigned char*>(a.slots[s].memory.data()),
                   *y = static_cast<const unsigned char*>(b.slots[s].memory.data());
        const size_t bytes = a.slots[s].memory.bytes();
        const size_t at = static_cast<size_t>(std::mismatch(x, x + bytes, y).first - x);
        if (at < bytes)
            return name + " differs first in element " + std::to_string(at / accel.slots[s].elem_bytes) + ", byte " +
                   std::to_string(at % accel.slots[s].elem_bytes);
    }
    if (a.leaf_count != b.leaf_count)
        return "there are " + std::to_string(a.leaf_count) + " leaves or " + std::to_string(b.leaf_count);
    const auto *x = static_cast<const rt_u32*>(a.refs.data()), *y = static_cast<const rt_u32*>(b.refs.data());
    for (uint64_t i = 0; i < a.leaf_count; ++i)
        if (x[i] != y[i]) return "the leaf order differs first at leaf " + std::to_string(i);
    if (a.roots != b.roots) return "the roots differ";
    if (a.defines != b.defines) return "the defines differ";
    return {};
}

}  // namespace clarity::check
