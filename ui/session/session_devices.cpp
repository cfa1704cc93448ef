// session_devices.cpp -- what the window does when devices are lost while they trace.
#include <cmath>
#include <string>
#include <utility>

#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "device/launch_limit.hpp"
#include "ui/session/session.hpp"

namespace clarity::ui {

// Remembers what the posted job is made of. changed: it traces other frames than the job before it.
void Session::note_sides(bool changed) {
    const PrepareRequest& request = ready_->request;
    posted_sides_ = {
        {request.main.device, frame_settings(request.main.settings, desired.main.settings)}, {}, request.kernel_revision};
    if (request.other && desired.other)
        posted_sides_.other = {request.other->device, frame_settings(request.other->settings, desired.other->settings)};
    if (changed && (ready_->lost() || lost_again_) && !edited_since_shown()) {  // the user tries another view
        posted_request_.reset();
        lost_again_ = false;
    }
}

bool Session::edited_since_shown() const {
    return shown_sides_ && shown_sides_->kernel_revision != sources_revision_;
}

// Devices were lost while something was prepared on them. If they were those of a picture, take_lost_devices() goes on.
void Session::note_lost_again() {
    if (!ready_ || ready_->lost()) return;
    lost_again_ = true;
    keeps_message_ = false;
    messages_.add(". The device is opened anew when the view or a setting changes");
}

// A launch did not end, or the driver failed. The worker opens lost devices anew with the next request, which this posts, with
// the settings of the last picture. If devices are lost again before there was another picture, or kernels were saved since
// that picture, nothing is tried until the user changes something.
void Session::take_lost_devices() {
    if (!ready_ || !ready_->lost() || lost_.lock() == ready_) return;
    if (worker_.activity().busy || worker_.has_outcomes()) return;  // it may have found that out itself, and then says why
    lost_ = ready_;
    const bool again = picture_when_lost_ && picture_when_lost_ == picture_;
    picture_when_lost_ = picture_;
    std::string next = "The device is opened anew, with the settings of the last picture";
    if (edited_since_shown()) {
        next = "The device is opened anew when the kernels are saved";
    } else if (again) {
        next = "The device is opened anew when the view or a setting changes";
    } else {
        keeps_message_ = true;
        if (shown_sides_) {
            desired.main = shown_sides_->main;
            desired.other = shown_sides_->other;
        }
        posted_request_.reset();
    }
    log(LogLevel::info, next);
    if (!messages_.shown().text.empty()) messages_.add(". " + next);
}

// A launch on a GPU has a limit of its own. On a CPU nothing stops a launch, and a driver may hang in a call: then all that can
// be done is to say so.
void Session::watch_tracing() {
    const double silent_s = frames_.silent_s();
    const bool silent = silent_s > 1.5 * launch_limit_s() && !PendingWrite::any();  // the same thread saves pictures
    if (silent && !told_silent_)
        messages_.report(
            "tracing has given no sign of life for " + std::to_string(std::lround(silent_s)) +
            " s: a launch does not end, or the driver does not return from a call, and neither can be stopped. The last "
            "picture stays. If kernels were edited, they may loop for ever. Close the window to end the program");
    told_silent_ = silent;
}

}  // namespace clarity::ui
