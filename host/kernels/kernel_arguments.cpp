#include "kernels/kernel_arguments.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace clarity {
namespace {

constexpr const char* kSpace = " \t\r\n";

bool is_word(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

std::string without_comments(const std::string& text) {
    std::string code;
    for (size_t at = 0; at < text.size();) {
        const size_t line = text.find("//", at), block = text.find("/*", at), begin = std::min(line, block);
        code.append(text, at, begin == std::string::npos ? begin : begin - at);
        if (begin == std::string::npos) break;
        const size_t end = text.find(begin == line ? "\n" : "*/", begin + 2);
        if (end == std::string::npos) break;
        code += ' ';
        at = begin == line ? end : end + 2;
    }
    return code;
}

// What stands between the parentheses where `entry` is declared with a body.
std::string parameters_of(const std::string& code, const std::string& entry) {
    for (size_t at = 0; (at = code.find(entry, at)) != std::string::npos; at += entry.size()) {
        const size_t open = code.find_first_not_of(kSpace, at + entry.size());
        if (open == std::string::npos || code[open] != '(' || (at > 0 && is_word(code[at - 1]))) continue;
        const size_t close = code.find(')', open);
        if (close == std::string::npos) break;
        if (const size_t body = code.find_first_not_of(kSpace, close + 1); body != std::string::npos && code[body] == '{')
            return code.substr(open + 1, close - open - 1);
    }
    return {};
}

void replace(std::string& text, const std::string& macro, const std::string& by) {
    if (const size_t at = text.find(macro); at != std::string::npos) text.replace(at, macro.size(), by);
}

}  // namespace

std::vector<std::string> argument_names(const std::string& text, const std::string& entry, const ArgumentMacros& macros) {
    std::string list = parameters_of(without_comments(text), entry);
    for (const auto& [macro, by] : macros) replace(list, macro, by);
    std::vector<std::string> names;
    for (size_t at = 0; at < list.size();) {
        const size_t comma = std::min(list.find(',', at), list.size());
        size_t end = comma;
        while (end > at && !is_word(list[end - 1])) --end;
        size_t begin = end;
        while (begin > at && is_word(list[begin - 1])) --begin;
        names.push_back(list.substr(begin, end - begin));
        at = comma + 1;
    }
    return names;
}

bool KernelArguments::has(std::string_view name) const {
    return std::find(names_.begin(), names_.end(), name) != names_.end();
}

cl_uint KernelArguments::number_of(std::string_view name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end())
        throw Error(Exit::kernel_build_failed, where_ + " has no argument `" + std::string(name) +
                                                   "`, which the program sets: declare it again, under that name");
    return static_cast<cl_uint>(found - names_.begin());
}

}  // namespace clarity
