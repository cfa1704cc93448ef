#include "ui/overlay/gl_lines.hpp"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstddef>

#include "base/log.hpp"

namespace clarity::ui {
namespace {

constexpr size_t kManyLines = 40000;

const char* const kVertexShader = R"(#version 330 core
layout(location = 0) in vec2 place;  // pixels from the upper left
layout(location = 1) in vec3 along;  // 1 / depth, pixels from the middle of the line, half its width
layout(location = 2) in vec4 color;
uniform vec2 size;
noperspective out vec3 line;
noperspective out vec2 at;
flat out vec4 tint;
void main() {
    line = along;
    at = place / size;
    tint = color;
    gl_Position = vec4(at.x * 2.0 - 1.0, 1.0 - at.y * 2.0, 0.0, 1.0);
}
)";

const char* const kFragmentShader = R"(#version 330 core
noperspective in vec3 line;
noperspective in vec2 at;
flat in vec4 tint;
uniform sampler2D distances;
uniform vec2 half_size;
uniform bool tested;
uniform float behind, play;
out vec4 result;
void main() {
    float opacity = tint.a * clamp(line.z + 0.5 - abs(line.y), 0.0, 1.0);
    if (tested) {
        vec2 slope = (at * 2.0 - 1.0) * half_size;
        float distance = sqrt(1.0 + dot(slope, slope)) / line.x;
        if (distance > texture(distances, at).r * (1.0 + play)) opacity *= behind;
    }
    result = vec4(tint.rgb * opacity, opacity);
}
)";

// Compiles a shader. Returns 0 on failure, with the compiler's log in `failure`.
GLuint compile(GLenum kind, const char* text, std::string& failure) {
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint done = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (done) return shader;
    char words[1024] = "";
    glGetShaderInfoLog(shader, sizeof words, nullptr, words);
    glDeleteShader(shader);
    failure = words;
    return 0;
}

}  // namespace

LineLayer::~LineLayer() {
    if (program_) glDeleteProgram(program_);
    if (vertex_array_) glDeleteVertexArrays(1, &vertex_array_);
    if (vertices_) glDeleteBuffers(1, &vertices_);
    if (indices_) glDeleteBuffers(1, &indices_);
    if (frame_buffer_) glDeleteFramebuffers(1, &frame_buffer_);
    if (texture_) glDeleteTextures(1, &texture_);
}

bool LineLayer::make_program() {
    if (program_ || !failure_.empty()) return failure_.empty();
    const GLuint vertex = compile(GL_VERTEX_SHADER, kVertexShader, failure_);
    const GLuint fragment = vertex ? compile(GL_FRAGMENT_SHADER, kFragmentShader, failure_) : 0;
    if (fragment) {
        program_ = glCreateProgram();
        glAttachShader(program_, vertex);
        glAttachShader(program_, fragment);
        glLinkProgram(program_);
        GLint done = 0;
        glGetProgramiv(program_, GL_LINK_STATUS, &done);
        if (!done) {
            char words[1024] = "";
            glGetProgramInfoLog(program_, sizeof words, nullptr, words);
            failure_ = words;
        }
    }
    glDeleteShader(vertex);  // OpenGL ignores 0
    glDeleteShader(fragment);
    if (!failure_.empty()) {
        log(LogLevel::warning, "lines over the picture: this OpenGL does not take their shader: " + failure_);
        return false;
    }
    size_location_ = glGetUniformLocation(program_, "size");
    half_size_location_ = glGetUniformLocation(program_, "half_size");
    tested_location_ = glGetUniformLocation(program_, "tested");
    behind_location_ = glGetUniformLocation(program_, "behind");
    glUseProgram(program_);
    glUniform1i(glGetUniformLocation(program_, "distances"), 0);
    glUniform1f(glGetUniformLocation(program_, "play"), kDistancePlay);

    glGenVertexArrays(1, &vertex_array_);
    glGenBuffers(1, &vertices_);
    glGenBuffers(1, &indices_);
    glBindVertexArray(vertex_array_);
    glBindBuffer(GL_ARRAY_BUFFER, vertices_);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
    const auto offset = [](size_t bytes) { return reinterpret_cast<const void*>(bytes); };
    constexpr GLsizei stride = sizeof(LineVertex);
    glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(LineVertex, x)));
    glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, stride, offset(offsetof(LineVertex, inv_depth)));
    glVertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, offset(offsetof(LineVertex, color)));
    for (GLuint i = 0; i < 3; ++i) glEnableVertexAttribArray(i);
    return true;
}

