#include "device/kernel_includes.hpp"

#include "base/error.hpp"

namespace clarity {
namespace {

constexpr int kMaxDepth = 16;  // levels of files that include files

// Returns NAME of a line `#include "NAME"`, or "" for any other line.
std::string included_name(const std::string& line) {
    static const std::string kBegin = "#include \"";
    if (line.compare(0, kBegin.size(), kBegin) != 0) return {};
    const size_t end = line.find('"', kBegin.size());
    if (end == std::string::npos || line.find_first_not_of(" \t\r", end + 1) != std::string::npos) return {};
    return line.substr(kBegin.size(), end - kBegin.size());
}

bool is_kernel(const std::string& name) {
    return name.compare(0, 3, "cl/") == 0 && name.find("..") == std::string::npos;
}
bool is_part(const std::string& name) {
    return !name.empty() && name[0] != '.' && name.find('/') == std::string::npos;
}

// Calls use(line, number, included name or "") for each line of a text. `line` contains its newline, if it has one.
template <class Use>
void for_each_line(const std::string& text, const Use& use) {
    unsigned number = 1;
    for (size_t at = 0; at < text.size(); ++number) {
        const size_t end = text.find('\n', at), next = end == std::string::npos ? text.size() : end + 1;
        const std::string line = text.substr(at, next - at);
        use(line, number, included_name(end == std::string::npos ? line : line.substr(0, line.size() - 1)));
        at = next;
    }
}

[[noreturn]] void refuse(const std::string& shown, unsigned line, const std::string& why) {
    throw Error(Exit::kernel_build_failed, shown + ":" + std::to_string(line) + ": " + why, {}, {shown, line, 0, why});
}

std::string expand(const std::string& text, const std::string& shown, IncludeKind kind, const ReadInclude& read, int depth) {
    std::string out;
    out.reserve(text.size());
    for_each_line(text, [&](const std::string& line, unsigned number, const std::string& name) {
        if (!name.empty() && !is_kernel(name) && !is_part(name))
            refuse(shown, number,
                   "cannot include \"" + name + "\": name a file of the same folder, or one of cl/ as \"cl/FOLDER/FILE\"");
        const bool replaces = kind == IncludeKind::kernel ? is_kernel(name) : is_part(name);
        if (!replaces) {
            out += line;
            return;
        }
        if (depth == kMaxDepth)
            refuse(shown, number,
                   "cannot include \"" + name + "\": files include each other in a circle, or more than " +
                       std::to_string(kMaxDepth) + " deep");
        const std::string inner = is_kernel(name) ? name : shown.substr(0, shown.rfind('/') + 1) + name;
        out += "#line 1 \"" + inner + "\"\n" + expand(read(name), inner, kind, read, depth + 1);
        if (out.back() != '\n') out += '\n';
        out += "#line " + std::to_string(number + 1) + " \"" + shown + "\"\n";
    });
    return out;
}

}  // namespace

std::string expand_includes(const std::string& text, const std::string& shown, IncludeKind kind, const ReadInclude& read) {
    return expand(text, shown, kind, read, 0);
}

std::vector<std::string> included_parts(const std::string& text) {
    std::vector<std::string> names;
    for_each_line(text, [&](const std::string&, unsigned, const std::string& name) {
        if (is_part(name)) names.push_back(name);
    });
    return names;
}

}  // namespace clarity
