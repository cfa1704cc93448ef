// gl_window.hpp -- one GLFW window with an OpenGL 3.3 core context and Dear ImGui on it; the events of its keys.
#pragma once
#include <string>
#include <vector>

#include "render/film/image_io.hpp"

struct GLFWwindow;

namespace clarity::ui {

struct KeyEvent {
    int key = 0;
    enum class Kind { press, release, lost_focus } kind = Kind::press;
    bool ctrl = false;
    bool other_modifier = false;  // Alt or Super
    double time_s = 0;            // as glfwGetTime counts
    double age_s() const;
};

class GlWindow {
 public:
    // Throws Error(usage) where there is no display or no OpenGL 3.3: what failed, and how to render without a window.
    // ini_path: where ImGui keeps its state; empty: nowhere.
    GlWindow(const std::string& title, int width, int height, const std::string& ini_path);
    ~GlWindow();
    GlWindow(const GlWindow&) = delete;
    GlWindow& operator=(const GlWindow&) = delete;

    bool closing() const;
    void close();
    void hide();
    void set_title(const std::string& title);
    // Waits for events, at most so long; returns whether any came to the window's callbacks or a thread called wake().
    bool wait_events(double seconds);
    static void wake();  // from any thread, while a GlWindow lives

    std::vector<KeyEvent> take_keys();
    std::vector<std::string> take_dropped_files();
    void drop(const std::vector<std::string>& files);  // as if a user did: through the callback
    double content_scale() const;                      // 1 at 96 dpi
    void size(int& width, int& height) const;

    void begin_frame();
    void end_frame();  // draws what ImGui collected, and shows it
    // As end_frame(), and returns what was drawn: RGBA8, top row first.
    ByteImage end_frame_and_read();
    std::string gl_text() const;  // "OpenGL 4.5, llvmpipe (...)"

 private:
    void init_imgui();
    void draw();

    GLFWwindow* window_ = nullptr;
    std::vector<KeyEvent> keys_;
    std::vector<std::string> dropped_;
    bool any_event_ = false;
    std::string ini_path_;  // ImGui keeps the pointer
    std::string gl_text_;
    friend struct Callbacks;
};

}  // namespace clarity::ui
