// machine.hpp -- what the host's processor is and how busy it is, so that figures can be judged later.
#pragma once
#include <cstdint>
#include <string>

namespace clarity::bench {

std::string host_cpu_name();
// Mean over the cores that say it, MHz; 0 if none does.
double host_clock_mhz();
// Of the first core; empty where the machine has none (a virtual one).
std::string clock_governor();
// Of the last minute.
double load_average();
// Memory that programs may still take, without swapping; 0: unknown.
uint64_t free_memory_bytes();
// Now, ISO 8601, UTC.
std::string utc_date();

}  // namespace clarity::bench
