// team_choice.hpp -- whether devices that share a picture are faster than the fastest of them alone: by trial.
//
// A slow device beside a fast one brings little, and its launches, its thread and the wait for its last tile cost time. So
// where the gain is in doubt, pictures are traced both ways, and then in the faster way (render/tracers/rays/autotuner.hpp):
// three pictures each way at first, and two each when the choice is reviewed, after 16, 64, 256 ... pictures. The others have
// to save 3 % of the time.
#pragma once
#include "render/tracers/rays/autotuner.hpp"

namespace clarity {

// Used from one thread.
class TeamChoice {
 public:
    // Whether the next picture is for the fastest device alone.
    bool alone() const { return doubtful_ && tuner_.variant() == 0; }
    // The picture took `ms` a sample. greatest_share: of the work, that of the fastest device by the known speeds.
    void took(double ms, double greatest_share) {
        if (doubtful_)
            tuner_.took(ms);
        else
            doubtful_ = greatest_share > kMostOfTheWork || ms < kShort;
    }

 private:
    static constexpr double kMostOfTheWork = 0.8;  // then the others can save a fifth of the time at best
    static constexpr double kShort = 2;            // ms: so short that threads and launches count

    bool doubtful_ = false;
    Autotuner tuner_{2};
};

}  // namespace clarity
