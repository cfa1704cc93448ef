// xml_check.hpp -- whether text is well-formed XML, as far as our pages go: one root, tags that match, quoted attributes given
// once, the five entities, no byte that XML forbids.
#pragma once
#include <string>

namespace clarity::test {

// "" if it is, else what is wrong and where.
std::string xml_error(const std::string& text);

}  // namespace clarity::test
