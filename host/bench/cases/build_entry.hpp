// build_entry.hpp -- an entry which builds one of our structures.
#pragma once
#include "bench/cases/case_state.hpp"

namespace clarity::bench {

// Sets `once` and `finish` of an entry: it builds the structure on the host. Both use `state` and `plugin`, which must outlive
// the entry.
void add_build(CaseState& state, Entry& entry, const rt_plugin& plugin, const Settings& settings);

}  // namespace clarity::bench
