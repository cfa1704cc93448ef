// session_files.cpp -- files that change on the disk while the window runs: kernels, plugin libraries, the scene's files.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/log.hpp"
#include "plugin/parameters.hpp"
#include "ui/session/session.hpp"

namespace clarity::ui {

void Session::take_kernels() {
    const uint64_t revision = kernels_->revision();
    if (revision == seen_kernels_) return;
    seen_kernels_ = revision;
    ++sources_revision_;
    for (const std::string& path : kernels_->last_changed()) log(LogLevel::info, "changed: " + path);
}

// Puts rebuilt plugin libraries into force: structures are built anew, files are read anew. A refused one is only reported.
void Session::take_libraries() {
    bool structures = false, importers = false;
    for (const RebuiltLibrary& library : libraries_.apply()) {
        if (!library.now) {
            messages_.report(library.why);
            continue;
        }
        ++sources_revision_;
        (library.now->importer ? importers : structures) = true;
        if (!library.before) continue;
        for (Side* side : {&desired.main, desired.other ? &*desired.other : nullptr})
            if (side && library.now->accel && side->settings.accel == library.now->id)
                side->settings.accel_params = carried_parameters(*library.before, *library.now, side->settings.accel_params);
        // Earlier steps hold values of parameters in the order of the library before.
        if (library.before->param_count != library.now->param_count) history_.forget();
    }
    if (structures) {  // the new library may have other kernel files
        kernels_ = std::make_unique<KernelWatch>(plugins_.accels(), wake_);
        seen_kernels_ = 0;
    }
    if (importers && !files_.empty()) reopen();
}

// Reads the same files again: camera, time and edits stay.
void Session::reopen() {
    open(files_);
    reread_files_revision_ = files_revision_;
}

void Session::take_scene_files() {
    if (!scene_files_ || scene_files_->revision() == seen_scene_files_) return;
    seen_scene_files_ = scene_files_->revision();
    log(LogLevel::info, "changed: " + scene_files_->last_changed().front());
    if (files_revision_ == viewed_files_revision_ || files_revision_ == reread_files_revision_) reopen();
}

void Session::watch_scene_files() {
    std::vector<std::string> files = ready_->loaded->scene->sources;
    files.insert(files.end(), ready_->loaded->files.begin(), ready_->loaded->files.end());
    scene_files_ = std::make_unique<FileWatch>(std::move(files), wake_, FileWatch::Rule::times);
    seen_scene_files_ = 0;
}

// What the user has changed of a scene that is read again, in words that hold for the new one.
std::vector<Word> Session::edits_to_keep(const Ready& before) const {
    EditedView edited = edited_view(desired);
    edited.camera_path = {};
    std::vector<Word> words = edits_between(*before.loaded->scene, first_view_of(before), edited);
    words.erase(std::remove_if(words.begin(), words.end(), [](const Word& word) { return word.key == "camera"; }), words.end());
    return words;
}

}  // namespace clarity::ui
