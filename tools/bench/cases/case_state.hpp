// case_state.hpp -- what the rows of one case share while they are measured.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/pictures/image_io.hpp"
#include "stand/ray_sets.hpp"
#include "tools/bench/baselines/whitted.hpp"
#include "tools/bench/cases/entry.hpp"
#include "tools/bench/output/record.hpp"
#include "tools/bench/output/row.hpp"
#include "tools/bench/run/fixture.hpp"
#include "tracers/rays/ray_queries.hpp"

namespace clarity::bench {

// Checks that all rows of a case compute the same. A row with other results does not trace the same scene,
// so that comparing times would mean nothing: it is refused.

class Agreement {
 public:
    // Compares hit distances (one per ray, +inf for a miss) with those of the first row that is checked, and counts the row's
    // hits.
    void check_hits(BenchRecord& row, const RaySet& set, const std::vector<float>& distances);
    // Compares a picture with that of the first row that is checked.
    void check_picture(BenchRecord& row, FloatImage picture);
    // Compares the digest of an overlapped sequence of pictures with that of the non-overlapped sequence of the same structure
    // and device, which is to be checked first.
    void check_sequence(BenchRecord& row, uint64_t digest, bool overlapped);

 private:
    std::vector<float> reference_hits_;
    FloatImage reference_picture_;
    std::map<std::string, uint64_t> one_by_one_;  // digests of the non-overlapped sequences, by structure_and_device()
};

// Key of a row's structure and device: rows of a case with equal keys differ only in how pictures are copied to the host.
std::string structure_and_device(const BenchRecord& row);

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
