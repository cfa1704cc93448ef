// document.hpp -- the container: a .gltf file is JSON; a .glb file has chunks, of which the first is JSON and the second may be
// binary data (glTF 2.0 specification, section 4).
#pragma once
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "../common/mapped_file.hpp"
#include "value.hpp"

namespace gltf_import {

class Document {
 public:
    // Opens the file, parses it, and checks its version and the extensions that it requires.
    Document(const rt_host* host, const std::string& path);
    // Parses bytes in memory. The bytes must outlive the document. folder: of the files beside it, ends with a slash or is
    // empty.
    Document(std::string_view bytes, std::string folder);

    Value root() const { return {json_, ""}; }
    Value list(const char* name) const { return root().list(name); }
    const std::string& folder() const { return folder_; }
    // The binary chunk; without one, has_binary() is false.
    bool has_binary() const { return has_binary_; }
    std::string_view binary() const { return binary_; }

 private:
    void parse(std::string_view bytes);
    void parse_chunks(std::string_view bytes);
    void parse_json(std::string_view text, size_t first_byte);
    void check_version() const;

    std::unique_ptr<importers::MappedFile> file_;
    std::string folder_;
    nlohmann::json json_;
    bool has_binary_ = false;
    std::string_view binary_;
};

}  // namespace gltf_import
