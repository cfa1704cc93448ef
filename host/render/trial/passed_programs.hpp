// passed_programs.hpp -- programs that have passed a trial, in this process and in earlier ones: a file for each in
// $XDG_CACHE_HOME/clarity/tried_kernels.
#pragma once
#include <string>

namespace clarity {

// One program. For any thread.
class PassedProgram {
 public:
    // text: all that its trial depends on.
    explicit PassedProgram(const std::string& text);
    bool known() const;
    void keep() const;

 private:
    std::string name_;
};

}  // namespace clarity
