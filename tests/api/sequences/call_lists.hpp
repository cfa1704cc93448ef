// call_lists.hpp -- the calls that are drawn, by what they are about.
#pragma once
#include "things.hpp"

namespace sequences {

extern const std::vector<Call> kSceneCalls, kTracerCalls, kRayCalls, kOtherCalls;

}  // namespace sequences
