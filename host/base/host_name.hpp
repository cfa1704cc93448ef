// host_name.hpp -- what this machine calls itself.
#pragma once
#include <string>

namespace clarity {

// Digits, letters, dots and hyphens of the machine's name, at most 64 characters; "host" if it has none. For files in folders
// that several machines share.
const std::string& host_name();

}  // namespace clarity
