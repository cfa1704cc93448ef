#include "device/kernel_files.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/error.hpp"

namespace clarity {
namespace {

struct Embedded {
    const char *name, *text;
};
const Embedded kEmbedded[] = {
#include "kernels.inc"
};

bool read_file(const std::filesystem::path& path, std::string& text) {
    std::ifstream in(path, std::ios::binary);
    if (!in) return false;
    std::ostringstream all;
    all << in.rdbuf();
    text = all.str();
    return true;
}

const char* override_folder() {
    const char* folder = std::getenv("CLARITY_KERNEL_PATH");
    return folder && *folder ? folder : nullptr;
}

}  // namespace

std::string kernel_text(const std::string& name) {
    std::string text;
    if (const char* folder = override_folder(); folder && read_file(std::filesystem::path(folder) / name, text)) return text;
    for (const Embedded& file : kEmbedded)
        if (name == file.name) return file.text;
    throw Error(Exit::kernel_build_failed, "no kernel source `" + name + "` in this program or in CLARITY_KERNEL_PATH");
}

std::string plugin_kernel_text(const std::string& id, const char* name, const char* embedded) {
    std::string text;
    const char* folder = override_folder();
    if (folder && name && read_file(std::filesystem::path(folder).parent_path() / "plugins" / "accel" / id / name, text))
        return text;
    return embedded ? embedded : "";
}

}  // namespace clarity
