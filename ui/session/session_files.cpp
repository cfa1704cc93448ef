// session_files.cpp -- files that change on the disk while the window runs: kernels, plugin libraries, the scene's files.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.hpp"
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
    if (importers && !asked_.files.empty()) reopen();
}

// Reads the same files again: camera, time and edits stay.
void Session::reopen() {
    const std::vector<PictureFile> pictures = asked_.pictures;
    const std::vector<Word> waiting = waiting_edits_;
    open(asked_.files);
    asked_.pictures = pictures;
    waiting_edits_ = waiting;
    reread_files_revision_ = asked_.files_revision;
}

bool Session::waits_for_picture(const Word& word) {
    const PictureFile picture = picture_of(word);
    if (picture.path.empty() || !ready_) return false;
    const auto is_known = [&](const PictureFile& known) { return known == picture; };
    const std::vector<PictureFile>& read = ready_->loaded->pictures;
    if (std::any_of(read.begin(), read.end(), is_known) && ready_->loaded->files_revision == asked_.files_revision) {
        // Unless it could not be read then.
        const std::string name = picture_name(picture.path);
        const std::vector<std::string>& names = ready_->loaded->scene->texture_names;
        if (std::find(names.begin(), names.end(), name) != names.end()) return false;
    }
    if (std::none_of(asked_.pictures.begin(), asked_.pictures.end(), is_known)) asked_.pictures.push_back(picture);
    waiting_edits_.push_back(word);
    reopen();
    pictures_revision_ = asked_.files_revision;
    return true;
}

void Session::apply(const Word& word) {
    if (!ready_) throw Error(Exit::usage, "no scene yet");
    if (waits_for_picture(word)) return;
    EditedView edited = edited_view(desired);
    apply_edit(*ready_->loaded->scene, edited, word.key, word.value);
    adopt_view(edited);
}

void Session::take_scene_files() {
    if (!scene_files_ || scene_files_->revision() == seen_scene_files_) return;
    seen_scene_files_ = scene_files_->revision();
    log(LogLevel::info, "changed: " + scene_files_->last_changed().front());
    if (asked_.files_revision == viewed_files_revision_ || asked_.files_revision == reread_files_revision_) reopen();
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
