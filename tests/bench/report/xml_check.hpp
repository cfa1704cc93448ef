// xml_check.hpp -- checks that text is well-formed XML, as far as our pages use it: one root, matching tags, quoted attributes
// without duplicates, the five entities, no byte which XML forbids.
#pragma once
#include <string>

namespace clarity::test {

// "" if it is, else what is wrong and where.
std::string xml_error(const std::string& text);

}  // namespace clarity::test
