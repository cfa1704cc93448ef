#include "file_kind.hpp"

#include <string_view>

namespace assimp_import {
int certainty(const uint8_t* head, size_t bytes) {
    const std::string_view text(reinterpret_cast<const char*>(head), bytes);
    if (text.substr(0, 1024).find("<COLLADA") != text.npos) return 90;
    return 0;
}

}  // namespace assimp_import
