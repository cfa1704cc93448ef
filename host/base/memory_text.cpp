#include "base/memory_text.hpp"

#include <cstdio>

namespace clarity {

std::string memory_text(uint64_t bytes) {
    char text[32];
    const double mebibytes = double(bytes) / (1u << 20);
    if (mebibytes < 1000)
        std::snprintf(text, sizeof text, "%.*f MiB", mebibytes < 10 ? 1 : 0, mebibytes);
    else
        std::snprintf(text, sizeof text, "%.1f GiB", mebibytes / 1024);
    return text;
}

std::string memory_limit_text(uint64_t bytes) {
    const uint64_t mebibytes = bytes >> 20;
    if (mebibytes == 0) return std::to_string(bytes) + " bytes";
    return mebibytes < 10240 ? std::to_string(mebibytes) + " MiB" : std::to_string(mebibytes >> 10) + " GiB";
}

}  // namespace clarity
