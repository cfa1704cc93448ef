// pace.hpp -- how much of a picture to launch at once.
#pragma once

namespace clarity {

// Drivers that also draw the desktop kill kernels after a second or two, and a launch under way cannot be cancelled: pieces aim
// at 200 ms, which leaves room for parts of a picture that take longer than others. Nothing is known of a first picture, so its
// pieces begin small, grow by steps and aim at less; later ones go by the slowest piece of the picture before.
class Pace {
 public:
    void forget() { known_ = 0; }
    void begin_picture();
    // Groups of the next piece: at least 1, at most `left` and `most`.
    unsigned next(unsigned left, unsigned most) const;
    void took(unsigned groups, double ms);
    // Of so many groups, by what is known; infinite if nothing is.
    double expected_ms(unsigned groups) const;
    void end_picture();

 private:
    double known_ = 0;  // groups per ms; 0: unknown
    // Of this picture:
    double slowest_ = 0, all_groups_ = 0, all_ms_ = 0;
    unsigned last_ = 0, pieces_ = 0;
};

}  // namespace clarity
