// From the words of the command line to checked values.
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "render/accel_choice.hpp"

namespace clarity {
Settings make_settings(const PluginRegistry& plugins, const TraceOptions& options) {
    Settings settings;
    for (const std::string& pair : options.sets) {
        const size_t equals = pair.find('=');
        if (equals == std::string::npos || equals == 0)
            throw Error(Exit::usage, "--set " + pair + ": expected key=value, as in --set shadows=false");
        set_setting(settings, pair.substr(0, equals), pair.substr(equals + 1));
    }
    for (const auto& [key, value] : options.settings) set_setting(settings, key, value);
    choose_accel(plugins, options.accel, settings);
    return settings;
}

void check_scene_files(const std::vector<std::string>& files) {
    for (const std::string& file : files) {
        struct stat status {};
        if (stat(file.c_str(), &status) != 0) {
            const std::string hint = file.find_first_of("./") == std::string::npos
                                         ? "; nor is it a command: `clarity --help` lists them"
                                         : "; check the name and the folder";
            throw Error(Exit::import_failed, file + ": " + std::strerror(errno) + hint);
        }
        if (S_ISDIR(status.st_mode)) throw Error(Exit::import_failed, file + ": is a folder; name a file in it");
        if (!S_ISREG(status.st_mode))
            throw Error(Exit::import_failed, file + ": is no regular file; copy its content into one");
        if (access(file.c_str(), R_OK) != 0)
            throw Error(Exit::import_failed, file + ": cannot be read: " + std::strerror(errno));
    }
}

}  // namespace clarity
