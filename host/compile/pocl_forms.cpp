#include "compile/pocl_forms.hpp"

#include <algorithm>
#include <filesystem>

#include "device/pocl_cache.hpp"

namespace clarity {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> folders_in(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error, gone;  // others may remove folders meanwhile
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
        if (at->is_directory(gone)) found.push_back(at->path());
    return found;
}

bool ends_with(const std::string& text, const std::string& end) {
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

void share_form_of(const fs::path& kernel_folder) {
    std::error_code ignored;
    const fs::path file = kernel_folder.filename().string() + ".so", general = kernel_folder / "0-0-0" / file;
    if (fs::exists(general, ignored)) return;
    for (const fs::path& form : folders_in(kernel_folder)) {
        if (!ends_with(form.filename().string(), "-goffs0-smallgrid") || !fs::exists(form / file, ignored)) continue;
        fs::create_directory(general.parent_path(), ignored);
        fs::create_hard_link(form / file, general, ignored);
        return;
    }
}

}  // namespace

void share_launched_forms(const std::vector<std::string>& kernels) {
    const fs::path cache = pocl_cache();
    if (cache.empty()) return;
    for (const fs::path& group : folders_in(cache))
        for (const fs::path& program : folders_in(group)) {
            const auto has = [&](const std::string& kernel) {
                std::error_code error;
                return fs::is_directory(program / kernel, error);
            };
            // Programs of the same kernels with other settings may be served, too: their launches are alike.
            if (!std::all_of(kernels.begin(), kernels.end(), has)) continue;
            for (const std::string& kernel : kernels) share_form_of(program / kernel);
        }
}

}  // namespace clarity
