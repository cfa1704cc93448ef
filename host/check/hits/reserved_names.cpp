#include "check/hits/reserved_names.hpp"

#include <algorithm>
#include <iterator>
#include <regex>
#include <sstream>

#include "device/kernel_files.hpp"
#include "plugin/capabilities.hpp"

namespace clarity::check {
namespace {

// What plugins bind for the templates of cl/ (CONTRACT.md).
constexpr const char* kBindings[] = {"RT_PACKET_STACK_SIZE", "RT_PACKET_RAYS",  "RT_STEP_STACK_SIZE",
                                     "RT_STEP_DONE",         "RT_STEP_IS_LEAF", "RT_TRAVERSES_PACKETS"};

bool is_reserved(const std::string& name, bool is_undef) {
    if (name.rfind("RT_", 0) != 0 && name.rfind("rt_", 0) != 0 && name != "vfloat" && name != "vint" && name != "vmask")
        return false;
    if (std::find(std::begin(kBindings), std::end(kBindings), name) != std::end(kBindings)) return false;
    // <id>_types.h may take back a capability.
    return !(is_undef && std::any_of(capabilities().begin(), capabilities().end(),
                                     [&](const Capability& capability) { return name == capability.define; }));
}

}  // namespace

Problem reserved_name_fault(const rt_plugin& tracer) {
    static const std::regex directive(R"(\s*#\s*(define|undef)\s+(\w+).*)"), mark(R"(\s*#line\s+(\d+)\s+\"([^\"]*)\".*)");
    for (const rt_cl_file* file : {&tracer.accel->types, &tracer.accel->traverse}) {
        if (!file->text) continue;
        std::istringstream text(plugin_kernel_text(tracer, *file));
        std::string shown = plugin_kernel_name(tracer, *file), line;
        std::smatch found;
        for (unsigned number = 1; std::getline(text, line); ++number) {
            if (std::regex_match(line, found, mark)) {  // the next line's place
                number = static_cast<unsigned>(std::stoul(found[1])) - 1;
                shown = found[2];
            } else if (shown.rfind("cl/", 0) != 0 && std::regex_match(line, found, directive) &&
                       is_reserved(found[2], found[1] == "undef")) {
                return shown + ":" + std::to_string(number) + " has `#" + found[1].str() + " " + found[2].str() +
                       "`, which is a name of the host: choose one that begins with " + tracer.id + "_ or its capitals";
            }
        }
    }
    return {};
}

}  // namespace clarity::check
