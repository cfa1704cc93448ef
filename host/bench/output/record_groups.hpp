// record_groups.hpp -- records grouped by a key, for tables and charts.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "bench/output/record.hpp"

namespace clarity::bench {

// Groups are in the order of their keys' first records. The records must outlive the groups.
class RecordGroups {
 public:
    void add(const std::string& key, const BenchRecord& record);
    const std::vector<std::vector<const BenchRecord*>>& all() const { return groups_; }

 private:
    std::map<std::string, size_t> index_;
    std::vector<std::vector<const BenchRecord*>> groups_;
};

}  // namespace clarity::bench
