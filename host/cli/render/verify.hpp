// verify.hpp -- clarity render --verify: renders frames again from their records, and compares.
#pragma once
#include "cli/commands.hpp"

namespace clarity {

// options.scene.files: records. Writes a line for each to stdout. Returns 0 if all pictures are what their records say and
// rendering them gives the same again, else 1.
int run_verify(const PluginRegistry& plugins, const RenderOptions& options);

}  // namespace clarity
