// build_run.hpp -- runs a builder on guarded memory, with a schedule of its parallel loops that the check chooses.
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "base/progress.hpp"
#include "plugin/parameters.hpp"
#include "rt_plugin.h"
#include "structures/judging.hpp"

namespace clarity::check {

// How the host's parallel_for runs its bodies.
enum class Schedule {
    program,    // as in the program
    forward,    // one thread, in order
    backward,   // one thread, the last first
    shuffled2,  // two threads, in an order of chance
    shuffled7   // seven threads, which often wait for each other
};
const char* schedule_text(Schedule schedule);
// The services of `host`, with loops that run so.
rt_host scheduled(const rt_host& host, Schedule schedule);

// Answers a certain report with "cancelled". at: its number; 0: none.
class CancelAt : public Progress {
 public:
    explicit CancelAt(unsigned at) : at_(at) {}
    bool report(float) override {
        if (++reports_ == at_) cancel();
        return !cancelled();
    }
    unsigned reports() const { return reports_; }

 private:
    const unsigned at_;
    std::atomic<unsigned> reports_{0};
};

struct BuildRun {
    int32_t status = RT_FAILED;
    Problem why;  // how it failed or broke its contract, in its terms; nothing: the result is sound as far as the ABI goes
    bool cancelled = false;  // it returned RT_CANCELLED after progress had said so
    double ms = 0;           // that it lasted, less what it waited for other processes
    unsigned reports = 0;    // calls of host->progress
    BuilderResult result;
};

// A scene, and the guarded input of builders that is made of it.
class BuildCase {
 public:
    BuildCase(std::string name, const Scene& scene);
    const std::string& name() const { return name_; }
    const BuildScene& scene() const { return build_; }
    uint64_t input_bytes() const {
        return build_.prims.size() * sizeof(rt_prim) + build_.triangles.size() * sizeof(rt_packed_prim);
    }
    // cancel_after: the number of the progress report that is answered with "cancelled"; 0: none.
    BuildRun run(const rt_plugin& plugin, const ParameterValues& params, Schedule schedule, unsigned cancel_after = 0) const;
    // Packs a tree over this scene. layout: a structure with rt_accel::pack.
    BuildRun pack(const rt_plugin& layout, const rt_topology& tree) const;

 private:
    template <class Call>
    BuildRun execute(const rt_plugin& plugin, const ParameterValues& params, Schedule schedule, unsigned cancel_after,
                     Call&& call) const;

    std::string name_;
    BuildScene build_;
    std::unique_ptr<BuilderInput> input_;
};

// Whether two results are the same in every byte. Returns the first difference, "slot nodes, element 12, byte 3".
Problem difference(const BuilderResult& a, const BuilderResult& b, const rt_accel& accel);

}  // namespace clarity::check
