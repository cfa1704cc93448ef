#!/bin/bash
# clocks_test.sh SOURCE_FOLDER -- no test asks a clock but by tests/support/clock.hpp: a busy machine must not turn a test red. Prints the
# lines that do: bounds on times that always count, and waits that end after a number of looks. `tests/farm` runs in full_test alone.
set -u
cd "$1/tests" || exit 1
find_in() { grep -rnE --include='*.cpp' --include='*.hpp' --include='*.c' --include='*.py' "$1" . | grep -vE '^\./(farm|fuzz)/|^\./support/clock\.hpp|no clock:'; }
lines="$(
    # Bounds from above on what is named as a time; ratios of figures and counts of samples are not.
    find_in '(EXPECT|ASSERT)_L[TE]\(.*(seconds|_since\(|elapsed|took|_answer_ms|_frame_ms"\]\)|best_ms)' | grep -vE 'at_most\(|clocks_count\(|"(min|median)"\]'
    find_in 'for \(.*<.*\) *(\{ *)?(usleep|std::this_thread::sleep|time\.sleep)'
    find . -name '*.cpp' | sort | xargs awk '/sleep/ && before ~ /for \(int i = 0; i < [0-9]+ &&/ { print FILENAME ":" FNR - 1 ":" before } { before = $0 }'
    find_in 'wait_for\([^,]*, *std::chrono::(milli)?seconds\([0-9]'
    find_in '(while|for) \(.*seconds_since\([a-z]+\) < [0-9]'
)"
[ -z "$lines" ] && exit 0
echo "These lines depend on the clock. Wait for a state by comes(), or bound a time by at_most() (tests/support/clock.hpp):"
echo "$lines"
exit 1
