#include "ui/app/gl_window.hpp"

#include <epoxy/gl.h>
// Defined before GLFW is included, which would otherwise include the system's own GL header.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "base/error.hpp"
#include "ui/widgets/key_map.hpp"

namespace clarity::ui {
namespace {

constexpr float kDoubleClickSeconds = 0.3f;  // at most so long between the clicks of a double click, as ImGui's default

std::string& last_glfw_error() {
    static std::string text;
    return text;
}

[[noreturn]] void no_window(const std::string& why) {
    throw Error(Exit::usage, "cannot open a window: " + why + "; to render without one: clarity render SCENE -o out.png");
}

bool names_display(const char* variable) {
    const char* value = std::getenv(variable);
    return value && *value;
}

}  // namespace

// GLFW's callbacks. They are set before ImGui's, and ImGui's callbacks call them first; key() is set after and calls ImGui's.
struct Callbacks {
    static GlWindow& of(GLFWwindow* window) { return *static_cast<GlWindow*>(glfwGetWindowUserPointer(window)); }

    // ImGui is told the key that is meant, too, so that Ctrl+A, C, V, X and Z in its text fields follow the letters.
    static void key(GLFWwindow* window, int place, int scancode, int action, int mods) {
        GlWindow& self = of(window);
        self.any_event_ = true;
        const bool ctrl = mods & GLFW_MOD_CONTROL, other = mods & (GLFW_MOD_ALT | GLFW_MOD_SUPER);
        const int key = self.key_at(place, scancode, action == GLFW_RELEASE, mods & GLFW_MOD_NUM_LOCK);
        ImGui_ImplGlfw_KeyCallback(window, key, scancode, action, mods);
        if (!is_modifier(place)) ImGui::GetIO().KeyCtrl |= ctrl;  // ImGui knows the two Ctrl keys, but no key made one
        if (action == GLFW_REPEAT || key == GLFW_KEY_UNKNOWN) return;
        const auto kind = action == GLFW_PRESS ? KeyEvent::Kind::press : KeyEvent::Kind::release;
        self.keys_.push_back({key, kind, ctrl, other, glfwGetTime()});
    }
    static bool is_modifier(int place) { return place >= GLFW_KEY_LEFT_SHIFT && place <= GLFW_KEY_RIGHT_SUPER; }
    static void focus(GLFWwindow* window, int focused) {
        GlWindow& self = of(window);
        self.any_event_ = true;
        if (!focused) self.keys_.push_back({0, KeyEvent::Kind::lost_focus, false, false, glfwGetTime()});
    }
    static void drop(GLFWwindow* window, int count, const char** paths) {
        GlWindow& self = of(window);
        self.any_event_ = true;
        self.dropped_.assign(paths, paths + count);
    }
    static void character(GLFWwindow* window, unsigned) { of(window).any_event_ = true; }
    static void button(GLFWwindow* window, int button, int action, int) {
        GlWindow& self = of(window);
        self.any_event_ = true;
        if (button == GLFW_MOUSE_BUTTON_LEFT && action == GLFW_PRESS) ++self.left_presses_;
    }
    static void cursor(GLFWwindow* window, double, double) { of(window).any_event_ = true; }
    static void scroll(GLFWwindow* window, double, double) { of(window).any_event_ = true; }
    static void resized(GLFWwindow* window, int, int) { of(window).any_event_ = true; }
    static void refresh(GLFWwindow* window) { of(window).any_event_ = true; }
};

double KeyEvent::age_s() const {
    return glfwGetTime() - time_s;
}

GlWindow::GlWindow(const std::string& title, int width, int height, const std::string& ini_path) : ini_path_(ini_path) {
    // Without a display, glfwInit fails late or hangs on some systems. So check for one first.
    if (!names_display("DISPLAY") && !names_display("WAYLAND_DISPLAY"))
        no_window("there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)");
    glfwSetErrorCallback([](int, const char* text) { last_glfw_error() = text; });
    if (!glfwInit()) no_window(last_glfw_error());
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    glfwWindowHintString(GLFW_X11_CLASS_NAME, "clarity");
    glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "clarity");
    window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (!window_) {
        const std::string why = last_glfw_error();
        glfwTerminate();
        no_window("no OpenGL 3.3 core context (" + why + ")");
    }
    glfwSetWindowSizeLimits(window_, 640, 400, GLFW_DONT_CARE, GLFW_DONT_CARE);
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    const auto text = [](GLenum name) {
        const auto* value = reinterpret_cast<const char*>(glGetString(name));
        return std::string(value ? value : "?");
    };
    gl_text_ = "OpenGL " + text(GL_VERSION) + ", " + text(GL_RENDERER);
    glfwSetWindowUserPointer(window_, this);
    glfwSetWindowFocusCallback(window_, Callbacks::focus);
    glfwSetDropCallback(window_, Callbacks::drop);
    glfwSetCharCallback(window_, Callbacks::character);
    glfwSetMouseButtonCallback(window_, Callbacks::button);
    glfwSetCursorPosCallback(window_, Callbacks::cursor);
    glfwSetScrollCallback(window_, Callbacks::scroll);
    glfwSetFramebufferSizeCallback(window_, Callbacks::resized);
    glfwSetWindowRefreshCallback(window_, Callbacks::refresh);
    init_imgui();
}

