// baseline_entries.hpp -- entries of the baselines: other ray tracers on the same scene.
#pragma once
#include "bench/cases/case_state.hpp"

namespace clarity::bench {

// Appends an entry for each kind of baseline that the case wants, and for each of its modes. Call it after our entries are
// added: baselines trace the rays and render the frame which these have prepared. If a baseline cannot be measured, its row
// says why. The entries use `state`, which must outlive them. Throws Cancelled.
void add_baselines(CaseState& state);

}  // namespace clarity::bench
