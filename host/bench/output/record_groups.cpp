#include "bench/output/record_groups.hpp"

namespace clarity::bench {

void RecordGroups::add(const std::string& key, const BenchRecord& record) {
    const auto [place, fresh] = index_.try_emplace(key, groups_.size());
    if (fresh) groups_.emplace_back();
    groups_[place->second].push_back(&record);
}

}  // namespace clarity::bench
