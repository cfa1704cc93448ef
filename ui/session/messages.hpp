// messages.hpp -- the message over the picture.
#pragma once
#include <cstdint>
#include <string>

#include "base/log.hpp"

namespace clarity::ui {

// It stays until it is dismissed or its cause is gone.
struct WindowMessage {
    std::string text, details;
};

// Used on the window's thread.
class Messages {
 public:
    // Shows a failure, in place of the last one, and logs it.
    void report(const std::string& text, const std::string& details = {}) {
        log(LogLevel::error, details.empty() ? text : text + "\n" + details);
        shown_ = {text, details};
        ++count_;
    }
    const WindowMessage& shown() const { return shown_; }  // without text: none
    void add(const std::string& text) { shown_.text += text; }
    void dismiss() { shown_ = {}; }
    uint64_t count() const { return count_; }  // of all that were reported

 private:
    WindowMessage shown_;
    uint64_t count_ = 0;
};

}  // namespace clarity::ui
