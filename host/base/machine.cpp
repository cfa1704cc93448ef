#include "base/machine.hpp"

#include <unistd.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace clarity {
namespace {

std::string read_host_name() {
    char text[256] = "";
    if (gethostname(text, sizeof text - 1) != 0) text[0] = 0;
    std::string plain;
    for (const char* at = text; *at && plain.size() < 64; ++at)
        if ((*at >= '0' && *at <= '9') || (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z') || *at == '.' || *at == '-')
            plain += *at;
    return plain.empty() ? "host" : plain;
}

}  // namespace

void give_free_memory_back() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

const std::string& host_name() {
    static const std::string& name = *new std::string(read_host_name());
    return name;
}

}  // namespace clarity
