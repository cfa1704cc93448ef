#include "tools/bench/output/machine.hpp"

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>

namespace clarity::bench {
namespace {

// Calls `use` with the text after the colon for each line of /proc/cpuinfo which begins with `key`.
template <class Use>
void each_cpu_line(const std::string& key, Use&& use) {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const size_t colon = line.find(':');
        if (line.compare(0, key.size(), key) != 0 || colon == std::string::npos) continue;
        const size_t first = line.find_first_not_of(" \t", colon + 1);
        if (first != std::string::npos) use(line.substr(first));
    }
}

std::string first_word(const std::string& path) {
    std::ifstream file(path);
    std::string word;
    file >> word;
    return word;
}

}  // namespace

std::string host_cpu_name() {
    std::string name;
    each_cpu_line("model name", [&](const std::string& text) {
        if (name.empty()) name = text;
    });
    return name.empty() ? "unknown processor" : name;
}

double host_clock_mhz() {
    double sum = 0;
    int count = 0;
    // The figure of the frequency driver; if there is none, the kernel's estimate.
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator("/sys/devices/system/cpu", none)) {
        const std::string khz = first_word(entry.path().string() + "/cpufreq/scaling_cur_freq");
        if (const double value = std::atof(khz.c_str()); value > 0) {
            sum += value / 1000;
            ++count;
        }
    }
    if (count == 0)
        each_cpu_line("cpu MHz", [&](const std::string& text) {
            sum += std::atof(text.c_str());
            ++count;
        });
    return count > 0 ? sum / count : 0;
}

std::string clock_governor() {
    return first_word("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
}

double load_average() {
    double minute = 0;
    return getloadavg(&minute, 1) == 1 ? minute : 0;
}

uint64_t free_memory_bytes() {
    std::ifstream file("/proc/meminfo");
    for (std::string line; std::getline(file, line);)
        if (line.compare(0, 13, "MemAvailable:") == 0) return std::strtoull(line.c_str() + 13, nullptr, 10) * 1024;
    return 0;
}

std::string utc_date() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

}  // namespace clarity::bench
