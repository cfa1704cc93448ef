// steps.hpp -- what a check says while it runs and when it is done.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/problem.hpp"

namespace clarity::check {

// Which rays were traced: their answers show how far a traversal is right.
enum class Asked : uint8_t { nothing, nearest_one_lane, any_one_lane, nearest_lanes, any_lanes };
constexpr Asked asked_of(bool any_hit, int lanes) {
    return lanes == 1 ? any_hit ? Asked::any_one_lane : Asked::nearest_one_lane
           : any_hit  ? Asked::any_lanes
                      : Asked::nearest_lanes;
}

// What a check found. passed: `found` tells what was seen; else what is wrong, and why it matters.
struct Outcome {
    enum class Kind { passed, failed, skipped } kind = Kind::passed;
    std::string found;
    std::string repeat;            // how to repeat it alone, besides --only; may be empty
    Asked asked = Asked::nothing;  // failed: which answers were wrong, or which rays the worker died of

    static Outcome passed(std::string found) { return {Kind::passed, std::move(found), {}}; }
    static Outcome failed(std::string found, std::string repeat = {}) {
        return {Kind::failed, std::move(found), std::move(repeat)};
    }
    static Outcome failed(const std::string& what, const Problem& why) { return failed(what + ": " + why.text()); }
    static Outcome skipped(std::string why) { return {Kind::skipped, std::move(why), {}}; }
};

// Told about each step before it begins, so that the parent process can name it if the worker dies in it. limit_s: seconds
// after which the step counts as endless.
class Step {
 public:
    using Say = std::function<void(const std::string& what, double limit_s, Asked asked)>;
    Step(Say say) : say_(std::move(say)) {}
    void operator()(const std::string& what, double limit_s, Asked asked = Asked::nothing) const { say_(what, limit_s, asked); }

 private:
    Say say_;
};

struct Check {
    std::string name;   // "builds.threads": of letters, digits, dots and _
    std::string tried;  // "the same result whatever the number of threads"
    std::function<Outcome(const Step&)> run;
};

// A check whose function takes what the checks of a phase share.
template <class Stand>
Check check_of(const std::shared_ptr<Stand>& stand, const char* name, const char* tried, Outcome (*run)(Stand&, const Step&)) {
    return {name, tried, [=](const Step& step) { return run(*stand, step); }};
}

}  // namespace clarity::check
