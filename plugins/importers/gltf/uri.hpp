// uri.hpp -- what a member 'uri' names: data in itself, or a file in the scene's folder.
#pragma once
#include <string>
#include <string_view>

#include "value.hpp"

namespace gltf_import {

// Decodes "data:...;base64,..." into `out`. Returns false if the text is no data URI. Throws Error if it is broken.
bool decode_data_uri(const Value& uri, std::string& out);
std::string percent_decoded(std::string_view text);  // replaces %20 and the like
// The path of the file within `folder`, which ends with a slash or is empty. Exporters differ in what they encode, so it is the
// first name of a file that there is: decoded, as it stands, and without a query. If there is none, the decoded one. Throws
// Error if the file would not lie in the folder.
std::string file_of_uri(const Value& uri, const std::string& folder);

}  // namespace gltf_import
