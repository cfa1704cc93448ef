#include "base/files/cache_folder.hpp"

#include <cstdlib>

namespace clarity {

std::filesystem::path cache_folder() {
    const char* cache = std::getenv("XDG_CACHE_HOME");
    const char* home = std::getenv("HOME");
    if (cache && cache[0] == '/') return std::filesystem::path(cache) / "clarity";
    return home && home[0] == '/' ? std::filesystem::path(home) / ".cache" / "clarity" : std::filesystem::path();
}

}  // namespace clarity
