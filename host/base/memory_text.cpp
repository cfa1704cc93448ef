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

}  // namespace clarity
