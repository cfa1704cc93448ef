// measure_test.cpp -- quartiles, interleaving, and the reasons for which rows are refused.
#include "tools/bench/run/measure.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <ctime>
#include <thread>

#include "base/error.hpp"
#include "tracers/rays/autotuner.hpp"

namespace {

using namespace clarity;
using namespace clarity::bench;

// A contender which returns at once and reports the times of the list, over and over.
Contender fake(const std::string& name, std::vector<double> ms, std::string* order = nullptr) {
    auto at = std::make_shared<size_t>(0);
    return {name, [=] {
                if (order) *order += name;
                const double value = ms[(*at)++ % ms.size()];
                return Sample{value, value + 1};
            }};
}

TEST(Statistics, QuartilesByInterpolation) {
    const Summary s = summarize({4, 1, 3, 2});
    EXPECT_EQ(s.n, 4u);
    EXPECT_DOUBLE_EQ(s.median, 2.5);
    EXPECT_DOUBLE_EQ(s.q1, 1.75);
    EXPECT_DOUBLE_EQ(s.q3, 3.25);
    EXPECT_DOUBLE_EQ(s.min, 1);
    EXPECT_DOUBLE_EQ(s.max, 4);
    EXPECT_DOUBLE_EQ(s.spread(), 0.6);
}

TEST(Statistics, PercentilesByInterpolation) {
    std::vector<double> values;
    for (int i = 100; i >= 0; --i) values.push_back(i);
    const Summary s = summarize(values);
    EXPECT_DOUBLE_EQ(s.median, 50);
    EXPECT_DOUBLE_EQ(s.p95, 95);
    EXPECT_DOUBLE_EQ(s.p99, 99);
    EXPECT_DOUBLE_EQ(summarize({1, 2}).p95, 1.95);
}

TEST(Statistics, MedianIgnoresOutliers) {
    const Summary s = summarize({10, 11, 12, 13, 1000});
    EXPECT_DOUBLE_EQ(s.median, 12);
    EXPECT_DOUBLE_EQ(s.q1, 11);
    EXPECT_DOUBLE_EQ(s.q3, 13);
}

TEST(Statistics, NoSampleAndOneSample) {
    EXPECT_EQ(summarize({}).n, 0u);
    EXPECT_DOUBLE_EQ(summarize({}).spread(), 0);
    const Summary one = summarize({7});
    EXPECT_DOUBLE_EQ(one.median, 7);
    EXPECT_DOUBLE_EQ(one.spread(), 0);
}

TEST(Measure, InterleavesTheContenders) {
    std::string order;
    MeasureRules rules;
    rules.min_rounds = rules.max_rounds = 5;
    Progress progress;
    measure_interleaved({fake("A", {1}, &order), fake("B", {2}, &order), fake("C", {3}, &order)}, rules, progress);
    EXPECT_EQ(order,
              "AABBCC"
              "ABCABCABCABCABC");  // warm-up, then rounds
}

TEST(Measure, SteadyContendersEndEarly) {
    MeasureRules rules;
    Progress progress;
    const auto measured = measure_interleaved({fake("A", {4}), fake("B", {8})}, rules, progress);
    ASSERT_EQ(measured.size(), 2u);
    EXPECT_EQ(measured[0].status, RowStatus::ok);
    EXPECT_EQ(measured[0].time_ms.n, rules.min_rounds);
    EXPECT_DOUBLE_EQ(measured[0].time_ms.median, 4);
    EXPECT_DOUBLE_EQ(measured[0].wall_ms.median, 5);
    EXPECT_DOUBLE_EQ(measured[1].time_ms.median, 8);
}

// Of a busy machine a thread gets less than a processor, so the two contenders are compared with each other.
TEST(Measure, BusyProcessorsAreCounted) {
    const auto works = [](double ms) {
        const auto used_ms = [] {
            timespec used{};
            clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
            return 1e3 * double(used.tv_sec) + 1e-6 * double(used.tv_nsec);
        };
        for (const double begin = used_ms(); used_ms() - begin < ms;) {
        }
    };
    const Contender sleeps{"sleeps", [] {
                               std::this_thread::sleep_for(std::chrono::milliseconds(20));
                               return Sample{20, 20};
                           }};
    const Contender busy{"busy", [=] {
                             std::thread other([&] { works(10); });
                             works(10);
                             other.join();
                             return Sample{10, 10};
                         }};
    Progress progress;
    const auto results = measure_interleaved({sleeps, busy}, MeasureRules{}, progress);
    EXPECT_GE(results[0].processors, 0);
    EXPECT_LT(results[0].processors, 0.2);
    EXPECT_GT(results[1].processors, 4 * results[0].processors);
    EXPECT_GT(results[1].processors, 0);
}

// By processors, clocks do not count: neither for the figure nor for refusing a row. What does not know its processors keeps
// its clock.
TEST(Measure, TimesAreOfProcessorsIfAskedFor) {
    const auto at = std::make_shared<int>(0);
    const Contender disturbed{"disturbed", [=] {
                                  const double clock_ms = 10.0 * (1 + ++*at % 5);
                                  return Sample{clock_ms, clock_ms, 3};
                              }};
    Progress progress;
    MeasureRules rules;
    for (const bool by_processor : {true, false}) {
        rules.by_processor = by_processor;
        const auto measured = measure_interleaved({disturbed, fake("by its clock", {7})}, rules, progress);
        EXPECT_EQ(measured[0].status, by_processor ? RowStatus::ok : RowStatus::refused);
        EXPECT_EQ(measured[0].by_processor, by_processor);
        EXPECT_EQ(measured[0].time_ms.median == 3, by_processor);
        EXPECT_EQ(measured[0].wall_ms.n == 0, by_processor);
        EXPECT_FALSE(measured[1].by_processor);
        EXPECT_DOUBLE_EQ(measured[1].time_ms.median, 7);
        EXPECT_DOUBLE_EQ(measured[1].wall_ms.median, 8);
    }
}

TEST(Measure, OnlyTheUnsteadyContenderIsRefused) {
    MeasureRules rules;
    rules.max_rounds = 20;
    Progress progress;
    const auto measured = measure_interleaved({fake("steady", {100}), fake("wild", {1, 2, 3, 4})}, rules, progress);
    EXPECT_EQ(measured[0].status, RowStatus::ok);
    EXPECT_EQ(measured[1].status, RowStatus::refused);
    EXPECT_NE(measured[1].why.find("--max-spread"), std::string::npos) << measured[1].why;
    EXPECT_NE(measured[1].why.find("3 attempts"), std::string::npos) << measured[1].why;
    EXPECT_GT(measured[1].spread(), rules.max_spread);
}

TEST(Measure, ADisturbedAttemptIsRepeated) {
    MeasureRules rules;
    rules.max_rounds = 20;
    int taken = 0;
    const Contender disturbed{"A", [&] {
                                  const double ms = ++taken <= 22 ? 1 + taken % 5 : 10;
                                  return Sample{ms, ms};
                              }};
    Progress progress;
    const auto measured = measure_interleaved({disturbed}, rules, progress);
    EXPECT_EQ(measured[0].status, RowStatus::ok);
    EXPECT_DOUBLE_EQ(measured[0].time_ms.median, 10);
    EXPECT_DOUBLE_EQ(measured[0].time_ms.min, 10);
}

TEST(Measure, AFailureAffectsOnlyItsOwnContender) {
    const Contender broken{"broken", []() -> Sample { throw Error(Exit::failed, "no memory on the device"); }};
    Progress progress;
    const auto measured = measure_interleaved({broken, fake("A", {1})}, MeasureRules{}, progress);
    EXPECT_EQ(measured[0].status, RowStatus::failed);
    EXPECT_EQ(measured[0].why, "no memory on the device");
    EXPECT_EQ(measured[1].status, RowStatus::ok);
}

TEST(Measure, AContenderBeyondTheBudgetIsSkipped) {
    const Contender slow{"slow", [] {
                             std::this_thread::sleep_for(std::chrono::milliseconds(60));
                             return Sample{60, 60};
                         }};
    MeasureRules rules;
    rules.budget_s = 0.05;
    Progress progress;
    const auto measured = measure_interleaved({slow, fake("quick", {1})}, rules, progress);
    EXPECT_EQ(measured[0].status, RowStatus::skipped);
    EXPECT_NE(measured[0].why.find("--time-limit"), std::string::npos) << measured[0].why;
    EXPECT_EQ(measured[1].status, RowStatus::ok);
}

TEST(Measure, CancelThrows) {
    Progress progress;
    int taken = 0;
    const Contender contender{"A", [&] {
                                  if (++taken == 4) progress.cancel();
                                  return Sample{1, 1};
                              }};
    EXPECT_THROW(measure_interleaved({contender}, MeasureRules{}, progress), Cancelled);
    EXPECT_EQ(taken, 4);
}

TEST(Measure, RunningOutOfMemoryAffectsOnlyItsOwnContender) {
    const Contender greedy{"greedy", []() -> Sample { throw std::bad_alloc(); }};
    Progress progress;
    const auto measured = measure_interleaved({greedy, fake("A", {1})}, MeasureRules{}, progress);
    EXPECT_EQ(measured[0].status, RowStatus::failed);
    EXPECT_NE(measured[0].why.find("not enough memory"), std::string::npos) << measured[0].why;
    EXPECT_EQ(measured[1].status, RowStatus::ok);
}

// A contender which tunes itself, as ray queries on a GPU do. ms: time of each variant at full clock. slowdown: factor on the
// time of the n-th run, while the clock rises.
Contender tuned(std::vector<double> ms, std::function<double(unsigned)> slowdown = [](unsigned) { return 1.0; }) {
    const auto tuner = std::make_shared<Autotuner>(static_cast<unsigned>(ms.size()));
    const auto runs = std::make_shared<unsigned>(0);
    return {"tuned", [=] {
                Sample sample;
                sample.variant = tuner->variant();
                sample.trial = tuner->trying();
                sample.time_ms = sample.wall_ms = ms[sample.variant] * slowdown((*runs)++);
                tuner->took(sample.time_ms);
                sample.settled = tuner->settled();
                return sample;
            }};
}

TEST(Measure, TrialsOfVariantsAreNotSamples) {
    MeasureRules rules;
    rules.few_rounds = rules.min_rounds = rules.max_rounds = 3;
    Progress progress;
    const auto measured = measure_interleaved({tuned({2.5, 1.8, 1, 1.4, 2}), fake("other", {3})}, rules, progress);
    EXPECT_EQ(measured[0].time_ms.n, 3u);
    EXPECT_DOUBLE_EQ(measured[0].time_ms.min, 1);
    EXPECT_DOUBLE_EQ(measured[0].time_ms.max, 1);
    EXPECT_DOUBLE_EQ(measured[1].time_ms.median, 3);
}

TEST(Measure, AVariantChosenWhileTheClockRoseIsReviewed) {
    MeasureRules rules;
    rules.few_rounds = rules.min_rounds = rules.max_rounds = 3;
    Progress progress;
    // The clock rises so fast that the variant which is tried last looks fastest, though it is the slowest.
    const auto rising = [](unsigned run) { return run < 12 ? 10.0 - 0.75 * run : 1.0; };
    const auto measured = measure_interleaved({tuned({1, 1.1, 1.2}, rising)}, rules, progress);
    EXPECT_EQ(measured[0].time_ms.n, 3u);
    EXPECT_DOUBLE_EQ(measured[0].time_ms.max, 1);
}

TEST(Measure, SamplesOfAnAbandonedVariantAreDropped) {
    MeasureRules rules;
    rules.few_rounds = 3;
    rules.min_rounds = rules.max_rounds = 9;
    Progress progress;
    // The clock rises during the samples.
    const auto late = [](unsigned run) { return run < 9 ? 5.0 : 1.0; };
    const Contender base = tuned({1, 1.5}, late);
    unsigned runs = 0;
    const Contender contender{"A", [&] {
                                  Sample sample = base.once();
                                  sample.variant = ++runs > 12 ? 7 : 3;  // the variant which the second tuning chooses
                                  return sample;
                              }};
    const auto measured = measure_interleaved({contender}, rules, progress);
    EXPECT_DOUBLE_EQ(measured[0].time_ms.max, 1);
    EXPECT_EQ(measured[0].time_ms.n, 4u);
}

}  // namespace