void GlWindow::init_imgui() {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = ini_path_.empty() ? nullptr : ini_path_.c_str();
    io.LogFilename = nullptr;
    ImGui_ImplGlfw_InitForOpenGL(window_, true);
    glfwSetKeyCallback(window_, Callbacks::key);
    glfwSetInputMode(window_, GLFW_LOCK_KEY_MODS, GLFW_TRUE);  // callbacks are told the state of Num Lock
    ImGui_ImplOpenGL3_Init("#version 330 core");
}

GlWindow::~GlWindow() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window_);
    glfwTerminate();
}

bool GlWindow::closing() const {
    return glfwWindowShouldClose(window_);
}
void GlWindow::close() {
    glfwSetWindowShouldClose(window_, GLFW_TRUE);
}
void GlWindow::hide() {
    glfwHideWindow(window_);
}
void GlWindow::set_title(const std::string& title) {
    glfwSetWindowTitle(window_, title.c_str());
}
void GlWindow::wake() {
    glfwPostEmptyEvent();
}

bool GlWindow::wait_events(double seconds) {
    any_event_ = left_presses_ > 0;
    if (seconds > 0 && !any_event_)
        glfwWaitEventsTimeout(seconds);
    else
        glfwPollEvents();
    return any_event_;
}

// Returns the key that is meant by the one at `place`. The layout may change while a key is down: it is released as the key
// that was pressed.
int GlWindow::key_at(int place, int scancode, bool released, bool num_lock) {
    const auto [down, pressed] = down_.try_emplace(scancode, GLFW_KEY_UNKNOWN);
    if (pressed) down->second = meant_key(place, num_lock);
    const int key = down->second;
    if (released) down_.erase(down);
    return key;
}

std::vector<KeyEvent> GlWindow::take_keys() {
    return std::exchange(keys_, {});
}
std::vector<std::string> GlWindow::take_dropped_files() {
    return std::exchange(dropped_, {});
}

void GlWindow::drop(const std::vector<std::string>& files) {
    std::vector<const char*> paths;
    for (const std::string& file : files) paths.push_back(file.c_str());
    Callbacks::drop(window_, static_cast<int>(paths.size()), paths.data());
}

double GlWindow::content_scale() const {
    float x = 1, y = 1;
    glfwGetWindowContentScale(window_, &x, &y);
    // Where the framebuffer has more pixels than the window has coordinates (Wayland), ImGui scales by itself.
    int width = 0, height = 0, pixels_x = 0, pixels_y = 0;
    glfwGetWindowSize(window_, &width, &height);
    glfwGetFramebufferSize(window_, &pixels_x, &pixels_y);
    const double finer = width > 0 ? static_cast<double>(pixels_x) / width : 1.0;
    return std::clamp(static_cast<double>(x) / std::max(finer, 1.0), 0.5, 4.0);
}

void GlWindow::size(int& width, int& height) const {
    glfwGetWindowSize(window_, &width, &height);
}

void GlWindow::begin_frame() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    keep_clicks_apart();
    ImGui::NewFrame();
}

// ImGui looks at the mouse button once a frame. If a frame takes as long as a double click, both presses arrive before one
// frame, and ImGui would see a single click. So a frame with the button released, then one with it pressed follow for each
// further press.
void GlWindow::keep_clicks_apart() {
    ImGuiIO& io = ImGui::GetIO();
    io.MouseDoubleClickTime = (double_click_s_ > 0 ? double_click_s_ : kDoubleClickSeconds) +
                              2 * io.DeltaTime;  // the time of a press is known to a frame
    if (left_presses_ > 0) {
        io.MouseDown[0] = !left_was_down_;
        if (io.MouseDown[0]) --left_presses_;
    }
    left_was_down_ = io.MouseDown[0];
}

void GlWindow::end_frame() {
    draw();
    glfwSwapBuffers(window_);
}

void GlWindow::draw() {
    ImGui::Render();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    glViewport(0, 0, width, height);
    const ImVec4 ground = ImGui::GetStyleColorVec4(ImGuiCol_WindowBg);
    glClearColor(ground.x, ground.y, ground.z, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

ByteImage GlWindow::end_frame_and_read() {
    draw();
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    const size_t row_bytes = size_t{4} * static_cast<unsigned>(width);
    std::vector<uint8_t> rows(row_bytes * static_cast<unsigned>(height)), pixels;
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rows.data());
    glfwSwapBuffers(window_);
    for (size_t i = 3; i < rows.size(); i += 4) rows[i] = 255;
    pixels.reserve(rows.size());
    for (auto row = rows.end(); row != rows.begin();) {  // OpenGL stores the lowest row first
        row -= static_cast<std::ptrdiff_t>(row_bytes);
        pixels.insert(pixels.end(), row, row + static_cast<std::ptrdiff_t>(row_bytes));
    }
    return {static_cast<unsigned>(width), static_cast<unsigned>(height), std::move(pixels)};
}

std::string GlWindow::gl_text() const {
    return gl_text_;
}

}  // namespace clarity::ui
