// pace.hpp -- how many work-groups to launch at once.
#pragma once

namespace clarity {

// Pieces of a picture aim at 200 ms each. Drivers that also draw the desktop kill kernels after one or two seconds, and a
// running launch cannot be cancelled; 200 ms leaves room for parts of a picture that take longer than others. Later pictures
// use the pace of the slowest piece of the previous picture. For a first picture nothing is known, so its pieces begin small,
// grow by a factor and aim at 50 ms.
class Pace {
 public:
    void forget() { known_ = 0; }
    // Groups take so many times as long from now on.
    void slow_down(double times) { known_ /= times; }
    void begin_picture();
    // Returns the number of groups of the next piece: at least 1, at most `left` and `most`.
    unsigned next(unsigned left, unsigned most) const;
    // Records that a piece of so many groups took `ms`.
    void took(unsigned groups, double ms);
    // Expected time of that many groups, in ms; infinite if nothing is known.
    double expected_ms(unsigned groups) const;
    void end_picture();

 private:
    double known_ = 0;  // groups per ms, from the previous picture; 0: unknown
    // Of the current picture: pace of the slowest piece (groups per ms), totals, size of the last piece, number of pieces.
    double slowest_ = 0, all_groups_ = 0, all_ms_ = 0;
    unsigned last_ = 0, pieces_ = 0;
};

}  // namespace clarity
