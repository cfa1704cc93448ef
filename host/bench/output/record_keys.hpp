// record_keys.hpp -- one record as JSON, which CSV is also made from.
#pragma once
#include "bench/output/fields.hpp"
#include "bench/output/output.hpp"

namespace clarity::bench {

// Every key is present; its value is null if there is nothing to say.
Json record_json(const BenchReport& report, const BenchRecord& record);

}  // namespace clarity::bench
