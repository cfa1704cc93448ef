// script.hpp -- commands that drive the window in tests, from the file or pipe that CLARITY_UI_SCRIPT names.
//
// One command a line. Each runs between two frames on the window's thread and answers on stdout with `ok COMMAND` or `error
// COMMAND: why`. There are no commands for keys and mouse: tests send real events.
//   set KEY VALUE               a setting, as on the command line
//   accel ID[,key=value...]     the structure
//   device CHOICE               the device, as for --device
//   open FILE                   opens a file, like the Scene tab
//   drop ["FILE",...]           opens files as if they were dropped onto the window
//   tab NAME                    the panel's tab
//   map thesis|viewer           the key map
//   moving_fps N                frame rate to hold while something moves; 0: all pixels
//   double_click S              seconds between the clicks of a double click, at most; 0: as usual
//   continuous 0|1              trace again and again, to measure
//   cancel                      cancels what is being prepared
//   quit                        closes the window
//   wait idle [S]               until everything is prepared and traced, at most S seconds (60)
//   wait busy|ready             until something is being prepared; until nothing is (tracing may go on)
//   focus path                  the path field gets the keyboard
//   scale FACTOR                of the text
//   level N|bottom|off          level of the bounding volumes
//   screenshot FILE             the window as PNG
//   picture FILE                the traced picture as PNG
//   state                       one line of JSON: the state of the window and its times; `state reset` resets the maxima
//   edit KEY VALUE              changes the view, in the words of edit.hpp: `edit background 1,0,0`
//   compare a|b|off             starts or ends the comparison; a, b: the side that later commands change
//   swap, undo, redo            as the buttons do
//   save FILE                   saves the picture once its samples are traced
//   save_preset FILE            and `load_preset FILE`
//   command_line FILE           the `clarity render` command for this picture: JSON command
//   turntable N FILE            a sequence of N pictures; FILE has #### for the number
//   inspect X Y, pick X Y       traces a pixel's rays; pick also selects what the camera ray hit
//   inspection                  the traced rays as JSON
//   why X Y                     traces a pixel's samples once more, to say why it is noisy
//   noise                       what that said, as JSON
//   find LABEL                  rectangle of this row's widget or list entry, as last drawn: JSON x, y, w, h
// The commands of script_commands.hpp work as well.
#pragma once
#include <deque>
#include <memory>
#include <string>

namespace clarity::ui {

struct ScriptedWindow;

// Reads the commands and runs them. Used on the window's thread.
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
    // Whether the next line waits until work is done. Frames that are drawn meanwhile only take processors from that work.
    bool waits_for_work() const { return waits_for_work_; }
    // Runs the next line. A line that waits stays the next one.
    void step(ScriptedWindow& window);

 private:
    void read_lines();
    // Runs one line. Returns false if it has to wait; it is then tried again in the next frame.
    bool run(ScriptedWindow& window, const std::string& line);
    // These two return false likewise.
    bool wait(ScriptedWindow& window, const std::string& what);
    bool find(const std::string& label);
    std::string state_text(ScriptedWindow& window) const;

    int file_;
    std::string partial_;
    std::deque<std::string> lines_;
    double waiting_since_ = 0;
    bool waits_for_work_ = false;
    int frames_left_ = 0;  // frames to draw before a wait may end, so that its result is on the screen
};

}  // namespace clarity::ui
