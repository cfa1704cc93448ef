// own_defect.hpp -- which defect a library of this folder has. The libraries of a kind are copies of one file, KIND.so, which
// is compiled once: each finds its defect in the name of its own file.
#pragma once
#include <dlfcn.h>

#include <string>

namespace {

const char place_in_this_library = 0;

// Of the file `KIND_DEFECT.so`, or `DEFECT.so` of the kind "": DEFECT.
inline const std::string& own_defect(const std::string& kind) {
    static const std::string defect = [&] {
        Dl_info library{};
        dladdr(&place_in_this_library, &library);
        const std::string path = library.dli_fname ? library.dli_fname : "";
        const std::string name = path.substr(path.rfind('/') + 1);
        return name.substr(kind.size(), name.rfind('.') - kind.size());
    }();
    return defect;
}

}  // namespace
