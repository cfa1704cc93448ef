// script.hpp -- commands that drive the window in tests, from the file or pipe that CLARITY_UI_SCRIPT names.
//
// One command a line. Each runs between two frames on the window's thread and answers on stdout with `ok COMMAND` or `error
// COMMAND: why`. There are no commands for keys and mouse: tests send real events.
//   set KEY VALUE      a setting, as on the command line      accel ID[,key=value...]    device CHOICE
//   open FILE          as the Scene tab does                   tab NAME                   map thesis|viewer
//   drop ["FILE",...]  as if they were dropped onto the window  moving_fps N              while something moves; 0: all pixels
//   wait idle [S]      until all is prepared and traced, at most S seconds (60)
//   wait busy|ready    until something is being prepared; until nothing is (tracing may go on)
//   focus path         the keyboard into the path field        continuous 0|1             cancel
//   screenshot FILE    the window as PNG                       picture FILE               the traced picture as PNG
//   state              one line of JSON: what is shown, and how the window fares; `state reset` starts its maxima anew
//   find LABEL         where that row's widget, or that entry of a list, was drawn last: JSON x, y, w, h
//   scale FACTOR       of the text                             level N|bottom|off         quit
// The commands of picture_script.hpp work as well.
#pragma once
#include <deque>
#include <memory>
#include <string>

namespace clarity::ui {

class App;

class Script {
 public:
    // Opens the script that CLARITY_UI_SCRIPT names. Returns nullptr if it is not set. Throws Error(usage) if it cannot be
    // read.
    static std::unique_ptr<Script> from_environment();
    explicit Script(int file) : file_(file) {}
    ~Script();
    Script(const Script&) = delete;
    Script& operator=(const Script&) = delete;

    // Reads new lines. Returns whether there are lines to run.
    bool has_lines();
    // Runs the next line. A line that waits stays the next one.
    void step(App& app);

 private:
    void read_lines();
    // Runs one line. Returns false if it has to wait; it is then tried again in the next frame.
    bool run(App& app, const std::string& line);
    bool wait(App& app, const std::string& what);
    std::string state_text(App& app) const;

    int file_;
    std::string partial_;
    std::deque<std::string> lines_;
    double waiting_since_ = 0;
    int frames_left_ = 0;  // frames to draw before a wait may end, so that its result is on the screen
};

}  // namespace clarity::ui
