// leaf_tally.hpp -- tracks which primitives the leaves of a tree hold: each primitive of a group once, and none of another
// group.
#pragma once
#include <string>
#include <unordered_map>
#include <vector>

#include "bounds.hpp"
#include "harness.hpp"

namespace accel_test {

class LeafTally {
 public:
    LeafTally(const Input& input, const Built& built) : input_(input), built_(built), seen_(built.leaves.size()) {
        for (uint32_t i = 0; i < input.prims.size(); ++i) prim_of_ref_[input.prims[i].ref] = i;
    }

    // Records a leaf of a group and returns the bounds of its primitives, which begin at `first` in leaf order. `why` receives
    // the fault, if there is one.
    Bounds visit(rt_u32 first, uint32_t count, uint32_t group_index, std::string& why) {
        Bounds below;
        for (uint32_t i = first; i < first + count; ++i) {
            if (i >= seen_.size() || seen_[i]) {
                why = "position " + std::to_string(i) + (i < seen_.size() ? " is in two leaves" : " is out of range");
                return below;
            }
            seen_[i] = true;
            const auto found = prim_of_ref_.find(built_.leaves[i]);
            const rt_group& group = input_.groups[group_index];
            if (found == prim_of_ref_.end() || found->second < group.first || found->second >= group.first + group.count) {
                why = "position " + std::to_string(i) + " holds a ref of another group, or none";
                return below;
            }
            const rt_prim& prim = input_.prims[found->second];
            prim_of_ref_.erase(found);  // a second one is a fault
            below.add(prim.lo, prim.hi);
        }
        return below;
    }

    // Returns a message if a position is in no leaf, else an empty string.
    std::string missing() const {
        for (size_t i = 0; i < seen_.size(); ++i)
            if (!seen_[i]) return "position " + std::to_string(i) + " is in no leaf";
        return {};
    }

 private:
    const Input& input_;
    const Built& built_;
    std::vector<bool> seen_;
    std::unordered_map<rt_u32, uint32_t> prim_of_ref_;
};

}  // namespace accel_test
