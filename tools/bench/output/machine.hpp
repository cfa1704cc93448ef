// machine.hpp -- describes the host's processor and its load, so that figures can be judged later.
#pragma once
#include <cstdint>
#include <string>

namespace clarity::bench {

std::string host_cpu_name();
// Mean frequency over the cores that tell theirs, MHz; 0 if there are none.
double host_clock_mhz();
// Frequency governor of the first core; empty if the machine has none (a virtual machine).
std::string clock_governor();
// Load average of the last minute.
double load_average();
// Memory in bytes which programs can still take without swapping; 0: unknown.
uint64_t free_memory_bytes();
// The present time, ISO 8601, UTC.
std::string utc_date();

}  // namespace clarity::bench
