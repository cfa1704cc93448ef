// tools.hpp -- the programs that build submissions, and the folders that these need to read: CMake may be in a Python
// environment, and a compiler in /opt.
#pragma once
#include <string>
#include <vector>

namespace clarity::lab {

struct BuildTools {
    std::string cmake, c, cxx, make;               // programs, by their whole paths
    std::string generator;                         // of CMake, for `make`
    std::string bubblewrap;                        // "": it is not there
    std::string sdk;                               // the folder that Clarity is installed in
    std::string path;                              // PATH: those of its folders that may be read
    std::vector<std::string> folders;              // that they may read: those of the system, of the tools, and of the SDK
    std::vector<std::string> own_folders() const;  // those that are not the system's
};

// The tools that PATH has. sdk: the folder that Clarity is installed in. more: folders that they may read besides, by the
// teacher's word. closed: folders of which nothing is opened, such as a lab and its submissions. Of a home folder only what
// belongs to a tool is. work: a folder for a file. Throws Error(failed) if a tool is missing.
BuildTools find_build_tools(const std::string& sdk, const std::vector<std::string>& more,
                            const std::vector<std::string>& closed, const std::string& work);

}  // namespace clarity::lab
