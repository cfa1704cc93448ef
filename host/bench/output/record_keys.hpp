// record_keys.hpp -- one record with the keys that JSON and CSV share.
#pragma once
#include "bench/output/fields.hpp"
#include "bench/output/output.hpp"

namespace clarity::bench {

// Every key is there, null where there is nothing to say.
Json record_json(const BenchReport& report, const BenchRecord& record);

}  // namespace clarity::bench
