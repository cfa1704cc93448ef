#include "uri.hpp"

#include <algorithm>
#include <filesystem>

#include "../common/base64.hpp"

namespace gltf_import {
namespace {

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    c = static_cast<char>(c | 0x20);
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

// Whether `text` has the word, in small letters, at this place, in any case.
bool has_word(std::string_view text, size_t at, std::string_view word) {
    const auto same = [](char a, char b) { return a == (b >= 'A' && b <= 'Z' ? b + 32 : b); };
    return at <= text.size() && word.size() <= text.size() - at &&
           std::equal(word.begin(), word.end(), text.begin() + at, same);
}

// The path without "." and "..", with slashes; empty if it leaves the folder.
std::string within_folder(std::string path) {
    std::replace(path.begin(), path.end(), '\\', '/');
    if (path.find('\0') != path.npos) return {};
    const size_t colon = path.find(':');
    const bool has_scheme = colon != path.npos && path.find('/') == colon + 1;
    path = std::filesystem::path(path).lexically_normal().string();
    const bool leaves = path == ".." || path.compare(0, 3, "../") == 0;
    return has_scheme || leaves || path == "." || (!path.empty() && path[0] == '/') ? std::string() : path;
}

}  // namespace

std::string percent_decoded(std::string_view text) {
    std::string out;
    for (size_t i = 0; i < text.size(); ++i) {
        const bool is_code =
            text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0;
        out += is_code ? static_cast<char>(16 * hex_digit(text[i + 1]) + hex_digit(text[i + 2])) : text[i];
        if (is_code) i += 2;
    }
    return out;
}

bool decode_data_uri(const Value& uri, std::string& out) {
    if (!uri.json().is_string()) uri.refuse("a text");
    const std::string_view text = uri.json().get_ref<const std::string&>();
    if (!has_word(text, 0, "data:")) return false;
    const size_t comma = text.find(',');
    if (comma == text.npos) uri.refuse("a comma between the kind of the data and the data");
    out.clear();
    constexpr std::string_view kBase64 = ";base64";
    std::string_view data = text.substr(comma + 1);
    if (comma < kBase64.size() || !has_word(text.substr(0, comma), comma - kBase64.size(), kBase64)) {
        out = percent_decoded(data);
        return true;
    }
    std::string cleaned;
    if (data.find_first_of("% \t\r\n") != data.npos) {  // '+', '/' and '=' may be encoded, and lines broken
        cleaned = percent_decoded(data);
        const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; };
        cleaned.erase(std::remove_if(cleaned.begin(), cleaned.end(), is_space), cleaned.end());
        data = cleaned;
    }
    if (const size_t bad = importers::decode_base64(data, out); bad != data.npos)
        uri.refuse(in_quotes(data.substr(bad, 1)) + " at character " + std::to_string(comma + 1 + bad), "base64");
    return true;
}

std::string file_of_uri(const Value& uri, const std::string& folder) {
    const std::string text = uri.text();
    const std::string decoded = within_folder(percent_decoded(text));
    if (decoded.empty()) uri.refuse("the name of a file in the scene's folder, or data");
    const std::string before_query = text.substr(0, text.find_first_of("?#"));
    for (const std::string& name : {decoded, within_folder(text), within_folder(percent_decoded(before_query))}) {
        std::error_code error;
        if (!name.empty() && std::filesystem::is_regular_file(folder + name, error)) return name;
    }
    return decoded;
}

}  // namespace gltf_import
