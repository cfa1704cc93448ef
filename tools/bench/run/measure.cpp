#include "tools/bench/run/measure.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "tools/bench/run/failure.hpp"

namespace clarity::bench {
namespace {

using Clock = std::chrono::steady_clock;

struct Runner {
    const Contender* contender = nullptr;
    Measured result;
    double once_s = 0;     // wall time of the last repetition of the warm-up, seconds
    unsigned variant = 0;  // variant which the samples were taken with
    std::vector<double> time_ms, wall_ms, processors;
    bool running() const { return result.status == RowStatus::ok; }
    void forget() {
        time_ms.clear();
        wall_ms.clear();
        processors.clear();
    }
};

// If a contender's tuning does not settle, the contender is measured as it is after so many trials.
constexpr unsigned kMostTrials = 100;

// Runs one repetition. Returns false if the contender failed; it is then dropped.
bool run_once(Runner& runner, Sample& result) {
    try {
        result = runner.contender->once();
        return true;
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& e) {
        runner.result.status = RowStatus::failed;
        runner.result.why = failure_text(e);
        return false;
    }
}

// Runs each contender at least twice: the first repetition compiles, loads pages and wakes threads, the second tells how long
// one takes. A contender that tunes itself goes on until its variant is chosen and confirmed, or a quarter of the budget is
// used up.
void warm_up(std::vector<Runner>& runners, const MeasureRules& rules, Progress& progress) {
    const auto first = Clock::now();
    for (Runner& runner : runners) {
        for (unsigned pass = 0; pass < kMostTrials && runner.running(); ++pass) {
            if (!progress.report(-1)) throw Cancelled();
            const auto begin = Clock::now();
            Sample last;
            if (!run_once(runner, last)) break;
            runner.once_s = seconds_since(begin);
            runner.variant = last.variant;
            if (runner.once_s > rules.budget_s) break;
            if (pass > 0 && (last.settled || seconds_since(first) > 0.25 * rules.budget_s)) break;
        }
        if (!runner.running() || runner.once_s * rules.few_rounds <= rules.budget_s) continue;
        char why[160];
        std::snprintf(why, sizeof why, "a repetition takes %.3g s, the case may take %.3g s in all: raise --time-limit",
                      runner.once_s, rules.budget_s);
        runner.result.status = RowStatus::skipped;
        runner.result.why = why;
    }
}

bool all_steady(const std::vector<Runner>& runners, double spread) {
    return std::all_of(runners.begin(), runners.end(), [&](const Runner& runner) {
        return !runner.running() ||
               (summarize(runner.time_ms).spread() <= spread && summarize(runner.wall_ms).spread() <= spread);
    });
}

// Adds one sample. Trials of a contender that tunes itself are run but not counted. If its tuning has chosen another variant
// than before, the samples of the old variant are dropped.
void take_sample(Runner& runner, bool by_processor) {
    Sample sample;
    double processors = 0;
    for (unsigned i = 0; i < kMostTrials; ++i) {
        const double before_ms = processor_ms();
        const auto begin = Clock::now();
        if (!run_once(runner, sample)) return;
        processors = (processor_ms() - before_ms) / std::max(ms_since(begin), 1e-6);
        if (!sample.trial) break;
    }
    if (sample.variant != runner.variant) {
        runner.forget();
        runner.variant = sample.variant;
    }
    runner.result.by_processor = by_processor && sample.processor_ms > 0;
    runner.time_ms.push_back(runner.result.by_processor ? sample.processor_ms : sample.time_ms);
    if (!runner.result.by_processor) runner.wall_ms.push_back(sample.wall_ms);
    runner.processors.push_back(processors);
}

bool all_have(const std::vector<Runner>& runners, size_t samples) {
    return std::all_of(runners.begin(), runners.end(),
                       [&](const Runner& runner) { return !runner.running() || runner.time_ms.size() >= samples; });
}

// Takes rounds of samples until all contenders are steady or the budget is used up.
void take_rounds(std::vector<Runner>& runners, const MeasureRules& rules, double budget_s, Progress& progress) {
    const auto begin = Clock::now();
    for (Runner& runner : runners) runner.forget();
    for (unsigned round = 0; round < rules.max_rounds; ++round) {
        if (round >= rules.few_rounds && all_have(runners, rules.few_rounds)) {
            const double used = seconds_since(begin), next = used / round;
            if (used + next > budget_s) break;
            if (all_have(runners, rules.min_rounds) && all_steady(runners, rules.goal_spread)) break;
        }
        for (Runner& runner : runners) {
            if (!runner.running()) continue;
            if (!progress.report(float(round) / rules.max_rounds)) throw Cancelled();
            take_sample(runner, rules.by_processor);
        }
    }
}

void refuse_unsteady(Measured& result, const MeasureRules& rules) {
    if (result.status != RowStatus::ok || result.spread() <= rules.max_spread) return;
    char why[200];
    std::snprintf(
        why, sizeof why,
        "the middle half of %u repetitions spreads over %.0f %% of the median, more than %.0f %%, after %u attempts: close "
        "other programs, or raise --max-spread or --time-limit",
        result.time_ms.n, 100 * result.spread(), 100 * rules.max_spread, rules.retries + 1);
    result.status = RowStatus::refused;
    result.why = why;
}

}  // namespace

double Measured::spread() const {
    return std::max(time_ms.spread(), wall_ms.spread());
}

std::vector<Measured> measure_interleaved(const std::vector<Contender>& contenders, const MeasureRules& rules,
                                          Progress& progress) {
    const auto begin = Clock::now();
    std::vector<Runner> runners;
    for (const Contender& contender : contenders) runners.emplace_back().contender = &contender;
    warm_up(runners, rules, progress);
    for (unsigned attempt = 0; attempt <= rules.retries; ++attempt) {
        // The first attempt with its warm-up gets half of the budget, and all further attempts together get the other half.
        const double share = attempt == 0 ? 0.5 - seconds_since(begin) / rules.budget_s : 0.5 / rules.retries;
        take_rounds(runners, rules, share * rules.budget_s, progress);
        if (all_steady(runners, rules.max_spread)) break;
    }
    std::vector<Measured> results;
    for (Runner& runner : runners) {
        runner.result.time_ms = summarize(runner.time_ms);
        runner.result.wall_ms = summarize(runner.wall_ms);
        runner.result.processors = summarize(runner.processors).median;
        refuse_unsteady(runner.result, rules);
        results.push_back(runner.result);
    }
    return results;
}

}  // namespace clarity::bench
