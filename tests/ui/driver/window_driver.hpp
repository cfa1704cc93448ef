// window_driver.hpp -- runs the program on an X server of its own (Xvfb) and drives it: real events through xdotool, the rest
// through the window's script (ui/script.hpp).
#pragma once
#include <sys/types.h>

#include <array>
#include <chrono>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace clarity::ui {

struct Pixels {
    int width = 0, height = 0;
    std::vector<unsigned char> rgb;
};
Pixels read_png(const std::string& path);
// Share of the pixels that differ by more than `tolerance` of 255 in a channel; 1 if the sizes differ.
double difference(const Pixels& a, const Pixels& b, int tolerance = 8);

// A folder that is gone after the test.
class TemporaryFolder {
 public:
    TemporaryFolder();
    ~TemporaryFolder();
    const std::string& path() const { return path_; }

 private:
    std::string path_;
};

// An X server on a free display; one for all tests of the program.
class VirtualScreen {
 public:
    static VirtualScreen& instance();
    // Empty if there is one, else what is missing.
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
// The larger models; empty if they are not there.
std::string shared_path(const std::string& relative);
// The executable under test.
std::string program_path();
double seconds_since(std::chrono::steady_clock::time_point begin);

// On the screen, in pixels.
struct Place {
    double x = 0, y = 0;
};
enum class Button { left = 1, middle = 2, right = 3 };

class WindowDriver {
 public:
    // arguments after `clarity view`; environment: variables to set besides those of a test, "" removes one.
    explicit WindowDriver(const std::vector<std::string>& arguments, std::map<std::string, std::string> environment = {});
    ~WindowDriver();

    // Sends a script line and waits for its answer: empty for ok, else the error.
    std::string command(const std::string& line, double seconds = 90);
    void settle(double seconds = 90);  // wait idle; a failure of the test if it does not come
    nlohmann::json state();
    nlohmann::json query(const std::string& line);  // a command that answers with JSON
    Pixels picture();
    Pixels screenshot();
    void send(const std::string& line);  // without waiting

    // Whether the state comes to be so, within so many seconds.
    using Condition = std::function<bool(const nlohmann::json& state)>;
    bool reaches(const Condition& condition, double seconds = 60);

    // Real events, by xdotool. Keys by their X names: "Left", "ctrl+z".
    void key(const std::string& name);
    void key_down(const std::string& name);
    void key_up(const std::string& name);
    void tap(const std::string& name);  // over a frame: what a widget is to see, which looks at keys once a frame
    void type(const std::string& text);
    void move(const Place& to);
    void click(double x, double y);
    void click(const Place& at, Button button = Button::left);
    void double_click(const Place& at);
    // Pressed, moved in steps, released.
    void drag(const Place& from, const Place& to, Button button = Button::left);
    void wheel(const Place& at, int steps);  // > 0: away from the user
    // The middle of the widget of that row, or of that entry of an open list; `at` from its left, 0..1.
    void click_on(const std::string& label, double at = 0.5);
    Place place_of(const std::string& label, double at = 0.5);
    // Of a pixel of the picture; of the second one, while two are shown.
    Place place_of_pixel(double x, double y, size_t picture = 0);
    void take_focus();  // of the keyboard, from whatever window has it

    // The next line of stdout that begins so; empty after so many seconds.
    std::string line(const std::string& prefix, double seconds);
    void quit();  // and waits for the end
    bool running();
    int exit_code() const { return exit_code_; }
    const std::string& folder() const { return folder_.path(); }
    std::string errors() const;  // what it wrote to stderr

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
    std::vector<std::string> lines_;  // read, not asked for yet
    int pictures_ = 0;
};

}  // namespace clarity::ui
