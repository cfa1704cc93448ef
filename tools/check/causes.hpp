// causes.hpp -- one fault makes many checks fail: groups failures by the first stage that fails.
#pragma once
#include <string>
#include <vector>

#include "tools/check/check.hpp"

namespace clarity::check {

// Failures that likely have one cause: the first of them shows it best, the others follow from it.
struct Cause {
    std::string stage;            // of the first one: "bounds", "nearest hits of one lane"
    std::vector<size_t> results;  // indices of failed results, in the order of stages
};

// The stage of a check's failure; "" for a check that depends on no other.
std::string stage_of(const CheckResult& result);

// The causes of the failures among the results of one plugin, in the order of stages.
std::vector<Cause> causes_of(const std::vector<CheckResult>& results);

}  // namespace clarity::check
