// case_state.hpp -- what the rows of one case share while they are measured.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/cases/agreement.hpp"
#include "bench/cases/entry.hpp"
#include "bench/output/row.hpp"
#include "bench/run/fixture.hpp"
#include "render/tracers/rays/ray_blocks.hpp"

namespace clarity::bench {

// Numbers of a work-item of a kernel, as NVIDIA's compiler tells them.
struct RegisterUse {
    int registers = -1, spilled_bytes = -1;  // -1: not told
};

struct CaseState {
    CaseState(Fixture& fixture, const BenchCase& definition, Progress& progress)
        : fixture(fixture), definition(definition), progress(progress) {}
    CaseState(const CaseState&) = delete;  // the entries' functions refer to it
    CaseState& operator=(const CaseState&) = delete;

    // Appends an entry; its row describes case and scene. The reference is valid until the next call.
    Entry& add_entry() {
        entries.push_back({make_row(definition), {}, {}});
        describe(entries.back().row, *fixture.scene());
        return entries.back();
    }

    Fixture& fixture;
    const BenchCase& definition;
    Progress& progress;
    std::vector<Entry> entries;
    Agreement agreement;
    const RaySet* rays = nullptr;         // of this case; null until one of our rows can trace them
    std::optional<WhittedScene> whitted;  // the frame that baselines render too; empty until one of our rows can render it
    std::optional<FloatImage> light_reference;                    // of suite light; empty until the first row has it
    std::map<std::string, RegisterUse> register_uses;             // of suite light, by the program's text
    std::map<unsigned, std::shared_ptr<const RayBlocks>> packed;  // `rays` packed for each number of lanes
};

}  // namespace clarity::bench
