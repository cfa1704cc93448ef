// gl_window.hpp -- a GLFW window with an OpenGL 3.3 core context, Dear ImGui, and the key events of the window.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "base/pictures/image_io.hpp"

struct GLFWwindow;

namespace clarity::ui {

// A key that was pressed or released, or the loss of the keyboard focus.
struct KeyEvent {
    int key = 0;  // GLFW's code of the key that is meant (widgets/key_map.hpp)
    enum class Kind { press, release, lost_focus } kind = Kind::press;
    bool ctrl = false;
    bool other_modifier = false;  // Alt or Super
    double time_s = 0;            // time of the event, as glfwGetTime() counts
    // Seconds since the event.
    double age_s() const;
};

// A window. Used on the main thread only, except for wake().
class GlWindow {
 public:
    // Throws Error(usage) if there is no display or no OpenGL 3.3. The message says what failed and how to render without a
    // window.
    // ini_path: file in which ImGui keeps its state; empty: ImGui keeps none.
    GlWindow(const std::string& title, int width, int height, const std::string& ini_path);
    ~GlWindow();
    GlWindow(const GlWindow&) = delete;
    GlWindow& operator=(const GlWindow&) = delete;

    bool closing() const;
    void close();
    // For tests: how many seconds may be between the clicks of a double click; 0: as usual.
    void set_double_click_s(float seconds) { double_click_s_ = seconds; }
    void hide();
    void set_title(const std::string& title);
    // Waits for events, at most `seconds`. Returns whether a callback of the window was called or a thread called wake().
    bool wait_events(double seconds);
    static void wake();  // ends wait_events(); from any thread, while a GlWindow exists

    // Return the events since the last call, oldest first, and forget them.
    std::vector<KeyEvent> take_keys();
    std::vector<std::string> take_dropped_files();
    void drop(const std::vector<std::string>& files);  // calls the drop callback, as if a user had dropped the files
    double content_scale() const;                      // 1 at 96 dpi
    void size(int& width, int& height) const;

    void begin_frame();
    void end_frame();  // draws what ImGui collected and shows it
    // Like end_frame(), but also returns the frame: RGBA8, top row first.
    ByteImage end_frame_and_read();
    std::string gl_text() const;  // "OpenGL 4.5, llvmpipe (...)"

 private:
    void init_imgui();
    void keep_clicks_apart();
    int key_at(int place, int scancode, bool released, bool num_lock);
    void draw();

    GLFWwindow* window_ = nullptr;
    std::vector<KeyEvent> keys_;
    std::map<int, int> down_;  // keys that are down, by scancode: what each means
    std::vector<std::string> dropped_;
    bool any_event_ = false;
    float double_click_s_ = 0;    // see set_double_click_s()
    int left_presses_ = 0;        // presses of the left mouse button which ImGui has not seen
    bool left_was_down_ = false;  // what ImGui saw in the last frame
    std::string ini_path_;        // a member, because ImGui keeps a pointer to its text
    std::string gl_text_;
    friend struct Callbacks;
};

}  // namespace clarity::ui
