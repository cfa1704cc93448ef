#include "readers.hpp"

namespace openmesh_import {

void warn(const Source& source, const std::string& text) {
    source.sink.warn(source.sink.ctx, text.c_str());
}

std::string too_large(const char* what, unsigned long long count, unsigned long long least_bytes,
                      unsigned long long available) {
    if (count <= available / least_bytes && count < 0x7FFFFFFFull) return {};
    return "declares " + std::to_string(count) + " elements '" + what + "' of at least " + std::to_string(least_bytes) +
           " bytes and has " + std::to_string(available) + " bytes for them: it is cut off or damaged";
}

}  // namespace openmesh_import
