// window_driver.hpp -- runs the program on its own X server (Xvfb) and drives it with real events through xdotool, and with the
// commands of the window's script (ui/automation/script.hpp).
#pragma once
#include <sys/types.h>

#include <array>
#include <chrono>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/clock.hpp"

namespace clarity::ui {

struct Pixels {
    int width = 0, height = 0;
    std::vector<unsigned char> rgb;
};
Pixels read_png(const std::string& path);
// The share of pixels that differ by more than `tolerance` of 255 in any channel; 1 if the sizes differ.
double difference(const Pixels& a, const Pixels& b, int tolerance = 8);

// A folder that is deleted after the test.
class TemporaryFolder {
 public:
    TemporaryFolder();
    ~TemporaryFolder();
    const std::string& path() const { return path_; }

 private:
    std::string path_;
};

// An X server on a free display, shared by all tests of the program.
class VirtualScreen {
 public:
    static VirtualScreen& instance();
    // Why there is no X server: the program that is missing. Empty if there is one.
    const std::string& missing() const { return missing_; }
    std::string display() const { return ":" + std::to_string(number_); }

 private:
    VirtualScreen();
    ~VirtualScreen();
    std::string missing_;
    int number_ = -1;
    pid_t pid_ = -1;
};

std::string source_path(const std::string& relative);
// The path of a file among the larger models; empty if they are not there.
std::string shared_path(const std::string& relative);
// The path of the executable under test.
std::string program_path();
using test::at_most;
using test::clocks_count;
using test::comes;
using test::seconds_since;

// A position on the screen in pixels.
struct Place {
    double x = 0, y = 0;
};
enum class Button { left = 1, middle = 2, right = 3 };

class WindowDriver {
 public:
    // arguments: those after `clarity view`. environment: further variables to set; the value "" removes a variable.
    explicit WindowDriver(const std::vector<std::string>& arguments, std::map<std::string, std::string> environment = {});
    ~WindowDriver();

    // Sends a script line and waits for its answer. Returns an empty text for ok, otherwise the error.
    std::string command(const std::string& line, double seconds = test::kHangs_s);
    void settle(double seconds = test::kHangs_s);  // waits until idle; the test fails if that does not happen
    nlohmann::json state();
    nlohmann::json query(const std::string& line);  // for commands that answer with JSON
    Pixels picture();
    Pixels screenshot();
    void send(const std::string& line);  // does not wait for the answer

    // Returns whether the state meets the condition within `seconds`.
    using Condition = std::function<bool(const nlohmann::json& state)>;
    bool reaches(const Condition& condition, double seconds = test::kHangs_s);

    // Real events through xdotool. Keys have their X names: "Left", "ctrl+z".
    void key(const std::string& name);
    void key_down(const std::string& name);
    void key_up(const std::string& name);
    void tap(const std::string& name);  // holds the key for a frame, for widgets, which read keys once a frame
    void type(const std::string& text);
    void move(const Place& to);
    void click(double x, double y);
    void click(const Place& at, Button button = Button::left);
    void double_click(const Place& at);
    void double_click_in_one_frame(const Place& at);  // as on a machine that is too busy to draw between the clicks
    // Presses the button, moves in steps, releases.
    void drag(const Place& from, const Place& to, Button button = Button::left);
    void wheel(const Place& at, int steps);  // steps > 0: away from the user
    // Clicks the widget in this row, or this entry of an open list. at: horizontal position in it, 0..1 from the left.
    void click_on(const std::string& label, double at = 0.5);
    Place place_of(const std::string& label, double at = 0.5);
    // The screen position of a pixel of a picture. picture: 1 for the second one, if two are shown.
    Place place_of_pixel(double x, double y, size_t picture = 0);
    void take_focus();  // gives the keyboard to this window

    // Returns the next line of stdout that begins with `prefix`; empty if there is none within `seconds`.
    std::string line(const std::string& prefix, double seconds = test::kHangs_s);
    void quit();               // and waits until the program has ended
    void quit_by(int signal);  // the same
    bool running();
    int exit_code() const { return exit_code_; }
    const std::string& folder() const { return folder_.path(); }
    std::string errors() const;  // the program's stderr

 private:
    void xdotool(const std::string& arguments);
    void mouse(const std::string& event);
    void pass_frame();
    bool read_more(double seconds);
    bool reap(bool wait);

    TemporaryFolder folder_;
    pid_t pid_ = -1;
    int script_ = -1, output_ = -1, exit_code_ = -1;
    std::string pending_;
    std::vector<std::string> lines_;  // lines which were read but not yet returned
    int pictures_ = 0;
};

}  // namespace clarity::ui
