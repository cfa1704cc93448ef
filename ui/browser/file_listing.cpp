#include "ui/browser/file_listing.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <dirent.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <mutex>
#include <thread>

#include "ui/widgets/formats.hpp"

namespace clarity::ui {
namespace {

namespace fs = std::filesystem;

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
}
std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](char c) { return lower(c); });
    return text;
}

bool wanted(const DesiredListing& desired, const FileEntry& entry) {
    if (entry.folder) return true;
    if (!desired.files) return false;
    if (desired.extensions.empty()) return true;
    const std::string name = lower(entry.name);
    return std::any_of(desired.extensions.begin(), desired.extensions.end(), [&](const std::string& extension) {
        return name.size() > extension.size() + 1 &&
               name.compare(name.size() - extension.size(), extension.size(), extension) == 0 &&
               name[name.size() - extension.size() - 1] == '.';
    });
}

bool before(const FileEntry& a, const FileEntry& b) {
    if (a.folder != b.folder) return a.folder;
    const std::string x = lower(a.name), y = lower(b.name);
    return x != y ? x < y : a.name < b.name;
}

bool begins_with(const std::string& text, const std::string& word) {
    return text.size() >= word.size() &&
           std::equal(word.begin(), word.end(), text.begin(), [](char a, char b) { return lower(a) == lower(b); });
}

}  // namespace

std::string absolute_folder(const std::string& folder) {
    std::error_code error;
    const fs::path path = fs::absolute(folder.empty() ? "." : folder, error).lexically_normal();
    std::string text = error ? folder : path.string();
    while (text.size() > 1 && text.back() == '/') text.pop_back();
    return text;
}

Listing list_folder(const DesiredListing& desired) {
    Listing listing;
    listing.folder = absolute_folder(desired.folder);
    const std::unique_ptr<DIR, int (*)(DIR*)> folder(opendir(listing.folder.c_str()), closedir);
    if (!folder) {
        listing.failure = std::string("cannot be read: ") + std::strerror(errno);
        return listing;
    }
    while (const dirent* found = readdir(folder.get())) {
        if (found->d_name[0] == '.') continue;
        FileEntry entry;
        entry.name = found->d_name;
        struct stat about{};
        if (fstatat(dirfd(folder.get()), found->d_name, &about, 0) != 0) continue;  // deleted meanwhile, or a broken link
        entry.folder = S_ISDIR(about.st_mode);
        if (!entry.folder && !S_ISREG(about.st_mode)) continue;
        entry.bytes = static_cast<uint64_t>(about.st_size);
        entry.modified_s = about.st_mtime;
        if (wanted(desired, entry)) listing.entries.push_back(std::move(entry));
    }
    std::sort(listing.entries.begin(), listing.entries.end(), before);
    return listing;
}

std::string home_folder() {
    const char* home = std::getenv("HOME");
    return home && *home == '/' ? home : "/";
}

std::string joined_path(const std::string& folder, const std::string& name) {
    return (fs::path(folder) / name).string();
}

std::string parent_folder(const std::string& folder) {
    return absolute_folder(fs::path(absolute_folder(folder)).parent_path().string());
}

Typed split_typed(const std::string& text, const std::string& folder) {
    std::string path = text;
    if (path == "~" || path.compare(0, 2, "~/") == 0) path = home_folder() + path.substr(1) + (path == "~" ? "/" : "");
    const size_t slash = path.find_last_of('/');
    if (slash == std::string::npos) return {absolute_folder(folder), path};
    const std::string in = path.substr(0, slash + 1);
    return {absolute_folder(in.front() == '/' ? in : joined_path(folder, in)), path.substr(slash + 1)};
}

std::vector<size_t> matching(const Listing& listing, const std::string& word) {
    std::vector<size_t> first, others;
    for (size_t i = 0; i < listing.entries.size(); ++i) {
        const std::string& name = listing.entries[i].name;
        if (begins_with(name, word))
            first.push_back(i);
        else if (lower(name).find(lower(word)) != std::string::npos)
            others.push_back(i);
    }
    first.insert(first.end(), others.begin(), others.end());
    return first;
}

std::string complete(const Listing& listing, const std::string& text) {
    const size_t slash = text.find_last_of('/'), begin = slash == std::string::npos ? 0 : slash + 1;
    const std::string word = text.substr(begin);
    if (word.empty() || text == "~") return text;
    std::string common;
    size_t count = 0;
    bool folder = false;
    for (const FileEntry& entry : listing.entries) {
        if (!begins_with(entry.name, word)) continue;
        if (count++ == 0) {
            common = entry.name;
            folder = entry.folder;
            continue;
        }
        const size_t shorter = std::min(common.size(), entry.name.size());
        const auto differs =
            std::mismatch(common.begin(), common.begin() + static_cast<std::ptrdiff_t>(shorter), entry.name.begin());
        common.erase(differs.first, common.end());
    }
    if (count == 0 || common.size() < word.size()) return text;
    // Cut at a whole UTF-8 character.
    if (count > 1)
        while (common.size() > word.size() && (static_cast<unsigned char>(common.back()) & 0x80)) common.pop_back();
    return text.substr(0, begin) + common + (count == 1 && folder ? "/" : "");
}

struct FolderReader::Shared {
    std::mutex mutex;
    uint64_t asked = 0, done = 0;
    std::shared_ptr<const Listing> latest;
};

void FolderReader::stop() {
    if (!shared_) return;
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    ++shared_->asked;
}

std::shared_ptr<const Listing> FolderReader::get(const DesiredListing& desired) {
    if (!shared_) shared_ = std::make_shared<Shared>();
    std::string key = desired.folder + (desired.files ? "\n" : "/\n");
    for (const std::string& extension : desired.extensions) key += extension + " ";
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    if (key != asked_ || stale_) {
        asked_ = key;
        stale_ = false;
        const uint64_t number = ++shared_->asked;
        std::thread([shared = shared_, desired, number] {
            auto listing = std::make_shared<const Listing>(list_folder(desired));
            const std::lock_guard<std::mutex> hold(shared->mutex);
            if (shared->asked != number) return;  // another folder was requested meanwhile, or the window is gone
            shared->latest = std::move(listing);
            shared->done = number;
            glfwPostEmptyEvent();  // wakes the window
        }).detach();
    }
    return shared_->latest;
}

bool FolderReader::reading() const {
    if (!shared_) return false;
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    return shared_->done != shared_->asked;
}

}  // namespace clarity::ui
