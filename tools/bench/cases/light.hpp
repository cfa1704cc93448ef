// light.hpp -- a picture by paths of light: paths a second, and how its errors fall with samples and seconds.
#pragma once
#include "tools/bench/cases/case_state.hpp"

namespace clarity::bench {

// Sets `once` and `finish` of an entry. Times are of one picture of settings.spp samples, at most 16. Errors are at 1, 4, 16
// ... settings.spp samples, against the picture of that file, or, if it is "", against one of 16 times as many samples and
// another seed, which the first entry of the case renders. All arguments must outlive the entry. Throws Error(failed), for a
// file of another size Error(usage).
void add_light(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held, const std::string& file);

// Of the kernel `entry`, from a log that NVIDIA's compiler writes with -cl-nv-verbose.
RegisterUse register_use(const std::string& log, const std::string& entry);

}  // namespace clarity::bench
