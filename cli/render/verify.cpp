// clarity render --verify: renders frames again from their records, and compares.
#include <cstdio>
#include <filesystem>

#include "base/digest.hpp"
#include "base/error.hpp"
#include "base/files/temporary_folder.hpp"
#include "base/problem.hpp"
#include "base/text.hpp"
#include "cli/commands.hpp"
#include "cli/interrupt.hpp"
#include "cli/render/frame_record.hpp"

namespace clarity {
namespace {

Problem difference(const PluginRegistry& plugins, const RenderOptions& asked, const std::string& path) {
    const FrameRecord record = read_record(path);
    const std::string picture = (std::filesystem::path(path).parent_path() / record.picture).string();
    const std::string found = digest_of_file(picture);
    if (found.empty()) return picture + " is missing or cannot be read";
    if (found != record.file_digest) return picture + " is not the file that was recorded: it was changed or damaged";
    if (record.options.time_budget_s > 0)
        return "--time-budget ended it after " + std::to_string(record.samples) +
               " samples, which depends on the machine: it cannot be rendered again";
    const TemporaryFolder folder("clarity-verify");
    RenderOptions again = record.options;
    again.output = folder.path() + "/again" + std::filesystem::path(record.picture).extension().string();
    again.skip_existing = true;  // so that the picture gets a record, too
    again.quiet = true;
    if (!asked.trace.device.empty()) again.trace.device = asked.trace.device;
    const int code = run_render(plugins, again);
    if (code != 0) return "it was not rendered again (exit code " + std::to_string(code) + ")";
    const FrameRecord anew = read_record(record_path(again.output));
    if (anew.digest != record.digest)
        return "the scene, its files, the kernels or the program have changed since it was rendered";
    if (anew.pixels != record.pixels)
        return "the picture that is rendered now, on " + anew.device + ", is another than the one of " + record.device;
    return {};
}

}  // namespace

int run_verify(const PluginRegistry& plugins, const RenderOptions& options) {
    if (!options.output.empty()) throw Error(Exit::usage, "--verify writes no picture; leave --output out");
    int code = 0;
    for (const std::string& path : options.scene.files) {
        const Problem why = difference(plugins, options, path);
        if (interrupted()) return static_cast<int>(Exit::interrupted);
        print_text("%s: %s\n", path.c_str(), why ? why.text().c_str() : "the same, bit for bit");
        std::fflush(stdout);
        if (why) code = static_cast<int>(Exit::failed);
    }
    return code;
}

}  // namespace clarity