bool LineLayer::resize(int width, int height) {
    if (texture_ && width == width_ && height == height_) return true;
    width_ = width;
    height_ = height;
    if (!texture_) {
        glGenTextures(1, &texture_);
        glGenFramebuffers(1, &frame_buffer_);
    }
    glBindTexture(GL_TEXTURE_2D, texture_);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);  // shown with one texel for each pixel
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    glBindFramebuffer(GL_FRAMEBUFFER, frame_buffer_);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
    const bool complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    if (!complete) failure_ = "no framebuffer of " + std::to_string(width) + "x" + std::to_string(height);
    return complete;
}

void LineLayer::fill_indices(size_t quads) {
    if (quads <= indexed_) return;
    indexed_ = std::max(quads, indexed_ * 2);
    std::vector<uint32_t> indices;
    indices.reserve(indexed_ * 6);
    for (uint32_t i = 0; i < indexed_; ++i)
        for (const uint32_t corner : {0u, 1u, 2u, 2u, 1u, 3u}) indices.push_back(4 * i + corner);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(uint32_t)), indices.data(),
                 GL_STATIC_DRAW);
}

void LineLayer::draw(const std::vector<const LineList*>& lists, const Projection& projection, float scale,
                     const LinesBehind& behind) {
    const Rect& area = projection.area();
    const int width = std::max(1, static_cast<int>(area.width * scale + 0.5f)),
              height = std::max(1, static_cast<int>(area.height * scale + 0.5f));
    if (!make_program() || !resize(width, height)) return;
    scratch_.clear();
    size_t wanted = 0;
    for (const LineList* list : lists) wanted += list->size();
    const bool thin = wanted > kManyLines;
    for (const LineList* list : lists)
        if (thin && list->size() > kManyLines / 2) append_thin(*list, projection, scale, {behind.values}, scratch_);
    const size_t ends = scratch_.size();
    for (const LineList* list : lists)
        if (!(thin && list->size() > kManyLines / 2)) append_quads(*list, projection, scale, scratch_);
    const size_t quads = (scratch_.size() - ends) / 4;
    drawn_ = ends / 2 + quads;

    glBindFramebuffer(GL_FRAMEBUFFER, frame_buffer_);
    glViewport(0, 0, width, height);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
    if (drawn_ > 0) {
        glEnable(GL_BLEND);
        glBlendEquation(GL_FUNC_ADD);
        glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        glUseProgram(program_);
        glUniform2f(size_location_, static_cast<float>(width), static_cast<float>(height));
        glUniform2f(half_size_location_, projection.half_size().x, projection.half_size().y);
        const bool tested = behind.distance != 0;
        glUniform1i(tested_location_, tested);
        glUniform1f(behind_location_, behind.opacity);
        glActiveTexture(GL_TEXTURE0);
        glBindTexture(GL_TEXTURE_2D, behind.distance);
        glBindVertexArray(vertex_array_);
        fill_indices(quads);
        glBindBuffer(GL_ARRAY_BUFFER, vertices_);
        glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(scratch_.size() * sizeof(LineVertex)), scratch_.data(),
                     GL_STREAM_DRAW);
        if (ends > 0) glDrawArrays(GL_LINES, 0, static_cast<GLsizei>(ends));
        if (quads > 0)
            glDrawElementsBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(quads * 6), GL_UNSIGNED_INT, nullptr,
                                     static_cast<GLint>(ends));
        glBindVertexArray(0);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

}  // namespace clarity::ui
