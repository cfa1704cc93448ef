// source_writer.hpp -- composes OpenCL C from defines and files.
#pragma once
#include <sstream>
#include <string>

#include "device/kernel_files.hpp"

namespace clarity {

class SourceWriter {
 public:
    void line(const std::string& text) { out_ << text << '\n'; }
    // Define a number as an int, or as a uint.
    void define_int(const std::string& name, unsigned value) { out_ << "#define " << name << ' ' << value << '\n'; }
    void define_uint(const std::string& name, unsigned value) { out_ << "#define " << name << ' ' << value << "u\n"; }
    void undef(const std::string& name) { out_ << "#undef " << name << '\n'; }
    // Appends a text. #line lets compiler messages name the author's file and line.
    void part(const std::string& name, const std::string& text) { out_ << "#line 1 \"" << name << "\"\n" << text << '\n'; }
    // Appends a file of cl/: in development from disk, else the embedded text.
    void include(const std::string& name) { part("cl/" + name, kernel_text(name)); }
    // Appends a plugin's file likewise.
    void include(const rt_plugin& plugin, const rt_cl_file& file) {
        part(plugin_kernel_name(plugin, file), plugin_kernel_text(plugin, file));
    }
    std::string text() const { return out_.str(); }

 private:
    std::ostringstream out_;
};

}  // namespace clarity
